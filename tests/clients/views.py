"""Reads every file in trimesh and PyVista. usage: python views.py FOLDER"""
import numpy as np
import pyvista
import trimesh
from PIL import Image

from results import COLUMNS, colors_of, columns, manifest, refused, say

TRIMESH, PYVISTA = f"trimesh {trimesh.__version__}", f"PyVista {pyvista.__version__}"
FOLDER, FILES = manifest()


def joined(parts, name):
    """Values of the first corner of each face over parts sorted by their first face; None where corners
    of a face differ."""
    out = []
    for faces, values in parts:
        data = np.asarray(values[name]).reshape(len(values[name]))[faces]
        if np.ptp(data, axis=1).any():
            return None
        out.append(data[:, 0])
    return np.concatenate(out)


def check(client, file, parts):
    """`parts`: faces and vertex attributes of each mesh."""
    expected = columns(FOLDER / file["csv"])
    if not all("_FACE_ID" in values for _, values in parts):
        say(client, file["file"], "values", "absent")
        return
    unique = {float(np.ravel(values["_FACE_ID"])[faces[0][0]]): (faces, values) for faces, values in parts}
    parts = [unique[first] for first in sorted(unique)]
    order = joined(parts, "_FACE_ID")
    right = order is not None and np.array_equal(order, np.arange(len(expected["face"])))
    say(client, file["file"], "order of faces", "right" if right else "wrong")
    for name, column in COLUMNS.items():
        found = joined(parts, name)
        if found is None or not np.array_equal(found.astype(np.float32), np.array(expected[column], np.float32)):
            say(client, file["file"], "values", "wrong", name)
            return
    say(client, file["file"], "values", "right")


def sampled(image, uv):
    pixels = np.asarray(image.convert("RGB"))
    x = np.clip((uv[:, 0] * pixels.shape[1]).astype(int), 0, pixels.shape[1] - 1)
    y = np.clip(((1 - uv[:, 1]) * pixels.shape[0]).astype(int), 0, pixels.shape[0] - 1)
    return pixels[y, x]


def check_trimesh(file):
    path = FOLDER / file["file"]
    if path.suffix == ".ply":
        mesh = trimesh.load(path, process=False)
        raw = mesh.metadata["_ply_raw"]["face"]["data"]
        right = np.array_equal(np.asarray(raw["mean"]).reshape(-1), np.array(columns(FOLDER / file["csv"])["mean"], np.float32))
        say(TRIMESH, file["file"], "values", "right" if right else "wrong", "in the raw data of the file")
        colors = mesh.visual.face_colors[:, :3]
        say(TRIMESH, file["file"], "colours", "right" if np.array_equal(colors, colors_of(path)) else "wrong")
        return
    scene = trimesh.load_scene(path, process=False)
    meshes = list(scene.geometry.values())
    check(TRIMESH, file, [(mesh.faces, mesh.vertex_attributes) for mesh in meshes])
    if file["layout"] == "faces" and not file["scene"]:
        want = np.array(colors_of(FOLDER / file["colors"][file["shown"][0]]))
        (mesh,) = meshes
        if file["carrier"] == "texture":
            got = sampled(mesh.visual.material.baseColorTexture, mesh.visual.uv[mesh.faces[:, 0]])
            say(TRIMESH, file["file"], "colours", "right" if np.array_equal(got, want) else "wrong")
        elif file["carrier"] == "vertex-srgb":
            got = np.asarray(mesh.visual.vertex_attributes["color"])[mesh.faces[:, 0], :3]
            say(TRIMESH, file["file"], "colours", "right" if np.array_equal(got, want) else "wrong", "bytes as they are")


def vtk_parts(path):
    """Faces and point data of every mesh of a file."""
    parts = []

    def walk(block):
        if isinstance(block, pyvista.MultiBlock):
            for part in block:
                walk(part)
        elif block is not None and block.n_cells:
            parts.append((block.faces.reshape(-1, 4)[:, 1:], dict(block.point_data)))

    walk(pyvista.get_reader(str(path)).read())
    return parts


def check_pyvista(file):
    if file["file"].endswith(".ply"):
        say(PYVISTA, file["file"], "values", "absent")
        return
    parts = vtk_parts(FOLDER / file["file"])
    if not parts and file["scene"] and not vtk_parts(FOLDER / file["input"]):
        say(PYVISTA, file["file"], "values", "absent", "does not read the input either: sparse accessors")
        return
    check(PYVISTA, file, parts)


for file in FILES:
    for client, test in ((TRIMESH, check_trimesh), (PYVISTA, check_pyvista)):
        try:
            test(file)
        except Exception as error:
            refused(client, file) or say(client, file["file"], "values", "wrong", f"{type(error).__name__}: {error}")
