"""Files that Osculate wrote arrive with values of faces and edges, on shared vertices; others arrive as ever."""

import json
import struct

from harness import (FIXTURES, FOLDER, MODULE, Case, annotated, corners, load, main, names, only, osculate, points, quiet,
                     table, values)

import bpy
import numpy as np

KINDS = {"inner": 0, "boundary": 1, "feature": 2, "non_manifold": 3}
DEFAULT = ("k_max", "k_min", "mean", "gauss", "dir_max", "coverage", "confidence")


def z_to_y_up(v):
    """What Blender's importer does to positions of a Y-up file."""
    return np.stack((v[:, 0], -v[:, 2], v[:, 1]), axis=1)


def rows_of(mesh):
    return values(mesh, "_FACE_ID")


class Values(Case):
    def test_every_value_is_that_of_the_csv_in_either_layout(self):
        for name in ("suzanne.stl", "cylinder_holes.stl", "fillet_part.stl"):
            expected = table(FIXTURES / name, "--attributes", "default,shape_index,curvedness")
            vertices = set()
            for layout in ("faces", "indexed"):
                with self.subTest(name, layout=layout):
                    path = annotated(FIXTURES / name, f"{name}-{layout}.glb", "--layout", layout, "--attributes", "all")
                    mesh = only(load(path)[0])
                    self.assertTrue(np.array_equal(rows_of(mesh), expected["face"].astype(int)))
                    self.assert_values(mesh, expected, required=(*DEFAULT, "dir_min", "radius", "shape_index", "curvedness"))
                    vertices.add((len(mesh.vertices), len(mesh.edges)))
            self.assertEqual(len(vertices), 1, "both layouts give the same mesh")

    def test_directions_turn_with_the_positions(self):
        expected = table(FIXTURES / "suzanne.ply")
        mesh = only(load(annotated(FIXTURES / "suzanne.ply", "y-up.glb"))[0])
        self.assert_values(mesh, expected, turn=z_to_y_up, required=DEFAULT)
        at = points(mesh)[corners(mesh)].astype(float)
        normals = np.cross(at[:, 1] - at[:, 0], at[:, 2] - at[:, 0])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        estimated = values(mesh, "_CURVATURE_CLASS") >= 0
        slant = np.abs(np.einsum("ij,ij->i", normals, values(mesh, "_DIRECTION_MAX")))[estimated]
        # Directions are tangent to the surface that was fitted, which leans a little on coarse faces.
        self.assertLess(np.median(slant), 0.2)

    def test_values_survive_merge_vertices(self):
        for layout in ("faces", "indexed"):
            path = annotated(FIXTURES / "suzanne.stl", f"suzanne.stl-{layout}.glb", "--layout", layout, "--attributes", "all")
            mesh = only(load(path, merge_vertices=True)[0])
            self.assert_values(mesh, table(FIXTURES / "suzanne.stl"), required=DEFAULT)

    def test_faces_that_blender_leaves_out_take_their_values_with_them(self):
        name = "fillet_degenerate.stl"
        expected = table(FIXTURES / name)
        for layout, merge, lost in (("faces", False, 0), ("indexed", False, 8), ("faces", True, 8), ("indexed", True, 8)):
            with self.subTest(layout=layout, merge=merge):
                path = annotated(FIXTURES / name, f"{name}-{layout}.glb", "--layout", layout)
                meshes, said = load(path, merge_vertices=merge)
                mesh = only(meshes)
                self.assertEqual(len(mesh.polygons), 968 - lost)
                self.assertEqual("left out 8 faces" in said, bool(lost), said)
                self.assert_values(mesh, expected, rows_of(mesh), required=DEFAULT)

    def test_a_face_that_is_there_twice_stays_twice(self):
        path = FOLDER / "twice.obj"
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 2 4\nf 4 2 1\n")
        mesh = only(load(annotated(path, "twice.glb"))[0])
        self.assertEqual(rows_of(mesh).tolist(), list(range(6)))
        self.assertEqual(len(mesh.vertices), 4 + 6, "the copies have vertices of their own")
        self.assert_values(mesh, table(path), turn=z_to_y_up)

    def test_scenes_keep_their_shape_looks_and_seams(self):
        for name in ("scene.glb", "character.glb", "two_meshes.glb"):
            plain, _ = load(FIXTURES / name)
            before = {key: (points(mesh), [layer.name for layer in mesh.uv_layers], len(mesh.polygons), uvs(mesh, 0))
                      for key, mesh in plain.items()}
            expected = table(FIXTURES / name)
            for layout in ("faces", "indexed"):
                with self.subTest(name, layout=layout):
                    path = annotated(FIXTURES / name, f"{name}-{layout}.glb", "--layout", layout)
                    meshes, _ = load(path)
                    self.assertEqual(set(meshes), set(before))
                    for key, mesh in meshes.items():
                        at, layers, count, first = before[key]
                        self.assertEqual(len(mesh.polygons), count)
                        self.assertTrue(np.array_equal(points(mesh), at), f"{key} has the vertices of the input")
                        self.assertEqual([layer.name for layer in mesh.uv_layers][:len(layers)], layers)
                        self.assertTrue(np.array_equal(uvs(mesh, 0), first) or not layers, key)
                        if "_FACE_ID" in mesh.attributes:
                            self.assert_values(mesh, expected, rows_of(mesh), turn=z_to_y_up, required=DEFAULT)

    def test_every_face_has_the_colour_it_has_without_the_extension(self):
        for name, options in (("variants.glb", ("--variants", "mean,gauss,k_max,shape_index,class")),
                              ("colors.glb", ("--color", "vertex", "--color-by", "gauss"))):
            path = annotated(FIXTURES / "suzanne.stl", name, *options)
            found = []
            for on in (True, False):
                enable(on)
                mesh = only(load(path)[0])
                found.append([uvs(mesh, n) for n in range(len(mesh.uv_layers))]
                             + [colors(layer) for layer in mesh.color_attributes])
            enable(True)
            self.assertGreater(len(found[0]), 0)
            for ours, theirs in zip(*found, strict=True):
                self.assertTrue(np.array_equal(ours, theirs), name)

    def test_values_of_vertices_stay_on_vertices(self):
        path = annotated(FIXTURES / "suzanne.stl", "vertex-values.glb", "--vertex-values")
        mesh = only(load(path)[0])
        self.assertEqual(len(mesh.vertices), 505)
        self.assertEqual(mesh.attributes["_CURVATURE_MEAN_VERTEX"].domain, "POINT")
        self.assertEqual(mesh.attributes["_CURVATURE_MEAN"].domain, "FACE")

    def test_annotated_twice_is_annotated_once(self):
        once = annotated(FIXTURES / "suzanne.stl", "once.glb")
        twice = annotated(once, "twice-annotated.glb", "--layout", "indexed", "--reuse")
        self.assert_values(only(load(twice)[0]), table(FIXTURES / "suzanne.stl"), required=DEFAULT)


