"""To and from the real libraries: values stand on the right faces, and go round whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays
from osculate import bridges

NAMES = ["class", "k_max", "k_min", "mean", "gauss", "dir_max", "dir_min", "radius", "coverage", "confidence"]


@pytest.fixture(scope="module")
def head() -> osculate.Mesh:
    return osculate.read(FIXTURES / "suzanne.ply")


def same(attached: Any, curvature: osculate.FaceCurvature) -> None:
    """Every quantity is there, with its values in their order."""
    for name in NAMES:
        found = np.asarray(attached[name])
        assert np.array_equal(found.reshape(curvature[name].shape), curvature[name]), name


def test_trimesh(head: osculate.Mesh, tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    theirs = bridges.trimesh.mesh(head)
    curvature = bridges.trimesh.annotate(theirs)
    same(theirs.face_attributes, curvature)
    same(theirs.face_attributes, head.annotate())
    same(bridges.trimesh.mesh(head, curvature).face_attributes, curvature)
    # Values go where trimesh takes the faces.
    some = np.arange(len(theirs.faces)) % 3 == 0
    theirs.update_faces(some)
    assert np.array_equal(theirs.face_attributes["k_max"], curvature.k_max[some])
    assert np.array_equal(theirs.face_attributes["dir_max"], curvature.dir_max[some])
    # Vertices that trimesh did not merge are one all the same.
    apart = trimesh.load(FIXTURES / "suzanne.stl", process=False)
    assert np.array_equal(osculate.annotate(*bridges.trimesh.arrays(apart)).face, np.arange(968))
    assert bridges.trimesh.annotate(apart).report["edges"]["boundary"] == head.report["edges"]["boundary"]
    # In what trimesh reads of our files, values are per vertex, three of each face.
    osculate.convert(FIXTURES / "suzanne.ply", tmp_path / "out.glb")
    loaded = trimesh.load(tmp_path / "out.glb", force="mesh", process=False)
    assert np.array_equal(np.asarray(loaded.vertex_attributes["_CURVATURE_MAX"]).reshape(-1, 3)[:, 0], curvature.k_max)


def test_pyvista(head: osculate.Mesh, tmp_path: Path) -> None:
    pyvista = pytest.importorskip("pyvista")
    theirs = bridges.pyvista.mesh(head)
    curvature = bridges.pyvista.annotate(theirs)
    same(theirs.cell_data, curvature)
    theirs.save(tmp_path / "head.vtp")
    again = pyvista.read(tmp_path / "head.vtp")
    same(again.cell_data, curvature)
    assert np.array_equal(osculate.annotate(*bridges.pyvista.arrays(again)).k_max, curvature.k_max)
    with pytest.raises(osculate.UsageError, match="more than three corners; take mesh.triangulate"):
        bridges.pyvista.annotate(pyvista.Cube())
    assert len(bridges.pyvista.annotate(pyvista.Cube().triangulate())) == 12
    with pytest.raises(osculate.UsageError, match="lines, vertices or strips"):
        bridges.pyvista.arrays(theirs + pyvista.Line())
    with pytest.raises(osculate.EmptyMeshError):
        bridges.pyvista.arrays(pyvista.PolyData())


def test_open3d(head: osculate.Mesh, tmp_path: Path) -> None:
    o3d = pytest.importorskip("open3d")
    theirs = bridges.open3d.mesh(head)
    curvature = bridges.open3d.annotate(theirs)
    same({name: theirs.triangle[name].numpy() for name in NAMES}, curvature)
    legacy = theirs.to_legacy()
    assert np.array_equal(bridges.open3d.annotate(legacy).k_max, curvature.k_max)
    with pytest.raises(osculate.UsageTypeError, match="from_legacy"):
        bridges.open3d.attach(legacy, curvature)
    with pytest.raises(osculate.EmptyMeshError):
        bridges.open3d.annotate(o3d.t.geometry.TriangleMesh())


def test_meshio(head: osculate.Mesh, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    theirs = bridges.meshio.mesh(head)
    curvature = bridges.meshio.annotate(theirs)
    same({name: blocks[0] for name, blocks in theirs.cell_data.items()}, curvature)
    theirs.write(tmp_path / "head.vtu")
    again = meshio.read(tmp_path / "head.vtu")
    same({name: blocks[0] for name, blocks in again.cell_data.items()}, curvature)
    assert np.array_equal(osculate.annotate(*bridges.meshio.arrays(again)).k_max, curvature.k_max)
    # Two blocks of triangles and one of lines: values stay with their faces.
    cells = [("triangle", head.faces[:100]), ("line", [[0, 1], [1, 2]]), ("triangle", head.faces[100:])]
    mixed = meshio.Mesh(head.vertices, [(kind, np.asarray(data, np.int64)) for kind, data in cells])
    bridges.meshio.annotate(mixed)
    first, lines, second = mixed.cell_data["k_max"]
    assert np.isnan(lines).all() and np.array_equal(np.concatenate([first, second]), curvature.k_max)
    with pytest.raises(osculate.UsageError, match="cells of type quad; triangulate"):
        bridges.meshio.annotate(meshio.Mesh(head.vertices, [("quad", [[0, 1, 2, 3]])]))


def test_pandas(ring: Arrays) -> None:
    pandas = pytest.importorskip("pandas")
    curvature = osculate.annotate(*ring)
    frame = bridges.tables.to_pandas(curvature)
    assert list(frame.columns) == list(curvature.columns()) and len(frame) == len(curvature)
    assert frame["class"].dtype == np.int8 and frame["method"].dtype == "category"
    assert (frame["method"].astype(str).to_numpy() == curvature.method).all()
    assert np.array_equal(frame[["dir_max_x", "dir_max_y", "dir_max_z"]].to_numpy(), curvature.dir_max)
    vertices = pandas.DataFrame(ring[0], columns=["x", "y", "z"])
    again = osculate.annotate(*bridges.tables.arrays(vertices, pandas.DataFrame(ring[1])))
    assert np.array_equal(again.k_max, curvature.k_max)
    with pytest.raises(osculate.UsageError, match="three columns, not 2"):
        bridges.tables.arrays(vertices[["x", "y"]], vertices)


def test_arrow(ring: Arrays, tmp_path: Path) -> None:
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    vertices = ring[0].copy()
    vertices[7] = np.nan
    with pytest.warns(osculate.DefectWarning):
        curvature = osculate.annotate(vertices, ring[1])
    table = bridges.tables.to_arrow(curvature)
    assert table.column_names == list(curvature.columns())
    parquet.write_table(table, tmp_path / "values.parquet")
    again = parquet.read_table(tmp_path / "values.parquet")
    assert again["k_max"].null_count == np.count_nonzero(~curvature.estimated) > 0
    assert np.array_equal(again["k_max"].to_numpy(), curvature.k_max, equal_nan=True)
    assert again["method"].cast(arrow.string()).to_pylist() == curvature.method.tolist()
    points = arrow.table({axis: ring[0][:, i] for i, axis in enumerate("xyz")})
    corners = arrow.table({name: ring[1][:, i] for i, name in enumerate("abc")})
    assert np.array_equal(osculate.annotate(*bridges.tables.arrays(points, corners)).k_max, osculate.annotate(*ring).k_max)


def test_values_of_another_mesh_are_refused(head: osculate.Mesh, ring: Arrays) -> None:
    pytest.importorskip("trimesh")
    theirs = bridges.trimesh.mesh(head)
    with pytest.raises(osculate.UsageError, match="the values are of 3600 faces, but the mesh has 968"):
        bridges.trimesh.attach(theirs, osculate.annotate(*ring))
    assert not theirs.face_attributes


def test_a_package_that_is_missing_is_named(head: osculate.Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(osculate.MissingPackageError, match="this needs trimesh: pip install trimesh"):
        bridges.trimesh.mesh(head)
