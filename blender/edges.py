# SPDX-License-Identifier: MIT
"""Kinds of edges and angles between the faces at them, as attributes of edges."""

import numpy as np

from . import store
from .equal import first_equal, repeated_triangles
from .quantities import BOUNDARY, DIHEDRAL, EDGE_KIND, FEATURE, INNER, NON_MANIFOLD

#: How many faces without area may lie between an edge and the face that gives it a normal.
_LONGEST_CHAIN = 16


def write(mesh, feature_angle, known=None):
    """Writes kind and angle of every edge; `known` has the kinds where a file gives them. Returns the kinds."""
    sides = _Sides(mesh)
    # Looking for faces without area takes long. Known kinds tell whether there are any that matter.
    kinds, angles = sides.kinds_and_angles(store.face_normals(mesh), feature_angle) if known is not None else (None, None)
    if known is None or ((kinds == FEATURE) != (known == FEATURE)).any():
        kinds, angles = sides.kinds_and_angles(sides.lent_normals(mesh), feature_angle)
    if known is not None:
        kinds = known
    store.put(mesh, EDGE_KIND, "INT", "EDGE", kinds)
    store.put(mesh, DIHEDRAL, "FLOAT", "EDGE", angles)
    return kinds


class _Sides:
    """The sides of all faces: `edge` and `face` of each. For each edge `count` (faces), `pair` (there are two),
    `faces` (2 x edges; the two of a pair), `flipped` (both walk it the same way), and `joined`: the edge it is
    counted as, None where all are their own."""

    def __init__(self, mesh):
        # NumPy makes indices of this width of all others, each time that they are used.
        self.edge, self.face = store.corner_edges(mesh).astype(np.intp), store.corner_faces(mesh)
        start, ends = store.corner_vertices(mesh), store.edge_vertices(mesh)
        self.joined = None
        self.count = np.bincount(self.edge, minlength=len(ends))
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
            self.count = np.bincount(self.edge, minlength=len(ends))
        is_ahead = start == ends[:, 0][self.edge]
        self.pair = self.count == 2
        # The last to be written stays, so that writing both ways gives both faces.
        self.faces = np.zeros((2, len(ends)), np.int32)
        self.faces[0][self.edge], self.faces[1][self.edge[::-1]] = self.face, self.face[::-1]
        self.flipped = self.pair & (np.bincount(self.edge[is_ahead], minlength=len(ends)) != 1)

    def kinds_and_angles(self, normals, feature_angle):
        """Kind of each edge, and the angle between the normals of its two faces in degrees, 0 where there are not
        two or one has no normal. Edges are taken as curvature takes them: at one place they are one."""
        a, b = normals[self.faces[0]], normals[self.faces[1]]
        if self.flipped.any():
            b[self.flipped] *= -1
        apart, along = a - b, a + b
        apart, along = (np.sqrt(np.einsum("ij,ij->i", v, v)) for v in (apart, along))
        angle = np.degrees(2 * np.arctan2(apart, along))
        angle[~self.pair | np.isnan(angle)] = 0
        kind = np.full(len(angle), INNER, np.int32)
        kind[self.count == 1] = BOUNDARY
        kind[self.count > 2] = NON_MANIFOLD
        if feature_angle < 180:
            kind[angle > feature_angle] = FEATURE
        return (kind, angle) if self.joined is None else (kind[self.joined], angle[self.joined])

    def lent_normals(self, mesh):
        """Unit normals of the faces, where a triangle without area has that of its neighbour across its longest
        edge: a sliver in the seam between two flat sides belongs to the side it lies along."""
        normals = store.face_normals(mesh)
        if not store.is_triangles(mesh):
            return normals
        at = store.positions(mesh).astype(np.float64)[store.corner_vertices(mesh)].reshape(-1, 3, 3)
        first, second = at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]
        lengths = [np.einsum("ij,ij->i", side, side) for side in (first, second - first, second)]
        crossed = np.cross(first, second)
        # Below the rounding error of the area, as in the program; where coordinates are no numbers there is none either.
        u, v = np.sqrt(lengths[0]), np.sqrt(lengths[2])
        rounding = 4 * np.finfo(float).eps * (u * v + np.abs(at).max(axis=(1, 2)) * np.maximum(u, v))
        slivers = np.flatnonzero(~(np.sqrt(np.einsum("ij,ij->i", crossed, crossed)) > rounding))
        if not len(slivers):
            return normals
        normals = normals.copy()
        is_sliver = np.zeros(len(normals), bool)
        is_sliver[slivers] = True
        sides_of, of_slivers = {}, is_sliver[self.face]
        for edge, face in zip(self.edge[of_slivers].tolist(), self.face[of_slivers].tolist()):
            sides_of.setdefault(face, []).append(edge)
        longest = np.argmax(np.stack(lengths)[:, slivers], axis=0)
        lender = {}
        for face, side in zip(slivers.tolist(), longest.tolist()):
            own = sides_of.get(face, [])
            if len(own) == 3 and self.pair[own[side]]:
                edge = own[side]
                other = int(self.faces[0][edge] + self.faces[1][edge]) - face
                lender[face] = other, -1 if self.flipped[edge] else 1
        for face in slivers.tolist():
            now, sign = face, 1
            for _ in range(_LONGEST_CHAIN):
                if not is_sliver[now] or now not in lender:
                    break
                now, turn = lender[now]
                sign *= turn
            # Both sides of an edge without a normal get none, and no angle.
            normals[face] = sign * normals[now] if not is_sliver[now] else np.nan
        return normals

    def _is_torn(self, mesh, ends):
        """Vertices on the rim lie at one place."""
        rim = np.unique(ends[self.count == 1])
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
