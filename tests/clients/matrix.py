"""Puts what the clients said into one table, and fails where something arrived wrong.
usage: python matrix.py FOLDER TABLE [--write]
Without --write the table must be the one that is in the repository already."""
import json
import sys
from pathlib import Path

folder, table = Path(sys.argv[1]), Path(sys.argv[2])
ways = {file["file"]: file["way"] for file in json.loads((folder / "manifest.json").read_text())}
WAYS = {
    "glb": "`.glb`", "gltf": "`.gltf`", "variants.glb": "`.glb --variants` (five)", "vertex.glb": "`.glb --color vertex`",
    "srgb.glb": "`.glb --color vertex-srgb`", "indexed.glb": "`.glb --layout indexed`",
    "metadata.glb": "`.glb --metadata`", "meshopt.glb": "`.glb --compress meshopt`", "ply": "`.ply`",
}
CHECKS = {
    "order of faces": "Order of faces", "faces": "Number of faces",
    "values": "Values of every face, as the CSV has them", "faces under the mouse": "Values of the faces under the mouse",
    "colours": "Colours of every face",
    "colours, switched": "Five variants, switched one after the other",
    "shape at five times": "Shape of skinned, morphed and moving scenes at five times, within 1e-6",
    "cameras, lights, bones, actions": "Cameras, lights, bones, actions and names of a scene",
}

said = [json.loads(line) for path in sorted(folder.glob("*.jsonl")) for line in path.read_text().splitlines()]
wrong = [answer for answer in said if answer["result"] == "wrong"]
for answer in wrong:
    print(f"{answer['client']}: {answer['file']}: {answer['check']}: {answer['detail']}", file=sys.stderr)

clients = sorted({answer["client"] for answer in said}, key=str.lower)
cells, notes = {}, []
for answer in said:
    cells.setdefault((answer["check"], ways[answer["file"]], answer["client"]), []).append(answer)


def note(text):
    if text not in notes:
        notes.append(text)
    return notes.index(text) + 1


def cell(answers):
    """`yes` where all files came right, `no` where none did; else how many did."""
    if not answers:
        return ""
    right = sum(answer["result"] == "right" for answer in answers)
    why = {answer["detail"] for answer in answers if answer["result"] != "right" and answer["detail"]}
    # Numbers of faces differ from file to file; what is said of them does not.
    marks = "".join(f" ({note(text)})" for text in sorted({text.lstrip("0123456789 ") for text in why}))
    word = "yes" if right == len(answers) else "no" if right == 0 else f"{right} of {len(answers)}"
    return word + marks


lines = ["# Which client takes what", "",
         "Made by `tests/clients/run.sh` from what the clients themselves showed; not typed. Six fixtures (STL, OBJ and",
         "glTF scenes) in every way there is; `yes`: right for all of them, `no`: not taken over, empty: does not apply.",
         "Values are compared as 32-bit floats, exactly, but those of `--compress meshopt` to 16 bits; colours exactly, but vertex colours in linear light within 8 of 255."]
for check, title in CHECKS.items():
    rows = [way for way in WAYS if any((check, way, client) in cells for client in clients)]
    columns = [client for client in clients if any((check, way, client) in cells for way in rows)]
    if not rows:
        continue
    lines += ["", f"## {title}", "", "| written as | " + " | ".join(columns) + " |", "|" + "---|" * (len(columns) + 1)]
    for way in rows:
        lines.append("| " + " | ".join([WAYS[way]] + [cell(cells.get((check, way, client), [])) for client in columns]) + " |")
lines += [""] + [f"({i + 1}) {text}" + ("" if i + 1 == len(notes) else "  ") for i, text in enumerate(notes)]
text = "\n".join(lines).rstrip() + "\n"

if "--write" in sys.argv:
    table.write_text(text)
elif text != table.read_text():
    print(f"{table} is not what the clients show now; write it anew with: tests/clients/run.sh PROGRAM --write", file=sys.stderr)
    (folder / "compatibility.md").write_text(text)
    sys.exit(1)
print(f"{len(said)} answers of {len(clients)} clients, {len(wrong)} wrong")
sys.exit(1 if wrong else 0)
