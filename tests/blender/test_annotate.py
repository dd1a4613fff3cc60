"""The operator gives the values of the program, on any mesh, or one clear sentence and an untouched scene."""

import os
import sys
import threading
import time
import warnings
from pathlib import Path
from types import SimpleNamespace

from harness import (FIXTURES, FOLDER, MODULE, Fresh, annotated, call, corners, load, main, names, obj_of, only, osculate,
                     points, quiet, select, settings, table, values, write_ply)

import bpy
import numpy as np

REQUIRED = ("k_max", "k_min", "mean", "gauss", "dir_max", "dir_min", "radius", "coverage", "confidence")


def mesh_object(vertices, faces, name="given", edges=()):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, list(edges), faces)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def monkey():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.active_object


def triangles_of(mesh):
    """Corners and faces of the triangles into which Blender cuts a mesh."""
    mesh.calc_loop_triangles()
    return (np.array([t.vertices[:] for t in mesh.loop_triangles]), np.array([t.polygon_index for t in mesh.loop_triangles]))


def program_on(mesh, name, *options):
    """The table of the program for the triangles of a mesh, and the face of each."""
    found, faces = triangles_of(mesh)
    return table(write_ply(FOLDER / f"{name}.ply", points(mesh), found), "--up", "z", *options), faces


