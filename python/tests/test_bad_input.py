"""What is no mesh is told in the user's own words, and nothing is changed."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays

TRIANGLE = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], float)
FACE = np.array([[0, 1, 2]])


@pytest.mark.parametrize(
    ("vertices", "faces", "error", "words"),
    [
        (TRIANGLE[:, :2], FACE, osculate.UsageError, r"vertices must have the shape \(n, 3\), not \(3, 2\)"),
        (np.zeros((3, 7)), FACE, osculate.UsageError, r"not \(3, 7\), transposed\?"),
        (TRIANGLE.ravel(), FACE, osculate.UsageError, r"\(n, 3\), not \(9,\)"),
        (TRIANGLE.astype(complex), FACE, osculate.UsageTypeError, "vertices must be numbers, not complex128"),
        (TRIANGLE.astype(str), FACE, osculate.UsageTypeError, "vertices must be numbers"),
        (TRIANGLE.astype(object), FACE, osculate.UsageTypeError, "not of Python objects"),
        ([[0, 0, 0], [1, 0]], FACE, osculate.UsageError, "vertices cannot be read as an array"),
        (np.ma.masked_less(TRIANGLE, 0.5), FACE, osculate.UsageError, "partly masked"),
        (TRIANGLE, FACE.astype(float), osculate.UsageTypeError, r"faces must be integers.*astype\(int\)"),
        (TRIANGLE, FACE.astype(bool), osculate.UsageTypeError, "faces must be integers"),
        (TRIANGLE, [[0, 1, 2, 0]], osculate.UsageError, r"not \(1, 4\); triangulate faces with more corners first"),
        (TRIANGLE, [[0, 1, 2], [0, 1, 2, 0]], osculate.UsageError, "triangulate faces with more corners"),
        (TRIANGLE, [0, 1, 2], osculate.UsageError, r"faces must have the shape \(m, 3\), not \(3,\)"),
        (TRIANGLE, [[0, 1, 2], [0, 1, 3]], osculate.UsageError, "face 1 names vertex 3, but there are 3 vertices"),
        (TRIANGLE, [[0, 1, 2], [0, 1, -1]], osculate.UsageError, "face 1 names vertex -1, but there are 3 vertices"),
        (TRIANGLE, np.array([[0, 1, 7]], np.uint32), osculate.UsageError, "face 0 names vertex 7, but there are 3"),
        (TRIANGLE, np.array([[0, 1, 2**40]]), osculate.UsageError, "face 0 names vertex 1099511627776"),
        (np.zeros((0, 3)), FACE, osculate.UsageError, "face 0 names vertex 0, but there are no vertices"),
        (TRIANGLE, [], osculate.EmptyMeshError, "there are no faces"),
        (TRIANGLE, np.zeros((0, 3), int), osculate.EmptyMeshError, "there are no faces"),
        (TRIANGLE * 0, FACE, osculate.EmptyMeshError, "none of the 1 faces has an area"),
        (TRIANGLE * np.nan, FACE, osculate.EmptyMeshError, "none of the 1 faces has an area and finite coordinates"),
    ],
)
def test_arrays_that_are_no_mesh(vertices: Any, faces: Any, error: type[Exception], words: str) -> None:
    for call in (osculate.annotate, osculate.Mesh):
        with pytest.raises(error, match=words) as raised:
            call(vertices, faces)
        assert isinstance(raised.value, osculate.Error) and isinstance(raised.value, (ValueError, TypeError))
        assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("settings", "error", "words"),
    [
        ({"estimater": "auto"}, osculate.UsageError, "there is no setting estimater here; there are estimator, radius"),
        ({"estimator": "best"}, osculate.UsageError, "estimator must be one of auto, osculating, .*, not \"best\""),
        ({"radius": "wide"}, osculate.UsageError, 'radius: "wide" will not do: give a length or auto'),
        ({"radius": -1.0}, osculate.UsageError, "the radius must be above 0, not -1"),
        ({"radius": float("nan")}, osculate.UsageError, "the radius must be above 0, not NaN"),
        ({"radius": 1, "radius_factor": 3}, osculate.UsageError, "radius cannot be given together with radius_factor"),
        ({"radius": True}, osculate.UsageTypeError, "radius cannot be True"),
        ({"radius": object()}, osculate.UsageTypeError, "radius must be a number, a text, a path or a list"),
        ({"feature_angle": 200}, osculate.UsageError, "the feature angle must be 0 to 180 degrees, not 200"),
        ({"weld": -1}, osculate.UsageError, "the weld distance must be 0 or more"),
        ({"diameters": 2}, osculate.UsageError, "the number of diameters must be 3 to 360, not 2"),
        ({"attributes": "k_mux"}, osculate.UsageError, "unknown attribute \"k_mux\""),
        ({"attributes": []}, osculate.UsageError, "attributes is an empty list"),
        ({"threads": 0}, osculate.UsageError, "give a number from 1 to 1024"),
        ({"progress": 3}, osculate.UsageTypeError, "progress must be True, None or a callable"),
        ({"radius": 1e9}, osculate.UsageError, "the radius 1.0000e9 is larger than the mesh"),
    ],
)
def test_settings_out_of_range(ring: Arrays, settings: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words) as raised:
        osculate.annotate(*ring, **settings)
    assert isinstance(raised.value, osculate.Error) and "--" not in str(raised.value)


def test_none_is_the_default(ring: Arrays) -> None:
    given = osculate.annotate(*ring, radius=None, estimator=None, attributes=None)
    assert given.settings == osculate.annotate(*ring).settings


def test_defects_are_warned_of_and_told(ring: Arrays) -> None:
    vertices, faces = ring[0].copy(), ring[1]
    vertices[5, 1] = np.nan
    with pytest.warns(osculate.DefectWarning, match="faces with NaN or infinite coordinates, not estimated") as caught:
        curvature = osculate.annotate(vertices, faces)
    assert caught[0].filename == __file__
    touched = (faces == 5).any(axis=1)
    assert np.array_equal(~curvature.estimated, touched) and np.isnan(curvature.k_max[touched]).all()
    assert np.isnan(curvature.dir_max[touched]).all() and (curvature.confidence[touched] == 0).all()
    assert curvature.report["non_finite_faces"] == touched.sum() and len(curvature.defects) == 1
    with warnings.catch_warnings(), pytest.raises(osculate.DefectWarning):
        warnings.simplefilter("error", osculate.DefectWarning)
        osculate.annotate(vertices, faces)


def test_files_that_are_no_mesh(tmp_path: Path) -> None:
    missing = tmp_path / "no.stl"
    for call in (osculate.read, osculate.inspect):
        with pytest.raises(osculate.MissingFileError, match=r"no\.stl: cannot read: ") as raised:
            call(missing)
        assert isinstance(raised.value, FileNotFoundError) and raised.value.filename == str(missing)
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
    with pytest.raises(osculate.ParseError, match=r"bad\.obj: line 4: ") as parsed:
        osculate.read(tmp_path / "bad.obj")
    assert (parsed.value.line, parsed.value.path, parsed.value.byte) == (4, str(tmp_path / "bad.obj"), None)
    (tmp_path / "empty.ply").write_bytes(b"")
    with pytest.raises(osculate.ParseError, match="the file is empty"):
        osculate.convert(tmp_path / "empty.ply", tmp_path / "out.glb")
    with pytest.raises(osculate.UsageError, match="is a folder"):
        osculate.read(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.obj", "empty.ply"]


def test_outputs_that_cannot_be(tmp_path: Path) -> None:
    source = FIXTURES / "suzanne.stl"
    with pytest.raises(osculate.MissingFileError):
        osculate.convert(source, tmp_path / "nowhere" / "out.glb")
    with pytest.raises(osculate.UsageError, match="the extension must be .glb"):
        osculate.convert(source, tmp_path / "out.xyz")
    kept = tmp_path / "kept.csv"
    kept.write_text("mine")
    with pytest.raises(osculate.ExistsError, match="no_clobber") as raised:
        osculate.convert(source, kept, no_clobber=True)
    assert isinstance(raised.value, FileExistsError) and kept.read_text() == "mine"
    with pytest.raises(osculate.UsageError, match="metadata and compress are for .glb and .gltf"):
        osculate.convert(source, kept, metadata=True)
    with pytest.raises(osculate.UsageError, match="edges must be given as well"):
        osculate.convert(source, tmp_path / "out.glb", view=(1, 0, 0))
    with pytest.raises(osculate.UsageTypeError, match="force must be True or False, not 'yes'"):
        osculate.convert(source, tmp_path / "out.glb", force="yes")  # type: ignore[arg-type]
    with pytest.raises(osculate.UsageError, match="unit does not apply to glTF"):
        osculate.convert(FIXTURES / "suzanne.glb", tmp_path / "out.glb", unit="mm")
    assert [path.name for path in tmp_path.iterdir()] == ["kept.csv"]
