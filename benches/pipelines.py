#!/usr/bin/env python3
"""Throughput of the recipes of docs/pipelines.md, taken in turn: writes a part of that page.

usage: benches/pipelines.py [--files N] [--faces N] [--rounds N]      by a Python that has osculate[ray]
                            $OSCULATE: a program to take instead of building it"""
import argparse
import os
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import ray

import common
import osculate.ray

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--files", type=int, default=1000)
parser.add_argument("--faces", type=int, default=20000, help="of each file")
parser.add_argument("--rounds", type=int, default=3)
options = parser.parse_args()
program = common.program()
SHAPES = ["torus", "sphere", "saddle", "fillet-box", "wave", "cylinder", "ellipsoid", "monkey-saddle"]


def seconds(work):
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def processor(of_ray):
    """Seconds of all processors: of this process and all that it has started and that still run, as Ray's do, or of
    those that have ended."""
    if not of_ray:
        return sum(os.times()[2:4])
    stats = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            stats[int(folder.name)] = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue

    def is_ours(process):
        while process in stats and process != os.getpid():
            process = int(stats[process][1])
        return process == os.getpid()

    ticks = sum(int(stat[11]) + int(stat[12]) for process, stat in stats.items() if is_ours(process))
    return ticks / os.sysconf("SC_CLK_TCK")


def made(folder):
    return sum(1 for path in folder.rglob("*.glb"))


with tempfile.TemporaryDirectory() as top:
    top = Path(top)
    known = subprocess.run([program, "synth", "--help"], capture_output=True, text=True, check=True).stdout
    shapes = [shape for shape in SHAPES if shape in known]
    faces = 0
    kinds = []
    for i in range(4 * len(shapes)):
        kinds.append(top / f"{i}.stl")
        count = options.faces * (100 + 2 * (i // len(shapes)) - 3) // 100
        subprocess.run([program, "synth", shapes[i % len(shapes)], "--faces", str(count), "-o", kinds[-1], "-q"], check=True)
    source = top / "in"
    for i in range(options.files):
        (source / str(i % 20)).mkdir(parents=True, exist_ok=True)
        shutil.copy(kinds[i % len(kinds)], source / str(i % 20) / f"{i}.stl")
        faces += (kinds[i % len(kinds)].stat().st_size - 84) // 50

    start = seconds(lambda: ray.init(num_cpus=os.cpu_count(), include_dashboard=False, log_to_driver=False))
    ray.data.DataContext.get_current().enable_progress_bars = False
    command = ["make", "-s", f"-j{os.cpu_count()}", "-f", common.ROOT / "examples/pipelines/Makefile", f"IN={source}", f"OSCULATE={program}"]
    ways = {
        "`osculate batch`": lambda out: subprocess.run([program, "batch", source, "-o", out, "-q"], check=True),
        "Ray": lambda out: osculate.ray.annotate_dataset(source, out),
        "make": lambda out: subprocess.run([*command, f"OUT={out}"], check=True),
    }
    # Ray's workers start with the first run.
    first = seconds(lambda: osculate.ray.annotate_dataset(kinds[:2], top / "first"))
    taken = {way: [] for way in ways}
    worked = {way: [] for way in ways}
    for _ in range(options.rounds):
        for way, work in ways.items():
            out = top / "out"
            before = processor(way == "Ray")
            taken[way].append(seconds(lambda: work(out)))
            worked[way].append(processor(way == "Ray") - before)
            assert made(out) == options.files, f"{way} has made {made(out)}"
            shutil.rmtree(out)
            print(way, f"{taken[way][-1]:.1f} s, of processors {worked[way][-1]:.1f} s", flush=True)
    ray.shutdown()

    # The step, one process for each file as a build would have it.
    packages = subprocess.run([common.ROOT / "tests/clients/setup.sh"], check=True, capture_output=True, text=True).stdout.strip()
    step = top / "step"
    step.mkdir()
    shutil.copy(common.ROOT / "examples/pipelines/curvature.mjs", step)
    (step / "node_modules").symlink_to(Path(packages) / "node_modules")
    scene = step / "scene.glb"
    subprocess.run([program, "annotate", kinds[0], "-o", scene, "-q", "--attributes", "none", "--color-by", "none"], check=True)
    count = 10
    environment = {**os.environ, "OSCULATE": str(program)}
    node = seconds(lambda: [subprocess.run(["node", step / "curvature.mjs", scene, step / "out.glb"], check=True, env=environment) for _ in range(count)])

rows = [[way, *(f"{common.median(times):.1f}", f"{options.files / common.median(times):.1f}",
                f"{faces / common.median(times) / 1e3:.0f}", f"{common.median(worked[way]):.1f}"),
         f"{common.median([base / other for base, other in zip(taken['`osculate batch`'], times)]):.2f}"]
        for way, times in taken.items()]
rows.append(["glTF-Transform, one process a file", f"{node:.1f} ({count} files)", f"{count / node:.1f}",
             f"{count * options.faces / node / 1e3:.0f}", "", ""])
head = ["recipe", "seconds", "files per second", "thousand faces per second", "seconds of processors", "share of `osculate batch`"]
common.write("benches/pipelines.py", "Throughput", f"""{options.files:,} files of about {options.faces:,} faces ({', '.join(shapes)} in four sizes each; binary STL) to GLB with
all default attributes; {common.machine()}; median of {options.rounds} rounds in which the recipes took turns.

{common.table(head, rows)}

Ray itself takes {start:.1f} s to start on one machine, and its workers {first:.1f} s with the first files that they get; neither is
in the table.""", common.ROOT / "docs" / "pipelines.md")
