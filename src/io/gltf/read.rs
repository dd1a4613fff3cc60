//! A glTF document as a soup: meshes become bodies, primitives groups, nodes the scene.

use super::accessor::Accessors;
use super::buffers::{Buffers, Source};
use super::container;
use super::geometry::{DRACO, Geometry, Material, draco_error, surface_mode};
use super::meshopt::NAMES as MESHOPT;
use super::scene::{SceneRoots, read_scene};
use super::uri::has_scheme;
use crate::error::ParseError;
use crate::io::folders::Folders;
use crate::soup::{Note, Positions, Soup};
use gltf_json::{Accessor, Asset, Buffer, Index, Mesh, buffer::View};
use percent_encoding::percent_decode_str;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Extensions that need no word when a file requires them: they leave positions, indices and nodes
/// alone, or are handled.
const HARMLESS: [&str; 9] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
];

/// What of a document matters to geometry.
///
/// `gltf_json::Root` would be refused as a whole for a flaw in an animation or an image, and for a
/// scene without nodes, which the specification allows.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document {
    asset: Asset,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) buffer_views: Vec<View>,
    /// Not looked into but for the files they name.
    #[serde(default)]
    images: serde_json::Value,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    #[serde(default)]
    materials: Vec<Material>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    nodes: Vec<gltf_json::Node>,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<SceneRoots>,
}

/// Reads a `.glb` or a `.gltf` file. `folders` are where its external buffers are looked for.
///
/// # Errors
/// Place and reason where the file is not glTF 2.0, its geometry cannot be found, or there are no
/// triangles in it.
pub(in crate::io) fn read<'a>(bytes: &'a [u8], folders: impl Into<Folders<'a>>) -> Result<Soup, ParseError> {
    let folders = folders.into();
    let mut notes = Vec::new();
    let (document, bin) = if container::is_glb(bytes) {
        let chunks = container::split(bytes, &mut notes)?;
        (parse(chunks.json, " of the JSON chunk")?, chunks.bin)
    } else {
        (parse(bytes, "")?, None)
    };
    check_version(&document.asset.version)?;
    let meshopt_required = check_extensions(&document.extensions_required, &mut notes)?;
    let source = Source { file: bytes, bin, folders };
    let buffers = Buffers::new(&document.buffers, &document.buffer_views, meshopt_required, source);

    let mut geometry = Geometry::new(Accessors::new(&document.accessors, buffers), &document.materials, notes);
    let bodies = (document.meshes.iter().enumerate())
        .map(|(index, mesh)| geometry.add_mesh(index, mesh))
        .collect::<Result<Vec<_>, _>>()?;
    if geometry.triangles.is_empty() {
        return Err(ParseError::file(format!("there are no triangles: {}", why_empty(&document))));
    }
    let mut scene = read_scene(&document.nodes, &document.scenes, document.scene, &bodies, &mut geometry.notes)?;
    scene.primitives = std::mem::take(&mut geometry.primitives);
    note_the_rest(&document, &bodies, &mut geometry);
    Ok(Soup {
        positions: Positions::F32(geometry.positions),
        triangles: geometry.triangles,
        bodies: geometry.bodies,
        groups: geometry.groups,
        scene: Some(scene),
        notes: geometry.notes,
        files: folders.base().map(|folder| named_files(&document, folder)).unwrap_or_default(),
        metres_per_unit: Some(1.0),
    })
}

/// The files that the document names: an output must not replace them.
fn named_files(document: &Document, folder: &Path) -> Vec<PathBuf> {
    let buffers = document.buffers.iter().filter_map(|buffer| buffer.uri.as_deref());
    let images = document.images.as_array().into_iter().flatten().filter_map(|image| image.get("uri")?.as_str());
    let relative = buffers.chain(images).filter(|uri| !has_scheme(uri));
    relative.filter_map(|uri| Some(folder.join(&*percent_decode_str(uri).decode_utf8().ok()?))).collect()
}

pub(super) fn parse(json: &[u8], whose: &str) -> Result<Document, ParseError> {
    serde_json::from_slice(json).map_err(|error| {
        /// A version 1 document fails on its shape first, which would be a riddle to its owner.
        #[derive(Deserialize)]
        struct Head {
            asset: Version,
        }
        #[derive(Deserialize)]
        struct Version {
            version: String,
        }
        if let Ok(head) = serde_json::from_slice::<Head>(json)
            && let Err(version) = check_version(&head.asset.version)
        {
            return version;
        }
        let (line, column) = (error.line() as u64, error.column());
        let text = error.to_string();
        let what = text.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&text);
        ParseError::line(line, format!("{what}, at column {column}{whose}"))
    })
}

