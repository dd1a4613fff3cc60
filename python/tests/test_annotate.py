"""Curvature of meshes in arrays."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays, exact_k_min
from osculate.settings import AnnotateSettings


def test_a_torus_has_its_curvature(ring: Arrays) -> None:
    vertices, faces = ring
    curvature = osculate.annotate(vertices, faces)
    assert len(curvature) == len(faces) and curvature.estimated.all() and not curvature.defects
    assert np.abs(curvature.k_max - 1.0).max() < 1e-3
    assert np.abs(curvature.k_min - exact_k_min(vertices, faces)).max() < 1e-3
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for direction in (curvature.dir_max, curvature.dir_min):
        assert direction.shape == (len(faces), 3)
        assert np.abs(np.linalg.norm(direction, axis=1) - 1).max() < 1e-5
        assert np.abs((direction * normals).sum(axis=1)).max() < 0.05
    assert np.abs((curvature.dir_max * curvature.dir_min).sum(axis=1)).max() < 1e-5


def test_fields_agree_with_one_another(ring: Arrays) -> None:
    c = osculate.annotate(*ring, attributes="all")
    assert np.allclose(c.mean, (c.k_max + c.k_min) / 2, atol=1e-6)
    assert np.allclose(c.gauss, c.k_max * c.k_min, atol=1e-6)
    assert np.allclose(c.curvedness, np.sqrt((c.k_max**2 + c.k_min**2) / 2), atol=1e-6)
    assert np.allclose(c.shape_index, 2 / np.pi * np.arctan2(c.k_max + c.k_min, c.k_max - c.k_min), atol=1e-5)
    assert np.abs(c.gauss_perimeter - c.gauss).mean() < 0.05
    assert np.array_equal(c.face, np.arange(len(c)))
    assert {osculate.CLASSES[int(code)] for code in c.face_class} <= {"parabolic", "elliptic", "hyperbolic"}
    assert set(c.method) == {"fit"} and (c.confidence > 0.5).all() and (c.coverage == 1).all()
    expected = {"face": np.uint32, "class": np.int8}
    for name in osculate.QUANTITIES:
        assert c[name].dtype == expected.get(name, c[name].dtype) and len(c[name]) == len(c)
    assert c.k_max is c["k_max"] and c.k_max.flags.c_contiguous


def test_the_perimeter_estimate_is_there_where_it_is_asked_for(ring: Arrays) -> None:
    assert np.isnan(osculate.annotate(*ring).gauss_perimeter).all()
    asked = osculate.annotate(*ring, attributes=["default", "gauss_perimeter"])
    assert np.isfinite(asked.gauss_perimeter).all() and "gauss_perimeter" in asked.attributes
    assert np.isfinite(osculate.annotate(*ring, estimator="osculating").gauss_perimeter).all()


@pytest.mark.parametrize("width", ["i2", "u2", "i4", "u4", "i8", "u8", ">i4"])
def test_the_layout_of_arrays_does_not_matter(ring: Arrays, width: str) -> None:
    vertices, faces = ring
    expected = osculate.annotate(vertices, faces).k_min
    padded = np.zeros((len(vertices), 5))
    padded[:, 1:4] = vertices
    unaligned = np.frombuffer(b"\0" + vertices.tobytes(), np.uint8)[1:].view(np.float64).reshape(-1, 3)
    for points in (vertices, np.asfortranarray(vertices), padded[:, 1:4], vertices.astype(">f8"), unaligned):
        assert np.array_equal(osculate.annotate(points, faces.astype(width)).k_min, expected)
    assert np.array_equal(osculate.annotate(vertices.tolist(), np.asfortranarray(faces).tolist()).k_min, expected)
    narrow = osculate.annotate(vertices.astype(np.float32), faces.astype(width)).k_min
    assert np.abs(narrow - expected).max() < 1e-3


def test_arrays_stay_as_they_were(ring: Arrays) -> None:
    vertices, faces = (array.copy() for array in ring)
    vertices.flags.writeable = faces.flags.writeable = False
    osculate.annotate(vertices, faces)
    assert np.array_equal(vertices, ring[0]) and np.array_equal(faces, ring[1])


def test_vertices_at_equal_positions_are_one_unless_numbers_count(ring: Arrays) -> None:
    vertices, faces = ring
    apart, own = vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    assert np.array_equal(osculate.annotate(apart, own).k_max, osculate.annotate(vertices, faces).k_max)
    alone = osculate.annotate(apart, own, indexed=True)
    assert (alone.face_class == 0).all() and alone.report["edges"]["boundary"] == 3 * len(faces)
    assert np.array_equal(osculate.annotate(vertices, faces, indexed=True).k_max, osculate.annotate(vertices, faces).k_max)


SETTINGS: list[tuple[str, AnnotateSettings]] = [
    ("suzanne.ply", {"attributes": "all", "estimator": "osculating", "radius_factor": "2:mesh", "diameters": 8}),
    ("suzanne.ply", {"attributes": "all"}),
    ("fillet_part.stl", {}),
]


@pytest.mark.parametrize(("name", "settings"), SETTINGS)
def test_the_values_are_those_of_the_command_line(tmp_path: Path, name: str, settings: AnnotateSettings) -> None:
    mesh = osculate.read(FIXTURES / name)
    curvature = osculate.annotate(mesh.vertices, mesh.faces, **settings)
    table = tmp_path / "values.csv"
    osculate.convert(FIXTURES / name, table, **settings)
    written = np.genfromtxt(table, delimiter=",", names=True, dtype=None, encoding="utf-8")
    columns = curvature.columns()
    assert tuple(columns) == written.dtype.names
    for name, column in columns.items():
        if name == "method":
            assert (column == written[name]).all()
        else:
            assert np.array_equal(column, written[name].astype(column.dtype), equal_nan=column.dtype.kind == "f"), name
    for setting in ("radius_factor", "diameters"):
        assert setting not in settings or curvature.settings[setting] == settings[setting]


def test_values_can_be_selected_summarised_and_coloured(ring: Arrays) -> None:
    c = osculate.annotate(*ring)
    saddles = c.select("class=hyperbolic and gauss<-0.1")
    assert saddles.dtype == bool and np.array_equal(saddles, (c.face_class == 4) & (c.gauss < -0.1))
    with pytest.raises(osculate.UsageError, match="k_mux"):
        c.select("k_mux>1")
    summary = c.summary()
    assert summary["estimated"] == len(c) and summary["classes"]["hyperbolic"] == np.count_nonzero(c.face_class == 4)
    assert summary["percentiles"]["k_max"]["p50"] == pytest.approx(np.median(c.k_max), rel=1e-5)
    scale = c.color_scale(color_by="gauss", range=(-0.5, 0.5), colormap="purple-green")
    assert (scale.quantity, scale.colormap, scale.low, scale.high) == ("gauss", "purple-green", -0.5, 0.5)
    assert scale.colors.shape == (len(c), 3) and scale.colors.dtype == np.uint8
    middle = np.abs(c.gauss).argmin()
    assert int(scale.indices[middle]) == round(254 * (float(c.gauss[middle]) + 0.5))
    assert scale.clipped == np.count_nonzero(np.abs(c.gauss) > 0.5)
    assert np.array_equal(c.colors(color_by="class"), osculate.palette("classes")[c.color_scale(color_by="class").indices])
    assert "viridis" in osculate.COLORMAPS and osculate.palette("viridis").shape == (256, 3)
    with pytest.raises(osculate.UsageError, match="colormap"):
        c.colors(color_by="class", colormap="viridis")
    with pytest.raises(osculate.UsageError, match="range"):
        c.colors(range=(1, -1))


def test_values_survive_a_pickle(ring: Arrays) -> None:
    c = osculate.annotate(*ring, attributes=["k_max", "dir_max", "method"])
    again = pickle.loads(pickle.dumps(c))
    for name in osculate.QUANTITIES:
        assert np.array_equal(again[name], c[name], equal_nan=c[name].dtype.kind == "f"), name
    assert (again.settings, again.report, again.attributes) == (c.settings, c.report, ("k_max", "dir_max", "method"))


def test_threads_do_not_change_values(ring: Arrays) -> None:
    one = osculate.annotate(*ring, threads=1)
    assert np.array_equal(one.k_min, osculate.annotate(*ring, threads=3).k_min)
