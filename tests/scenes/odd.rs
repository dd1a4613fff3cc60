//! Scenes of what exporters seldom write.

use crate::document::{Document, assert_same};
use crate::{annotate, run};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A scene of everything that exporters seldom write: shared and sparse accessors, interleaved views,
/// narrow attributes, strips, lines over the same vertices, unknown extensions with data, foreign
/// variants, extras that are no objects.
pub(crate) fn odd_scene() -> (Value, Vec<u8>) {
    let mut bin: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let mut view = |bytes: &[u8], stride: Option<usize>| {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        views.push(view);
        bin.extend_from_slice(bytes);
        views.len() - 1
    };
    let grid = 4;
    // Position and texture coordinate side by side.
    let mut both = Vec::new();
    for i in 0..grid {
        for j in 0..grid {
            let (x, y) = (i as f32, j as f32);
            for c in [x, y, 0.3 * x * x - 0.2 * y * y, x / 3.0, y / 3.0] {
                both.extend(c.to_le_bytes());
            }
        }
    }
    let both = view(&both, Some(20));
    let colors: Vec<u8> = (0..4 * grid * grid).map(|i| (i * 13 % 256) as u8).collect();
    let colors = view(&colors, Some(4));
    let mut triangles: Vec<u16> = Vec::new();
    for i in 0..grid - 1 {
        for j in 0..grid - 1 {
            let a = i * grid + j;
            triangles.extend([a, a + grid, a + grid + 1, a, a + grid + 1, a + 1].map(|v| v as u16));
        }
    }
    let half = triangles.len() / 2;
    let bytes = |list: &[u16]| list.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>();
    let first = view(&bytes(&triangles[..half]), None);
    let second = view(&bytes(&triangles[half..]), None);
    let strip = view(&[0, 4, 1, 5, 2, 6, 3, 7], None);
    let places = view(&bytes(&[2, 9]), None);
    let deltas: Vec<u8> = [0.5f32, 0.0, 0.25, 0.0, -0.5, 0.125].iter().flat_map(|c| c.to_le_bytes()).collect();
    let deltas = view(&deltas, None);
    let secret = view(b"the data of an extension nobody knows", None);
    let joined = bin.len();
    let points = grid * grid;
    let accessor = |view: usize, offset: usize, component: u32, count: usize, shape: &str| json!({ "bufferView": view, "byteOffset": offset, "componentType": component, "count": count, "type": shape });
    let mut position = accessor(both, 0, 5126, points, "VEC3");
    position["min"] = json!([0.0, 0.0, -1.8]);
    position["max"] = json!([3.0, 3.0, 2.7]);
    position["extras"] = json!("kept");
    let mut color = accessor(colors, 0, 5121, points, "VEC3");
    color["normalized"] = true.into();
    let morph = json!({ "componentType": 5126, "count": points, "type": "VEC3", "min": [0.0, -0.5, 0.0], "max": [0.5, 0.0, 0.25],
        "sparse": { "count": 2, "indices": { "bufferView": places, "componentType": 5123 }, "values": { "bufferView": deltas } } });
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2 });
    let variant = json!({ "KHR_materials_variants": { "mappings": [{ "material": 1, "variants": [0, 1] }] }, "ACME_more": { "x": [1, 2] } });
    let document = json!({
        "asset": { "version": "2.0", "copyright": "someone", "generator": "something", "extras": [1] },
        "extensionsUsed": ["KHR_materials_variants", "ACME_data", "ACME_more"],
        "extensions": {
            "KHR_materials_variants": { "variants": [{ "name": "mean" }, { "name": "dusk" }] },
            "ACME_data": { "bufferView": secret, "n": 7 }
        },
        "buffers": [{ "byteLength": joined, "name": "all", "extras": { "a": 1 } }],
        "bufferViews": views,
        "accessors": [
            position, accessor(both, 12, 5126, points, "VEC2"), color, accessor(first, 0, 5123, half, "SCALAR"),
            accessor(second, 0, 5123, half, "SCALAR"), accessor(strip, 0, 5121, 8, "SCALAR"), morph
        ],
        "materials": [{ "name": "a", "extras": { "b": [true] } }, { "alphaMode": "MASK" }],
        "meshes": [
            { "name": "split", "extras": { "theirs": 1 }, "weights": [0.5], "primitives": [
                { "attributes": attributes, "indices": 3, "material": 0, "targets": [{ "POSITION": 6 }], "extensions": variant },
                { "attributes": attributes, "indices": 4, "targets": [{ "POSITION": 6 }] },
                { "attributes": { "POSITION": 0 }, "mode": 0 }
            ] },
            { "extras": 5, "primitives": [{ "attributes": attributes, "indices": 5, "mode": 5 }] }
        ],
        "nodes": [{ "mesh": 0, "name": "n" }, { "mesh": 1, "scale": [1, 2, 1] }, { "mesh": 0, "translation": [0, 0, 5] }],
        "scenes": [{ "nodes": [0, 1] }, { "name": "second", "nodes": [2] }],
        "scene": 0
    });
    (document, bin)
}