class Edges(Case):
    def test_kinds_are_those_that_inspect_counts_and_features_are_sharp(self):
        for name in ("suzanne.stl", "cylinder_holes.stl", "fillet_part.stl"):
            counted = json.loads(osculate("inspect", FIXTURES / name, "--format", "json"))["edges"]
            for layout in ("faces", "indexed"):
                with self.subTest(name, layout=layout):
                    path = annotated(FIXTURES / name, f"{name}-{layout}.glb", "--layout", layout, "--attributes", "all")
                    mesh = only(load(path)[0])
                    kinds = values(mesh, "_EDGE_KIND", "EDGE")
                    found = {kind: int((kinds == code).sum()) for kind, code in KINDS.items()}
                    self.assertEqual(found, {kind: counted[kind] for kind in KINDS})
                    self.assertTrue(np.array_equal(values(mesh, "sharp_edge", "EDGE"), kinds == KINDS["feature"]))

    def test_a_sliver_in_a_seam_hides_no_sharp_edge(self):
        path = FOLDER / "sliver.obj"
        path.write_text("v 0 0 0\nv 2 0 0\nv 1 0 0\nv 1 1 0\nv 1 0 -1\nf 1 2 4\nf 1 5 3\nf 3 5 2\nf 1 3 2\n")
        counted = json.loads(osculate("inspect", path, "--format", "json"))["edges"]
        self.assertEqual(counted["feature"], 2)
        for layout in ("faces", "indexed"):
            mesh = only(load(annotated(path, f"sliver-{layout}.glb", "--layout", layout))[0])
            kinds, angles = values(mesh, "_EDGE_KIND", "EDGE"), values(mesh, "_DIHEDRAL", "EDGE")
            self.assertEqual({kind: int((kinds == code).sum()) for kind, code in KINDS.items()}, counted, layout)
            self.assertTrue(np.allclose(angles[kinds == 2], 90) and np.allclose(angles[kinds != 2], 0), layout)

    def test_angles_are_those_of_the_file_of_edges(self):
        edges = FOLDER / "angles-edges.glb"
        annotated(FIXTURES / "suzanne.stl", "angles.glb", "--edges", edges)
        mesh = only(load(FOLDER / "angles.glb")[0])
        kinds, angles = values(mesh, "_EDGE_KIND", "EDGE"), values(mesh, "_DIHEDRAL", "EDGE")
        written = numbers_of(edges, "feature", "_DIHEDRAL")[::2]
        np.testing.assert_allclose(np.sort(angles[kinds == 2]), np.sort(written), rtol=1e-4)
        self.assertTrue((angles[kinds == 1] == 0).all() and (angles[kinds == 0] <= 40).all())

    def test_the_feature_angle_of_the_run_decides(self):
        path = annotated(FIXTURES / "suzanne.stl", "angle-10.glb", "--feature-angle", "10")
        counted = json.loads(osculate("inspect", FIXTURES / "suzanne.stl", "--feature-angle", "10", "--format", "json"))
        kinds = values(only(load(path)[0]), "_EDGE_KIND", "EDGE")
        self.assertEqual(int((kinds == 2).sum()), counted["edges"]["feature"])

    def test_a_seam_of_texture_coordinates_is_no_border(self):
        both = []
        for layout in ("faces", "indexed"):
            meshes, _ = load(annotated(FIXTURES / "scene.glb", f"scene.glb-{layout}.glb", "--layout", layout))
            both.append({key: values(mesh, "_EDGE_KIND", "EDGE") for key, mesh in meshes.items()})
            self.assertEqual(sum(int((kinds == 1).sum()) for kinds in both[-1].values()), 4)
        for key in both[0]:
            self.assertTrue(np.array_equal(both[0][key], both[1][key]), key)

    def test_given_normals_stay(self):
        name = "scene.glb"
        before = {key: corner_normals(mesh) for key, mesh in load(FIXTURES / name)[0].items()}
        meshes, _ = load(annotated(FIXTURES / name, "scene.glb-faces.glb", "--layout", "faces"))
        self.assertTrue(any(values(mesh, "sharp_edge", "EDGE").any() for mesh in meshes.values()
                            if "sharp_edge" in mesh.attributes))
        for key, mesh in meshes.items():
            np.testing.assert_allclose(corner_normals(mesh), before[key], atol=2e-4, err_msg=key)


