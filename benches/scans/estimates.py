"""k_max and k_min of every face by Osculate and by other libraries, with Osculate's sign."""

import csv
import os
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

import igl
import numpy as np
import pymeshlab

from . import mesh


def osculate(binary, path, options):
    """k_max, k_min per face from `osculate annotate`; NaN where not estimated."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "faces.csv"
        run(binary, "annotate", path, "-o", out, "--up", "y", "-q", *options)
        return columns(out, "k_max", "k_min")


def run(binary, *arguments):
    """Runs Osculate; 3 is its exit code for repaired input."""
    done = subprocess.run([binary.resolve(), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        sys.exit(f"{binary} {' '.join(map(str, arguments))}: {done.stderr.strip()}")


def columns(path, *names):
    """Columns of a CSV as arrays, NaN where empty."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [np.array([float(row[name] or "nan") for row in rows]) for name in names]


def libigl(points, faces):
    """libigl's principal_curvature with its default radius of 5 rings."""
    _, _, k_max, k_min, _ = igl.principal_curvature(points, faces, radius=5)
    return per_face(k_max, k_min, faces)


def meshlab(points, faces, edges):
    """MeshLab's scale-dependent quadric fitting, at a scale of this many mean edges, or its default."""
    scale = {} if edges is None else {"scale": pymeshlab.PureValue(edges * mesh.mean_edge(points, faces))}
    values = []
    for which in ("Max Curvature", "Min Curvature"):
        meshes = pymeshlab.MeshSet()
        meshes.add_mesh(pymeshlab.Mesh(points, faces))
        with silence():
            meshes.compute_curvature_principal_directions_per_vertex(
                method="Scale Dependent Quadric Fitting", curvcolormethod=which, autoclean=False, **scale
            )
        values.append(np.array(meshes.current_mesh().vertex_scalar_array()))
    return per_face(*values, faces)


def per_face(k1, k2, faces):
    """Vertex values averaged to faces, the larger first."""
    return np.maximum(k1, k2)[faces].mean(axis=1), np.minimum(k1, k2)[faces].mean(axis=1)


@contextmanager
def silence():
    """Hides what native code prints to standard output."""
    sys.stdout.flush()
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
