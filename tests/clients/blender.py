"""Reads every file in Blender: values and order of faces, colours of every variant, and the shape of
scenes over time. usage: python blender.py FOLDER"""
import contextlib
import io
import os

import bpy

from results import COLUMNS, colors_of, columns, equal, manifest, refused, say

CLIENT = f"Blender {bpy.app.version_string.split()[0]}"
FOLDER, FILES = manifest()


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon = bpy.context.preferences.addons.get("io_scene_gltf2")
    addon.preferences.KHR_materials_variants_ui = True
    # The importer talks on standard output, which is for results.
    sink, kept = os.open(os.devnull, os.O_WRONLY), os.dup(1)
    os.dup2(sink, 1)
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            if path.suffix == ".ply":
                bpy.ops.wm.ply_import(filepath=str(path))
            else:
                bpy.ops.import_scene.gltf(filepath=str(path))
    finally:
        os.dup2(kept, 1)


def meshes():
    """Every mesh once, by the number of its first face."""
    found = {obj.data for obj in bpy.data.objects if obj.type == "MESH" and "_FACE_ID" in obj.data.attributes}
    first = lambda mesh: mesh.attributes["_FACE_ID"].data[mesh.loops[0].vertex_index].value
    return sorted(found, key=first)


def values(mesh, name):
    data = mesh.attributes[name].data
    return [[data[v].value for v in polygon.vertices] for polygon in mesh.polygons]


def texel(image, pixels, u, v):
    width, height = image.size
    at = 4 * (min(int(v * height), height - 1) * width + min(int(u * width), width - 1))
    return tuple(round(255 * c) for c in pixels[at:at + 3])


def colors(mesh, materials):
    """The colour of each face by the material's image, wired as the importer did."""
    found, cache = [], {}
    for polygon in mesh.polygons:
        material = materials[polygon.material_index]
        if material.name not in cache:
            node = next(n for n in material.node_tree.nodes if n.type == "TEX_IMAGE")
            assert node.interpolation == "Closest"
            link = node.inputs["Vector"].links
            layer = link[0].from_node.uv_map if link else ""
            cache[material.name] = (node.image, list(node.image.pixels), mesh.uv_layers[layer or 0])
        image, pixels, layer = cache[material.name]
        found.append(texel(image, pixels, *layer.data[polygon.loop_start].uv))
    return found


def check_values(file):
    expected = columns(FOLDER / file["csv"])
    all_meshes = meshes()
    faces = [corners for mesh in all_meshes for corners in values(mesh, "_FACE_ID")]
    in_order = [corners[0] for corners in faces] == list(range(len(expected["face"])))
    say(CLIENT, file["file"], "order of faces", "right" if in_order else "wrong")
    for name, column in COLUMNS.items():
        found = [corners for mesh in all_meshes for corners in values(mesh, name)]
        if any(len(set(corners)) > 1 for corners in found) or not equal([c[0] for c in found], expected[column]):
            say(CLIENT, file["file"], "values", "wrong", name)
            return
    say(CLIENT, file["file"], "values", "right")


def check_colors(file):
    scene = bpy.context.scene
    names = [variant.name for variant in scene.gltf2_KHR_materials_variants_variants]
    for shown in file["shown"]:
        if shown in names:
            scene.gltf2_active_variant = names.index(shown)
            bpy.ops.scene.gltf2_display_variant()
        elif len(file["shown"]) > 1 or file["scene"]:
            say(CLIENT, file["file"], "colours", "wrong", f"no variant {shown}")
            return
        found = []
        for mesh in meshes():
            obj = next(obj for obj in bpy.data.objects if obj.data == mesh)
            found += colors(mesh, [slot.material for slot in obj.material_slots])
        if found != colors_of(FOLDER / file["colors"][shown]):
            say(CLIENT, file["file"], "colours", "wrong", shown)
            return
    check = "colours, switched" if len(file["shown"]) > 1 else "colours"
    say(CLIENT, file["file"], check, "right")


def check_vertex_colors(file):
    """Kept in 8 bits of linear light, so that dark colours lose steps."""
    worst = 0
    expected = iter(colors_of(FOLDER / file["colors"][file["shown"][0]]))
    for mesh in meshes():
        layer = mesh.color_attributes[0].data
        for polygon in mesh.polygons:
            srgb = layer[polygon.loop_start].color_srgb
            worst = max(worst, *(abs(255 * a - b) for a, b in zip(srgb, next(expected))))
    say(CLIENT, file["file"], "colours", "right" if worst <= 8 else "wrong", f"within {worst:.0f} of 255")


def shape():
    """Positions of the corners of every face of every object at five times."""
    scene, found = bpy.context.scene, []
    for frame in (1, 5, 10, 17, 24):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for obj in sorted((o for o in bpy.data.objects if o.type == "MESH"), key=lambda o: o.name):
            evaluated = obj.evaluated_get(graph)
            mesh = evaluated.to_mesh()
            world = [evaluated.matrix_world @ v.co for v in mesh.vertices]
            found += [world[v] for polygon in mesh.polygons for v in polygon.vertices]
    return found


def inventory():
    return {kind: sorted(item.name for item in getattr(bpy.data, kind))
            for kind in ("objects", "cameras", "lights", "armatures", "actions", "shape_keys")}


def check_scene(file):
    before, had = shape(), inventory()
    load(FOLDER / file["input"])
    original, own = shape(), inventory()
    far = max((a - b).length for a, b in zip(before, original)) if len(before) == len(original) else float("inf")
    say(CLIENT, file["file"], "shape at five times", "right" if far <= 1e-6 else "wrong", f"{far:.1e}")
    say(CLIENT, file["file"], "cameras, lights, bones, actions", "right" if had == own else "wrong")


for file in FILES:
    try:
        load(FOLDER / file["file"])
        if file["layout"] == "indexed":
            carries = any(len(mesh.attributes) and "_FACE_ID" in mesh.attributes for mesh in bpy.data.meshes)
            # The importer makes a mesh of its own for the look of bones.
            shapes = {bone.custom_shape for o in bpy.data.objects if o.pose for bone in o.pose.bones}
            own = {o.data for o in bpy.data.objects if o.type == "MESH" and o not in shapes}
            lost = len(columns(FOLDER / file["csv"])["face"]) - sum(len(mesh.polygons) for mesh in own)
            say(CLIENT, file["file"], "faces", "wrong" if lost and "degenerate" not in file["file"] else
                "absent" if lost else "right", f"{lost} with a repeated vertex are dropped" if lost else "")
            say(CLIENT, file["file"], "values", "right" if carries else "absent")
        elif file["file"].endswith(".ply"):
            say(CLIENT, file["file"], "values", "absent")
            continue
        else:
            check_values(file)
            if file["carrier"] == "vertex-srgb":
                say(CLIENT, file["file"], "colours", "absent", "too bright: made for MeshLab")
            elif file["carrier"] == "vertex":
                check_vertex_colors(file)
            else:
                check_colors(file)
        if file["scene"]:
            check_scene(file)
    except Exception as error:  # the importer's and ours alike
        refused(CLIENT, file) or say(CLIENT, file["file"], "values", "wrong", f"{type(error).__name__}: {error}")