class Others(Case):
    def test_files_of_others_arrive_as_without_the_extension(self):
        for path in [FIXTURES / name for name in ("scene.glb", "character.glb", "two_meshes.glb", "suzanne.glb")]:
            found = []
            for on in (True, False):
                enable(on)
                found.append({key: names(mesh) for key, mesh in load(path)[0].items()})
            enable(True)
            self.assertEqual(found[0], found[1], path.name)

    def test_attributes_of_our_names_in_files_of_others_stay_where_they_are(self):
        path = FOLDER / "foreign.glb"
        rewrite(annotated(FIXTURES / "suzanne.stl", "once.glb"), path, lambda document: [
            mesh.pop("extras") for mesh in document["meshes"]])
        mesh = only(load(path)[0])
        self.assertEqual(mesh.attributes["_CURVATURE_MEAN"].domain, "POINT")
        self.assertNotIn("_EDGE_KIND", mesh.attributes)

    def test_values_that_cannot_be_read_are_said_and_the_mesh_arrives(self):
        def missing(document):
            used = document["meshes"][0]["primitives"][0]["extensions"]["OSCULATE_face_values"]["values"]
            used["mean"]["accessor"] = 10_000

        def short(document):
            used = document["meshes"][0]["primitives"][0]["extensions"]["OSCULATE_face_values"]["values"]
            document["accessors"][used["mean"]["accessor"]]["count"] = 3

        def nothing(document):
            document["meshes"][0]["primitives"][0]["extensions"]["OSCULATE_face_values"] = {}

        def nonsense(document):
            document["meshes"][0]["primitives"][0]["extensions"]["OSCULATE_face_values"] = {"values": 7}

        given = annotated(FIXTURES / "suzanne.stl", "suzanne.stl-indexed.glb", "--layout", "indexed", "--attributes", "all")
        for damage in (missing, short, nothing, nonsense):
            with self.subTest(damage.__name__):
                path = FOLDER / f"damaged-{damage.__name__}.glb"
                rewrite(given, path, damage)
                meshes, said = load(path)
                mesh = only(meshes)
                self.assertEqual((len(mesh.vertices), len(mesh.polygons)), (505, 968))
                self.assertFalse([a.name for a in mesh.attributes if a.name.startswith("_")])
                self.assertIn("was imported without values of faces", said)

    def test_the_choice_not_to_read_is_kept(self):
        preferences = bpy.context.preferences.addons[MODULE].preferences
        preferences.read_values = False
        try:
            mesh = only(load(annotated(FIXTURES / "suzanne.stl", "once.glb"))[0])
            self.assertEqual(mesh.attributes["_CURVATURE_MEAN"].domain, "POINT")
        finally:
            preferences.read_values = True

    def test_values_survive_save_and_reload(self):
        mesh = only(load(annotated(FIXTURES / "suzanne.stl", "once.glb"))[0])
        before, kinds = table(FIXTURES / "suzanne.stl"), values(mesh, "_EDGE_KIND", "EDGE")
        with quiet():
            bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "saved.blend"))
            bpy.ops.wm.open_mainfile(filepath=str(FOLDER / "saved.blend"))
        mesh = next(obj.data for obj in bpy.data.objects if obj.type == "MESH")
        self.assert_values(mesh, before, required=DEFAULT)
        self.assertTrue(np.array_equal(values(mesh, "_EDGE_KIND", "EDGE"), kinds))
        self.assertEqual(mesh["osculate"]["settings"]["estimator"], "auto")


