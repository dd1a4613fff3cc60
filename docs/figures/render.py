"""Draws a mesh and glTF lines as a PNG with Blender's Cycles; `render.py --help` lists the options.

Everything is in the axes of the mesh file: lines are to be written with `--up z`, which Blender's
turn from +Y up to Z-up undoes.
"""
import argparse
import csv
import json
import os
import struct
import zlib
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

HEIGHT = 600
# Radius of the tubes in pixels, by the name of the glTF mesh.
TUBE = {"legs": 0.9, "rim": 1.3, "dir_max": 2.6, "dir_min": 2.6, "boundary": 3.0, "feature": 1.5}
# glTF's modes for lines.
LINES, LOOP, STRIP = 1, 2, 3


def arguments():
    vector = lambda text: Vector(float(x) for x in text.split(","))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", type=Path, help="PLY or STL")
    parser.add_argument("lines", type=Path, nargs="*", help="GLB with lines")
    parser.add_argument("-o", "--output", type=Path, required=True)
    parser.add_argument("--view", type=vector, action="append", required=True,
                        help="from the place looked at to the viewer; several: side by side")
    parser.add_argument("--look", type=vector, required=True, help="the place in the picture's middle")
    parser.add_argument("--height", type=float, required=True, help="what the picture shows, in file units")
    parser.add_argument("--skip", action="append", default=[], help="leave out lines of this name")
    parser.add_argument("--trace", type=Path, help="CSV of a trace: mark its centres and their faces' barycentres")
    return parser.parse_args()


def emission(name, rgb):
    """A material of one colour. Lights would make noise, which takes samples and swells a PNG."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (*rgb, 1)
    output = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def surface_material():
    """Light grey, darker where it turns away and on the inside, with the faces' edges. Also the
    node with the direction to the light, which is to follow the viewer."""
    material = emission("surface", (1, 1, 1))
    tree = material.node_tree
    shader = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")
    geometry = tree.nodes.new("ShaderNodeNewGeometry")

    def math(operation, a, b):
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, (a, b)):
            if isinstance(value, float):
                socket.default_value = value
            else:
                tree.links.new(value, socket)
        return node.outputs[0]

    light = tree.nodes.new("ShaderNodeVectorMath")
    light.operation = "DOT_PRODUCT"
    tree.links.new(geometry.outputs["True Normal"], light.inputs[0])
    lit = math("MAXIMUM", light.outputs["Value"], 0.0)
    grey = math("MULTIPLY_ADD", lit, 0.5)
    grey.node.inputs[2].default_value = 0.32
    inside = math("MULTIPLY_ADD", geometry.outputs["Backfacing"], -0.45)
    inside.node.inputs[2].default_value = 1
    grey = math("MULTIPLY", grey, inside)

    # Width in pixels: equally thin however large the picture's part of the mesh is.
    wire = tree.nodes.new("ShaderNodeWireframe")
    wire.use_pixel_size = True
    wire.inputs["Size"].default_value = 1.2
    edges = math("MULTIPLY_ADD", wire.outputs[0], -0.6)
    edges.node.inputs[2].default_value = 1
    tree.links.new(math("MULTIPLY", grey, edges), shader.inputs["Color"])
    return material, light.inputs[1]


def load_mesh(path):
    if path.suffix == ".stl":
        bpy.ops.wm.stl_import(filepath=str(path))
    else:
        bpy.ops.wm.ply_import(filepath=str(path))
    return bpy.context.object


def polylines(path):
    """Name, colour and points of every line. Blender's own importer would drop the colours:
    materials of Blender's meshes are on faces, and lines have none."""
    data = path.read_bytes()
    size, = struct.unpack_from("<I", data, 12)
    gltf = json.loads(data[20:20 + size])
    binary = data[28 + size:]
    for mesh in gltf["meshes"]:
        for primitive in mesh["primitives"]:
            accessor = gltf["accessors"][primitive["attributes"]["POSITION"]]
            view = gltf["bufferViews"][accessor["bufferView"]]
            start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
            points = np.frombuffer(binary, "<f4", 3 * accessor["count"], start).reshape(-1, 3)
            points = points[:, [0, 2, 1]] * (1, -1, 1)
            rgb = gltf["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"][:3]
            mode = primitive["mode"]
            if mode == LINES:
                parts = points.reshape(-1, 2, 3)
            else:
                assert mode in (LOOP, STRIP), f"{path}: mode {mode} is not of lines"
                parts = [points]
            for part in parts:
                yield mesh["name"], tuple(rgb), part, mode == LOOP


