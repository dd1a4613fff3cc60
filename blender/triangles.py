# SPDX-License-Identifier: MIT
"""A mesh as triangles, and values of triangles as values of its faces."""

import numpy as np

from . import store
from .quantities import NOT_ESTIMATED, QUANTITIES


class Triangles:
    """What the estimate needs of a mesh, copied so that the work can go on without Blender.

    vertices: n x 3 (32 bits). corners: triangles x 3. face: the face of each triangle, None where all faces are
    triangles."""

    def __init__(self, mesh):
        self.vertices = store.positions(mesh)
        self.face_count = len(mesh.polygons)
        self.face = None
        if store.is_triangles(mesh):
            self.corners = store.corner_vertices(mesh).reshape(-1, 3)
            return
        mesh.calc_loop_triangles()
        count = len(mesh.loop_triangles)
        self.corners, self.face = np.empty(3 * count, np.int32), np.empty(count, np.int32)
        mesh.loop_triangles.foreach_get("vertices", self.corners)
        mesh.loop_triangles.foreach_get("polygon_index", self.face)
        self.corners = self.corners.reshape(-1, 3)

    def is_same(self, other):
        """The mesh has not changed in between."""
        return (self.face_count == other.face_count and np.array_equal(self.corners, other.corners)
                and np.array_equal(self.vertices, other.vertices, equal_nan=True))

    def polygons(self):
        """How many faces have more than three corners."""
        return 0 if self.face is None else int((np.bincount(self.face, minlength=self.face_count) > 1).sum())

    def of_faces(self, columns):
        """Values of faces from {token: values of triangles}, finite everywhere.

        A number of a polygon is the mean over its estimated triangles by area; its class the one with most area;
        its directions those of its largest triangle."""
        estimated = columns["class"] != NOT_ESTIMATED
        if self.face is None:
            return {token: _finite(token, values, estimated) for token, values in columns.items()}
        corners = self.vertices.astype(np.float64)[self.corners]
        area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        area = np.where(estimated & np.isfinite(area), np.maximum(area, np.finfo(float).tiny), 0)
        total = np.bincount(self.face, area, self.face_count)
        # Sorted by area within faces, the last triangle of each is its largest.
        order = np.lexsort((area, self.face))
        largest = order[np.searchsorted(self.face[order], np.arange(self.face_count), "right") - 1]
        found = {}
        for token, values in columns.items():
            if token == "class":
                shares = [np.bincount(self.face, area * (values == code), self.face_count) for code in range(5)]
                found[token] = np.where(total > 0, np.argmax(shares, axis=0), NOT_ESTIMATED)
            elif values.ndim == 2:
                found[token] = np.where((total > 0)[:, None], values[largest], 0)
            else:
                known = estimated & np.isfinite(values)
                weight = np.where(known, area, 0)
                sums = np.bincount(self.face, weight * np.where(known, values, 0), self.face_count)
                weights = np.bincount(self.face, weight, self.face_count)
                found[token] = np.divide(sums, weights, out=np.zeros(self.face_count), where=weights > 0)
        return found


def _finite(token, values, estimated):
    if token == "class":
        return values
    values = np.nan_to_num(values, nan=0.0)
    values[~estimated] = 0
    return values


def columns_of(curvature, tokens):
    """The arrays of an estimate by token; `class` is always there."""
    wanted = [q.token for q in QUANTITIES if q.token in tokens and q.token != "face"]
    columns = {token: np.asarray(getattr(curvature, "face_class" if token == "class" else token)) for token in wanted}
    columns.setdefault("class", np.asarray(curvature.face_class))
    return columns