def uvs(mesh, number):
    if number >= len(mesh.uv_layers):
        return None
    found = np.empty(2 * len(mesh.loops), np.float32)
    mesh.uv_layers[number].uv.foreach_get("vector", found)
    return found


def colors(layer):
    found = np.empty(4 * len(layer.data), np.float32)
    layer.data.foreach_get("color", found)
    return found


def corner_normals(mesh):
    found = np.empty(3 * len(mesh.loops), np.float32)
    mesh.corner_normals.foreach_get("vector", found)
    return found


def enable(on):
    with quiet():
        (bpy.ops.preferences.addon_enable if on else bpy.ops.preferences.addon_disable)(module=MODULE)


def parts(path):
    """The document and the binary chunk of a GLB."""
    content = path.read_bytes()
    length = struct.unpack_from("<I", content, 12)[0]
    return json.loads(content[20:20 + length]), content[28 + length:]


def rewrite(given, path, change):
    """A GLB with another document."""
    document, binary = parts(given)
    change(document)
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(binary), 0x004E4942) + binary
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def numbers_of(path, mesh_name, attribute):
    document, binary = parts(path)
    mesh = next(mesh for mesh in document["meshes"] if mesh["name"] == mesh_name)
    accessor = document["accessors"][mesh["primitives"][0]["attributes"][attribute]]
    view = document["bufferViews"][accessor["bufferView"]]
    at = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    return np.frombuffer(binary, np.float32, accessor["count"], at)


if __name__ == "__main__":
    main()