fn check_version(version: &str) -> Result<(), ParseError> {
    match version.split('.').next() {
        Some("2") => Ok(()),
        _ => Err(ParseError::json("asset.version", format!("this is glTF {version}; only version 2 can be read"))),
    }
}

fn why_empty(document: &Document) -> &'static str {
    let mut primitives = document.meshes.iter().flat_map(|mesh| &mesh.primitives).peekable();
    if primitives.peek().is_none() {
        "the file has no meshes"
    } else if primitives.all(|primitive| surface_mode(primitive).is_none()) {
        "the meshes hold only points or lines"
    } else {
        "no mesh has a whole triangle whose vertices are in the file"
    }
}

/// True when compressed views have no other content to fall back on.
pub(super) fn requires_meshopt(required: &[String]) -> bool {
    required.iter().any(|name| MESHOPT.contains(&name.as_str()))
}

/// Refuses what makes the geometry unreadable and tells whether meshopt is required.
fn check_extensions(required: &[String], notes: &mut Vec<Note>) -> Result<bool, ParseError> {
    let mut meshopt = false;
    for (i, name) in required.iter().enumerate() {
        if name == DRACO {
            return Err(draco_error(format!("extensionsRequired[{i}]")));
        } else if MESHOPT.contains(&name.as_str()) {
            meshopt = true;
        } else if !HARMLESS.iter().any(|known| name.starts_with(known)) {
            notes.push(Note::repaired(format!("the required extension {name} is not known and was ignored")));
        }
    }
    Ok(meshopt)
}