class Values(Fresh):
    def test_every_value_is_that_of_the_csv(self):
        scan = FOLDER / "scan.ply"
        osculate("synth", "ellipsoid", "--faces", "20000", "--scan-noise", "0.1", "-o", scan, "-q")
        scans = [scan, *(Path(path) for path in os.environ.get("OSCULATE_SCANS", "").split(":") if path)]
        for number, path in enumerate(scans):
            # As Blender has it: in 32 bits, without faces that are there twice.
            glb = annotated(path, f"scan-{number}.glb", "--up", "z", "--layout", "indexed", "--attributes", "none")
            mesh = only(load(glb)[0])
            scans[number] = write_ply(FOLDER / f"scan-{number}-32.ply", points(mesh), corners(mesh))
        for path in (FIXTURES / "suzanne.stl", FIXTURES / "fillet_part.stl", *scans):
            with self.subTest(path.name):
                glb = annotated(path, f"{path.name}-plain.glb", "--up", "z", "--layout", "indexed", "--attributes", "none")
                mesh = only(load(glb)[0])
                select(obj_of(mesh))
                result, said = call(bpy.ops.osculate.annotate)
                self.assertEqual(result, {"FINISHED"}, said)
                self.assert_values(mesh, table(path), required=REQUIRED)
                self.assertTrue(np.array_equal(values(mesh, "_FACE_ID"), np.arange(len(mesh.polygons))))
                self.assertIn(f"{len(mesh.polygons)} faces", said)

    def test_settings_are_those_of_the_program(self):
        path = FIXTURES / "cylinder_holes.stl"
        mesh = only(load(annotated(path, "cylinder-plain.glb", "--layout", "indexed", "--attributes", "none"))[0])
        select(obj_of(mesh))
        group = settings()
        group.estimator, group.radius, group.diameters, group.class_tolerance = "tangent", "2.5", 8, 0.1
        group.feature_angle, group.attributes = 30, "default,shape_index,curvedness,gauss_perimeter"
        self.assertEqual(call(bpy.ops.osculate.annotate)[0], {"FINISHED"})
        expected = table(path, "--estimator", "tangent", "--radius", "2.5", "--diameters", "8", "--class-tolerance", "0.1",
                         "--feature-angle", "30", "--attributes", "default,shape_index,curvedness,gauss_perimeter")
        self.assert_values(mesh, expected, required=(*REQUIRED, "shape_index", "curvedness", "gauss_perimeter"))
        used = mesh["osculate"]["settings"]
        self.assertEqual((used["estimator"], used["diameters"], used["feature_angle"]), ("tangent", 8, 30))
        self.assertEqual(call(bpy.ops.osculate.reset_settings)[0], {"FINISHED"})
        self.assertEqual((group.estimator, group.radius, group.feature_angle), ("auto", "auto", 40))

    def test_names_defaults_and_help_are_those_of_the_command_line(self):
        text = " ".join(osculate("annotate", "--help").split())
        properties = settings().bl_rna.properties
        for name in ("estimator", "radius", "radius_factor", "diameters", "class_tolerance", "feature_angle", "weld",
                     "attributes"):
            with self.subTest(name):
                self.assertIn(f"--{name.replace('_', '-')} ", text)
                self.assertIn(" ".join(properties[name].description.split()), text)
        self.assertIn(f"[default: {settings().class_tolerance:.3g}]", text)
        self.assertIn(f"[default: {settings().feature_angle:.3g}]", text)

    def test_faces_with_many_corners_get_the_mean_of_their_triangles(self):
        mesh = monkey().data
        self.assertGreater(len(mesh.loops), 3 * len(mesh.polygons))
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"FINISHED"}, said)
        self.assertIn("as means of their triangles", said)
        expected, faces = program_on(mesh, "monkey")
        at = points(mesh).astype(float)[triangles_of(mesh)[0]]
        area = np.linalg.norm(np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0]), axis=1)
        for column, name in (("k_max", "_CURVATURE_MAX"), ("gauss", "_CURVATURE_GAUSS"), ("coverage", "_COVERAGE")):
            wanted = [np.average(expected[column][faces == f], weights=area[faces == f]) for f in range(len(mesh.polygons))]
            np.testing.assert_allclose(values(mesh, name), wanted, rtol=1e-5, atol=1e-6)
        for f in range(0, len(mesh.polygons), 7):
            own = np.flatnonzero(faces == f)
            classes = [area[own][expected["class"][own] == code].sum() for code in range(5)]
            self.assertAlmostEqual(classes[values(mesh, "_CURVATURE_CLASS")[f]], max(classes), places=12)
        largest = [np.flatnonzero(faces == f)[np.argmax(area[faces == f])] for f in range(len(mesh.polygons))]
        clear = np.array([np.ptp(area[faces == f]) > 1e-6 or (faces == f).sum() == 1 for f in range(len(mesh.polygons))])
        wanted = np.stack([expected[f"dir_max_{axis}"][largest] for axis in "xyz"], axis=1)
        np.testing.assert_array_equal(values(mesh, "_DIRECTION_MAX")[clear], wanted[clear])

    def test_modifiers_are_left_out_or_make_a_new_object(self):
        bpy.ops.mesh.primitive_torus_add(major_segments=24, minor_segments=12)
        obj = bpy.context.active_object
        obj.location, obj.rotation_euler = (1, 2, 3), (0.3, 0.2, 0.1)
        bpy.context.view_layer.update()
        subdivided = obj.modifiers.new("Subdivision", "SUBSURF")
        subdivided.levels = 2
        self.assertEqual(call(bpy.ops.osculate.annotate)[0], {"FINISHED"})
        self.assertEqual(len(values(obj.data, "_CURVATURE_MEAN")), 24 * 12)
        plain = values(obj.data, "_CURVATURE_MEAN").copy()
        settings().use_modifiers = True
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"FINISHED"}, said)
        self.assertIn("as new object", said)
        new = next(o for o in bpy.data.objects if o != obj)
        self.assertEqual(len(new.data.polygons), 24 * 12 * 16)
        np.testing.assert_allclose(new.matrix_world, obj.matrix_world, atol=1e-6)
        self.assertTrue(np.array_equal(values(obj.data, "_CURVATURE_MEAN"), plain), "the object itself stays")
        expected, faces = program_on(new.data, "subdivided")
        mean = np.bincount(faces, expected["mean"]) / np.bincount(faces)
        self.assertLess(np.abs(values(new.data, "_CURVATURE_MEAN") - mean).max(), 0.05 * np.abs(mean).max())
        # The torus is 1 and 0.25: at the outside 1/0.25 and 1/1.25.
        self.assertAlmostEqual(float(values(new.data, "_CURVATURE_MEAN").max()), (1 / 0.25 + 1 / 1.25) / 2, delta=0.15)

    def test_modifiers_that_move_vertices_only_write_to_the_object(self):
        obj = monkey()
        obj.modifiers.new("Smooth", "SMOOTH").iterations = 3
        settings().use_modifiers = True
        self.assertEqual(call(bpy.ops.osculate.annotate)[0], {"FINISHED"})
        self.assertEqual([o.name for o in bpy.data.objects if o.type == "MESH"], [obj.name])
        moved = values(obj.data, "_CURVATURE_MEAN").copy()
        settings().use_modifiers = False
        self.assertEqual(call(bpy.ops.osculate.annotate)[0], {"FINISHED"})
        self.assertFalse(np.array_equal(values(obj.data, "_CURVATURE_MEAN"), moved))

    def test_several_objects_at_once_and_a_mesh_that_two_share_once(self):
        first, second = monkey(), monkey()
        twin = bpy.data.objects.new("twin", first.data)
        bpy.context.collection.objects.link(twin)
        bpy.ops.object.light_add()
        lamp = bpy.context.active_object
        select(first, second, twin, lamp)
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"FINISHED"})
        self.assertIn("is no mesh (light)", said)
        self.assertEqual(said.count("faces of \"Suzanne"), 2)
        for obj in (first, second):
            self.assertIn("_CURVATURE_MEAN", obj.data.attributes)

    def test_edges_have_kind_and_angle_and_are_sharp_on_request(self):
        bpy.ops.mesh.primitive_cube_add()
        mesh = bpy.context.active_object.data
        call(bpy.ops.osculate.annotate)
        self.assertEqual(values(mesh, "_EDGE_KIND", "EDGE").tolist(), [2] * 12)
        np.testing.assert_allclose(values(mesh, "_DIHEDRAL", "EDGE"), 90, rtol=1e-6)
        self.assertNotIn("sharp_edge", mesh.attributes)
        settings().mark_sharp = True
        call(bpy.ops.osculate.annotate)
        self.assertTrue(values(mesh, "sharp_edge", "EDGE").all())

    def test_values_go_away_again(self):
        obj = monkey()
        before = names(obj.data)
        call(bpy.ops.osculate.annotate)
        self.assertNotEqual(names(obj.data), before)
        self.assertEqual(call(bpy.ops.osculate.clear)[0], {"FINISHED"})
        self.assertEqual(names(obj.data), before)
        self.assertNotIn("osculate", obj.data)
        self.assertIn("None of the selected objects has values", call(bpy.ops.osculate.clear)[1])

    def test_a_second_run_leaves_nothing_of_the_first(self):
        mesh = monkey().data
        call(bpy.ops.osculate.annotate)
        once = names(mesh)
        settings().attributes = "all"
        call(bpy.ops.osculate.annotate)
        self.assertIn("_SHAPE_INDEX", mesh.attributes)
        call(bpy.ops.osculate.reset_settings)
        call(bpy.ops.osculate.annotate)
        self.assertEqual(names(mesh), once)

    def test_modifiers_of_one_object_leave_the_mesh_that_another_shares(self):
        first = monkey()
        second = bpy.data.objects.new("second", first.data)
        bpy.context.collection.objects.link(second)
        first.modifiers.new("Smooth", "SMOOTH")
        settings().use_modifiers = True
        before = names(first.data)
        select(first)
        self.assertIn("as new object", call(bpy.ops.osculate.annotate)[1])
        self.assertEqual(names(first.data), before)

    def test_undo_takes_the_values_back(self):
        obj = monkey()
        name = obj.name
        bpy.ops.ed.undo_push(message="before")
        call(bpy.ops.osculate.annotate)
        bpy.ops.ed.undo_push(message="annotated")
        self.assertIn("_CURVATURE_MEAN", bpy.data.objects[name].data.attributes)
        with quiet():
            bpy.ops.ed.undo()
        self.assertNotIn("_CURVATURE_MEAN", bpy.data.objects[name].data.attributes)
        with quiet():
            bpy.ops.ed.redo()
        self.assertIn("_CURVATURE_MEAN", bpy.data.objects[name].data.attributes)


