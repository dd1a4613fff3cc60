# SPDX-License-Identifier: MIT
"""Settings of the estimate, as the scene keeps them.

Names, defaults and help are asked of the package, which has them from the definitions of the command line."""

import bpy

from . import wheel
from .quantities import CLASSES, QUANTITIES

#: Settings of the call that the panel does not offer.
_NOT_OFFERED = {"threads"}


def facts():
    """What is known of the settings of `osculate.annotate`: name, help, default, choices and group of each."""
    if not wheel.is_there():
        return []
    return [fact for name, fact in wheel.setting_facts("annotate").items() if name not in _NOT_OFFERED]


def _property(fact):
    label = fact["name"].replace("_", " ").capitalize()
    given = {"name": label, "description": fact["help"]}
    default = fact["default"]
    if fact["choices"]:
        items = [(choice, choice, "") for choice in fact["choices"]]
        return bpy.props.EnumProperty(items=items, default=default or fact["choices"][0], **given)
    if default is not None and default.lstrip("-").isdigit() and fact["value"] == "N":
        return bpy.props.IntProperty(default=int(default), **given)
    try:
        return bpy.props.FloatProperty(default=float(default), precision=4, **given)
    except (TypeError, ValueError):
        return bpy.props.StringProperty(default=default or "", **given)


def chosen(group):
    """The settings that differ from their defaults, for `osculate.annotate`. A float goes as Blender shows it: it
    is kept in 32 bits, in which 0.1 is 0.10000000149."""
    given = {}
    for fact in facts():
        name = fact["name"]
        if group.is_property_set(name):
            value = getattr(group, name)
            if isinstance(value, float):
                value = float(f"{value:.7g}")
            if value != "":
                given[name] = value
    return given


def feature_angle(group, given):
    """The feature angle of a run with the settings `given`, in degrees."""
    return float(given.get("feature_angle", getattr(group, "feature_angle", 40.0)))


def reset(group):
    """All settings of the estimate back to their defaults."""
    for fact in facts():
        group.property_unset(fact["name"])


_shown = [(quantity.token, quantity.label, f"Attribute {quantity.attribute}") for quantity in QUANTITIES
          if quantity.is_shown]


class OsculateSettings(bpy.types.PropertyGroup):
    """bpy.types.Scene.osculate"""

    use_modifiers: bpy.props.BoolProperty(
        name="With modifiers", default=False,
        description="Estimate the object as its modifiers and shape keys make it. Where they change faces, the result "
                    "is a new object beside it")
    mark_sharp: bpy.props.BoolProperty(
        name="Mark feature edges sharp", default=False,
        description="Mark edges sharp at which the faces meet at more than the feature angle")
    quantity: bpy.props.EnumProperty(name="Quantity", items=_shown, default="mean", description="What colours show")
    colormap: bpy.props.StringProperty(
        name="Colour map", default="",
        description="Empty: blue-red for signed quantities, viridis for others, one colour for each class",
        search=lambda self, context, text: list(wheel.osculate().COLORMAPS) if wheel.is_there() else [])
    is_auto_range: bpy.props.BoolProperty(
        name="Range from the values", default=True,
        description="95th percentile of the magnitudes, on both sides of zero for signed quantities")
    low: bpy.props.FloatProperty(name="Low", default=-1.0, precision=4, description="Value of the first colour")
    high: bpy.props.FloatProperty(name="High", default=1.0, precision=4, description="Value of the last colour")
    select_by: bpy.props.EnumProperty(
        name="Select by", items=[("class", "Class", "Faces of some classes"),
                                 ("range", "Range", "Faces whose value lies in a range")])
    select_classes: bpy.props.EnumProperty(
        name="Classes", options={"ENUM_FLAG"}, default={"hyperbolic"},
        items=[(name, name.capitalize(), f"Class {code - 1}", 1 << code) for code, name in enumerate(CLASSES)])
    select_low: bpy.props.FloatProperty(name="From", default=0.0, precision=4, description="Least value, included")
    select_high: bpy.props.FloatProperty(name="To", default=1.0, precision=4, description="Largest value, included")


def register():
    for fact in facts():
        OsculateSettings.__annotations__[fact["name"]] = _property(fact)
    bpy.utils.register_class(OsculateSettings)
    bpy.types.Scene.osculate = bpy.props.PointerProperty(type=OsculateSettings)


def unregister():
    del bpy.types.Scene.osculate
    bpy.utils.unregister_class(OsculateSettings)
