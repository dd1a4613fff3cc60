# SPDX-License-Identifier: MIT
"""The operators that show values as colours, and take the colours off again."""

import bpy
import numpy as np

from . import legend, material, wheel
from .estimate import Refused
from .objects import selected_meshes
from .scale import Scale

COLORS = "osculate_colors"


class OSCULATE_OT_show(bpy.types.Operator):
    """Colour the faces of the selected meshes by a quantity, with a legend"""

    bl_idname = "osculate.show"
    bl_label = "Show"
    bl_options = {"REGISTER", "UNDO"}

    way: bpy.props.EnumProperty(name="As", default="MATERIAL", items=[
        ("MATERIAL", "Material", "In Material Preview and in renders. The object's own materials stay in the mesh"),
        ("COLORS", "Solid view", "As a colour attribute, which the Solid view shows")])
    with_legend: bpy.props.BoolProperty(name="Legend", default=True, description="Put a legend beside the objects")

    def execute(self, context):
        group = context.scene.osculate
        objects = selected_meshes(context)
        try:
            if not objects:
                raise Refused("Select one or more meshes with values, in Object Mode, first.")
            bounds = None if group.is_auto_range else (group.low, group.high)
            scale = Scale(group.quantity, group.colormap, bounds, {obj.data for obj in objects})
        except (Refused, wheel.Missing) as reason:
            self.report({"ERROR"}, str(reason))
            return {"CANCELLED"}
        if self.way == "MATERIAL":
            made = material.make(scale)
            for obj in objects:
                material.put_on(obj, made)
        else:
            for mesh in {obj.data for obj in objects}:
                _put_colors(mesh, scale)
            _show_colors(context)
        if self.with_legend:
            legend.place(context, scale, objects)
        material.purge()
        if not scale.is_classes:
            group.low, group.high = scale.low, scale.high
        self.report({"INFO"}, f"{scale.quantity.label} from {scale.low:.4g} to {scale.high:.4g}.")
        return {"FINISHED"}


class OSCULATE_OT_hide(bpy.types.Operator):
    """Give the selected objects the look they had, and remove the legend"""

    bl_idname = "osculate.hide"
    bl_label = "Hide"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        objects = selected_meshes(context)
        changed = sum(material.take_off(obj) for obj in objects)
        for mesh in {obj.data for obj in objects}:
            colors = mesh.attributes.get(COLORS)
            if colors is not None:
                mesh.attributes.remove(colors)
                changed += 1
        if not any(material.LOOK in obj for obj in bpy.data.objects):
            legend.remove()
        material.purge()
        if not changed:
            self.report({"ERROR"}, "None of the selected objects shows colours of Osculate.")
            return {"CANCELLED"}
        return {"FINISHED"}


def _put_colors(mesh, scale):
    """A colour attribute, active for the viewport."""
    from . import store
    attribute = mesh.attributes.get(COLORS) or mesh.attributes.new(COLORS, "BYTE_COLOR", "CORNER")
    colors = scale.colors(mesh)[store.corner_faces(mesh)]
    rows = np.concatenate((colors, np.ones((len(colors), 1))), axis=1)
    attribute.data.foreach_set("color_srgb", rows.astype(np.float32).reshape(-1))
    mesh.color_attributes.active_color = mesh.color_attributes[COLORS]
    mesh.update()


def _show_colors(context):
    """Has the 3D view, where there is one, show colour attributes in its Solid mode."""
    for area in context.screen.areas if context.screen else []:
        if area.type == "VIEW_3D":
            area.spaces.active.shading.color_type = "VERTEX"


register, unregister = bpy.utils.register_classes_factory((OSCULATE_OT_show, OSCULATE_OT_hide))
