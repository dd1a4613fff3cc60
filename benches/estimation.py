#!/usr/bin/env python3
"""Microseconds a face of the estimation alone: writes a part of docs/performance.md.

usage: benches/estimation.py [--runs N] [--faces N] [MESH...]      files of your own are added to the table
                             $OSCULATE: a program to take instead of building it"""
import argparse
import json
import os
import random
import subprocess
import tempfile
from pathlib import Path

import common

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--runs", type=int, default=5)
parser.add_argument("--faces", type=int, default=1_000_000)
parser.add_argument("meshes", type=Path, nargs="*")
options = parser.parse_args()
osculate = common.program()


def shuffled(source, target):
    """The facets of a binary STL in random order."""
    content = source.read_bytes()
    facets = [content[at:at + 50] for at in range(84, len(content), 50)]
    random.Random(1).shuffle(facets)
    target.write_bytes(content[:84] + b"".join(facets))
    return target


with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)

    def synth(name, shape, faces, *extra):
        path = folder / name
        subprocess.run([osculate, "synth", shape, "--faces", str(faces), *extra, "-o", path, "-q"], check=True)
        return path

    def measure(mesh, threads, *extra):
        """Faces, and microseconds a face: the median of all runs."""
        stats, seconds = folder / "stats.json", []
        for _ in range(options.runs):
            subprocess.run([osculate, "annotate", mesh, "-o", folder / "out.ply", f"-j{threads}", "-q", *extra, "--stats", stats],
                           stderr=subprocess.DEVNULL)
            told = json.loads(stats.read_text())
            seconds.append(told["seconds"]["estimate"])
        return told["faces"], 1e6 * common.median(seconds) / told["faces"]

    torus = synth("torus.stl", "torus", options.faces)
    mixed = shuffled(torus, folder / "mixed.stl")
    sections = ["--estimator", "osculating", "--radius-factor"]
    meshes = [("torus", torus), ("the same, faces in random order", mixed),
              ("wave (a surface outside the exact class)", synth("wave.stl", "wave", options.faces)),
              ("torus, noise of a hundredth of an edge", synth("n1.stl", "torus", 50_000, "--noise", "0.01")),
              ("torus, noise of a tenth of an edge", synth("n10.stl", "torus", 50_000, "--noise", "0.1")),
              *((mesh.name, mesh) for mesh in options.meshes)]
    rows = []

    def row(name, mesh, label, *extra):
        one, all_ = measure(mesh, 1, *extra), measure(mesh, os.cpu_count(), *extra)
        rows.append((name, f"{one[0]:,}", label, f"{one[1]:.2f}", f"{all_[1]:.2f}", f"{one[1] / all_[1]:.2f}"))
        print(rows[-1], flush=True)

    for name, mesh in meshes:
        row(name, mesh, "default")
    for factor in ["1", "2", "3", "4", "8"]:
        row("torus", torus, f"`osculating`, factor {factor}", *sections, factor)
    row("the same, faces in random order", mixed, "`osculating`, factor 3", *sections, "3")
head = ["mesh", "faces", "estimator", "us/face, one thread", f"{os.cpu_count()} threads", "ratio"]
common.write("benches/estimation.py", "Estimation", f"""The stage `estimate` of `--stats`, putting faces in order and back included; 32-bit files, 12 diameters, median of
{options.runs}; {common.machine()}.

{common.table(head, rows)}""")
