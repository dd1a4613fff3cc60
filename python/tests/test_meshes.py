"""Meshes from files and arrays: what is in them, disks, traces and sections."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Literal

import numpy as np
import osculate
import pytest
from conftest import FIXTURES, Arrays, torus


def test_a_file_becomes_arrays() -> None:
    mesh = osculate.read(FIXTURES / "suzanne.stl")
    assert len(mesh) == 968 and mesh.faces.shape == (968, 3) and mesh.faces.dtype == np.uint32
    assert mesh.vertices.dtype == np.float64 and len(mesh.vertices) == mesh.report["vertices"]
    assert mesh.faces.max() == len(mesh.vertices) - 1 and mesh.defects == []
    again = osculate.Mesh(mesh.vertices, mesh.faces)
    assert again.report == mesh.report and np.array_equal(again.faces, mesh.faces)
    assert np.array_equal(again.annotate().k_max, mesh.annotate().k_max)


def test_large_coordinates_lose_nothing(ring: Arrays) -> None:
    far = np.array([4.5e6, 5.4e6, 200.0])
    mesh = osculate.Mesh(ring[0] + far, ring[1])
    order = np.unique(ring[1], return_index=True)[1]
    assert np.abs(np.sort(mesh.vertices, axis=0) - np.sort((ring[0] + far)[np.unique(ring[1])], axis=0)).max() < 1e-9
    assert np.abs(mesh.annotate().k_max - 1).max() < 1e-3 and len(order) == len(mesh.vertices)
    assert np.abs(mesh.section((0, 0, 1, -200))[0].points[:, 2] - 200).max() < 1e-9


@pytest.mark.parametrize("layout", ["faces", "indexed"])
def test_values_that_a_file_carries_are_read(tmp_path: Path, layout: Literal["faces", "indexed"]) -> None:
    out = tmp_path / "out.glb"
    osculate.convert(FIXTURES / "suzanne.ply", out, layout=layout, attributes="default,radius,dir_min", diameters=8)
    stored = osculate.read(out).stored
    assert stored is not None and stored.settings["diameters"] == 8
    expected = osculate.read(FIXTURES / "suzanne.ply").annotate(diameters=8)
    for name in ("k_max", "k_min", "class", "dir_max", "dir_min", "radius", "coverage", "confidence"):
        assert np.array_equal(stored[name], expected[name]), name
    assert osculate.read(FIXTURES / "suzanne.ply").stored is None


def test_converting_tells_what_stats_tell(tmp_path: Path) -> None:
    out, stats = tmp_path / "out.glb", tmp_path / "stats.json"
    summary = osculate.convert(FIXTURES / "suzanne.stl", out, stats=stats, color_by="k_max", range=(-1, 1), threads=2)
    written = json.loads(stats.read_text())
    assert summary == written and summary["legend"]["range"] == [-1.0, 1.0] and summary["curvature"] is not None
    assert osculate.convert(FIXTURES / "suzanne.stl", out)["curvature"] is None
    assert osculate.convert(FIXTURES / "suzanne.stl", str(out), summarise=True)["curvature"]["estimated"] == 968
    with pytest.warns(osculate.DefectWarning, match="fillet_degenerate.stl: .* faces without area"):
        osculate.convert(FIXTURES / "fillet_degenerate.stl", out)


def test_every_format_is_written(tmp_path: Path) -> None:
    for extension in ("glb", "gltf", "ply", "csv", "npz"):
        osculate.convert(FIXTURES / "suzanne.obj", tmp_path / f"out.{extension}", variants=["mean", "class"])
    with np.load(tmp_path / "out.npz") as arrays:
        c = osculate.annotate(arrays["positions"], arrays["faces"])
        assert np.array_equal(arrays["k_max"], c.k_max) and np.array_equal(arrays["class"], c.face_class)


def test_inspecting_is_what_the_command_line_prints() -> None:
    path = str(FIXTURES / "cylinder_holes.stl")
    found = osculate.inspect(path, view=(0, 0, 1), feature_angle=30)
    options = ["--format", "json", "--view", "0,0,1", "--feature-angle", "30"]
    printed = subprocess.run([sys.executable, "-m", "osculate", "inspect", path, *options], capture_output=True, check=True)
    assert found == json.loads(printed.stdout) and found["silhouette_edges"] > 0


def test_the_module_is_the_program(tmp_path: Path) -> None:
    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([sys.executable, "-m", "osculate", *arguments], capture_output=True, text=True)

    assert run("--version").stdout == f"osculate {osculate.__version__}\n"
    assert run("annotate", str(FIXTURES / "suzanne.stl"), "-o", str(tmp_path / "a.glb"), "-q").returncode == 0
    assert run("annotate", str(FIXTURES / "fillet_degenerate.stl"), "-o", str(tmp_path / "b.glb")).returncode == 3
    assert run("annotate", "no.stl", "-o", str(tmp_path / "c.glb")).returncode == 1
    assert run("dance").returncode == 2 and "dance" in run("dance").stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.glb", "b.glb"]


def test_a_disk_is_laid_around_a_point(ring: Arrays) -> None:
    mesh = osculate.Mesh(*ring)
    disk = mesh.disk(point=(4, 0, 0), diameters=8, radius=0.5)
    assert disk.normal @ [1, 0, 0] > 0.99 and np.allclose(disk.centre, [4, 0, 0], atol=1e-5)
    assert disk.angle.shape == disk.length.shape == (16,) and len(disk.legs) == len(disk.stop) == 16
    assert disk.curvature.shape == (8,) and set(disk.stop) == {"length"} and np.allclose(disk.length, 0.5)
    for leg, length in zip(disk.legs, disk.length):
        assert np.allclose(leg[0], disk.centre)
        assert np.linalg.norm(np.diff(leg, axis=0), axis=1).sum() == pytest.approx(length)
    assert disk.value["k_max"] == pytest.approx(1, abs=0.1) and disk.value["k_min"] == pytest.approx(0.25, abs=0.1)
    assert disk.curvature.max() <= disk.value["k_max"] + 0.1 and disk.curvature.min() >= disk.value["k_min"] - 0.1
    assert abs(disk.x @ disk.y) < 1e-12 and np.allclose(np.cross(disk.normal, disk.x), disk.y)
    with pytest.raises(osculate.UsageError, match="face 5000 is out of range: the faces are 0 to 3599"):
        mesh.disk(face=5000)
    with pytest.raises(osculate.UsageError, match="say where: face N, perhaps with at U,V, or point"):
        mesh.disk()
    with pytest.raises(osculate.UsageError, match="lies .* away from the mesh"):
        mesh.disk(point=(90, 0, 0))


def test_traces_follow_the_meridians(ring: Arrays) -> None:
    mesh = osculate.Mesh(*ring)
    (trace,) = mesh.trace(face=100, steps=10)
    assert trace.end == "steps" and trace.backward_end is None and trace.centres.shape == (11, 3)
    assert trace.faces.shape == (11,) and trace.directions.shape == (11, 3) and len(trace.path) > 11
    angle = np.arctan2(trace.centres[:, 1], trace.centres[:, 0])
    assert np.ptp(angle) < 0.05
    many = mesh.trace(seeds=20, both=True, steps=3, along="min", estimator="osculating", radius=0.3)
    assert len(many) == 20 and all(len(t.centres) <= 7 and t.backward_end is not None for t in many)


def test_a_section_is_two_circles(ring: Arrays) -> None:
    mesh = osculate.Mesh(*ring)
    lines = mesh.section((0, 0, 1, -0.01))
    assert [line.closed for line in lines] == [True, True]
    assert sum(line.length for line in lines) == pytest.approx(2 * np.pi * 6, rel=0.01)
    assert all(np.allclose(line.points[:, 2], 0.01) for line in lines)
    assert mesh.section(np.array([0, 0, 1, -5.0])) == []
    with pytest.raises(osculate.UsageError, match="plane: .* a, b and c must not all be 0"):
        mesh.section((0, 0, 0, 1))
    with pytest.raises(osculate.UsageError, match="plane: .* give four numbers"):
        mesh.section((0, 0, 1))


def test_the_report_counts_edges() -> None:
    mesh = osculate.Mesh(*torus(20, 10))
    assert mesh.report["edges"] == {"inner": 600, "boundary": 0, "feature": 0, "non_manifold": 0}
    assert osculate.Mesh(*torus(20, 10), feature_angle=1).report["edges"]["feature"] > 0
