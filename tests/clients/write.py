"""Writes fixtures in every way there is, with the numbers and colours that clients must find in them.
usage: python write.py PROGRAM FOLDER"""
import json
import shutil
import subprocess
import sys
from pathlib import Path

PROGRAM, FOLDER = sys.argv[1], Path(sys.argv[2])
FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
VARIANTS = ["mean", "gauss", "k_max", "shape_index", "class"]

INPUTS = ["suzanne.stl", "fillet_degenerate.stl", "groups.obj", "two_meshes.glb", "scene.gltf", "character.glb"]


def annotate(source, output, *options):
    run = subprocess.run([PROGRAM, "annotate", str(source), "-o", str(FOLDER / output), "-q", *options])
    assert run.returncode in (0, 3), (source, options)


files = []
for name in INPUTS:
    source, stem = FIXTURES / name, name.replace(".", "_")
    is_scene = source.suffix in (".glb", ".gltf")
    shutil.copy(source, FOLDER / name)
    for beside in {"scene.gltf": ["scene.bin", "Tiles.png"]}.get(name, []):
        shutil.copy(FIXTURES / beside, FOLDER / beside)
    up = [] if is_scene else ["--up", "y"]
    annotate(source, f"{stem}.csv", *up)
    colors = {}
    for quantity in VARIANTS:
        colors[quantity] = f"{stem}-{quantity}.ply"
        annotate(source, colors[quantity], "--color-by", quantity, *up)
    ways = [("glb", "texture", "faces", ["mean"], []),
            ("gltf", "texture", "faces", ["k_max"], ["--color-by", "k_max"]),
            ("variants.glb", "texture", "faces", VARIANTS, ["--variants", ",".join(VARIANTS)]),
            ("indexed.glb", "none", "indexed", [], ["--layout", "indexed"]),
            ("metadata.glb", "texture", "faces", ["mean"], ["--metadata"]),
            ("meshopt.glb", "texture", "faces", ["mean"], ["--compress", "meshopt"])]
    if not is_scene:
        ways.append(("vertex.glb", "vertex", "faces", ["mean"], ["--color", "vertex"]))
        ways.append(("srgb.glb", "vertex-srgb", "faces", ["mean"], ["--color", "vertex-srgb"]))
    for ending, carrier, layout, shown, options in ways:
        file = f"{stem}.{ending}" if "." not in ending else f"{stem}-{ending}"
        annotate(source, file, *options, *up)
        files.append({"file": file, "input": name, "csv": f"{stem}.csv", "carrier": carrier, "layout": layout,
                      "shown": shown, "colors": colors, "scene": is_scene, "way": ending})
    files.append({"file": colors["mean"], "input": name, "csv": f"{stem}.csv", "carrier": "face", "layout": "ply",
                  "shown": ["mean"], "colors": colors, "scene": is_scene, "way": "ply"})
(FOLDER / "manifest.json").write_text(json.dumps(files, indent=1))
print(len(files), "files", file=sys.stderr)
