//! `--select`: a file with some of the faces, under their old numbers.

use crate::document::Document;
use crate::tables::{array, f32s};
use crate::{annotate, column, fixture, run};
use serde_json::Value;
use std::fs;
use std::path::Path;

const SADDLES: [&str; 2] = ["--select", "class=hyperbolic and k_max>0.1"];

/// Face number and k_max of every face of a document, from the first corner of each, or from our extension.
fn faces_of(out: &Document) -> Vec<(f32, f32)> {
    let mut found = Vec::new();
    let float = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().expect("4 bytes"));
    for primitive in out.json["meshes"].as_array().expect("meshes").iter().flat_map(|m| m["primitives"].as_array()) {
        for primitive in primitive {
            let values = &primitive["extensions"]["OSCULATE_face_values"]["values"];
            if values.is_object() {
                let [ids, k] = ["face", "k_max"].map(|name| out.elements(&values[name]["accessor"]));
                found.extend(ids.iter().zip(&k).map(|(id, k)| (float(id), float(k))));
            } else if primitive["attributes"]["_FACE_ID"].is_u64() {
                let ids = out.elements(&primitive["attributes"]["_FACE_ID"]);
                let k = out.elements(&primitive["attributes"]["_CURVATURE_MAX"]);
                for corner in out.corners(primitive, ids.len()).into_iter().step_by(3) {
                    found.push((float(&ids[corner]), float(&k[corner])));
                }
            }
        }
    }
    found
}

/// The same from a CSV of all faces, for those that fulfil the condition.
fn expected(csv: &Path) -> Vec<(f32, f32)> {
    let csv = fs::read_to_string(csv).expect("a CSV");
    let [face, class, k_max] = ["face", "class", "k_max"].map(|name| column(&csv, name));
    let chosen = (0..face.len()).filter(|&f| class[f] == 4.0 && k_max[f] > 0.1);
    chosen.map(|f| (face[f], k_max[f])).collect()
}

#[test]
fn only_the_chosen_faces_are_written_with_the_values_and_numbers_they_have() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["suzanne.stl", "scene.gltf", "character.glb", "two_meshes.glb"] {
        annotate(&fixture(name), &path("all.csv"), &[]);
        let expected = expected(&path("all.csv"));
        assert!(!expected.is_empty());
        for layout in ["faces", "indexed"] {
            annotate(&fixture(name), &path("some.glb"), &[&SADDLES[..], &["--layout", layout]].concat());
            assert_eq!(faces_of(&Document::read(&path("some.glb"))), expected, "{name} {layout}");
            // It is a mesh like any other.
            annotate(&path("some.glb"), &path("again.csv"), &[]);
            let again = fs::read_to_string(path("again.csv")).expect("a CSV");
            assert_eq!(again.lines().count(), 1 + expected.len(), "{name} {layout}");
        }
        annotate(&fixture(name), &path("some.csv"), &SADDLES);
        let csv = fs::read_to_string(path("some.csv")).expect("a CSV");
        let rows: Vec<_> = column(&csv, "face").into_iter().zip(column(&csv, "k_max")).collect();
        assert_eq!(rows, expected, "{name} CSV");
    }
}

#[test]
fn tables_hold_the_chosen_faces_and_the_vertices_they_use() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("suzanne.stl"), &path("all.csv"), &[]);
    let expected = expected(&path("all.csv"));
    let extra = [&SADDLES[..], &["--vertex-values"]].concat();
    annotate(&fixture("suzanne.stl"), &path("some.npz"), &extra);
    let npz = fs::read(path("some.npz")).expect("an archive");
    assert_eq!(f32s(&array(&npz, "k_max").2), expected.iter().map(|(_, k)| *k).collect::<Vec<_>>());
    let words = |name: &str| -> Vec<u32> {
        array(&npz, name).2.as_chunks().0.iter().map(|&bytes| u32::from_le_bytes(bytes)).collect()
    };
    assert_eq!(
        words("face").iter().map(|&f| f as f32).collect::<Vec<_>>(),
        expected.iter().map(|e| e.0).collect::<Vec<_>>()
    );
    let mut corners = words("faces");
    corners.sort_unstable();
    corners.dedup();
    assert_eq!(corners, (0..corners.len() as u32).collect::<Vec<_>>(), "every vertex is used");
    for name in ["positions", "vertex_mean"] {
        assert!(array(&npz, name).1.starts_with(&format!("{},", corners.len())), "{name}");
    }
    annotate(&fixture("suzanne.stl"), &path("some.ply"), &extra);
    let ply = fs::read(path("some.ply")).expect("a PLY");
    let header = String::from_utf8_lossy(&ply[..2000]).into_owned();
    assert!(header.contains(&format!("element vertex {}\n", corners.len())), "{header}");
    assert!(header.contains(&format!("element face {}\n", expected.len())) && header.contains("property uint face\n"));
    annotate(&path("some.ply"), &path("again.csv"), &[]);
}

/// A mesh that loses all its faces takes its data with it; its node stays.
#[test]
fn what_only_lost_faces_used_goes_with_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(
        &fixture("scene.glb"),
        &path("some.glb"),
        &["--select", "face=0:1", "--stats", path("s.json").to_str().expect("text")],
    );
    let (input, out) = (Document::read(&fixture("scene.glb")), Document::read(&path("some.glb")));
    let count = |of: &Document, list: &str| of.json[list].as_array().map_or(0, Vec::len);
    assert_eq!((count(&out, "meshes"), count(&out, "nodes")), (1, count(&input, "nodes")));
    assert!(out.buffers[0].len() < input.buffers[0].len() / 2);
    let stats: Value = serde_json::from_slice(&fs::read(path("s.json")).expect("statistics")).expect("JSON");
    assert_eq!((&stats["selected_faces"], &stats["settings"]["select"]), (&2.into(), &"face=0:1".into()));
    // The 3MF's bodies too.
    annotate(&fixture("two_bodies.3mf"), &path("body.glb"), &["--select", "face=0:1"]);
    assert_eq!(count(&Document::read(&path("body.glb")), "meshes"), 1);
}

#[test]
fn a_condition_that_says_nothing_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("out.glb");
    for (condition, code, why) in [
        ("k_mux>1", 2, "unknown column \"k_mux\""),
        ("k_max", 2, "compares nothing"),
        ("k_max=2:1", 2, "is empty"),
        ("class=saddle", 2, "known are not_estimated, flat"),
        ("k_max>1e9", 1, "none of its 968 faces"),
    ] {
        let refused = run(&fixture("suzanne.stl"), &output, &["--select", condition]);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(code), "{condition}: {said}");
        assert!(said.contains(why), "{said}");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0, "{condition}");
    }
}
