"""Reads every file in MeshLab: face quality and colours of PLY, texture or vertex colours of glTF.
usage: python meshlab.py FOLDER"""
from importlib.metadata import version

import numpy as np
import pymeshlab

from results import colors_of, columns, manifest, refused, say

CLIENT = f"MeshLab {version('pymeshlab').split('.post')[0]}"
FOLDER, FILES = manifest()


def load(path):
    """A set with the meshes of a file, which live as long as the set."""
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    return meshes


for file in FILES:
    name, expected = file["file"], columns(FOLDER / file["csv"])
    faces = len(expected["face"])
    try:
        loaded = load(FOLDER / name)
        meshes = list(loaded)
        found = sum(mesh.face_number() for mesh in meshes)
        if file["layout"] == "ply":
            (mesh,) = meshes
            lost = faces - found
            say(CLIENT, name, "faces", "right" if not lost else
                "absent" if "degenerate" in name else "wrong", f"{lost} with a repeated vertex are dropped" if lost else "")
            if lost:
                continue
            quality = mesh.face_scalar_array()
            right = np.array_equal(quality.astype(np.float32), np.array(expected["mean"], np.float32))
            say(CLIENT, name, "values", "right" if right else "wrong", "face quality")
            colors = np.rint(255 * mesh.face_color_matrix()[:, :3]).astype(int)
            say(CLIENT, name, "colours", "right" if np.array_equal(colors, colors_of(FOLDER / file["colors"]["mean"])) else "wrong")
            continue
        if file["layout"] == "indexed":
            # Instances count once for each node that shows them.
            lost = max(faces - found, 0) if file["scene"] else faces - found
            say(CLIENT, name, "faces", "right" if not lost else
                "absent" if "degenerate" in name else "wrong", f"{lost} with a repeated vertex are dropped" if lost else "")
            say(CLIENT, name, "values", "absent")
            continue
        say(CLIENT, name, "faces", "right" if found == faces or file["scene"] and found > faces else "wrong")
        say(CLIENT, name, "values", "absent", "PLY brings them")
        if file["scene"]:
            say(CLIENT, name, "colours", "absent", "shows the scene's own look")
            continue
        (mesh,) = meshes
        want = np.array(colors_of(FOLDER / file["colors"][file["shown"][0]]))
        if file["carrier"] == "texture":
            coordinates = mesh.wedge_tex_coord_matrix().reshape(faces, 3, 2)
            texels = np.floor(coordinates[:, 0, 0] * 256).astype(int)
            color_of = dict(zip(texels.tolist(), want.tolist()))
            # One texel for all corners, one colour for each texel, and a texture to show it.
            right = np.ptp(coordinates, axis=1).max() == 0 and mesh.texture_number() == 1
            right &= [color_of[texel] for texel in texels.tolist()] == want.tolist()
            say(CLIENT, name, "colours", "right" if right else "wrong")
        else:
            colors = np.rint(255 * mesh.vertex_color_matrix()[:, :3]).astype(int)[mesh.face_matrix()[:, 0]]
            if file["carrier"] == "vertex-srgb":
                say(CLIENT, name, "colours", "right" if np.array_equal(colors, want) else "wrong")
            else:
                dark = colors.mean() < want.mean()
                say(CLIENT, name, "colours", "absent" if dark else "wrong", "too dark: linear light is shown as it is")
    except Exception as error:
        refused(CLIENT, file) or say(CLIENT, name, "values", "wrong", f"{type(error).__name__}: {error}")
