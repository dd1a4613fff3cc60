# SPDX-License-Identifier: MIT
"""File > Import > glTF: values that Osculate wrote become attributes of faces and edges.

Blender's importer calls the hooks for every mesh. What they cannot do they say and leave alone: the import
itself goes on as if the extension were not there."""

import traceback

import numpy as np

from . import edges, preferences, store
from .gltf_join import Joined, joined_corners
from .gltf_primitive import Primitive, mark_of
from .gltf_survivors import Lost, survivors
from .quantities import QUANTITIES

_DEFAULT_FEATURE_ANGLE = 40.0


class glTF2ImportUserExtension:
    """Made by Blender's importer, once for every import."""

    def __init__(self):
        self.reading = {}

    def gather_import_mesh_before_hook(self, gltf_mesh, gltf):
        self._guarded(gltf, gltf_mesh, self._before)

    def gather_import_mesh_after_hook(self, gltf_mesh, mesh, gltf):
        reading = self.reading.pop(id(gltf_mesh), None)
        if reading is None:
            return
        reading.restore()
        self._guarded(gltf, gltf_mesh, lambda *_: reading.write(mesh))

    def _before(self, gltf, gltf_mesh):
        mark = mark_of(gltf_mesh)
        chosen = preferences.get()
        if mark is None or (chosen is not None and not chosen.read_values):
            return
        reading = Reading(gltf, gltf_mesh, mark)
        try:
            reading.prepare()
        except Exception:
            reading.restore()
            raise
        self.reading[id(gltf_mesh)] = reading

    def _guarded(self, gltf, gltf_mesh, step):
        name = gltf_mesh.name or "unnamed"
        try:
            step(gltf, gltf_mesh)
        except Lost:
            gltf.log.warning(
                f"Osculate: mesh \"{name}\": merging left out faces, and it cannot be told which; it has no values of "
                "faces. Import it without Merge Vertices.", popup=True)
        except Exception as error:
            traceback.print_exc()
            gltf.log.warning(
                f"Osculate: mesh \"{name}\" was imported without values of faces, which cannot be read: {error}",
                popup=True)


class Reading:
    """One mesh on its way into Blender."""

    def __init__(self, gltf, gltf_mesh, mark):
        self.gltf, self.mark = gltf, mark
        self.primitives = [Primitive(gltf, primitive) for primitive in gltf_mesh.primitives]
        self.joined = []
        self.looks = {}

    def prepare(self):
        """Takes out of the importer's sight what it would put on vertices."""
        for primitive in self.primitives:
            primitive.shown = primitive.corners
            if primitive.edges is None and primitive.values:
                looks = primitive.own_looks(self.gltf)
                primitive.shown = joined_corners(self.gltf, primitive, looks)
                self.joined.append(Joined(self.gltf, primitive, primitive.shown))
                for name in looks:
                    self.looks.setdefault(name, []).append(primitive)

    def restore(self):
        while self.joined:
            self.joined.pop().restore()

    def write(self, mesh):
        """Puts the values on the mesh that the importer made."""
        if not any(primitive.values for primitive in self.primitives):
            return
        kept = survivors(self.gltf, mesh, self.primitives)
        dropped = sum(primitive.face_count for primitive in self.primitives) - len(kept)
        for quantity in QUANTITIES:
            if any(primitive.quantity(quantity) is not None for primitive in self.primitives):
                rows = _joined([primitive.rows(quantity) for primitive in self.primitives if primitive.face_count])
                store.put(mesh, quantity.attribute, quantity.type, "FACE", rows[kept] if dropped else rows)
        for name in self.looks:
            self._write_look(mesh, name, kept)
        self._write_edges(mesh, kept)
        if store.MARK not in mesh:
            mesh[store.MARK] = self.mark
        if dropped:
            self.gltf.log.warning(
                f"Osculate: mesh \"{mesh.name}\": Blender left out {dropped} faces that repeat a vertex or another "
                "face; _FACE_ID says which are left", popup=True)

    def _write_look(self, mesh, name, kept):
        """The importer gave faces the colours of faces that share their vertices; each gets its own."""
        kind, number = name.rsplit("_", 1)
        if kind == "COLOR":
            layers, field, width = mesh.color_attributes, "color", 4
        else:
            layers, field, width = mesh.uv_layers, "vector", 2
        if int(number) >= len(layers):
            return
        layer = layers[int(number)]
        data = layer.data if kind == "COLOR" else layer.uv
        if len(data) != len(mesh.loops):
            return
        corners = np.empty(len(mesh.loops) * width, np.float32)
        data.foreach_get(field, corners)
        corners = corners.reshape(-1, 3 * width)
        own, ranges = self.looks[name], self._ranges()
        for primitive in own:
            first = ranges[id(primitive)]
            ours = (kept >= first) & (kept < first + primitive.face_count)
            rows = self._look_rows(primitive, name)[primitive.corners[kept[ours] - first]]
            corners[ours] = rows.reshape(-1, 3 * width)
        data.foreach_set(field, corners.reshape(-1))

    def _look_rows(self, primitive, name):
        from .gltf_primitive import decoded
        rows = decoded(self.gltf, primitive.given.attributes[name]).astype(np.float32)
        if name.startswith("COLOR"):
            return rows if rows.shape[1] == 4 else np.pad(rows, ((0, 0), (0, 1)), constant_values=1)
        rows[:, 1] = 1 - rows[:, 1]
        return rows

    def _ranges(self):
        """The first face of each primitive."""
        first, ranges = 0, {}
        for primitive in self.primitives:
            ranges[id(primitive)] = first
            first += primitive.face_count
        return ranges

    def _write_edges(self, mesh, kept):
        settings = self.mark.get("settings")
        angle = settings.get("feature_angle") if isinstance(settings, dict) else None
        angle = angle if isinstance(angle, (int, float)) else _DEFAULT_FEATURE_ANGLE
        known = None
        if any(primitive.edges is not None for primitive in self.primitives):
            known = np.zeros(len(mesh.edges), np.int32)
            if any(primitive.edges for primitive in self.primitives):
                sides = _joined([primitive.edge_kinds() for primitive in self.primitives if primitive.face_count])
                sides = sides.reshape(-1, 3)[kept].reshape(-1)
                np.maximum.at(known, store.corner_edges(mesh)[sides > 0], sides[sides > 0])
        kinds = edges.write(mesh, angle, known)
        edges.mark_sharp(mesh, kinds)


def _joined(parts):
    """One array of all; most meshes have one primitive, whose array it is."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts)
