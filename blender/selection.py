# SPDX-License-Identifier: MIT
"""The operator that selects faces by their values."""

import bpy
import numpy as np

from . import store
from .quantities import BY_TOKEN, CLASSES, NOT_ESTIMATED


class OSCULATE_OT_select(bpy.types.Operator):
    """Select the faces of the active mesh that are of some classes, or whose value lies in a range"""

    bl_idname = "osculate.select"
    bl_label = "Select Faces"
    bl_options = {"REGISTER", "UNDO"}

    extend: bpy.props.BoolProperty(name="Extend", default=False, description="Keep what is selected")

    def execute(self, context):
        obj, group = context.active_object, context.scene.osculate
        if obj is None or obj.type != "MESH":
            self.report({"ERROR"}, "Make a mesh with values the active object first.")
            return {"CANCELLED"}
        was_editing = obj.mode == "EDIT"
        if was_editing:
            bpy.ops.object.mode_set(mode="OBJECT")
        try:
            return self._select(context, obj.data, group)
        finally:
            if was_editing:
                bpy.ops.object.mode_set(mode="EDIT")

    def _select(self, context, mesh, group):
        quantity = BY_TOKEN["class" if group.select_by == "class" else group.quantity]
        values, classes = store.get(mesh, quantity.attribute), store.get(mesh, BY_TOKEN["class"].attribute)
        if values is None or mesh.attributes[quantity.attribute].domain != "FACE":
            self.report({"ERROR"}, f"\"{mesh.name}\" has no {quantity.label.lower()} on its faces; annotate it first.")
            return {"CANCELLED"}
        if group.select_by == "class":
            wanted = np.isin(values, [code - 1 for code, name in enumerate(CLASSES) if name in group.select_classes])
        else:
            if not group.select_low <= group.select_high:
                self.report({"ERROR"}, "The range to select is reversed; give the lower value first.")
                return {"CANCELLED"}
            wanted = (values >= np.float32(group.select_low)) & (values <= np.float32(group.select_high))
            if classes is not None:
                wanted &= classes != NOT_ESTIMATED
        select_faces(mesh, wanted, self.extend)
        context.tool_settings.mesh_select_mode = (False, False, True)
        self.report({"INFO"}, f"{int(wanted.sum())} of {len(wanted)} faces.")
        return {"FINISHED"}


def select_faces(mesh, wanted, extend=False):
    """Selects faces, with their edges and vertices, that are not hidden."""
    hidden = np.zeros(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("hide", hidden)
    wanted = wanted & ~hidden
    if extend:
        before = np.zeros(len(wanted), bool)
        mesh.polygons.foreach_get("select", before)
        wanted |= before
    corners = wanted[store.corner_faces(mesh)]
    for elements, numbers in ((mesh.vertices, store.corner_vertices(mesh)), (mesh.edges, store.corner_edges(mesh))):
        chosen = np.zeros(len(elements), bool)
        chosen[numbers[corners]] = True
        elements.foreach_set("select", chosen)
    mesh.polygons.foreach_set("select", wanted)
    mesh.update()


register, unregister = bpy.utils.register_classes_factory((OSCULATE_OT_select,))
