"""What the tests share: Blender with the extension installed as a user would, files of the program, arrays.

usage of a test file: python test_X.py PROGRAM ZIP FOLDER [TEST...]"""

import contextlib
import csv
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, ZIP, FOLDER = (Path(argument).resolve() for argument in sys.argv[1:4])
FIXTURES = Path(__file__).resolve().parents[2] / "fixtures"
MODULE = "bl_ext.user_default.osculate"
# Nothing of the user's own Blender is read or written. Blender reads the variable when it is imported.
assert "bpy" not in sys.modules, "import the harness before bpy"
os.environ["BLENDER_USER_RESOURCES"] = tempfile.mkdtemp(dir=FOLDER)

import bpy  # noqa: E402
import numpy as np  # noqa: E402


def install():
    """Blender as it comes, and the extension from its zip."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with quiet():
        bpy.ops.extensions.package_install_files(filepath=str(ZIP), repo="user_default", enable_on_install=True)
    assert MODULE in bpy.context.preferences.addons, "the zip could not be installed"


@contextlib.contextmanager
def quiet():
    """Blender's own words go to a file, which is given."""
    sys.stdout.flush()
    kept = [os.dup(1), os.dup(2)]
    with tempfile.TemporaryFile("w+", dir=FOLDER) as sink:
        os.dup2(sink.fileno(), 1), os.dup2(sink.fileno(), 2)
        said = []
        try:
            yield said
        finally:
            sys.stdout.flush(), sys.stderr.flush()
            for number, copy in enumerate(kept, 1):
                os.dup2(copy, number)
                os.close(copy)
            sink.seek(0)
            said.append(sink.read())


def osculate(*arguments, codes=(0, 3)):
    """Runs the program."""
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode in codes, f"{arguments}: {done.returncode}\n{done.stderr}"
    return done.stdout


def annotated(given, name, *options):
    """The path of a file that the program wrote."""
    path = FOLDER / name
    if not path.exists():
        osculate("annotate", given, "-o", path, "-q", *options)
    return path


def table(given, *options):
    """The columns of a CSV of the program, 32 bits; NaN where a field is empty, words as they are."""
    text = osculate("annotate", given, "-o", "-", "--format", "csv", "-q", *options)
    rows = list(csv.DictReader(text.splitlines()))
    columns = {}
    for name in rows[0]:
        column = [row[name] for row in rows]
        words = name == "method"
        columns[name] = np.array(column if words else [float(field or "nan") for field in column],
                                 str if words else np.float32)
    return columns


def load(path, **options):
    """Imports a glTF file into an empty scene; the meshes of its objects by name, and what the importer said."""
    empty()
    with quiet() as said:
        bpy.ops.import_scene.gltf(filepath=str(path), **options)
    return {obj.data.name: obj.data for obj in bpy.data.objects if obj.type == "MESH"}, said[0]


def empty():
    for kind in (bpy.data.objects, bpy.data.meshes, bpy.data.materials, bpy.data.images, bpy.data.armatures):
        for item in list(kind):
            kind.remove(item)


def only(meshes):
    assert len(meshes) == 1, list(meshes)
    return next(iter(meshes.values()))


def values(mesh, name, domain="FACE"):
    """An attribute, read without the extension's help."""
    attribute = mesh.attributes[name]
    assert attribute.domain == domain, f"{name} is of {attribute.domain}"
    width = 3 if attribute.data_type == "FLOAT_VECTOR" else 1
    dtype = {"FLOAT": np.float32, "FLOAT_VECTOR": np.float32, "INT": np.int32, "BOOLEAN": bool}[attribute.data_type]
    found = np.empty(len(attribute.data) * width, dtype)
    attribute.data.foreach_get("vector" if width == 3 else "value", found)
    return found.reshape(-1, 3) if width == 3 else found


def points(mesh):
    found = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def corners(mesh):
    """Vertices of the faces of a mesh of triangles."""
    found = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", found)
    return found.reshape(-1, 3)