pub(crate) fn write_glb(path: &Path, json: &Value, bin: &[u8]) {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    for word in [2, 28 + json.len() + bin.len(), json.len(), 0x4e4f_534a] {
        file.extend((word as u32).to_le_bytes());
    }
    file.extend(&json);
    file.extend((bin.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&bin);
    fs::write(path, file).expect("writable");
}

#[test]
fn odd_scenes_come_out_as_they_went_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    for (output, extra) in [("out.glb", &[][..]), ("out.gltf", &["--variants", "k_max,class", "--attributes", "all"])] {
        annotate(&path("odd.glb"), &path(output), extra);
        assert_same(&path("odd.glb"), &path(output), output);
        annotate(&path(output), &path("bare.glb"), &["--color-by", "none", "--attributes", "none"]);
        assert_same(&path("odd.glb"), &path("bare.glb"), output);
    }
    let out = Document::read(&path("out.gltf"));
    assert_eq!(out.json["buffers"][0]["name"], "all");
    let names: Vec<&Value> = out.json["extensions"]["KHR_materials_variants"]["variants"]
        .as_array()
        .expect("some")
        .iter()
        .map(|v| &v["name"])
        .collect();
    assert_eq!(names, ["mean", "dusk", "k_max", "class"]);
    // Points over the same vertices see as many of them as before.
    let points = &out.json["meshes"][0]["primitives"][2]["attributes"]["POSITION"];
    assert_eq!(out.elements(points).len(), 16);
    // Every face carries its own number in all of its corners.
    let mut face = 0;
    for (mesh, primitive) in [(0, 0), (0, 1), (1, 0)] {
        let primitive = &out.json["meshes"][mesh]["primitives"][primitive];
        let numbers = out.elements(&primitive["attributes"]["_FACE_ID"]);
        for corners in out.corners(primitive, numbers.len()).chunks_exact(3) {
            assert!(corners.iter().all(|&c| numbers[c] == (face as f32).to_le_bytes()), "face {face}");
            face += 1;
        }
    }
    assert_eq!(face, 9 + 9 + 6);
}

#[test]
fn vertices_are_split_only_where_values_differ() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    let vertices = |extra: &[&str]| {
        annotate(&path("odd.glb"), &path("out.glb"), extra);
        let out = Document::read(&path("out.glb"));
        out.elements(&out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]).len()
    };
    assert_eq!(vertices(&[]), 3 * 18, "every face has a number of its own");
    assert_eq!(vertices(&["--attributes", "none", "--color-by", "none"]), 16);
    let by_class = vertices(&["--attributes", "class", "--color-by", "class"]);
    assert!((16..40).contains(&by_class), "{by_class}");
}

#[test]
fn a_foreign_attribute_stays_unless_it_is_to_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (mut json, bin) = odd_scene();
    // One of another origin with the very name of ours: here the first coordinates.
    json["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(json!({ "bufferView": 0, "componentType": 5126, "count": 16, "type": "SCALAR" }));
    json["meshes"][1]["primitives"][0]["attributes"]["_COVERAGE"] = 7.into();
    write_glb(&path("odd.glb"), &json, &bin);
    let said = annotate(&path("odd.glb"), &path("out.glb"), &[]);
    assert!(said.contains("meshes[1].primitives[0] has an attribute _COVERAGE of its own"), "{said}");
    let values = |name: &str| {
        let out = Document::read(&path(name));
        let of = &out.json["meshes"][1]["primitives"][0]["attributes"]["_COVERAGE"];
        out.elements(of).into_iter().take(16).flatten().collect::<Vec<u8>>()
    };
    assert_eq!(values("out.glb"), values("odd.glb"));
    assert!(!annotate(&path("odd.glb"), &path("forced.glb"), &["--force"]).contains("of its own"));
    assert_ne!(values("forced.glb"), values("odd.glb"));
    // Attributes that do not fit their mesh are left out, and that is said.
    json["accessors"][7]["count"] = 15.into();
    write_glb(&path("odd.glb"), &json, &bin);
    let run = run(&path("odd.glb"), &path("out.glb"), &[]);
    assert_eq!(run.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&run.stderr).contains("_COVERAGE has 15 elements for 16 vertices"));
}
