# SPDX-License-Identifier: MIT
"""A legend beside the objects: a bar with the colours of the scale and its values, as objects that render."""

import bpy
import numpy as np
from mathutils import Matrix, Vector

from . import material, store
from .quantities import BY_TOKEN, CLASSES

COLLECTION = "Osculate legend"
_CELLS = 64


def remove():
    """Takes the legend out of the file."""
    collection = bpy.data.collections.get(COLLECTION)
    if collection is None:
        return
    for obj in list(collection.objects):
        data = obj.data
        bpy.data.objects.remove(obj)
        if data.users == 0:
            (bpy.data.meshes if isinstance(data, bpy.types.Mesh) else bpy.data.curves).remove(data)
    bpy.data.collections.remove(collection)


def place(context, scale, objects):
    """Puts the legend at the right of the objects, as the scene's camera sees them, or from the front."""
    remove()
    collection = bpy.data.collections.new(COLLECTION)
    context.scene.collection.children.link(collection)
    frame, height = _frame(context.scene.camera, objects)
    bar = bpy.data.objects.new(COLLECTION, _bar(scale, height))
    bar.data.materials.append(material.make(scale, is_lit=False))
    ink = _ink()
    labels = [(y, text, 0.045) for y, text in _labels(scale)]
    unit = {"class": "", "shape_index": "", "coverage": "", "confidence": ""}.get(
        scale.quantity.token, "1/length\N{SUPERSCRIPT TWO}" if "gauss" in scale.quantity.token else "1/length")
    labels.append((1.06, scale.quantity.label + (f", {unit}" if unit else ""), 0.055))
    for y, text, size in labels:
        curve = bpy.data.curves.new(COLLECTION, "FONT")
        curve.body, curve.size, curve.align_y = text, size * height, "CENTER"
        curve.materials.append(ink)
        label = bpy.data.objects.new(COLLECTION, curve)
        label.location = ((0.0 if y > 1 else 0.1) * height, y * height, 0)
        label.parent = bar
        collection.objects.link(label)
    bar.matrix_world = frame
    collection.objects.link(bar)
    for obj in collection.objects:
        obj.hide_select = True


def _bar(scale, height):
    """A strip of faces whose values run from the lowest to the highest."""
    cells = len(CLASSES) - 1 if scale.is_classes else _CELLS
    y = np.linspace(0, height, cells + 1)
    points = np.stack([np.tile((0, 0.07 * height), cells + 1), np.repeat(y, 2), np.zeros(2 * cells + 2)], axis=1)
    first = 2 * np.arange(cells)
    mesh = bpy.data.meshes.new(COLLECTION)
    mesh.from_pydata(points.tolist(), [], np.stack((first, first + 1, first + 3, first + 2), axis=1).tolist())
    middles = scale.low + (np.arange(cells) + 0.5) / cells * (scale.high - scale.low)
    store.put(mesh, scale.quantity.attribute, scale.quantity.type, "FACE",
              np.rint(middles) if scale.is_classes else middles)
    if not scale.is_classes:
        store.put(mesh, BY_TOKEN["class"].attribute, "INT", "FACE", np.zeros(cells))
    return mesh


def _labels(scale):
    if scale.is_classes:
        names = CLASSES[1:]
        return [((code + 0.5) / len(names), name) for code, name in enumerate(names)]
    values = np.linspace(scale.low, scale.high, 5)
    return [(share, f"{value:.4g}") for share, value in zip(np.linspace(0, 1, 5), values)]


def _ink():
    """A material that is dark grey under any light."""
    ink = bpy.data.materials.get("Osculate ink") or bpy.data.materials.new("Osculate ink")
    ink[material.LOOK] = {}
    if ink.node_tree is None:
        ink.use_nodes = True
    ink.diffuse_color = (0.02, 0.02, 0.02, 1)
    ink.node_tree.nodes.clear()
    shader, out = (ink.node_tree.nodes.new(kind) for kind in ("ShaderNodeEmission", "ShaderNodeOutputMaterial"))
    shader.inputs["Color"].default_value = (0.02, 0.02, 0.02, 1)
    ink.node_tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return ink


def _frame(camera, objects):
    """Where the legend stands and its height: x to the right, y up, facing the viewer."""
    turned = camera.matrix_world.to_quaternion() if camera else Matrix(((1, 0, 0), (0, 0, -1), (0, 1, 0))).to_quaternion()
    corners = [obj.matrix_world @ Vector(corner) for obj in objects for corner in obj.bound_box]
    seen = np.array([turned.inverted() @ corner for corner in corners])
    low, high = seen.min(axis=0), seen.max(axis=0)
    height = 0.8 * max(high[1] - low[1], 0.5 * (high[0] - low[0])) or 1.0
    corner = Vector((high[0] + 0.15 * height, (low[1] + high[1] - height) / 2, (low[2] + high[2]) / 2))
    return Matrix.LocRotScale(turned @ corner, turned, None), height
