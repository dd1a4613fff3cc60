#!/usr/bin/env python3
"""What a call from Python costs beside the library's own time: writes a part of docs/performance.md.

usage: benches/python_call.py [--faces N] [--runs N]      run by a Python that has the package `osculate`"""
import argparse
import statistics
import tempfile
import time
from pathlib import Path

import numpy as np
import osculate

import common

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--faces", type=int, default=1_000_000)
parser.add_argument("--runs", type=int, default=7)
options = parser.parse_args()

FIELDS = [name for name in osculate.QUANTITIES if name not in ("face", "method", "gauss_perimeter")]


def timed(work):
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "torus.ply"
    assert osculate._native.run(["osculate", "synth", "torus", "--faces", str(options.faces), "-o", str(path), "-q"]) == 0
    mesh = osculate.read(path)
    vertices, faces = mesh.vertices, mesh.faces
    del mesh
    layouts = {
        "float32, uint32, contiguous: read where they lie": (vertices.astype(np.float32), faces),
        "float64, uint32, contiguous: the same": (vertices, faces),
        "float64, int64 (as NumPy, trimesh and others have them)": (vertices, faces.astype(np.int64)),
        "float64 and int64 in columns (Fortran order)": (np.asfortranarray(vertices), np.asfortranarray(faces.astype(np.int64))),
    }
    rows = []
    for threads in (1, None):
        own, calls, made = [], {name: [] for name in layouts}, []
        # In turns, so that other work on the machine meets all alike.
        for _ in range(options.runs):
            seconds = osculate.convert(path, Path(folder) / "out.npz", attributes="none", color_by="none", threads=threads)["seconds"]
            own.append(seconds["weld"] + seconds["estimate"])
            for name, arrays in layouts.items():
                took, curvature = timed(lambda: osculate.annotate(*arrays, threads=threads))
                calls[name].append(took)
            made.append(timed(lambda: [curvature[name] for name in FIELDS])[0])
        base = min(own)
        for name, took in calls.items():
            rows.append((name, threads or "all", f"{base:.3f}", f"{min(took):.3f}", f"{100 * (min(took) / base - 1):+.1f} %",
                         f"{100 * (statistics.median(took) / statistics.median(own) - 1):+.1f} %"))
        rows.append((f"making {len(FIELDS)} fields, once", threads or "all", "", f"{min(made):.3f}", f"{100 * min(made) / base:+.1f} %", ""))
head = ["arrays", "threads", "the library's own, s", "the call, s", "more (best of each)", "more (medians)"]
common.write("benches/python_call.py", "Python", f"""A torus of {len(faces):,} faces, `osculate.annotate(vertices, faces)` from Python beside what connecting and estimating take of
`osculate.convert` on the same mesh in the same process, {options.runs} runs of each in turns; {common.machine()}. The file has 32-bit
vertices.

{common.table(head, rows)}""")
