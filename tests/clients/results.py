"""What every client script says: one line of JSON per check, `right`, `absent` or `wrong`.

`absent`: the client does not take this over, which is a fact about the client and goes into the matrix.
`wrong`: what arrives is not what was written; the tests then fail.
"""
import csv
import json
import sys
from pathlib import Path

COLUMNS = {
    "_FACE_ID": "face", "_CURVATURE_CLASS": "class", "_CURVATURE_MAX": "k_max", "_CURVATURE_MIN": "k_min",
    "_CURVATURE_MEAN": "mean", "_CURVATURE_GAUSS": "gauss", "_CONFIDENCE": "confidence",
    "_DIRECTION_MAX_X": "dir_max_x", "_DIRECTION_MAX_Y": "dir_max_y", "_DIRECTION_MAX_Z": "dir_max_z",
    "_COVERAGE": "coverage",
}


def say(client, file, check, result, detail=""):
    print(json.dumps({"client": client, "file": file, "check": check, "result": result, "detail": detail}))
    sys.stdout.flush()


def manifest():
    """The folder with all written files, and the list of them."""
    folder = Path(sys.argv[1])
    return folder, json.loads((folder / "manifest.json").read_text())


def columns(path):
    """A CSV by column; an empty field is 0, as in the other files."""
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name] or 0) for row in rows] for name in rows[0] if name != "method"}


def refused(client, file):
    """True for a compressed file, which a client cannot read; says so."""
    if file["way"] != "meshopt.glb":
        return False
    say(client, file["file"], "values", "absent", "does not know EXT_meshopt_compression")
    return True


def equal(a, b):
    """True when numbers agree as 32-bit floats."""
    import struct
    if len(a) != len(b):
        return False
    f32 = lambda x: struct.unpack("f", struct.pack("f", x))[0]
    return all(f32(x) == f32(y) for x, y in zip(a, b))


def colors_of(path):
    """Red, green and blue of every face of an annotated PLY."""
    data = Path(path).read_bytes()
    head, body = data.split(b"end_header\n", 1)
    sizes = {"char": 1, "uchar": 1, "float": 4, "double": 8, "int": 4, "uint": 4}
    vertices = faces = stride = row = at = 0
    for line in head.decode().splitlines():
        word = line.split()
        if word[:2] == ["element", "vertex"]:
            vertices, where = int(word[2]), "vertex"
        elif word[:2] == ["element", "face"]:
            faces, where = int(word[2]), "face"
        elif word[0] == "property" and where == "vertex":
            stride += sizes[word[1]]
        elif word[0] == "property" and word[1] == "list":
            row += 13
        elif word[0] == "property":
            at = row if word[2] == "red" else at
            row += sizes[word[1]]
    rows = body[vertices * stride:]
    return [tuple(rows[f * row + at: f * row + at + 3]) for f in range(faces)]