def names(mesh):
    """Everything that a mesh carries, for comparing before and after."""
    return sorted((a.name, a.domain, a.data_type) for a in mesh.attributes if not a.name.startswith(".select"))


def write_ply(path, vertices, faces):
    """A PLY file of triangles, 32 bits."""
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\n"
              f"property float y\nproperty float z\nelement face {len(faces)}\n"
              "property list uchar int vertex_indices\nend_header\n")
    rows = np.empty(len(faces), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    rows["count"], rows["corners"] = 3, faces
    path.write_bytes(header.encode() + np.asarray(vertices, "<f4").tobytes() + rows.tobytes())
    return path


def settings():
    """What the panel sets."""
    return bpy.context.scene.osculate


def obj_of(mesh):
    return next(obj for obj in bpy.data.objects if obj.data == mesh)


def select(*objects):
    for obj in bpy.data.objects:
        obj.select_set(obj in objects)
    bpy.context.view_layer.objects.active = objects[0] if objects else None


def call(operator, **options):
    """Runs an operator: what it returned, and all it reported. An error it reports is among that."""
    with quiet() as said:
        try:
            result, error = operator(**options), ""
        except RuntimeError as raised:
            result, error = {"CANCELLED"}, str(raised)
    return result, error + said[0]


#: Columns of CSV and the attribute each arrives in.
SCALARS = {"k_max": "_CURVATURE_MAX", "k_min": "_CURVATURE_MIN", "mean": "_CURVATURE_MEAN", "gauss": "_CURVATURE_GAUSS",
           "gauss_perimeter": "_CURVATURE_GAUSS_PERIMETER", "shape_index": "_SHAPE_INDEX", "curvedness": "_CURVEDNESS",
           "radius": "_RADIUS", "coverage": "_COVERAGE", "confidence": "_CONFIDENCE"}
VECTORS = {"dir_max": "_DIRECTION_MAX", "dir_min": "_DIRECTION_MIN"}


class Case(unittest.TestCase):
    """A test that compares attributes with CSV."""

    def assert_values(self, mesh, expected, rows=slice(None), turn=lambda v: v, required=()):
        """Every value that the mesh has is, bit by bit, that of the CSV; `turn` takes directions to its axes."""
        compared = set()
        self.assertTrue(np.array_equal(values(mesh, "_CURVATURE_CLASS"), expected["class"][rows].astype(int)))
        for column, name in SCALARS.items():
            if name in mesh.attributes and column in expected:
                self.assertEqual(mesh.attributes[name].data_type, "FLOAT")
                wanted = np.nan_to_num(expected[column][rows])
                self.assertTrue(np.array_equal(values(mesh, name), wanted), f"{mesh.name}: {column}")
                compared.add(column)
        for column, name in VECTORS.items():
            if name in mesh.attributes:
                self.assertEqual(mesh.attributes[name].data_type, "FLOAT_VECTOR")
                wanted = np.stack([expected[f"{column}_{axis}"] for axis in "xyz"], axis=1)[rows]
                wanted = turn(np.nan_to_num(wanted))
                self.assertTrue(np.array_equal(values(mesh, name), wanted), f"{mesh.name}: {column}")
                compared.add(column)
        self.assertLessEqual(set(required), compared)


class Fresh(Case):
    """A test that begins with a new scene and the extension enabled."""

    def setUp(self):
        with quiet():
            bpy.ops.wm.read_homefile(app_template="", use_empty=True)
        if MODULE not in bpy.context.preferences.addons:
            bpy.ops.preferences.addon_enable(module=MODULE)
        empty()


def main():
    install()
    done = unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=1, exit=False)
    sys.stdout.flush(), sys.stderr.flush()
    # Blender 4.2 as a module crashes at its end where anything was exported as glTF, with or without extensions.
    os._exit(0 if done.result.wasSuccessful() else 1)
