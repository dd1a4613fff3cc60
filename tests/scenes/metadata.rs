//! `--metadata`: a table of faces, and its rows in the vertices.

use crate::document::{Document, assert_same};
use crate::odd::write_glb;
use crate::{annotate, column, fixture, run};
use serde_json::{Value, json};
use std::fs;

fn table(out: &Document) -> Value {
    out.json["extensions"]["EXT_structural_metadata"]["propertyTables"]
        .as_array()
        .expect("tables")
        .last()
        .expect("ours")
        .clone()
}

#[test]
fn every_corner_names_the_row_with_the_values_of_its_face() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for (name, select) in [("suzanne.stl", &[][..]), ("character.glb", &[]), ("scene.gltf", &["--select", "k_max>0.2"])]
    {
        let select = [select, &["--up", "y"]].concat();
        annotate(&fixture(name), &path("out.csv"), &select);
        annotate(&fixture(name), &path("out.glb"), &[&select[..], &["--metadata"]].concat());
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let out = Document::read(&path("out.glb"));
        let table = table(&out);
        let rows = csv.lines().count() - 1;
        assert_eq!(table["count"], rows);
        let bytes = |name: &str| out.view(&table["properties"][name]["values"]).0;
        let floats = |bytes: &[u8]| bytes.as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect::<Vec<_>>();
        for name in ["k_max", "gauss", "coverage"] {
            assert_eq!(floats(bytes(name)), column(&csv, name), "{name}");
        }
        let y: Vec<f32> = floats(bytes("dir_max")).into_iter().skip(1).step_by(3).collect();
        assert_eq!(y, column(&csv, "dir_max_y"));
        assert_eq!(bytes("class").iter().map(|&b| f32::from(b as i8)).collect::<Vec<_>>(), column(&csv, "class"));
        let faces: Vec<f32> = bytes("face").as_chunks().0.iter().map(|&b| u32::from_le_bytes(b) as f32).collect();
        assert_eq!(faces, column(&csv, "face"));
        let mut next = 0;
        for primitive in out.json["meshes"]
            .as_array()
            .expect("meshes")
            .iter()
            .flat_map(|m| m["primitives"].as_array().expect("some"))
        {
            let ids = primitive["extensions"]["EXT_mesh_features"]["featureIds"].as_array().expect("feature ids");
            let stored = floats(
                &out.elements(&primitive["attributes"][format!("_FEATURE_ID_{}", ids[0]["attribute"])]).concat(),
            );
            let corners = out.corners(primitive, stored.len());
            assert_eq!(ids[0]["featureCount"], corners.len() / 3);
            for corners in corners.chunks_exact(3) {
                assert!(corners.iter().all(|&c| stored[c] == next as f32));
                next += 1;
            }
        }
        assert_eq!(next, rows);
    }
}

#[test]
fn another_run_takes_the_table_out_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf"] {
        annotate(&fixture(name), &path("once.glb"), &["--metadata"]);
        annotate(&path("once.glb"), &path("twice.glb"), &["--metadata"]);
        assert!(fs::read(path("once.glb")).expect("a GLB") == fs::read(path("twice.glb")).expect("a GLB"), "{name}");
        annotate(&path("once.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
        assert_same(&fixture(name), &path("bare.glb"), name);
        assert!(!Document::read(&path("bare.glb")).json.to_string().contains("EXT_"));
    }
}

/// A quad of two triangles with a schema, a table and feature ids of somebody else's.
fn with_metadata() -> (Value, Vec<u8>) {
    let positions: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.5];
    let mut bin: Vec<u8> = positions.iter().flat_map(|c| c.to_le_bytes()).collect();
    bin.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()));
    bin.extend([0_f32; 5].iter().flat_map(|i| i.to_le_bytes()));
    let json = json!({
        "asset": { "version": "2.0" }, "extensionsUsed": ["EXT_mesh_features", "EXT_structural_metadata"],
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 16 }, { "buffer": 0, "byteOffset": 76, "byteLength": 4 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0.5] },
            { "bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 4, "type": "SCALAR" },
        ],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "_FEATURE_ID_0": 2 }, "indices": 1,
            "extensions": { "EXT_mesh_features": { "featureIds": [{ "featureCount": 1, "attribute": 0, "propertyTable": 0 }] } },
        }] }],
        "nodes": [{ "mesh": 0 }], "scenes": [{ "nodes": [0] }], "scene": 0,
        "extensions": { "EXT_structural_metadata": {
            "schema": { "id": "theirs", "classes": { "part": { "properties": {
                "mass": { "type": "SCALAR", "componentType": "FLOAT32" } } } } },
            "propertyTables": [{ "class": "part", "count": 1, "properties": { "mass": { "values": 3 } } }],
        } },
    });
    (json, bin)
}

#[test]
fn the_metadata_of_others_stays_beside_ours() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (mut json, bin) = with_metadata();
    write_glb(&path("theirs.glb"), &json, &bin);
    annotate(&path("theirs.glb"), &path("both.glb"), &["--metadata"]);
    let both = Document::read(&path("both.glb"));
    let metadata = &both.json["extensions"]["EXT_structural_metadata"];
    assert_eq!(metadata["schema"]["id"], "theirs");
    assert!(
        metadata["schema"]["classes"]["part"].is_object() && metadata["schema"]["classes"]["osculate_face"].is_object()
    );
    let ids = &both.json["meshes"][0]["primitives"][0]["extensions"]["EXT_mesh_features"]["featureIds"];
    assert_eq!(
        (&ids[0]["propertyTable"], &ids[1]["propertyTable"], &ids[1]["attribute"]),
        (&0.into(), &1.into(), &1.into())
    );
    annotate(&path("both.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
    let bare = Document::read(&path("bare.glb"));
    assert_eq!(
        bare.json["extensions"]["EXT_structural_metadata"]["schema"],
        json["extensions"]["EXT_structural_metadata"]["schema"]
    );
    assert_same(&path("theirs.glb"), &path("bare.glb"), "theirs");

    json["extensions"]["EXT_structural_metadata"] = json!({ "schemaUri": "schema.json" });
    write_glb(&path("apart.glb"), &json, &bin);
    let refused = run(&path("apart.glb"), &path("no.glb"), &["--metadata"]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(refused.status.code() == Some(1) && said.contains("schemaUri"), "{said}");
    assert!(!path("no.glb").exists());
}
