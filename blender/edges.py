# SPDX-License-Identifier: MIT
"""Kinds of edges and angles between the faces at them, as attributes of edges."""

import numpy as np

from . import store
from .equal import first_equal, repeated_triangles
from .quantities import BOUNDARY, DIHEDRAL, EDGE_KIND, FEATURE, INNER, NON_MANIFOLD


def write(mesh, feature_angle, known=None):
    """Writes kind and angle of every edge; `known` has the kinds where a file gives them. Returns the kinds."""
    kinds, angles = kinds_and_angles(mesh, feature_angle)
    if known is not None:
        kinds = known
    store.put(mesh, EDGE_KIND, "INT", "EDGE", kinds)
    store.put(mesh, DIHEDRAL, "FLOAT", "EDGE", angles)
    return kinds


def kinds_and_angles(mesh, feature_angle):
    """Kind of each edge, and the angle between the normals of its two faces in degrees, 0 where there are not
    two. Edges are taken as curvature takes them: where vertices lie at one place they are one."""
    sides = _Sides(mesh)
    count = np.bincount(sides.edge, minlength=len(mesh.edges))
    pair = count == 2
    # The last to be written stays, so that writing both ways gives both faces.
    faces = np.zeros((2, len(mesh.edges)), np.int32)
    faces[0][sides.edge], faces[1][sides.edge[::-1]] = sides.face, sides.face[::-1]
    a, b = store.face_normals(mesh)[faces]
    flipped = pair & (np.bincount(sides.edge, sides.is_ahead, len(mesh.edges)) != 1)
    if flipped.any():
        b[flipped] *= -1
    apart, along = np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)
    angle = np.where(pair, np.degrees(2 * np.arctan2(apart, along)), 0)
    kind = np.full(len(mesh.edges), INNER, np.int32)
    kind[count == 1] = BOUNDARY
    kind[count > 2] = NON_MANIFOLD
    if feature_angle < 180:
        kind[pair & (angle > feature_angle)] = FEATURE
    return (kind, angle) if sides.joined is None else (kind[sides.joined], angle[sides.joined])


class _Sides:
    """The sides of all faces: `edge` and `face` of each, and `is_ahead` where it runs from the edge's first
    vertex to the second. `joined`: for each edge the one it is counted as, None where all are their own."""

    def __init__(self, mesh):
        self.edge, self.face = store.corner_edges(mesh), store.corner_faces(mesh)
        start, ends = store.corner_vertices(mesh), store.edge_vertices(mesh)
        self.joined = None
        if self._is_torn(mesh, ends):
            place = first_equal(store.positions(mesh))
            start, ends = place[start], np.sort(place[ends], axis=1)
            self.joined = first_equal(ends)
            self.edge = self.joined[self.edge]
            if store.is_triangles(mesh):
                # As on shared vertices, faces that repeat a place or another face have no part in the surface.
                twice, again = repeated_triangles(start.reshape(-1, 3))
                counted = np.repeat(~(twice | again), 3)
                self.edge, self.face, start = self.edge[counted], self.face[counted], start[counted]
        self.is_ahead = start == ends[:, 0][self.edge]

    def _is_torn(self, mesh, ends):
        """Vertices on the rim lie at one place."""
        rim = np.unique(ends[np.bincount(self.edge, minlength=len(ends)) == 1])
        places = store.positions(mesh)[rim]
        return len(rim) > 0 and not np.array_equal(first_equal(places), np.arange(len(rim)))


def mark_sharp(mesh, kinds):
    """Marks feature edges sharp, beside those that are. Normals that the mesh was given stay as they are."""
    features = kinds == FEATURE
    if not features.any():
        return
    normals = None
    if mesh.has_custom_normals:
        normals = np.empty(3 * len(mesh.loops), np.float32)
        mesh.corner_normals.foreach_get("vector", normals)
    sharp = store.get(mesh, "sharp_edge")
    store.put(mesh, "sharp_edge", "BOOLEAN", "EDGE", features if sharp is None else features | sharp)
    if normals is not None:
        mesh.normals_split_custom_set(normals.reshape(-1, 3).tolist())
