"""Colours, legend, selection, and what goes out again."""

import json
import os
import struct
import unittest
from pathlib import Path

from harness import (FIXTURES, FOLDER, MODULE, Fresh, annotated, call, load, main, obj_of, only, osculate, points,
                     quiet, select, settings, table, values)

import bpy
import numpy as np

#: Where pictures go to be looked at; nowhere if not set.
PICTURES = os.environ.get("OSCULATE_PICTURES")
DEFAULT = ("k_max", "k_min", "mean", "gauss", "dir_max", "coverage", "confidence")


class OnSuzanne(Fresh):
    def suzanne(self):
        path = annotated(FIXTURES / "suzanne.stl", "plain.glb", "--layout", "indexed", "--attributes", "all")
        mesh = only(load(path)[0])
        select(obj_of(mesh))
        return mesh


class Show(OnSuzanne):
    def test_the_range_is_that_of_the_program(self):
        mesh = self.suzanne()
        for token in ("mean", "gauss", "k_max", "k_min", "curvedness", "shape_index"):
            with self.subTest(token):
                settings().quantity = token
                result, said = call(bpy.ops.osculate.show)
                self.assertEqual(result, {"FINISHED"}, said)
                stats = FOLDER / "range.json"
                osculate("annotate", FIXTURES / "suzanne.stl", "-o", FOLDER / "range.glb", "--color-by", token, "--stats",
                         stats, "-q")
                wanted = json.loads(stats.read_text())["legend"]["range"]
                look = obj_of(mesh).material_slots[0].material["osculate_look"]
                np.testing.assert_allclose(list(look["range"]), wanted, rtol=1e-6)

    def test_every_face_has_the_colour_it_has_in_the_program(self):
        for token in ("mean", "curvedness", "class"):
            with self.subTest(token):
                mesh = self.suzanne()
                settings().quantity = token
                self.assertEqual(call(bpy.ops.osculate.show, way="COLORS", with_legend=False)[0], {"FINISHED"})
                ply = FOLDER / f"colors-{token}.ply"
                osculate("annotate", FIXTURES / "suzanne.stl", "-o", ply, "--color-by", token, "-q")
                layer = mesh.color_attributes["osculate_colors"]
                found = np.empty(4 * len(mesh.loops), np.float32)
                layer.data.foreach_get("color_srgb", found)
                found = np.rint(255 * found.reshape(-1, 3, 4)[:, :, :3]).astype(int)
                wanted = face_colors(ply)
                self.assertTrue((found == wanted[:, None]).all(axis=(1, 2)).mean() > 0.999)
                self.assertLessEqual(np.abs(found - wanted[:, None]).max(), 2)

    def test_the_ramp_has_the_colours_of_the_map(self):
        import osculate as package
        mesh = self.suzanne()
        for name in package.COLORMAPS:
            settings().colormap = name
            call(bpy.ops.osculate.show)
            ramp = obj_of(mesh).material_slots[0].material.node_tree.nodes["Colours"].color_ramp
            palette = package.palette(name) / 255
            worst = 0
            for index in range(255):
                linear = np.array(ramp.evaluate(index / 254))[:3]
                srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)
                worst = max(worst, np.abs(srgb - palette[index]).max())
            # Between its 31 stops a ramp runs straight in linear light.
            self.assertLess(worst, 0.05 if name == "turbo" else 0.02, name)

    def test_a_range_and_a_map_of_ones_own(self):
        mesh = self.suzanne()
        group = settings()
        group.colormap, group.is_auto_range, group.low, group.high = "magma", False, -0.5, 2
        call(bpy.ops.osculate.show)
        look = obj_of(mesh).material_slots[0].material["osculate_look"]
        self.assertEqual((look["colormap"], list(look["range"])), ("magma", [-0.5, 2]))
        for low, high, sentence in ((1, 1, "is empty or reversed"), (2, 1, "is empty or reversed")):
            group.low, group.high = low, high
            result, said = call(bpy.ops.osculate.show)
            self.assertEqual(result, {"CANCELLED"})
            self.assertIn(sentence, said)
        group.is_auto_range, group.colormap = True, "rainbow"
        self.assertIn("unknown colour map \"rainbow\"", call(bpy.ops.osculate.show)[1])

    def test_own_materials_come_back(self):
        mesh = self.suzanne()
        obj = obj_of(mesh)
        mesh.materials.clear()
        own, linked = bpy.data.materials.new("own"), bpy.data.materials.new("linked to the object")
        mesh.materials.append(own)
        mesh.materials.append(None)
        obj.material_slots[1].link = "OBJECT"
        obj.material_slots[1].material = linked
        count = len(bpy.data.materials)
        for _ in range(2):
            self.assertEqual(call(bpy.ops.osculate.show)[0], {"FINISHED"})
        self.assertTrue(all("osculate_look" in slot.material for slot in obj.material_slots))
        self.assertEqual(list(mesh.materials), [own, None], "the mesh keeps its own")
        self.assertEqual(call(bpy.ops.osculate.hide)[0], {"FINISHED"})
        self.assertEqual([(slot.link, slot.material) for slot in obj.material_slots], [("DATA", own), ("OBJECT", linked)])
        self.assertEqual(len(bpy.data.materials), count, "nothing of ours is left")
        self.assertNotIn("Osculate legend", bpy.data.collections)
        self.assertIn("shows colours of Osculate", call(bpy.ops.osculate.hide)[1])

    def test_an_object_without_materials_has_none_afterwards(self):
        mesh = self.suzanne()
        mesh.materials.clear()
        call(bpy.ops.osculate.show)
        call(bpy.ops.osculate.hide)
        self.assertEqual(len(mesh.materials), 0)

    def test_the_legend_says_the_range(self):
        self.suzanne()
        settings().quantity = "gauss"
        call(bpy.ops.osculate.show)
        texts = [obj.data.body for obj in bpy.data.collections["Osculate legend"].objects if obj.type == "FONT"]
        self.assertIn("Gaussian curvature, 1/length\N{SUPERSCRIPT TWO}", texts)
        low, high = settings().low, settings().high
        self.assertTrue({f"{low:.4g}", f"{high:.4g}", "0"} <= set(texts), texts)
        settings().quantity = "class"
        call(bpy.ops.osculate.show)
        texts = {obj.data.body for obj in bpy.data.collections["Osculate legend"].objects if obj.type == "FONT"}
        self.assertEqual(texts, {"Class", "flat", "parabolic", "elliptic", "umbilic", "hyperbolic"})

    def test_a_mesh_without_values_is_refused(self):
        bpy.ops.mesh.primitive_cube_add()
        result, said = call(bpy.ops.osculate.show)
        self.assertEqual(result, {"CANCELLED"})
        self.assertIn("has no mean curvature on its faces; annotate it first", said)
        self.assertFalse([m for m in bpy.data.materials if "osculate_look" in m])
        select()
        self.assertIn("Select one or more meshes", call(bpy.ops.osculate.show)[1])

    def test_a_render_shows_the_colours(self):
        """A plane of three faces with known values, seen from above, pixel by pixel."""
        mesh = bpy.data.meshes.new("strip")
        mesh.from_pydata([(x, y, 0) for x in range(5) for y in range(2)], [], [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1)
                                                                             for i in range(4)])
        obj = bpy.data.objects.new("strip", mesh)
        bpy.context.collection.objects.link(obj)
        for name, kind, rows in (("_CURVATURE_MEAN", "FLOAT", [-1, 0, 1, 0]), ("_CURVATURE_CLASS", "INT", [4, 0, 2, -1])):
            mesh.attributes.new(name, kind, "FACE").data.foreach_set("value", rows)
        bpy.context.view_layer.objects.active = obj
        obj.select_set(True)
        group = settings()
        group.is_auto_range, group.low, group.high = False, -1, 1
        self.assertEqual(call(bpy.ops.osculate.show)[0], {"FINISHED"})
        # Lit, a colour would depend on the light; the legend's material shines by itself.
        shining = bpy.data.collections["Osculate legend"].objects["Osculate legend"].data.materials[0]
        obj.material_slots[0].material = shining
        camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        camera.data.type, camera.data.ortho_scale, camera.location = "ORTHO", 4, (2, 0.5, 5)
        bpy.context.collection.objects.link(camera)
        pixels = render(camera, FOLDER / "strip.png", 80, 20)
        import osculate as package
        palette = package.palette("blue-red")
        for column, index in ((10, 0), (30, 127), (50, 254), (70, 255)):
            self.assertLessEqual(np.abs(pixels[10, column] - palette[index].astype(int)).max(), 2, (column, index))

    @unittest.skipUnless(PICTURES, "a picture for people")
    def test_a_picture(self):
        from mathutils import Vector
        folder = Path(PICTURES)
        folder.mkdir(exist_ok=True)
        for token in ("mean", "class"):
            self.suzanne()
            settings().quantity = token
            light = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
            light.data.energy, light.rotation_euler = 1.2, (0.9, 0.1, 0.6)
            camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
            camera.data.type, camera.data.ortho_scale = "ORTHO", 4.6
            camera.rotation_euler = (1.35, 0, 0.35)
            bpy.context.collection.objects.link(light)
            bpy.context.collection.objects.link(camera)
            bpy.context.scene.camera = camera
            bpy.context.view_layer.update()
            camera.location = camera.matrix_world.to_quaternion() @ Vector((0.75, 0, 10))
            bpy.context.view_layer.update()
            call(bpy.ops.osculate.show)
            render(camera, folder / f"blender-{bpy.app.version_string[:3]}-{token}.png", 960, 640, 32)


