"""Errors of the program on its own synthetic meshes, and what the scripts that draw them have in common."""
import argparse
import os
import subprocess
import tempfile

import numpy as np


def columns(path, names):
    """Columns of a CSV file as arrays; empty fields are not a number."""
    with open(path) as file:
        header = file.readline().strip().split(",")
        rows = [line.rstrip("\n").split(",") for line in file]
    at = [header.index(name) for name in names]
    return [np.array([float(row[i] or "nan") for row in rows]) for i in at]


def measure(program, synth, annotate=()):
    """Confidence and error of every face of a mesh that `osculate synth` makes with these options, seed 1.

    The error is that of k_max or k_min, whichever is worse, relative to the larger of them in magnitude (at
    least a hundredth of the largest on the mesh); not a number for a face without an estimate.
    """
    with tempfile.TemporaryDirectory() as folder:
        mesh, exact, faces = (os.path.join(folder, name) for name in ("mesh.ply", "exact.csv", "faces.csv"))
        subprocess.run([program, "synth", *synth, "--seed", "1", "-o", mesh, "--exact", exact, "-q"], check=True)
        # 3: written, but the mesh has defects.
        done = subprocess.run([program, "annotate", mesh, "-o", faces, "--up", "y", "-q", *annotate])
        if done.returncode not in (0, 3):
            raise SystemExit(f"annotate ended with {done.returncode} for {' '.join(synth)}")
        true_max, true_min = columns(exact, ["k_max", "k_min"])
        k_max, k_min, confidence = columns(faces, ["k_max", "k_min", "confidence"])
    size = np.maximum(abs(true_max), abs(true_min))
    error = np.maximum(abs(k_max - true_max), abs(k_min - true_min)) / np.maximum(size, 0.01 * size.max())
    return confidence, error


def options(about):
    """The options of a script that measures and, with -o, draws."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="target/release/osculate")
    parser.add_argument("-o", "--output", help="picture to write")
    return parser.parse_args()
