# SPDX-License-Identifier: MIT
"""File > Export > glTF: values of faces go out as Osculate writes them, as numbers on vertices.

Blender's exporter splits vertices where values of faces differ and writes one attribute each. What it does not do
is done here: directions become three numbers in the axes of the file, since attributes of more than one type in a
mesh abort the import in Blender 4.2 to 5.0, and the mesh says that Osculate made the values."""

import traceback

import numpy as np

from . import preferences
from .quantities import QUANTITIES
from .store import MARK

_FLOAT = 5126
_BY_NAME = {quantity.attribute: quantity for quantity in QUANTITIES}


class glTF2ExportUserExtension:
    """Made by Blender's exporter, once for every export."""

    def __init__(self):
        chosen = preferences.get()
        self.is_wanted = chosen is None or chosen.write_values
        #: What the user chose for attributes of others.
        self.others = True
        self.split = {}

    def vtree_before_filter_hook(self, tree, export_settings):
        self.others = export_settings.get("gltf_attributes", False)
        if self.is_wanted:
            export_settings["gltf_attributes"] = True

    def gather_attribute_keep(self, attribute, export_settings):
        ours = attribute.attr_name in _BY_NAME
        if not self.others and not (self.is_wanted and ours):
            attribute.keep = False

    def gather_mesh_hook(self, gltf_mesh, mesh, *rest):
        export_settings = rest[-1]
        if not self.is_wanted:
            return
        try:
            self._write(gltf_mesh, mesh, export_settings)
        except Exception as error:
            traceback.print_exc()
            export_settings["log"].warning(
                f"Osculate: mesh \"{gltf_mesh.name}\" was exported without marking its values: {error}")

    def _write(self, gltf_mesh, mesh, export_settings):
        names = {name for primitive in gltf_mesh.primitives for name in primitive.attributes or {}} & set(_BY_NAME)
        if not names:
            return
        for primitive in gltf_mesh.primitives:
            for name in names & set(primitive.attributes or {}):
                if _BY_NAME[name].type == "FLOAT_VECTOR":
                    accessor = primitive.attributes.pop(name)
                    numbers = self._numbers(accessor, export_settings)
                    primitive.attributes.update(zip(_BY_NAME[name].gltf_attributes, numbers))
        extras = dict(gltf_mesh.extras or {})
        extras[MARK] = _plain(mesh.get(MARK)) or {"schema": 1}
        gltf_mesh.extras = extras

    def _numbers(self, accessor, export_settings):
        """Three accessors of numbers for one of vectors; the same three where primitives share it."""
        if id(accessor) not in self.split:
            x, y, z = np.frombuffer(accessor.buffer_view.data, np.float32).reshape(-1, 3).T
            turned = (x, z, -y) if export_settings["gltf_yup"] else (x, y, z)
            # The accessor is kept so that its id stays its own.
            self.split[id(accessor)] = accessor, [self._accessor(accessor, column) for column in turned]
        return self.split[id(accessor)][1]

    @staticmethod
    def _accessor(like, column):
        view = type(like.buffer_view)(np.ascontiguousarray(column, np.float32).tobytes(),
                                      like.buffer_view.bufferViewTarget)
        return type(like)(
            buffer_view=view, byte_offset=None, component_type=_FLOAT, count=len(column), extensions=None, extras=None,
            max=None, min=None, name=None, normalized=None, sparse=None, type="SCALAR")


def _plain(value):
    """Custom properties as JSON has them."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value if isinstance(value, dict) else None
