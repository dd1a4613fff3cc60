# SPDX-License-Identifier: MIT
"""Which objects an operator works on."""


def selected_meshes(context):
    """The selected objects that are meshes and whose attributes can be written, which those of Edit Mode cannot."""
    return [obj for obj in context.selected_objects if obj.type == "MESH" and obj.mode != "EDIT"]
