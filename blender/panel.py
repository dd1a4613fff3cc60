# SPDX-License-Identifier: MIT
"""The tab in the sidebar of the 3D view."""

import bpy

from . import material, settings, wheel
from .quantities import BY_TOKEN


class _Panel:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Osculate"


class OSCULATE_PT_annotate(_Panel, bpy.types.Panel):
    bl_label = "Annotate"

    def draw(self, context):
        layout, group = self.layout, context.scene.osculate
        if not wheel.is_there():
            column = layout.column()
            column.alert = True
            column.label(text="No compiled part for this system", icon="ERROR")
            column.label(text="See Install in docs/blender.md")
            return
        layout.use_property_split = True
        layout.operator_context = "INVOKE_DEFAULT"
        layout.operator("osculate.annotate", icon="PLAY")
        layout.prop(group, "use_modifiers")
        layout.prop(group, "mark_sharp")
        shown = ""
        for fact in settings.facts():
            if fact["group"] != shown:
                shown = fact["group"]
                layout.label(text=shown)
            layout.prop(group, fact["name"])
        row = layout.row()
        row.operator("osculate.reset_settings")
        row.operator("osculate.clear")


class OSCULATE_PT_show(_Panel, bpy.types.Panel):
    bl_label = "Show"

    def draw(self, context):
        layout, group = self.layout, context.scene.osculate
        layout.use_property_split = True
        layout.prop(group, "quantity")
        if group.quantity != "class":
            layout.prop(group, "colormap")
            layout.prop(group, "is_auto_range")
            column = layout.column(align=True)
            column.enabled = not group.is_auto_range
            column.prop(group, "low")
            column.prop(group, "high")
        row = layout.row(align=True)
        row.operator("osculate.show", icon="MATERIAL").way = "MATERIAL"
        row.operator("osculate.show", text="", icon="SHADING_SOLID").way = "COLORS"
        row.operator("osculate.hide")
        _draw_legend(layout, context.active_object)


class OSCULATE_PT_select(_Panel, bpy.types.Panel):
    bl_label = "Select"

    def draw(self, context):
        layout, group = self.layout, context.scene.osculate
        layout.prop(group, "select_by", expand=True)
        if group.select_by == "class":
            layout.column().prop(group, "select_classes")
        else:
            layout.prop(group, "quantity")
            column = layout.column(align=True)
            column.prop(group, "select_low")
            column.prop(group, "select_high")
        layout.operator("osculate.select", icon="RESTRICT_SELECT_OFF")


def _draw_legend(layout, obj):
    """The colours of the active object and what they stand for."""
    shown = material.of(obj) if obj is not None and obj.type == "MESH" else None
    if shown is None or "quantity" not in shown[material.LOOK]:
        return
    look = shown[material.LOOK]
    box = layout.box()
    box.label(text=BY_TOKEN[look["quantity"]].label)
    ramp = shown.node_tree.nodes.get("Colours")
    if ramp is not None:
        box.template_color_ramp(ramp, "color_ramp", expand=False)
    if look["quantity"] != "class":
        low, high = look["range"]
        row = box.row()
        row.label(text=f"{low:.4g}")
        row.label(text=f"{high:.4g}")


PANELS = (OSCULATE_PT_annotate, OSCULATE_PT_show, OSCULATE_PT_select)
register, unregister = bpy.utils.register_classes_factory(PANELS)