/// Notes on what concerns the file as a whole.
fn note_the_rest(document: &Document, bodies: &[Option<usize>], geometry: &mut Geometry<'_>) {
    let body = |mesh: Option<Index<Mesh>>| mesh.and_then(|mesh| bodies.get(mesh.value()).copied().flatten());
    if let Some((count, first)) = geometry.skipped.take() {
        geometry
            .notes
            .push(Note::info(format!("primitives of points or lines were skipped: {count}, the first is {first}")));
    }
    if document.nodes.iter().any(|node| node.skin.is_some() && body(node.mesh).is_some()) {
        geometry.notes.push(Note::info("skinned meshes are read in their rest pose"));
    }
    let mut used = document.meshes.iter().zip(bodies).filter(|(_, body)| body.is_some()).map(|(mesh, _)| mesh);
    if used.any(|mesh| mesh.primitives.iter().any(|p| p.targets.as_ref().is_some_and(|t| !t.is_empty()))) {
        geometry.notes.push(Note::info("meshes with morph targets are read without them"));
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::container::tests::glb_of;
    use super::*;
    use crate::soup::{Group, PrimitiveFaces, Scene};
    use serde_json::{Value, json};

    const CORNERS: [[f32; 3]; 5] =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 1.0]];

    /// Five positions, then bytes of indices, in the first buffer; the document gets buffers and
    /// views for them and the given parts.
    fn document(indices: &[u8], parts: &Value) -> (Value, Vec<u8>) {
        let mut bin: Vec<u8> = CORNERS.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        bin.extend(indices);
        let mut document = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": bin.len() }],
            "bufferViews": [
                { "buffer": 0, "byteLength": 60 },
                { "buffer": 0, "byteOffset": 60, "byteLength": indices.len() }
            ],
            "accessors": [
                { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3" },
                { "bufferView": 1, "componentType": 5121, "count": indices.len(), "type": "SCALAR" }
            ],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }]
        });
        for (key, value) in parts.as_object().expect("an object") {
            document[key] = value.clone();
        }
        (document, bin)
    }

    fn glb(indices: &[u8], parts: &Value) -> Vec<u8> {
        let (document, bin) = document(indices, parts);
        glb_of(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &bin)])
    }

    pub(in crate::io::gltf) fn read_glb(indices: &[u8], parts: &Value) -> Result<Soup, ParseError> {
        read(&glb(indices, parts), None)
    }

    pub(in crate::io::gltf) fn error_of(indices: &[u8], parts: &Value) -> String {
        read_glb(indices, parts).expect_err("an error").to_string()
    }

    pub(in crate::io::gltf) fn primitives(list: &Value) -> Value {
        json!({ "meshes": [{ "primitives": list }] })
    }

    #[test]
    fn a_glb_becomes_a_soup() {
        let soup = read_glb(&[0, 1, 2, 2, 1, 3], &json!({})).expect("readable");
        assert_eq!(soup.positions, Positions::F32(CORNERS.to_vec()));
        assert_eq!(soup.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(soup.bodies, [Group { name: String::new(), faces: 0..2 }]);
        assert_eq!(soup.groups, soup.bodies);
        assert!(soup.notes.is_empty());
        let primitives = vec![PrimitiveFaces { mesh: 0, primitive: 0, faces: 0..2 }];
        assert_eq!(soup.scene, Some(Scene { primitives, ..Scene::default() }));
    }

    #[test]
    fn a_gltf_finds_its_buffer_in_the_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut document, bin) = document(&[0, 1, 2], &json!({}));
        document["buffers"][0]["uri"] = json!("my%20data.bin");
        std::fs::write(folder.path().join("my data.bin"), bin).expect("a file");
        let text = document.to_string();
        assert_eq!(read(text.as_bytes(), Some(folder.path())).expect("readable").triangles, [[0, 1, 2]]);
        let error = read(text.as_bytes(), None).expect_err("no folder").to_string();
        assert!(error.starts_with("buffers[0].uri: ") && error.contains("stream"), "{error}");
        document["buffers"][0]["uri"] = json!("../data.bin");
        let error = read(document.to_string().as_bytes(), Some(folder.path())).expect_err("above").to_string();
        assert!(error.starts_with("buffers[0].uri: "), "{error}");
    }

    #[test]
    fn buffers_that_geometry_does_not_need_are_left_alone() {
        let (document, bin) = document(&[0, 1, 2], &json!({}));
        let mut document = document;
        document["buffers"].as_array_mut().expect("a list").push(json!({ "byteLength": 9, "uri": "http://gone/x" }));
        document["images"] = json!("nonsense");
        document["animations"] = json!([{ "channels": 3 }]);
        let file = glb_of(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &bin)]);
        assert_eq!(read(&file, None).expect("readable").face_count(), 1);
    }

    #[test]
    fn files_without_triangles_say_why() {
        for (parts, why) in [
            (json!({ "meshes": [] }), "no meshes"),
            (primitives(&json!([{ "attributes": { "POSITION": 0 }, "mode": 0 }])), "only points or lines"),
            (primitives(&json!([{ "attributes": {} }])), "whole triangle"),
            (primitives(&json!([{ "attributes": { "POSITION": 0 }, "indices": 1 }])), "whole triangle"),
        ] {
            assert!(error_of(&[0], &parts).contains(why), "{why}");
        }
    }

    #[test]
    fn skins_and_morph_targets_are_mentioned() {
        let parts = json!({
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "targets": [{ "POSITION": 0 }] }] }],
            "nodes": [{ "mesh": 0, "skin": 0 }]
        });
        let notes = read_glb(&[0, 1, 2], &parts).expect("readable").notes;
        assert_eq!(notes.iter().filter(|n| !n.repaired).count(), 2);
        assert!(notes[0].message.contains("rest pose") && notes[1].message.contains("morph"));
    }

    #[test]
    fn required_extensions_are_judged_by_what_they_do_to_geometry() {
        let read = |name: &str| read_glb(&[0, 1, 2], &json!({ "extensionsRequired": [name] }));
        for name in [
            "KHR_mesh_quantization",
            "KHR_materials_unlit",
            "KHR_texture_basisu",
            "EXT_texture_webp",
            "EXT_meshopt_compression",
        ] {
            assert!(read(name).expect(name).notes.is_empty(), "{name}");
        }
        let notes = read("ACME_bones").expect("readable").notes;
        assert!(notes[0].repaired && notes[0].message.contains("ACME_bones is not known and was ignored"));
        assert!(read(DRACO).expect_err("draco").to_string().contains("gltf-transform copy"));
        let blank = json!({
            "accessors": [{ "componentType": 5126, "count": 5, "type": "VEC3" }],
            "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "extensions": { DRACO: { "bufferView": 0 } } }] }]
        });
        assert!(error_of(&[], &blank).starts_with("meshes[0].primitives[0].extensions: "));
    }

    #[test]
    fn another_version_is_refused_by_name() {
        assert!(
            error_of(&[], &json!({ "asset": { "version": "3.1" } })).starts_with("asset.version: this is glTF 3.1")
        );
        // Found by a fuzzer: a version with an end of line in it.
        let error = error_of(&[], &json!({ "asset": { "version": "ve\n" } }));
        assert!(error.contains("glTF ve?;"), "{error}");
        let first = br#"{ "asset": { "version": "1.0" }, "nodes": { "a": {} }, "meshes": {} }"#;
        assert!(read(first, None).expect_err("version 1").to_string().contains("glTF 1.0"));
    }

    #[test]
    fn bad_json_has_a_line_and_a_column() {
        let error = read(b"{\n \"asset\": { \"version\": 2 }\n}", None).expect_err("a number").to_string();
        assert!(error.starts_with("line 2: invalid type") && error.contains("at column 24"), "{error}");
        let error = read(&glb_of(&[(b"JSON", b"{]")]), None).expect_err("a bracket").to_string();
        assert!(error.starts_with("line 1: ") && error.ends_with("at column 2 of the JSON chunk"), "{error}");
    }

    #[test]
    fn wrong_references_are_named_by_their_path() {
        for (parts, path) in [
            (primitives(&json!([{ "attributes": { "POSITION": 7 } }])), "meshes[0].primitives[0].attributes.POSITION"),
            (
                primitives(&json!([{ "attributes": { "POSITION": 0 }, "indices": 9 }])),
                "meshes[0].primitives[0].indices",
            ),
            (primitives(&json!([{ "attributes": { "POSITION": 0 }, "mode": 7 }])), "meshes[0].primitives[0].mode"),
            (json!({ "nodes": [{ "mesh": 4 }] }), "nodes[0].mesh"),
            (json!({ "nodes": [{ "children": [1] }] }), "nodes[0].children[0]"),
            (json!({ "nodes": [{}], "scenes": [{ "nodes": [0, 1] }] }), "scenes[0].nodes[1]"),
            (json!({ "scene": 2 }), "scene"),
            (json!({ "bufferViews": [] }), "accessors[0].bufferView"),
            (json!({ "buffers": [] }), "bufferViews[0].buffer"),
        ] {
            let error = error_of(&[0, 1, 2], &parts);
            assert!(error.starts_with(&format!("{path}: ")), "{path}: {error}");
        }
    }

    #[test]
    fn huge_numbers_are_errors() {
        let (sound, bin) = document(&[0, 1, 2], &json!({ "nodes": [{ "mesh": 0 }] }));
        for (pointer, key) in [
            ("/accessors/0", "count"),
            ("/accessors/1", "count"),
            ("/accessors/0", "byteOffset"),
            ("/accessors/1", "byteOffset"),
            ("/bufferViews/0", "byteOffset"),
            ("/bufferViews/1", "byteOffset"),
            ("/bufferViews/0", "byteStride"),
        ] {
            for huge in [1 << 20, u64::from(u32::MAX), 1 << 32, 1 << 62, u64::MAX - 3, u64::MAX] {
                let mut document = sound.clone();
                document.pointer_mut(pointer).expect("there")[key] = json!(huge);
                let file = glb_of(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &bin)]);
                read(&file, None).expect_err(key);
                // A view that promises as much must not be believed either.
                document["bufferViews"][0]["byteLength"] = json!(u64::MAX);
                document["bufferViews"][1]["byteLength"] = json!(u64::MAX);
                let file = glb_of(&[(b"JSON", document.to_string().as_bytes()), (b"BIN\0", &bin)]);
                read(&file, None).expect_err(key);
            }
        }
    }

    #[test]
    fn a_glb_cut_anywhere_is_an_error() {
        let whole = glb(&[0, 1, 2, 2, 1, 3, 0, 0], &json!({ "nodes": [{ "mesh": 0 }] }));
        assert!(read(&whole, None).is_ok());
        for length in 0..whole.len() {
            read(&whole[..length], None).expect_err("a part of a file");
        }
    }

    #[test]
    fn a_glb_with_any_byte_changed_does_no_harm() {
        let whole = glb(&[0, 1, 2, 2, 1, 3, 0, 0], &json!({ "nodes": [{ "mesh": 0, "children": [1] }, {}] }));
        for at in 0..whole.len() {
            for value in [0, b'9', b'-', 0xff] {
                let mut file = whole.clone();
                file[at] = value;
                if let Ok(soup) = read(&file, None) {
                    assert!(soup.triangles.as_flattened().iter().all(|&v| (v as usize) < soup.positions.len()));
                }
            }
        }
    }
}
