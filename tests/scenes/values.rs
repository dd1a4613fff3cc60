//! Values of faces as attributes and in our extension.

use crate::document::{Document, assert_same};
use crate::odd::{odd_scene, write_glb};
use crate::{annotate, column, fixture, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn every_corner_of_a_face_carries_the_value_of_the_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf", "two_meshes_embedded.gltf"] {
        annotate(&fixture(name), &path("out.glb"), &["--attributes", "all"]);
        annotate(&fixture(name), &path("out.csv"), &["--attributes", "all"]);
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let out = Document::read(&path("out.glb"));
        for (attribute, name) in [
            ("_FACE_ID", "face"),
            ("_CURVATURE_CLASS", "class"),
            ("_CURVATURE_MAX", "k_max"),
            ("_CURVATURE_GAUSS", "gauss"),
            ("_SHAPE_INDEX", "shape_index"),
            ("_DIRECTION_MIN_Y", "dir_min_y"),
            ("_RADIUS", "radius"),
        ] {
            let mut values = Vec::new();
            for mesh in out.json["meshes"].as_array().expect("meshes") {
                for primitive in mesh["primitives"].as_array().expect("primitives") {
                    let stored = out.elements(&primitive["attributes"][attribute]);
                    for corners in out.corners(primitive, stored.len()).chunks_exact(3) {
                        assert!(corners.iter().all(|&c| stored[c] == stored[corners[0]]));
                        values.push(f32::from_le_bytes(stored[corners[0]][..].try_into().expect("4 bytes")));
                    }
                }
            }
            assert_eq!(values, column(&csv, name), "{attribute}");
        }
    }
}

/// The extension's values of a column, primitive after primitive.
pub(crate) fn face_values(out: &Document, column: &str) -> Vec<f32> {
    let primitives = out.json["meshes"].as_array().expect("meshes").iter().flat_map(|m| m["primitives"].as_array());
    let values = primitives.flatten().map(|p| &p["extensions"]["OSCULATE_face_values"]["values"][column]["accessor"]);
    let bytes = values.filter(|accessor| accessor.is_u64()).flat_map(|accessor| out.elements(accessor));
    bytes.map(|b| f32::from_le_bytes(b[..].try_into().expect("4 bytes"))).collect()
}

#[test]
fn layout_indexed_leaves_vertices_alone_and_has_a_value_for_every_triangle() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    for input in [fixture("character.glb"), fixture("scene.gltf"), fixture("suzanne.stl"), path("odd.glb")] {
        annotate(&input, &path("out.glb"), &["--layout", "indexed", "--up", "y"]);
        annotate(&input, &path("out.csv"), &["--up", "y"]);
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let out = Document::read(&path("out.glb"));
        for name in ["face", "class", "k_max", "k_min", "mean", "gauss", "dir_max_y", "coverage"] {
            assert_eq!(face_values(&out, name), column(&csv, name), "{name}");
        }
        let required = out.json.get("extensionsRequired");
        assert!(required.is_none_or(|list| !list.to_string().contains("OSCULATE")));
        assert!(out.json["extensionsUsed"].to_string().contains("OSCULATE_face_values"));
        if input.extension().is_some_and(|e| e == "stl") {
            let primitive = &out.json["meshes"][0]["primitives"][0];
            assert_eq!(out.elements(&primitive["attributes"]["POSITION"]).len(), 505);
            let boundary = &primitive["extensions"]["OSCULATE_face_values"]["edges"]["boundary"]["accessor"];
            assert_eq!(out.elements(boundary).len(), 2 * 42, "fixtures/README.md counts 42 boundary edges");
            continue;
        }
        let given = Document::read(&input);
        for (mesh, old) in
            out.json["meshes"].as_array().expect("some").iter().zip(given.json["meshes"].as_array().expect("some"))
        {
            for (new, old) in
                mesh["primitives"].as_array().expect("some").iter().zip(old["primitives"].as_array().expect("some"))
            {
                for (name, index) in old["attributes"].as_object().expect("attributes") {
                    assert_eq!(out.elements(&new["attributes"][name]), given.elements(index), "{name}");
                }
            }
        }
        // Annotating in the other layout finds nothing of this one left.
        annotate(&path("out.glb"), &path("faces.glb"), &[]);
        assert!(!fs::read_to_string(path("faces.glb")).is_ok_and(|text| text.contains("OSCULATE_face_values")));
        annotate(&path("out.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
        assert_same(&input, &path("bare.glb"), "bare");
    }
}

/// A CSV without the column `method`, which glTF does not hold.
pub(crate) fn without_method(csv: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(csv).expect("a CSV");
    let column = text.lines().next().and_then(|head| head.split(',').position(|name| name == "method"));
    let fields =
        |line: &str| line.split(',').enumerate().filter(|(i, _)| Some(*i) != column).map(|f| f.1.into()).collect();
    text.lines().map(fields).collect()
}

#[test]
fn values_in_a_file_are_used_again_bit_by_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("scene.glb"), &path("once.csv"), &[]);
    for layout in ["faces", "indexed"] {
        let extra = ["--layout", layout, "--attributes", "default,radius,dir_min", "--radius-factor", "3"];
        annotate(&fixture("scene.glb"), &path("out.glb"), &extra);
        annotate(&fixture("scene.glb"), &path("once.csv"), &extra[4..]);
        let said = annotate(&path("out.glb"), &path("again.csv"), &[]);
        assert!(said.contains("--reuse"), "offered: {said}");
        let stats = path("stats.json");
        annotate(&path("out.glb"), &path("again.csv"), &["--reuse", "--stats", stats.to_str().expect("text")]);
        assert_eq!(without_method(&path("once.csv")), without_method(&path("again.csv")));
        let stats: Value = serde_json::from_slice(&fs::read(stats).expect("statistics")).expect("JSON");
        assert_eq!(
            (&stats["settings"]["radius_factor"], &stats["settings"]["reused"]),
            (&"3:face".into(), &true.into())
        );
    }
    let refused = run(&fixture("scene.glb"), &path("none.csv"), &["--reuse"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no values of Osculate's"));
    assert!(!path("none.csv").exists());
}
