# SPDX-License-Identifier: MIT
"""Puts vertices together again that Osculate took apart to give every face its own.

Vertices that differ in nothing but values and colours of ours become one, before the importer sees them. A
face that Blender would then drop, because it repeats a vertex or another face, keeps the vertices it has."""

import numpy as np

from .equal import first_equal, repeated_triangles
from .gltf_primitive import OWN_ATTRIBUTES, decoded

_UNSIGNED_INT = 5125


def joined_corners(gltf, primitive, own_looks):
    """Corners of the faces over the vertices that are left."""
    rows = [decoded(gltf, number) for number in primitive.surface_attributes(own_looks)]
    corners = first_equal(*rows)[primitive.corners]
    twice, again = repeated_triangles(corners)
    apart = twice | again
    corners[apart] = primitive.corners[apart]
    return corners


class Joined:
    """A primitive as the importer is to see it, until `restore`."""

    def __init__(self, gltf, primitive, corners):
        given = primitive.given
        self.gltf, self.given = gltf, given
        self.before = (given.indices, given.mode, dict(given.attributes))
        self.accessor = self._add(np.ascontiguousarray(corners, np.uint32))
        given.indices, given.mode = self.accessor, 4
        for name in OWN_ATTRIBUTES & set(given.attributes):
            del given.attributes[name]

    def _add(self, corners):
        """Adds an accessor of indices in a buffer of its own."""
        from io_scene_gltf2.io.com.gltf2_io import Accessor, BufferView
        data = self.gltf.data
        self.buffer = max([len(data.buffers or []), *(number + 1 for number in self.gltf.buffers)])
        self.gltf.buffers[self.buffer] = corners.tobytes()
        data.buffer_views.append(BufferView.from_dict({"buffer": self.buffer, "byteLength": corners.nbytes}))
        data.accessors.append(Accessor.from_dict({
            "bufferView": len(data.buffer_views) - 1, "componentType": _UNSIGNED_INT, "count": corners.size,
            "type": "SCALAR"}))
        return len(data.accessors) - 1

    def restore(self):
        """Gives the document back as it was. The last to be added goes first."""
        self.given.indices, self.given.mode, attributes = self.before
        self.given.attributes.clear()
        self.given.attributes.update(attributes)
        del self.gltf.buffers[self.buffer]
        self.gltf.data.buffer_views.pop()
        self.gltf.data.accessors.pop()
