# SPDX-License-Identifier: MIT
"""Which faces of a file Blender kept: its importer drops those that repeat a vertex or another face."""

import numpy as np

from . import store
from .gltf_primitive import decoded


class Lost(Exception):
    """Faces were dropped and it cannot be told which."""


def survivors(gltf, mesh, primitives):
    """The number of each face of `mesh` among the faces of the primitives."""
    total = sum(primitive.face_count for primitive in primitives)
    if len(mesh.polygons) == total:
        return np.arange(total)
    if gltf.import_settings["merge_vertices"]:
        # Vertices have new numbers; faces are known by where they lie.
        expected = [_positions(gltf, primitive) for primitive in primitives if primitive.face_count]
        expected = np.concatenate(expected).reshape(-1, 9)
        present = store.positions(mesh)[store.corner_vertices(mesh)].reshape(-1, 9)
    else:
        expected = _numbered(gltf, primitives)
        present = store.corner_vertices(mesh).reshape(-1, 3)
    present = iter(enumerate(map(bytes, np.ascontiguousarray(present))))
    kept = np.empty(len(mesh.polygons), np.int64)
    place, wanted = next(present, (None, None))
    for number, face in enumerate(map(bytes, np.ascontiguousarray(expected))):
        if face == wanted:
            kept[place] = number
            place, wanted = next(present, (None, None))
    if wanted is not None:
        raise Lost
    return kept


def _positions(gltf, primitive):
    corners = decoded(gltf, primitive.given.attributes["POSITION"])[primitive.corners].reshape(-1, 3)
    corners = corners.astype(np.float32)
    gltf.locs_batch_gltf_to_blender(corners)
    return corners


def _numbered(gltf, primitives):
    """Corners as vertices of the mesh: each primitive's used vertices follow those of the one before."""
    parts, base = [], 0
    for primitive in primitives:
        if "POSITION" not in primitive.given.attributes:
            continue
        if primitive.corners is None:
            raise Lost
        used, places = np.unique(primitive.shown, return_inverse=True)
        parts.append((places.reshape(-1, 3) + base).astype(np.int32))
        base += len(used)
    return np.concatenate(parts)
