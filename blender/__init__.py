# SPDX-License-Identifier: MIT
"""Osculate for Blender: the curvature of every face as attributes.

`gltf_*` read and write files; `annotate` and `estimate` make values, `show` and `selection` use them; `store` moves
arrays between Blender and NumPy; `wheel` is the compiled part."""

from . import annotate, panel, preferences, selection, settings, show
# Looked up by Blender's importer and exporter.
from .gltf_export import glTF2ExportUserExtension  # noqa: F401
from .gltf_import import glTF2ImportUserExtension  # noqa: F401

_PARTS = (preferences, settings, annotate, show, selection, panel)


def register():
    for part in _PARTS:
        part.register()


def unregister():
    for part in reversed(_PARTS):
        part.unregister()


def draw_import(context, layout):
    """In the dialogue of File > Import > glTF."""
    preferences.draw(context, layout, "read_values")


def draw_export(context, layout):
    """In the dialogue of File > Export > glTF."""
    preferences.draw(context, layout, "write_values")
