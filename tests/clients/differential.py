"""Reads files of all formats with trimesh and with the program, and compares the number of faces, the
total area and the bounds of the placed scene.

usage: differential.py PROGRAM FOLDER   files in FOLDER as fixtures/make_variants.py makes them"""
import gzip
import io
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import trimesh

program, folder = sys.argv[1], Path(sys.argv[2])
# What trimesh 5.2 reads without its substitutions.
LEFT_OUT = {"sparse.glb"}


def theirs(path):
    kind = path.suffix[1:]
    if kind == "gz":
        kind = path.suffixes[-2][1:]
        return trimesh.load_scene(io.BytesIO(gzip.decompress(path.read_bytes())), file_type=kind, process=False)
    return trimesh.load_scene(path, process=False)


def ours(path):
    run = subprocess.run([program, "inspect", path, "--format", "json"], capture_output=True, text=True)
    if run.returncode != 0:
        raise SystemExit(f"{path}: exit code {run.returncode}: {run.stderr}")
    return json.loads(run.stdout)


compared = 0
for path in sorted(p for p in folder.rglob("*") if p.is_file() and p.suffix != ".bin" and p.name not in LEFT_OUT):
    scene, found = theirs(path), ours(path)
    # A glTF mesh counts once for faces and area, however often it is placed.
    once = path.suffix in (".glb", ".gltf")
    meshes = list(scene.geometry.values()) if once else [scene.to_mesh()]
    faces, area = sum(len(m.faces) for m in meshes), sum(m.area for m in meshes)
    bounds = found["scene"]["bounds"] if found["scene"] else found["bounds"]
    size = np.linalg.norm(scene.extents)
    off = np.abs(np.array([bounds["min"], bounds["max"]]) - scene.bounds).max() / size
    problems = []
    if faces != found["faces"]:
        problems.append(f"{found['faces']} faces, trimesh has {faces}")
    if abs(area - found["area"]) > 1e-6 * area:
        problems.append(f"area {found['area']}, trimesh has {area}")
    if off > 1e-6:
        problems.append(f"bounds {bounds}, trimesh has {scene.bounds.tolist()}")
    if problems:
        raise SystemExit(f"{path}: " + "; ".join(problems))
    compared += 1
if compared < 60:
    raise SystemExit(f"only {compared} files in {folder}")
print(f"{compared} files read as trimesh reads them")