class Refusals(Fresh):
    def refused(self, sentence):
        before = {obj.name: names(obj.data) for obj in bpy.data.objects if obj.type == "MESH"}
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"CANCELLED"}, said)
        self.assertIn(sentence, said)
        self.assertNotIn("Traceback", said)
        self.assertEqual({obj.name: names(obj.data) for obj in bpy.data.objects if obj.type == "MESH"}, before)
        self.assertFalse(any("osculate" in mesh for mesh in bpy.data.meshes))

    def test_nothing_selected(self):
        self.refused("Select one or more mesh objects first")

    def test_no_mesh(self):
        bpy.ops.curve.primitive_bezier_curve_add()
        self.refused("is no mesh (curve); convert it")

    def test_a_mesh_without_faces(self):
        select(mesh_object([(0, 0, 0), (1, 0, 0)], [], edges=[(0, 1)]))
        self.refused("\"given\" has no faces, so there is nothing to estimate")

    def test_an_empty_mesh(self):
        select(mesh_object([], []))
        self.refused("\"given\" has no faces")

    def test_edit_mode(self):
        monkey()
        bpy.ops.object.mode_set(mode="EDIT")
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"CANCELLED"})
        self.assertIn("is in Edit Mode", said)
        bpy.ops.object.mode_set(mode="OBJECT")
        self.refused_nothing()

    def refused_nothing(self):
        self.assertFalse([a.name for mesh in bpy.data.meshes for a in mesh.attributes if a.name.startswith("_")])

    def test_a_setting_out_of_range(self):
        monkey()
        for name, value, sentence in (("radius", "-1", "radius"), ("radius", "wide", "radius"), ("diameters", 2, "diameters"),
                                      ("attributes", "k_mux", "k_mux"), ("weld", -1.0, "weld")):
            with self.subTest(name, value=value):
                call(bpy.ops.osculate.reset_settings)
                setattr(settings(), name, value)
                self.refused(sentence)

    def test_coordinates_that_are_no_numbers(self):
        obj = mesh_object([(float("nan"), 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
        select(obj)
        self.refused("")

    def test_faces_with_nan_among_others_are_not_estimated(self):
        obj = mesh_object([(float("nan"), 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 3, 2)])
        select(obj)
        self.assertEqual(call(bpy.ops.osculate.annotate)[0], {"FINISHED"})
        self.assertEqual(values(obj.data, "_CURVATURE_CLASS").tolist(), [-1, 0])
        self.assertTrue(np.isfinite(values(obj.data, "_DIRECTION_MAX")).all())

    def test_an_object_that_cannot_be_estimated_keeps_no_other_from_it(self):
        nowhere = mesh_object([(float("nan"),) * 3] * 3, [(0, 1, 2)], "nowhere")
        good = monkey()
        select(nowhere, good)
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"FINISHED"}, said)
        self.assertIn("\"nowhere\": none of the 1 faces has an area and finite coordinates", said)
        self.assertNotIn("_CURVATURE_MEAN", nowhere.data.attributes)
        self.assertIn("_CURVATURE_MEAN", good.data.attributes)

    def test_defects_are_told_and_are_no_warnings_of_python(self):
        select(mesh_object([(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2), (0, 1, 3)]))
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            said = call(bpy.ops.osculate.annotate)[1]
            warnings.warn("somebody else's")
        self.assertIn("1 face without area", said)
        self.assertEqual([str(warning.message) for warning in caught], ["somebody else's"])

    def test_loose_edges_are_left_out_and_said(self):
        obj = mesh_object([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 2, 2)], [(0, 1, 2)], edges=[(1, 3)])
        select(obj)
        result, said = call(bpy.ops.osculate.annotate)
        self.assertEqual(result, {"FINISHED"})
        self.assertIn("1 loose edges left out", said)
        self.assertEqual(len(obj.data.edges), 4)
        self.assertEqual(sorted(values(obj.data, "_EDGE_KIND", "EDGE").tolist()), [0, 1, 1, 1])

    def test_a_missing_compiled_part(self):
        monkey()
        with without_wheel():
            self.refused("This copy of the extension has no compiled part for")
            mesh = only(load(annotated(FIXTURES / "suzanne.stl", "once.glb"))[0])
            self.assertEqual(mesh.attributes["_CURVATURE_MEAN"].domain, "FACE", "imports go on")

    def test_a_run_goes_on_beside_blender_until_it_is_cancelled(self):
        package = sys.modules[MODULE]
        bpy.ops.mesh.primitive_torus_add(major_segments=600, minor_segments=300)
        obj = bpy.context.active_object
        before = names(obj.data)
        jobs, _ = package.estimate.collect(bpy.context, [obj], False)
        # Long walks: on any machine there is time to cancel between the first report and the end.
        work = package.work.Work(jobs, {"estimator": "osculating", "radius_factor": 100.0})
        work.start()
        looked = 0
        while work.is_running() and work.share == 0:
            looked += 1
            time.sleep(0.002)
        self.assertGreater(looked, 1, "this thread runs meanwhile")
        self.assertTrue(work.is_running(), "there is time to cancel")
        work.cancel()
        asked = time.perf_counter()
        work.wait()
        self.assertLess(time.perf_counter() - asked, 5)
        self.assertIsInstance(work.error, package.estimate.Cancelled)
        self.assertIsNone(jobs[0].columns)
        self.assertEqual(names(obj.data), before)

    def test_a_run_tells_how_far_it_is(self):
        package = sys.modules[MODULE]
        first, second = monkey(), monkey()
        jobs, _ = package.estimate.collect(bpy.context, [first, second], False)
        work = package.work.Work(jobs, {})
        work.start()
        work.wait()
        self.assertIsNone(work.error)
        self.assertEqual(work.share, 1)

    def test_a_mesh_that_changed_meanwhile_is_not_written_to(self):
        package = sys.modules[MODULE]
        obj = monkey()
        jobs, _ = package.estimate.collect(bpy.context, [obj], False)
        worker = threading.Thread(target=jobs[0].run, args=({}, None))
        worker.start()
        worker.join()
        obj.data.vertices[0].co.x += 1
        with self.assertRaisesRegex(package.estimate.Refused, "has changed while it was estimated"):
            jobs[0].write(bpy.context, 40, False)
        self.refused_nothing()
        name = obj.name
        bpy.data.objects.remove(obj)
        with self.assertRaisesRegex(package.estimate.Refused, f"\"{name}\" has changed"):
            jobs[0].write(bpy.context, 40, False)