def add_tubes(name, rgb, parts, radius):
    curve = bpy.data.curves.new(name, "CURVE")
    curve.dimensions = "3D"
    curve.bevel_depth = radius
    curve.bevel_resolution = 2
    curve.use_fill_caps = True
    for points, closed in parts:
        spline = curve.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.c_[points, np.ones(len(points))].ravel())
        spline.use_cyclic_u = closed
    curve.materials.append(emission(name, rgb))
    obj = bpy.data.objects.new(name, curve)
    bpy.context.collection.objects.link(obj)
    return obj


def add_dot(place, radius, material):
    bpy.ops.mesh.primitive_uv_sphere_add(radius=radius, location=place)
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def write_png(path, pixels):
    """A PNG with a palette: the pictures have few colours, and Blender writes true colour only."""
    # Blender's rows go up, those of a PNG down.
    rgb = np.clip(pixels[::-1, :, :3], 0, 1)
    # 32 steps of each colour are as good to look at and half as large.
    rgb = (np.round(rgb * 31) * 255 / 31).round().astype(np.int32)
    packed = rgb[..., 0] << 16 | rgb[..., 1] << 8 | rgb[..., 2]
    keys, index, count = np.unique(packed, return_inverse=True, return_counts=True)
    colours = np.stack([keys >> 16, keys >> 8 & 255, keys & 255], 1)
    # The most frequent colours stay; of the rest, blends on the lines' borders, each becomes the
    # nearest of those.
    palette = colours[np.argsort(-count, kind="stable")[:256]]
    nearest = np.array([np.argmin(((palette - colour) ** 2).sum(1)) for colour in colours])
    index = nearest[index]
    palette = palette.astype(np.uint8)
    height, width = packed.shape
    rows = np.zeros((height, width + 1), np.uint8)
    rows[:, 1:] = index.reshape(height, width)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    path.write_bytes(
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
        + chunk(b"PLTE", palette.tobytes())
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
        + chunk(b"IEND", b""))


def main():
    args = arguments()
    # Blender reports every step on standard output, errors on standard error.
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    pixel = args.height / HEIGHT

    mesh = load_mesh(args.mesh)
    surface, light = surface_material()
    mesh.data.materials.clear()
    mesh.data.materials.append(surface)

    drawn = {}
    for path in args.lines:
        for name, rgb, points, closed in polylines(path):
            if name not in args.skip:
                drawn.setdefault((name, rgb), []).append((points, closed))
    marks = [add_tubes(name, rgb, parts, TUBE.get(name, 1.5) * pixel)
             for (name, rgb), parts in drawn.items()]
    if args.trace:
        black, white = emission("centre", (0, 0, 0)), emission("barycentre", (1, 1, 1))
        for row in csv.DictReader(args.trace.open()):
            centre = Vector(float(row[axis]) for axis in "xyz")
            marks.append(add_dot(centre, 6 * pixel, black))
            barycentre = mesh.data.polygons[int(row["face"])].center
            # A white dot with a black border, told from the surface by that.
            marks.append(add_dot(barycentre, 6 * pixel, white))
            marks.append(add_dot(barycentre, 8 * pixel, black))
            marks[-1]["behind"] = 8 * pixel

    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    camera.data.type = "ORTHO"
    camera.data.sensor_fit = "VERTICAL"
    camera.data.ortho_scale = args.height
    far = max(mesh.dimensions) * 4
    camera.data.clip_end = 2 * far
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    scene.world = world
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 32
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.max_bounces = 0
    # The default compresses bright colours; these are to come out as they are in the files.
    scene.view_settings.view_transform = "Standard"
    scene.render.dither_intensity = 0
    scene.render.image_settings.file_format = "PNG"
    scene.render.resolution_x = 800 if len(args.view) == 1 else 440
    scene.render.resolution_y = HEIGHT

    panels = []
    for view in args.view:
        view = view.normalized()
        camera.location = args.look + far * view
        camera.rotation_euler = view.to_track_quat("Z", "Y").to_euler()
        right = camera.rotation_euler.to_matrix() @ Vector((1, 0, 0))
        up = view.cross(right)
        light.default_value = (view + 0.35 * up - 0.45 * right).normalized()
        # The rim's chords cut below a curved surface. Without perspective a shift towards the
        # viewer brings them out without moving them in the picture.
        for mark in marks:
            mark["home"] = mark.get("home", mark.location.copy())
            mark.location = Vector(mark["home"]) + (0.02 * args.height - mark.get("behind", 0)) * view
        file = args.output.with_suffix(".panel.png")
        scene.render.filepath = str(file)
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(str(file))
        width, height = image.size
        panels.append(np.array(image.pixels[:], np.float32).reshape(height, width, 4))
        bpy.data.images.remove(image)
        file.unlink()
    gap = np.ones((HEIGHT, 20, 4), np.float32)
    joined = [part for panel in panels for part in (gap, panel)][1:]
    write_png(args.output, np.hstack(joined))


main()
