# SPDX-License-Identifier: MIT
"""A material that colours faces by one of their attributes, and how objects put it on and off."""

import json

import bpy

from .quantities import BY_TOKEN

#: Custom property of materials and objects that are ours.
LOOK = "osculate_look"


def make(scale, is_lit=True):
    """attribute -> range -> ramp -> surface, with a colour of its own for faces without estimate."""
    name = f"Osculate {scale.quantity.token}" + ("" if is_lit else " legend")
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    material[LOOK] = {"quantity": scale.quantity.token, "colormap": scale.colormap, "range": [scale.low, scale.high]}
    tree = material.node_tree
    tree.nodes.clear()

    def node(kind, column, row=0, **values):
        made = tree.nodes.new(kind)
        made.location = (220 * column, -260 * row)
        for key, value in values.items():
            setattr(made, key, value)
        return made

    value = node("ShaderNodeAttribute", 0, attribute_name=scale.quantity.attribute, label=scale.quantity.label)
    spread = node("ShaderNodeMapRange", 1, label="Range", clamp=True)
    spread.inputs["From Min"].default_value, spread.inputs["From Max"].default_value = scale.low, scale.high
    ramp = node("ShaderNodeValToRGB", 2, name="Colours", label=scale.colormap)
    fill(ramp.color_ramp, scale)
    classes = node("ShaderNodeAttribute", 0, 1, attribute_name=BY_TOKEN["class"].attribute, label="Class")
    without = node("ShaderNodeMath", 1, 1, operation="LESS_THAN", label="Not estimated")
    without.inputs[1].default_value = -0.5
    mix = node("ShaderNodeMix", 3, data_type="RGBA")
    factor, a, b = mix.inputs[0], mix.inputs[6], mix.inputs[7]
    b.default_value = (*scale.none, 1)
    shader = node("ShaderNodeBsdfPrincipled" if is_lit else "ShaderNodeEmission", 4)
    out = node("ShaderNodeOutputMaterial", 5)
    if is_lit:
        shader.inputs["Roughness"].default_value = 0.8
    link = tree.links.new
    link(value.outputs["Fac"], spread.inputs["Value"])
    link(spread.outputs["Result"], ramp.inputs["Fac"])
    link(ramp.outputs["Color"], a)
    link(classes.outputs["Fac"], without.inputs[0])
    link(without.outputs[0], factor)
    link(mix.outputs[2], shader.inputs["Base Color" if is_lit else "Color"])
    link(shader.outputs[0], out.inputs["Surface"])
    return material


def fill(ramp, scale):
    """Gives a ramp the colours of a scale."""
    ramp.interpolation = "CONSTANT" if scale.is_classes else "LINEAR"
    places, colors = scale.stops()
    while len(ramp.elements) > 1:
        ramp.elements.remove(ramp.elements[-1])
    for number, (place, color) in enumerate(zip(places, colors)):
        element = ramp.elements[0] if number == 0 else ramp.elements.new(float(place))
        element.position = float(place)
        element.color = (*color, 1)


def put_on(obj, material):
    """Shows `material` on all slots of an object. What the mesh has stays in the mesh."""
    if LOOK not in obj:
        is_bare = not obj.material_slots
        if is_bare:
            obj.data.materials.append(None)
        slots = [[slot.link, slot.material.name if slot.link == "OBJECT" and slot.material else None]
                 for slot in obj.material_slots]
        obj[LOOK] = json.dumps({"slots": slots, "is_bare": is_bare})
    for slot in obj.material_slots:
        slot.link = "OBJECT"
        slot.material = material


def take_off(obj):
    """Gives an object the materials it had. True if ours were on it."""
    if LOOK not in obj:
        return False
    before = json.loads(obj[LOOK])
    del obj[LOOK]
    for number, slot in enumerate(obj.material_slots):
        link, name = before["slots"][number] if number < len(before["slots"]) else ("DATA", None)
        slot.link = "OBJECT"
        slot.material = bpy.data.materials.get(name) if name else None
        slot.link = link
    users = [other for other in bpy.data.objects if other.data == obj.data and LOOK in other]
    if before["is_bare"] and not users and not any(obj.data.materials):
        obj.data.materials.clear()
    return True


def purge():
    """Removes materials of ours that nothing shows any more."""
    for material in [m for m in bpy.data.materials if LOOK in m and m.users == 0]:
        bpy.data.materials.remove(material)


def of(obj):
    """The material of ours that an object shows; None where it shows none."""
    shown = [slot.material for slot in obj.material_slots if slot.material and LOOK in slot.material]
    return shown[0] if shown else None