class Panels(Fresh):
    def test_panels_name_properties_and_operators_that_there_are(self):
        package = sys.modules[MODULE]
        for prepared in (False, True):
            if prepared:
                monkey()
                call(bpy.ops.osculate.annotate)
                call(bpy.ops.osculate.show)
            for quantity in ("mean", "class"):
                for by in ("class", "range"):
                    settings().quantity, settings().select_by = quantity, by
                    for panel in package.panel.PANELS:
                        layout = Layout()
                        # A panel cannot be made without a window; what it draws with, it can.
                        panel.draw(SimpleNamespace(layout=layout), bpy.context)
                        self.assertGreater(layout.count, 1)


class Layout:
    """A layout that checks what it is given, and draws nothing."""

    count = 0

    def prop(self, data, name, **_):
        self.count += 1
        assert name in data.bl_rna.properties, name

    def operator(self, name, **_):
        self.count += 1
        group, operator = name.split(".")
        getattr(getattr(bpy.ops, group), operator).get_rna_type()
        return SimpleNamespace()

    def label(self, text="", icon="NONE"):
        self.count += 1
        assert isinstance(text, str)

    def template_color_ramp(self, data, name, **_):
        self.count += 1
        assert hasattr(data, name)

    def column(self, **_):
        return self

    row = box = column


class without_wheel:
    """As on a system that the bundled wheel was not made for."""

    def __enter__(self):
        self.wheel = sys.modules[MODULE].wheel
        self.kept = {name: module for name, module in sys.modules.items() if name.split(".")[0] == "osculate"}
        for name in self.kept:
            del sys.modules[name]
        sys.modules["osculate"] = None
        self.wheel._load.cache_clear()

    def __exit__(self, *_):
        del sys.modules["osculate"]
        sys.modules.update(self.kept)
        self.wheel._load.cache_clear()


if __name__ == "__main__":
    main()
