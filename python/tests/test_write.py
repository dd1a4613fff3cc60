"""Writing a mesh with its curvature: the files are those of ``convert``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def both(tmp_path: Path, source: Path, name: str, estimation: Any = {}, **look: Any) -> tuple[Any, Any]:
    """Writes by ``convert`` and by ``write``; what each tells."""
    converted, written = tmp_path / "converted", tmp_path / "written"
    for folder in (converted, written):
        folder.mkdir()
    besides = {key: value for key, value in look.items() if key in ("edges", "legend")}

    def settings(folder: Path) -> Any:
        return {**look, **{key: folder / value for key, value in besides.items()}}

    attributes = {"attributes": look.pop("attributes")} if "attributes" in look else {}
    summary = osculate.convert(source, converted / name, **settings(converted), **estimation, **attributes)
    mesh = osculate.read(source)
    told = mesh.write(written / name, mesh.annotate(**estimation, **attributes), **settings(written))
    assert files(written) == files(converted), "to the last byte"
    return summary, told


@pytest.mark.filterwarnings("ignore::osculate.DefectWarning")
@pytest.mark.parametrize("name", ["out.glb", "out.gltf", "out.ply", "out.csv", "out.npz"])
@pytest.mark.parametrize("source", ["suzanne.stl", "fillet_degenerate.stl", "scene.glb", "two_meshes.gltf"])
def test_it_is_what_convert_writes(tmp_path: Path, source: str, name: str) -> None:
    summary, told = both(tmp_path, FIXTURES / source, name)
    for key in ("settings", "legend", "units"):
        assert told[key] == summary[key], key


def test_all_that_convert_can_write_is_written(tmp_path: Path) -> None:
    looks: list[Any] = [
        {"color_by": "k_max", "range": (-1, 1), "colormap": "turbo", "up": "y", "unit": "mm", "legend": "legend.svg"},
        {"variants": ["gauss", "class"], "vertex_values": True, "metadata": True, "edges": "edges.glb", "view": (1, 0, 0)},
        {"layout": "indexed", "select": "k_max>0.5", "attributes": "all"},
        {"compress": "meshopt", "color": "none", "attributes": ["k_max", "gauss_perimeter"]},
    ]
    for number, look in enumerate(looks):
        folder = tmp_path / str(number)
        folder.mkdir()
        estimation = {"estimator": "tangent", "diameters": 8} if number == 0 else {}
        summary, told = both(folder, FIXTURES / "suzanne.stl", "out.glb", estimation, **look)
        assert told.get("selected_faces") == summary.get("selected_faces")
        assert ("selected_faces" in told) == ("select" in look)


def test_arrays_come_back(tmp_path: Path, ring: Arrays) -> None:
    curvature = osculate.annotate(*ring, radius=0.5)
    osculate.Mesh(*ring).write(tmp_path / "ring.glb", curvature, attributes="default,dir_min")
    again = osculate.read(tmp_path / "ring.glb")
    assert again.stored is not None and again.stored.settings["radius"] == 0.5
    assert np.array_equal(again.stored.k_max, curvature.k_max)
    assert np.array_equal(again.stored.dir_min, curvature.dir_min)
    assert np.abs(again.vertices[again.faces] - ring[0][ring[1]]).max() < 1e-6
    # Values of an earlier run go on, with the settings that they were made with.
    again.write(tmp_path / "again.ply", again.stored)
    told = again.write(tmp_path / "again.csv", again.stored, attributes=["k_max"], color_by="none")
    assert told["settings"]["radius"] == 0.5 and told["legend"] is None
    rows = (tmp_path / "again.csv").read_text().splitlines()
    assert rows[0] == "k_max" and np.array_equal(np.array(rows[1:], np.float32), curvature.k_max)


def test_attributes_are_those_of_the_curvature(tmp_path: Path) -> None:
    mesh = osculate.read(FIXTURES / "sphere.off")
    mesh.write(tmp_path / "out.csv", mesh.annotate(attributes=["k_max", "curvedness"]))
    assert (tmp_path / "out.csv").read_text().splitlines()[0] == "k_max,curvedness"
    mesh.write(tmp_path / "out.csv", mesh.annotate(attributes=["k_max"]), attributes=["mean"])
    assert (tmp_path / "out.csv").read_text().splitlines()[0] == "mean"
    for look in ({"attributes": "all"}, {"color_by": "gauss_perimeter"}, {"select": "gauss_perimeter>0"}):
        with pytest.raises(osculate.UsageError, match="without gauss_perimeter; name it among the attributes"):
            mesh.write(tmp_path / "out.csv", mesh.annotate(), **look)  # type: ignore[arg-type]


def test_what_makes_no_sense_writes_nothing(tmp_path: Path, ring: Arrays, square: Arrays) -> None:
    mesh = osculate.Mesh(*ring)
    curvature = mesh.annotate()
    other = osculate.annotate(*square)
    cases: list[tuple[Any, Any, Any, type[Exception], str]] = [
        ("a.glb", other, {}, osculate.UsageError, "curvature is of 2 faces, but the mesh has 3600"),
        ("a.glb", curvature.k_max, {}, osculate.UsageTypeError, "curvature must be what annotate gives, not ndarray"),
        ("a.stl", curvature, {}, osculate.UsageError, "extension must be .glb"),
        ("none/a.glb", curvature, {}, osculate.MissingFileError, "the folder does not exist"),
        ("a.ply", curvature, {"metadata": True}, osculate.UsageError, "metadata and compress are for .glb and .gltf"),
        ("a.glb", curvature, {"radius": 1}, osculate.UsageError, "there is no setting radius here"),
        ("a.glb", curvature, {"select": "k_max>1e9"}, osculate.EmptyMeshError, "mesh: none of its 3600 faces"),
        ("a.glb", curvature, {"edges": tmp_path / "a.glb"}, osculate.UsageError, "is named for two outputs"),
    ]
    for name, values, settings, kind, sentence in cases:
        with pytest.raises(kind, match=sentence):
            mesh.write(tmp_path / name, values, **settings)
    assert not os.listdir(tmp_path)


def test_nothing_is_replaced_that_should_stay(tmp_path: Path) -> None:
    source = tmp_path / "own.glb"
    osculate.convert(FIXTURES / "suzanne.stl", source)
    before = source.read_bytes()
    mesh = osculate.read(source)
    curvature = mesh.annotate()
    with pytest.raises(osculate.UsageError, match="belongs to the input"):
        mesh.write(source, curvature)
    (tmp_path / "there.glb").write_bytes(b"there")
    with pytest.raises(osculate.ExistsError, match="there.glb exists"):
        mesh.write(tmp_path / "there.glb", curvature, no_clobber=True)
    assert source.read_bytes() == before and (tmp_path / "there.glb").read_bytes() == b"there"
