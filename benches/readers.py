"""Reading speed beside trimesh and MeshLab: writes the readers' part of docs/performance.md.

Makes a torus of a million faces in every format and reads each file in turn with the three programs,
one thread each, file in the page cache. Seconds are those of the processor, which do not depend on
what else the machine is doing; the best of three runs.

usage: benches/readers.py [FACES [FOLDER]]   FOLDER: with programs built for release already
with the Python of fixtures/make.sh: ~/.cache/osculate/meshlab/bin/python benches/readers.py"""
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"
os.environ["OPENBLAS_NUM_THREADS"] = "1"
import numpy as np
import pymeshlab
import trimesh

ROOT = Path(__file__).resolve().parent.parent
FACES = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000_000
RUNS = 3
BEGIN, END = "<!-- benches/readers.py -->", "<!-- end of benches/readers.py -->"


def cargo(*arguments):
    subprocess.run(["cargo", *arguments], cwd=ROOT, check=True, stdout=sys.stderr)


if len(sys.argv) > 2:
    target = Path(sys.argv[2])
else:
    cargo("build", "--release", "--quiet", "--bin", "osculate", "--example", "read_speed")
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"


def make(folder):
    """The same faces in every format: 32-bit where the format is binary, nine digits in text."""
    subprocess.run([target / "osculate", "synth", "torus", "--faces", str(FACES), "-o", folder / "torus.ply", "-q"], check=True)
    mesh = trimesh.load(folder / "torus.ply", process=False)
    points = mesh.vertices.astype("<f4")
    mesh = trimesh.Trimesh(points, mesh.faces, process=False)
    text = "\n".join(" ".join(f"{x:.9g}" for x in p) for p in points)
    mesh.export(folder / "binary.stl")
    (folder / "ascii.stl").write_text(trimesh.exchange.stl.export_stl_ascii(mesh))
    obj = "v " + text.replace("\n", "\nv ") + "\n" + "".join(f"f {a} {b} {c}\n" for a, b, c in (mesh.faces + 1).tolist())
    (folder / "plain.obj").write_text(obj)
    faces = "".join(f"3 {a} {b} {c}\n" for a, b, c in mesh.faces.tolist())
    head = f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(mesh.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    (folder / "ascii.ply").write_text(f"ply\nformat ascii 1.0\n{head}{text}\n{faces}")
    rows = np.zeros(len(mesh.faces), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, mesh.faces
    (folder / "binary.ply").write_bytes(f"ply\nformat binary_little_endian 1.0\n{head}".encode() + points.tobytes() + rows.tobytes())
    (folder / "plain.off").write_text(f"OFF\n{len(points)} {len(mesh.faces)} 0\n{text}\n{faces}")
    mesh.export(folder / "indexed.glb", include_normals=False)
    mesh.export(folder / "zipped.3mf")


def best(read):
    seconds = []
    for _ in range(RUNS):
        start = time.process_time()
        read()
        seconds.append(time.process_time() - start)
    return min(seconds)


def osculate(path, *what, times=1):
    """Of a process of its own, which reads the file so many times."""
    seconds = []
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([target / "examples" / "read_speed", *what, str(times), path], check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(seconds)


def osculate_again(path):
    """In a process that has read the file before, as trimesh and MeshLab are timed."""
    return (osculate(path, times=7) - osculate(path, times=2)) / 5


def meshlab(path):
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))


NAMES = [("STL, binary", "binary.stl", 10), ("STL, ASCII", "ascii.stl", 8), ("OBJ", "plain.obj", 8),
         ("PLY, binary", "binary.ply", None), ("PLY, ASCII", "ascii.ply", 8), ("OFF", "plain.off", None),
         ("GLB", "indexed.glb", None), ("3MF", "zipped.3mf", None)]

rows = []
with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    make(folder)
    for name, file, goal in NAMES:
        path = folder / file
        size = path.stat().st_size / 1e6
        ours = osculate(path)
        again = osculate_again(path)
        raw = osculate(path, "bytes")
        plain = best(lambda: trimesh.load_scene(path, process=False))
        merged = best(lambda: trimesh.load(path))
        try:
            theirs = best(lambda: meshlab(path))
        except Exception:
            theirs = None
        rows.append((name, size, ours, again, raw, plain, merged, theirs, goal))
        print(rows[-1], file=sys.stderr)

table = ["| format | MB | Osculate, s | MB/s | again, s | bytes alone, s | trimesh, s | with merging, s | MeshLab, s | times trimesh | again | with merging | times MeshLab |",
         "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
for name, size, ours, again, raw, plain, merged, theirs, goal in rows:
    lab = (f"{theirs:.2f}", f"{theirs / ours:.1f}") if theirs else ("-", "-")
    table.append(f"| {name} | {size:.0f} | {ours:.3f} | {size / ours:.0f} | {again:.3f} | {raw:.3f} | {plain:.3f} | {merged:.2f} | {lab[0]} | "
                 f"{plain / ours:.1f} | {plain / again:.1f} | {merged / ours:.1f} | {lab[1]} |")
versions = f"trimesh {trimesh.__version__}, pymeshlab {subprocess.run([sys.executable, '-m', 'pip', 'show', 'pymeshlab'], capture_output=True, text=True).stdout.split('Version: ')[1].split()[0]}"
part = f"""{BEGIN}
A torus of {FACES:,} faces, single thread, seconds of the processor, best of {RUNS}, files in the page
cache; {versions}. "With merging" is what `trimesh.load` does by default: it also welds equal vertices, which Osculate does in a
later stage. "Osculate" is a process of its own from start to end, "again" is reading the file once more in a process that has read
it before, which is how trimesh and MeshLab are timed. "Bytes alone" is Osculate's process without the reader: what it takes to start and to bring the file into
fresh memory.

{chr(10).join(table)}
{END}"""
page = ROOT / "docs" / "performance.md"
text = page.read_text() if page.exists() else f"# Performance\n\n## Reading\n\n{BEGIN}\n{END}\n"
page.write_text(re.sub(f"{BEGIN}.*{END}", lambda _: part, text, flags=re.S))
print("\n".join(table))
