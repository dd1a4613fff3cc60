#!/usr/bin/env python3
"""Whole runs beside other programs, on one file in one go: writes a part of docs/performance.md.

Makes a torus as binary STL. Each program reads it, welds it, works out principal curvatures and writes
them, in a process of its own; what it says of its curvature step alone stands beside. Osculate runs with
two threads, as the others may.

usage: benches/peers.py [--faces N] [--only NAME,NAME] [--runs N]
Makes a Python environment in ~/.cache/osculate/peers where it is missing. CGAL needs Debian's libcgal-dev and
g++, and is left out without. $OSCULATE: a program to take instead of building it."""
import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CACHE = Path.home() / ".cache" / "osculate" / "peers"
PACKAGES = ["numpy", "scipy", "libigl", "pymeshlab", "pyvista", "trimesh"]


def environment():
    """Goes on in an environment that has all packages."""
    if Path(sys.prefix) == CACHE:
        return
    if not (CACHE / "bin" / "python").exists():
        subprocess.run([sys.executable, "-m", "venv", CACHE], check=True)
    has_all = subprocess.run([CACHE / "bin/python", "-c", "import igl, numpy, pymeshlab, pyvista, scipy, trimesh"],
                             capture_output=True).returncode == 0
    if not has_all:
        subprocess.run([CACHE / "bin/python", "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    os.execv(CACHE / "bin/python", [str(CACHE / "bin/python"), *sys.argv])


# One function for each peer: from a file to a file. Gives the seconds of its curvature step.

def libigl(source, target, radius):
    import igl
    import numpy as np
    corners, faces = igl.read_triangle_mesh(str(source))[:2]
    points, _, _, faces = igl.remove_duplicate_vertices(corners, faces, 0.0)[:4]
    start = time.perf_counter()
    directions_max, directions_min, k_max, k_min = igl.principal_curvature(points, faces, radius)[:4]
    seconds = time.perf_counter() - start
    np.savez(target, points=points, faces=faces, k_max=k_max, k_min=k_min, dir_max=directions_max, dir_min=directions_min)
    return seconds


def meshlab(source, target):
    import pymeshlab
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(source))
    meshes.meshing_remove_duplicate_vertices()
    start = time.perf_counter()
    meshes.compute_curvature_principal_directions_per_vertex(method="Quadric Fitting")
    seconds = time.perf_counter() - start
    meshes.save_current_mesh(f"{target}.ply")
    return seconds


def vtk(source, target):
    import pyvista
    mesh = pyvista.read(source).clean()
    start = time.perf_counter()
    mesh["k_max"], mesh["k_min"] = mesh.curvature("maximum"), mesh.curvature("minimum")
    seconds = time.perf_counter() - start
    mesh.save(f"{target}.vtp")
    return seconds


def trimesh_measure(source, target):
    import numpy as np
    import trimesh
    mesh = trimesh.load(source)
    start = time.perf_counter()
    radius = 2 * mesh.edges_unique_length.mean()
    area = np.pi * radius**2
    mean = trimesh.curvature.discrete_mean_curvature_measure(mesh, mesh.vertices, radius) / area
    gauss = trimesh.curvature.discrete_gaussian_curvature_measure(mesh, mesh.vertices, radius) / area
    seconds = time.perf_counter() - start
    np.savez(target, points=mesh.vertices, faces=mesh.faces, mean=mean, gauss=gauss)
    return seconds


def cgal(source, target):
    done = subprocess.run([os.environ["CGAL_JETS"], source, target, "4", "3"], check=True, capture_output=True, text=True)
    return float(done.stdout)


PEERS = {
    "libigl-2": ("libigl `principal_curvature`, radius 2", lambda *files: libigl(*files, 2)),
    "libigl-5": ("libigl `principal_curvature`, radius 5", lambda *files: libigl(*files, 5)),
    "meshlab": ("MeshLab, quadric fitting", meshlab),
    "vtk": ("VTK (PyVista) `curvature`", vtk),
    "trimesh": ("trimesh, curvature measures, two edges", trimesh_measure),
    "cgal": ("CGAL, jets of degree 4, three rings", cgal),
}


def compile_cgal(folder):
    source, driver = Path(__file__).with_name("cgal_jets.cpp"), folder / "cgal_jets"
    flags = ["-O3", "-march=native", "-DNDEBUG", "-I/usr/include/eigen3"]
    if shutil.which("g++") is None or subprocess.run(["g++", *flags, source, "-o", driver]).returncode:
        return None
    return driver


def versions():
    import importlib.metadata as metadata
    found = [f"{name} {metadata.version(name)}" for name in ["libigl", "pymeshlab", "pyvista", "vtk", "trimesh"]]
    header = Path("/usr/include/CGAL/version.h")
    if header.exists():
        found += ["CGAL " + line.split()[2] for line in header.read_text().splitlines() if line.startswith("#define CGAL_VERSION ")]
    return ", ".join(found)


def main():
    import common
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faces", type=int, default=1_000_000)
    parser.add_argument("--only", default=",".join(PEERS))
    parser.add_argument("--runs", type=int, default=3, help="of Osculate; the median counts. The others run once")
    options = parser.parse_args()
    osculate = common.program()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        source = folder / "torus.stl"
        subprocess.run([osculate, "synth", "torus", "--faces", str(options.faces), "-o", source, "-q"], check=True)
        faces = (source.stat().st_size - 84) // 50
        rows = []
        for name, extra in [("Osculate", []), ("Osculate, `--estimator osculating --radius-factor 3`",
                                              ["--estimator", "osculating", "--radius-factor", "3"])]:
            runs = []
            for _ in range(options.runs):
                runs.append(common.annotate([osculate, "annotate", source, "-j2", "-q", *extra], folder / "out.glb"))
                runs[-1]["kernel"] = runs[-1]["seconds"]["estimate"]
            rows.append((name, sorted(runs, key=lambda run: run["wall"])[len(runs) // 2]))
        reference = rows[0][1]["wall"]
        if "cgal" in options.only:
            driver = compile_cgal(folder)
            os.environ["CGAL_JETS"] = str(driver)
        for name in options.only.split(","):
            if name == "cgal" and driver is None:
                print("CGAL is left out: install libcgal-dev and g++", file=sys.stderr)
                continue
            result = common.run([sys.executable, __file__, "--peer", name, source, folder / f"out-{name}"])
            result["kernel"] = float(result["output"].split()[-1])
            rows.append((PEERS[name][0], result))
            print(rows[-1], file=sys.stderr)
        cells = [(name, f"{r['wall']:.2f}", f"{1e6 * r['wall'] / faces:.2f}", f"{r['kernel']:.2f}", f"{r['cpu']:.2f}",
                  f"{r['peak']:.0f}", f"{r['wall'] / reference:.1f}") for name, r in rows]
        head = ["program", "seconds, whole run", "microseconds per face", "of it curvature, s", "processor, s", "peak MB", "times Osculate"]
        text = f"""A torus of {faces:,} faces as binary STL, read, welded, estimated and written (Osculate: two threads, median of
{options.runs}); {common.machine()}. {versions()}.

{common.table(head, cells)}"""
        common.write("benches/peers.py", "Beside other programs", text)


if __name__ == "__main__":
    environment()
    if sys.argv[1:2] == ["--peer"]:
        name, source, target = sys.argv[2:]
        print(PEERS[name][1](source, target))
    else:
        main()
