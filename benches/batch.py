#!/usr/bin/env python3
"""Files per second of `osculate batch`: writes a part of docs/performance.md.

usage: benches/batch.py [--files N] [--faces N]      $OSCULATE: a program to take instead of building it"""
import argparse
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import common

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--files", type=int, default=2000)
parser.add_argument("--faces", type=int, default=1000, help="of each file")
options = parser.parse_args()
osculate = common.program()
SHAPES = ["torus", "sphere", "saddle", "fillet-box"]
rows = []
with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    for shape in SHAPES:
        subprocess.run([osculate, "synth", shape, "--faces", str(options.faces), "--jitter", "0.2", "-o", folder / f"{shape}.stl", "-q"], check=True)
    for i in range(options.files):
        target = folder / "in" / str(i % 20)
        target.mkdir(parents=True, exist_ok=True)
        shutil.copy(folder / f"{SHAPES[i % 4]}.stl", target / f"{i}.stl")
    settings = [("default", []), ("`--estimator osculating --radius-factor 3`", ["--estimator", "osculating", "--radius-factor", "3"])]
    for name, extra in settings:
        # What estimation takes of it, from the statistics of some of the files, one thread.
        some = ["batch", folder / "in" / "0", "-o", folder / "some", "-j1", "-q", "--stats", *extra]
        common.run([osculate, *some])
        stats = [json.loads(path.read_text())["seconds"] for path in (folder / "some").glob("*.stats.json")]
        share = sum(s["estimate"] for s in stats) / sum(s["total"] for s in stats)
        shutil.rmtree(folder / "some")
        for threads in dict.fromkeys([1, os.cpu_count()]):
            result = common.run([osculate, "batch", folder / "in", "-o", folder / "out", f"-j{threads}", "-q", *extra])
            shutil.rmtree(folder / "out")
            rows.append((name, threads, f"{result['wall']:.1f}", f"{options.files / result['wall']:.0f}",
                         f"{options.files / result['cpu']:.0f}", f"{100 * share:.0f} %", f"{result['peak']:.0f}"))
head = ["settings", "threads", "seconds", "files per second", "files per second of a processor", "of it estimation", "peak MB"]
common.write("benches/batch.py", "Many files", f"""{options.files:,} files of about {options.faces:,} faces ({', '.join(SHAPES)}; binary STL) to GLB with all default
attributes; {common.machine()}.

{common.table(head, rows)}""")