def render(camera, path, width, height, samples=1):
    """What a camera sees, rows from below, 8 bits."""
    scene = bpy.context.scene
    scene.camera = camera
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", samples, "CPU"
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.filter_size = 0.01 if samples == 1 else 1.5
    scene.world = scene.world or bpy.data.worlds.new("world")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    background = scene.world.node_tree.nodes.get("Background")
    if background:
        background.inputs[0].default_value = (0.9, 0.9, 0.9, 1)
    scene.render.filepath = str(path)
    with quiet():
        bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(4 * width * height, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return np.rint(255 * pixels.reshape(height, width, 4)[:, :, :3]).astype(int)


class Select(OnSuzanne):
    def selected(self, mesh):
        found = np.empty(len(mesh.polygons), bool)
        mesh.polygons.foreach_get("select", found)
        return found

    def test_faces_by_class_and_by_range(self):
        mesh = self.suzanne()
        group = settings()
        group.select_by, group.select_classes = "class", {"hyperbolic", "flat"}
        self.assertEqual(call(bpy.ops.osculate.select)[0], {"FINISHED"})
        classes = values(mesh, "_CURVATURE_CLASS")
        self.assertTrue(np.array_equal(self.selected(mesh), np.isin(classes, (0, 4))))
        group.select_by, group.quantity, group.select_low, group.select_high = "range", "k_max", 0.5, 2
        call(bpy.ops.osculate.select)
        k = values(mesh, "_CURVATURE_MAX")
        inside = (k >= 0.5) & (k <= 2) & (classes >= 0)
        self.assertTrue(0 < inside.sum() < len(inside))
        self.assertTrue(np.array_equal(self.selected(mesh), inside))
        group.select_by = "class"
        call(bpy.ops.osculate.select, extend=True)
        self.assertTrue(np.array_equal(self.selected(mesh), inside | np.isin(classes, (0, 4))))

    def test_in_edit_mode_too(self):
        mesh = self.suzanne()
        bpy.ops.object.mode_set(mode="EDIT")
        settings().select_by, settings().select_classes = "class", {"elliptic"}
        self.assertEqual(call(bpy.ops.osculate.select)[0], {"FINISHED"})
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertTrue(np.array_equal(self.selected(mesh), values(mesh, "_CURVATURE_CLASS") == 2))

    def test_hidden_faces_stay_unselected(self):
        mesh = self.suzanne()
        mesh.polygons[0].hide = True
        settings().select_by, settings().select_low, settings().select_high = "range", -1e9, 1e9
        call(bpy.ops.osculate.select)
        self.assertFalse(self.selected(mesh)[0])
        self.assertTrue(self.selected(mesh)[1:].all())

    def test_what_makes_no_sense_is_said(self):
        bpy.ops.mesh.primitive_cube_add()
        self.assertIn("has no class on its faces", call(bpy.ops.osculate.select)[1])
        self.suzanne()
        settings().select_by, settings().select_low, settings().select_high = "range", 1, 0
        self.assertIn("is reversed", call(bpy.ops.osculate.select)[1])
        bpy.context.view_layer.objects.active = None
        self.assertIn("active object", call(bpy.ops.osculate.select)[1])


class Export(OnSuzanne):
    def exported(self, **options):
        path = FOLDER / "exported.glb"
        with quiet() as said:
            bpy.ops.export_scene.gltf(filepath=str(path), **options)
        self.assertNotIn("Traceback", said[0])
        return path

    def test_values_come_back_and_the_program_reads_them(self):
        self.suzanne()
        path = self.exported()
        self.assert_values(only(load(path)[0]), table(FIXTURES / "suzanne.stl"), required=DEFAULT)
        again = table(path, "--reuse", "--attributes", "k_max,k_min,mean,class,coverage,confidence")
        first = table(FIXTURES / "suzanne.stl", "--attributes", "k_max,k_min,mean,class,coverage,confidence")
        for name in first:
            np.testing.assert_array_equal(np.nan_to_num(again[name]), np.nan_to_num(first[name]), name)

    def test_edges_come_back_as_they_were(self):
        for name in ("suzanne.stl", "fillet_part.stl", "cylinder_holes.stl"):
            with self.subTest(name):
                given = annotated(FIXTURES / name, f"{name}-edges.glb", "--layout", "indexed", "--feature-angle", "25")
                first = edges_of(only(load(given)[0]))
                again = edges_of(only(load(self.exported())[0]))
                self.assertEqual(again.keys(), first.keys())
                self.assertGreater(len({kind for kind, _ in first.values()}), 1)
                for place, (kind, angle) in first.items():
                    self.assertEqual(again[place][0], kind)
                    self.assertAlmostEqual(again[place][1], angle, delta=0.05)

    def test_all_attributes_are_numbers_and_ours_only_unless_asked(self):
        mesh = self.suzanne()
        mesh.attributes.new("_OTHER", "FLOAT", "POINT")
        for asked in (False, True):
            document = document_of(self.exported(export_attributes=asked))
            attributes = document["meshes"][0]["primitives"][0]["attributes"]
            self.assertEqual("_OTHER" in attributes, asked)
            custom = {name: document["accessors"][number] for name, number in attributes.items() if name.startswith("_")}
            self.assertIn("_DIRECTION_MAX_Z", custom)
            self.assertEqual({(a["type"], a["componentType"]) for a in custom.values()}, {("SCALAR", 5126)})
            self.assertEqual(document["meshes"][0]["extras"]["osculate"]["settings"]["estimator"], "auto")

    def test_they_come_back_where_the_extension_is_off(self):
        self.suzanne()
        path = self.exported()
        with quiet():
            bpy.ops.preferences.addon_disable(module=MODULE)
        mesh = only(load(path)[0])
        with quiet():
            bpy.ops.preferences.addon_enable(module=MODULE)
        expected = table(FIXTURES / "suzanne.stl")
        first = np.array([polygon.vertices[0] for polygon in mesh.polygons])
        self.assertTrue(np.array_equal(values(mesh, "_CURVATURE_MEAN", "POINT")[first], np.nan_to_num(expected["mean"])))

    def test_without_turning_to_y_up_directions_are_not_turned(self):
        mesh = self.suzanne()
        wanted = values(mesh, "_DIRECTION_MAX")
        expected = wanted[:, 2]
        path = self.exported(export_yup=False)
        document, binary = parts_of(path)
        primitive = document["meshes"][0]["primitives"][0]
        read = lambda number: read_accessor(document, binary, number)
        z = read(primitive["attributes"]["_DIRECTION_MAX_Z"])[read(primitive["indices"])[::3]]
        np.testing.assert_array_equal(z, expected)

    def test_the_choice_not_to_write_is_kept(self):
        self.suzanne()
        preferences = bpy.context.preferences.addons[MODULE].preferences
        preferences.write_values = False
        try:
            attributes = document_of(self.exported())["meshes"][0]["primitives"][0]["attributes"]
            self.assertFalse([name for name in attributes if name.startswith("_")])
        finally:
            preferences.write_values = True

    def test_meshes_without_values_go_out_as_ever(self):
        bpy.ops.mesh.primitive_monkey_add()
        document = document_of(self.exported())
        self.assertNotIn("extras", document["meshes"][0])


def edges_of(mesh):
    """Kind and angle of every edge, by where it lies."""
    at = points(mesh)
    ends = [tuple(sorted(tuple(at[vertex]) for vertex in edge.vertices)) for edge in mesh.edges]
    return dict(zip(ends, zip(values(mesh, "_EDGE_KIND", "EDGE").tolist(), values(mesh, "_DIHEDRAL", "EDGE").tolist())))


def parts_of(path):
    content = path.read_bytes()
    length = struct.unpack_from("<I", content, 12)[0]
    return json.loads(content[20:20 + length]), content[28 + length:]


def document_of(path):
    return parts_of(path)[0]


def read_accessor(document, binary, number):
    accessor = document["accessors"][number]
    view = document["bufferViews"][accessor["bufferView"]]
    dtype = {5126: np.float32, 5123: np.uint16, 5125: np.uint32}[accessor["componentType"]]
    return np.frombuffer(binary, dtype, accessor["count"], view.get("byteOffset", 0) + accessor.get("byteOffset", 0))


def face_colors(path):
    """Colours of the faces of a PLY file of the program."""
    content = path.read_bytes()
    header, body = content.split(b"end_header\n", 1)
    widths = {b"float": "<f4", b"double": "<f8", b"uchar": "u1", b"char": "i1"}
    fields, vertices, count, section = [], 0, 0, b""
    stride = 0
    for line in header.split(b"\n"):
        words = line.split()
        if words[:1] == [b"element"]:
            section = words[1]
            vertices, count = (int(words[2]), count) if section == b"vertex" else (vertices, int(words[2]))
        elif words[:1] == [b"property"] and section == b"vertex":
            stride += np.dtype(widths[words[1]]).itemsize
        elif words[:2] == [b"property", b"list"]:
            fields += [("count", "u1"), ("corners", "<i4", 3)]
        elif words[:1] == [b"property"]:
            fields.append((words[2].decode(), widths[words[1]]))
    rows = np.frombuffer(body, np.dtype(fields), count, stride * vertices)
    return np.stack([rows[name] for name in ("red", "green", "blue")], axis=1).astype(int)


if __name__ == "__main__":
    main()
