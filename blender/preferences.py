# SPDX-License-Identifier: MIT
"""What holds for every file: whether imports read values and exports write them."""

import bpy


class OsculatePreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    read_values: bpy.props.BoolProperty(
        name="Read Osculate's values", default=True,
        description="Importing a glTF file that Osculate wrote makes attributes of faces and edges")
    write_values: bpy.props.BoolProperty(
        name="Write Osculate's values", default=True,
        description="Exporting glTF writes the values of faces, whether other attributes are written or not")

    def draw(self, context):
        self.layout.prop(self, "read_values")
        self.layout.prop(self, "write_values")


def get(context=None):
    """The preferences; None while the extension is being enabled."""
    addon = (context or bpy.context).preferences.addons.get(__package__)
    return addon.preferences if addon else None


def draw(context, layout, name):
    """A line of a dialogue of Blender's glTF add-on."""
    found = get(context)
    if found is not None:
        header, body = layout.panel(f"OSCULATE_{name}", default_closed=False)
        header.label(text="Osculate")
        if body:
            body.prop(found, name)


register, unregister = bpy.utils.register_classes_factory((OsculatePreferences,))
