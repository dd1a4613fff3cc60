#!/usr/bin/env python3
"""Seconds of each stage and peak memory, binary STL to GLB: writes a part of docs/performance.md.

usage: benches/pipeline.py [--runs N] [FACES...]      $OSCULATE: a program to take instead of building it"""
import argparse
import os
import subprocess
import tempfile
from pathlib import Path

import common

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--runs", type=int, default=5)
parser.add_argument("faces", type=int, nargs="*", default=[100_000, 1_000_000, 10_000_000])
options = parser.parse_args()
osculate = common.program()
rows = []
with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    source, target = folder / "torus.stl", folder / "out.glb"

    def annotate(threads, *extra):
        return common.annotate([osculate, "annotate", source, f"-j{threads}", "-q", *extra], target)

    def synth(faces):
        subprocess.run([osculate, "synth", "torus", "--faces", str(faces), "-o", source, "-q"], check=True)
        return (source.stat().st_size - 84) // 50

    synth(100)
    constant = annotate(1)["anonymous"]
    for wanted in options.faces:
        faces = synth(wanted)
        settings = [("default", []), ("osculating, factor 3", ["--estimator", "osculating", "--radius-factor", "3"])]
        for name, extra in settings:
            for threads in dict.fromkeys([1, os.cpu_count()]):
                runs = [annotate(threads, *extra) for _ in range(options.runs)]

                def per_face(stage):
                    return 1e6 * common.median([run["seconds"][stage] for run in runs]) / faces

                rest = 1e6 * common.median([run["wall"] for run in runs]) / faces - per_face("estimate")
                memory = (max(run["anonymous"] for run in runs) - constant) * 2**20 / faces
                stages = [f"{per_face(stage):.3f}" for stage in ["read", "weld", "estimate", "write", "total"]]
                rows.append((f"{faces:,}", name, threads, *stages, f"{rest:.3f}", f"{memory:.0f}"))
                print(rows[-1], flush=True)
head = ["faces", "estimator", "threads", "read", "weld", "estimate", "write", "all", "all but estimate", "bytes per face"]
common.write("benches/pipeline.py", "Stages and memory", f"""A torus as binary STL to GLB (layout `faces`, all default attributes), microseconds per face by the wall clock, median of
{options.runs}; `weld` is weld, adjacency and edge kinds; "all but estimate" is of whole processes that are not asked for
statistics, their start and their end included. Bytes per face: anonymous memory at the peak (RssAnon, looked at every 2 ms, the mapped input not counted), less that of a mesh of a hundred
faces, {constant:.0f} MB. {common.machine()}.

{common.table(head, rows)}""")
