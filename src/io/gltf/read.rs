//! A glTF document as a soup: meshes become bodies, primitives groups, nodes the scene.

use super::accessor::Accessors;
use super::buffers::{Buffers, Source};
use super::container;
use crate::error::ParseError;
use crate::soup::{Group, MAX_FACES, Node, Note, Positions, Scene, Soup, Transform};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::{Accessor, Asset, Buffer, Index, Mesh, buffer::View, validation::Checked};
use serde::Deserialize;
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// How many vertices or faces a document may expand to by sharing accessors: that many for
/// nothing, and beyond them that many for each byte of input. Without sharing there is less than
/// one per byte, so that no honest file comes near.
const FREE_ELEMENTS: usize = 1 << 24;
const ELEMENTS_PER_BYTE: usize = 16;

/// Faces name their vertices in 32 bits.
const MAX_VERTICES: usize = u32::MAX as usize;

const DRACO: &str = "KHR_draco_mesh_compression";
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Extensions that need no word when a file requires them: they leave positions, indices and nodes
/// alone, or are handled.
const HARMLESS: [&str; 10] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
    "KHR_meshopt_compression",
];

/// What of a document matters to geometry.
///
/// `gltf_json::Root` would be refused as a whole for a flaw in an animation or an image, and for a
/// scene without nodes, which the specification allows.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Asset,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffers: Vec<Buffer>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default)]
    extensions_required: Vec<String>,
    #[serde(default)]
    materials: Vec<Material>,
    #[serde(default)]
    meshes: Vec<Mesh>,
    #[serde(default)]
    nodes: Vec<gltf_json::Node>,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<SceneRoots>,
}

#[derive(Deserialize)]
struct Material {
    name: Option<String>,
}

#[derive(Deserialize)]
struct SceneRoots {
    #[serde(default)]
    nodes: Vec<usize>,
}

/// Reads a `.glb` or a `.gltf` file. `folder` is where its external buffers are looked for; `None`,
/// for a stream, makes them an error.
///
/// # Errors
/// Place and reason where the file is not glTF 2.0, its geometry cannot be found, or there are no
/// triangles in it.
pub(in crate::io) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<Soup, ParseError> {
    let mut notes = Vec::new();
    let (document, bin) = if container::is_glb(bytes) {
        let chunks = container::split(bytes, &mut notes)?;
        (parse(chunks.json, " of the JSON chunk")?, chunks.bin)
    } else {
        (parse(bytes, "")?, None)
    };
    check_version(&document.asset.version)?;
    let meshopt_required = check_extensions(&document.extensions_required, &mut notes)?;
    let source = Source { file: bytes, bin, folder };
    let buffers = Buffers::new(&document.buffers, &document.buffer_views, meshopt_required, source);

    let mut geometry = Geometry::new(Accessors::new(&document.accessors, buffers), &document.materials, notes);
    let bodies = (document.meshes.iter().enumerate())
        .map(|(index, mesh)| geometry.add_mesh(index, mesh))
        .collect::<Result<Vec<_>, _>>()?;
    if geometry.triangles.is_empty() {
        return Err(ParseError::file(format!("there are no triangles: {}", why_empty(&document))));
    }
    let scene = read_scene(&document, &bodies, &mut geometry.notes)?;
    geometry.note_the_rest(&document, &bodies);
    Ok(Soup {
        positions: Positions::F32(geometry.positions),
        triangles: geometry.triangles,
        bodies: geometry.bodies,
        groups: geometry.groups,
        scene: Some(scene),
        notes: geometry.notes,
    })
}

fn parse(json: &[u8], whose: &str) -> Result<Document, ParseError> {
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

fn draco_error(path: String) -> ParseError {
    let way_out = "`gltf-transform copy in.glb out.glb` decodes it";
    ParseError::json(path, format!("the mesh is compressed with {DRACO}, which is not read here; {way_out}"))
}

/// The geometry read so far.
struct Geometry<'a> {
    accessors: Accessors<'a>,
    materials: &'a [Material],
    positions: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    bodies: Vec<Group>,
    groups: Vec<Group>,
    notes: Vec<Note>,
    /// How many primitives are points or lines, and the path of the first.
    skipped: Option<(usize, String)>,
}

impl<'a> Geometry<'a> {
    fn new(accessors: Accessors<'a>, materials: &'a [Material], notes: Vec<Note>) -> Self {
        Geometry {
            accessors,
            materials,
            positions: Vec::new(),
            triangles: Vec::new(),
            bodies: Vec::new(),
            groups: Vec::new(),
            notes,
            skipped: None,
        }
    }

    /// Adds a mesh and gives the index of its body, if it has a face.
    fn add_mesh(&mut self, index: usize, mesh: &Mesh) -> Result<Option<usize>, ParseError> {
        let (first_face, first_position) = (self.triangles.len(), self.positions.len());
        // Where the positions of an accessor start: primitives that share them share vertices.
        let mut offsets = HashMap::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            self.add_primitive(&format!("meshes[{index}].primitives[{p}]"), primitive, &mut offsets)?;
        }
        if self.triangles.len() == first_face {
            self.positions.truncate(first_position);
            return Ok(None);
        }
        let faces = number(first_face)..number(self.triangles.len());
        self.bodies.push(Group { name: mesh.name.clone().unwrap_or_default(), faces });
        Ok(Some(self.bodies.len() - 1))
    }

    fn add_primitive(
        &mut self,
        path: &str,
        primitive: &Primitive,
        offsets: &mut HashMap<usize, Range<u32>>,
    ) -> Result<(), ParseError> {
        if primitive.mode == Checked::Invalid {
            return Err(ParseError::json(format!("{path}.mode"), "must be from 0 to 6"));
        }
        let Some(mode) = surface_mode(primitive) else {
            self.skipped.get_or_insert_with(|| (0, path.to_owned())).0 += 1;
            return Ok(());
        };
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.notes.push(Note::repaired(format!("{path} has no POSITION and was left out")));
            return Ok(());
        };
        let mut needed = [Some(accessor), primitive.indices].into_iter().flatten();
        let is_draco = primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key(DRACO));
        if is_draco && needed.any(|accessor| self.accessors.is_blank(accessor)) {
            return Err(draco_error(format!("{path}.extensions")));
        }
        let vertices = match offsets.get(&accessor.value()) {
            Some(known) => known.clone(),
            None => {
                let added = self.add_positions(path, accessor)?;
                offsets.insert(accessor.value(), added.clone());
                added
            }
        };
        let first_face = self.triangles.len();
        let (corners, left_out) = match primitive.indices {
            None => {
                let corners = vertices.len();
                self.check_growth(path, first_face, face_bound(mode, corners), MAX_FACES)?;
                (corners, assemble(mode, corners, number, &vertices, &mut self.triangles))
            }
            Some(indices) => {
                let indices = self.accessors.indices(indices, &format!("{path}.indices"))?;
                let corners = indices.len();
                self.check_growth(path, first_face, face_bound(mode, corners), MAX_FACES)?;
                (corners, assemble(mode, corners, |i| indices.get(i), &vertices, &mut self.triangles))
            }
        };
        if mode == Mode::Triangles && corners % 3 != 0 {
            let message =
                format!("{path}: {corners} corners make no whole triangles; the last {} were left out", corners % 3);
            self.notes.push(Note::repaired(message));
        }
        if left_out > 0 {
            let message =
                format!("{path}: triangles left out for an index beyond the {} vertices: {left_out}", vertices.len());
            self.notes.push(Note::repaired(message));
        }
        if self.triangles.len() > first_face {
            let material = primitive.material.and_then(|material| self.materials.get(material.value()));
            let name = material.and_then(|material| material.name.clone()).unwrap_or_default();
            self.groups.push(Group { name, faces: number(first_face)..number(self.triangles.len()) });
        }
        Ok(())
    }

    /// Adds the positions of an accessor and gives the numbers they got.
    fn add_positions(&mut self, path: &str, accessor: Index<Accessor>) -> Result<Range<u32>, ParseError> {
        let from = format!("{path}.attributes.POSITION");
        let array = self.accessors.vectors(accessor, &from)?;
        let first = self.positions.len();
        self.check_growth(&from, first, array.len(), MAX_VERTICES)?;
        array.append_to(&mut self.positions)?;
        Ok(number(first)..number(self.positions.len()))
    }

    /// Refuses more vertices or faces than can be numbered, or than the input's size justifies.
    ///
    /// Accessors may be shared by any number of primitives, so that a file of a megabyte could ask
    /// for terabytes.
    fn check_growth(&self, path: &str, before: usize, added: usize, most: usize) -> Result<(), ParseError> {
        let total = before.saturating_add(added);
        let bytes = self.accessors.bytes_at_hand();
        if total > most {
            return Err(ParseError::json(
                path,
                format!("{total} of them are more than the {most} that can be numbered; split the file"),
            ));
        }
        if total > FREE_ELEMENTS.max(bytes.saturating_mul(ELEMENTS_PER_BYTE)) {
            let what = format!("shared accessors expand {bytes} bytes to {total} vertices or faces, which is refused");
            return Err(ParseError::json(path, what));
        }
        Ok(())
    }

    /// Notes on what concerns the file as a whole.
    fn note_the_rest(&mut self, document: &Document, bodies: &[Option<usize>]) {
        let body = |mesh: Option<Index<Mesh>>| mesh.and_then(|mesh| bodies.get(mesh.value()).copied().flatten());
        if let Some((count, first)) = self.skipped.take() {
            self.notes
                .push(Note::info(format!("primitives of points or lines were skipped: {count}, the first is {first}")));
        }
        if document.nodes.iter().any(|node| node.skin.is_some() && body(node.mesh).is_some()) {
            self.notes.push(Note::info("skinned meshes are read in their rest pose"));
        }
        let mut used = document.meshes.iter().zip(bodies).filter(|(_, body)| body.is_some()).map(|(mesh, _)| mesh);
        if used.any(|mesh| mesh.primitives.iter().any(|p| p.targets.as_ref().is_some_and(|t| !t.is_empty()))) {
            self.notes.push(Note::info("meshes with morph targets are read without them"));
        }
    }
}

/// The mode of a primitive that makes triangles.
fn surface_mode(primitive: &Primitive) -> Option<Mode> {
    match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => Some(mode),
        _ => None,
    }
}

/// The most faces that so many corners can make.
fn face_bound(mode: Mode, corners: usize) -> usize {
    if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
}

/// Appends the triangles of a primitive, whose indices count from the start of `vertices`, and
/// tells how many were left out for an index beyond them.
fn assemble(
    mode: Mode,
    corners: usize,
    index: impl Fn(usize) -> u32,
    vertices: &Range<u32>,
    out: &mut Vec<[u32; 3]>,
) -> usize {
    let count = vertices.end - vertices.start;
    let faces = face_bound(mode, corners);
    let before = out.len();
    let mut connecting = 0;
    out.reserve(faces);
    for face in 0..faces {
        // Winding as in section 3.7.2.1 of the specification.
        let [a, b, c] = match mode {
            Mode::TriangleStrip => [face, face + 1 + face % 2, face + 2 - face % 2],
            Mode::TriangleFan => [face + 1, face + 2, 0],
            _ => [3 * face, 3 * face + 1, 3 * face + 2],
        };
        let [a, b, c] = [index(a), index(b), index(c)];
        if mode == Mode::TriangleStrip && (a == b || b == c || c == a) {
            // Strips are joined by triangles without area, which are no faces by intent.
            connecting += 1;
        } else if a < count && b < count && c < count {
            out.push([vertices.start + a, vertices.start + b, vertices.start + c]);
        }
    }
    faces - connecting - (out.len() - before)
}

/// A number of vertices or faces, which have been counted before: it fits.
fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// The nodes and where the default scene begins.
fn read_scene(document: &Document, bodies: &[Option<usize>], notes: &mut Vec<Note>) -> Result<Scene, ParseError> {
    let count = document.nodes.len();
    let mut nodes = Vec::with_capacity(count);
    let mut parents: Vec<Option<usize>> = vec![None; count];
    for (i, node) in document.nodes.iter().enumerate() {
        let body = match node.mesh {
            None => None,
            Some(mesh) => *bodies.get(mesh.value()).ok_or_else(|| {
                let what = format!("there is no mesh {mesh} among {}", bodies.len());
                ParseError::json(format!("nodes[{i}].mesh"), what)
            })?,
        };
        let children: Vec<usize> = node.children.iter().flatten().map(Index::value).collect();
        for (c, &child) in children.iter().enumerate() {
            let path = || format!("nodes[{i}].children[{c}]");
            match parents.get_mut(child) {
                None => return Err(ParseError::json(path(), format!("there is no node {child} among {count}"))),
                Some(Some(other)) => {
                    return Err(ParseError::json(path(), format!("node {child} is already a child of node {other}")));
                }
                Some(parent) => *parent = Some(i),
            }
        }
        let transform = match node.matrix {
            Some(matrix) => Transform::Matrix(matrix),
            None => Transform::Parts {
                translation: node.translation,
                rotation: node.rotation.map(|rotation| rotation.0),
                scale: node.scale,
            },
        };
        nodes.push(Node { name: node.name.clone().unwrap_or_default(), transform, body, children });
    }
    let tops: Vec<usize> = (0..count).filter(|&node| parents[node].is_none()).collect();
    let listed = listed_roots(document, count)?;

    // From the top down, with a stack of our own: every node is met once, or it hangs on a cycle.
    let mut met = vec![false; count];
    let mut placed_by_parent = vec![false; count];
    let mut stack = tops.clone();
    while let Some(node) = stack.pop() {
        met[node] = true;
        for &child in &nodes[node].children {
            placed_by_parent[child] = placed_by_parent[node] || listed.as_ref().is_some_and(|l| l.is_root[node]);
            stack.push(child);
        }
    }
    if let Some(node) = met.iter().position(|met| !met) {
        // One with a parent always has one that is not met either: going up ends in the cycle.
        let inside = (0..count).fold(node, |node, _| parents[node].unwrap_or(node));
        return Err(ParseError::json(format!("nodes[{inside}].children"), "the node is a descendant of itself"));
    }
    let roots = match listed {
        None => tops,
        Some(listed) => {
            let (dropped, roots): (Vec<_>, Vec<_>) = listed.order.into_iter().partition(|&node| placed_by_parent[node]);
            if let Some(first) = dropped.first() {
                let message = format!(
                    "the scene lists children of its nodes as roots, node {first} first; they were placed once"
                );
                notes.push(Note::repaired(message));
            }
            roots
        }
    };
    Ok(Scene { nodes, roots })
}

/// The nodes that the default scene lists, each once.
struct Listed {
    order: Vec<usize>,
    is_root: Vec<bool>,
}

fn listed_roots(document: &Document, count: usize) -> Result<Option<Listed>, ParseError> {
    let index = document.scene.unwrap_or(0);
    let Some(scene) = document.scenes.get(index) else {
        if document.scene.is_some() {
            let what = format!("there is no scene {index} among {}", document.scenes.len());
            return Err(ParseError::json("scene", what));
        }
        return Ok(None);
    };
    let mut listed = Listed { order: Vec::with_capacity(scene.nodes.len()), is_root: vec![false; count] };
    for (r, &root) in scene.nodes.iter().enumerate() {
        let Some(is_root) = listed.is_root.get_mut(root) else {
            let what = format!("there is no node {root} among {count}");
            return Err(ParseError::json(format!("scenes[{index}].nodes[{r}]"), what));
        };
        if !std::mem::replace(is_root, true) {
            listed.order.push(root);
        }
    }
    Ok(Some(listed))
}

#[cfg(test)]
mod tests {
    use super::super::container::tests::glb_of;
    use super::*;
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

    fn read_glb(indices: &[u8], parts: &Value) -> Result<Soup, ParseError> {
        read(&glb(indices, parts), None)
    }

    fn error_of(indices: &[u8], parts: &Value) -> String {
        read_glb(indices, parts).expect_err("an error").to_string()
    }

    fn primitives(list: &Value) -> Value {
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
        assert_eq!(soup.scene, Some(Scene::default()));
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
    fn strips_and_fans_keep_their_winding() {
        for (mode, indices, expected) in [
            (5, &[0, 1, 2, 3, 4][..], &[[0, 1, 2], [1, 3, 2], [2, 3, 4]][..]),
            (6, &[0, 1, 2, 3, 4], &[[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
            (5, &[0, 1, 2, 2, 3, 3, 4, 1], &[[0, 1, 2], [3, 1, 4]]),
        ] {
            let parts = primitives(&json!([{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": mode }]));
            let soup = read_glb(indices, &parts).expect("readable");
            assert_eq!(soup.triangles, expected, "mode {mode}");
            assert!(soup.notes.is_empty());
        }
    }

    #[test]
    fn without_indices_the_vertices_are_taken_in_order() {
        let strip = primitives(&json!([{ "attributes": { "POSITION": 0 }, "mode": 5 }]));
        assert_eq!(read_glb(&[], &strip).expect("readable").triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let soup = read_glb(&[], &primitives(&json!([{ "attributes": { "POSITION": 0 } }]))).expect("readable");
        assert_eq!(soup.triangles, [[0, 1, 2]]);
        assert!(soup.notes[0].repaired && soup.notes[0].message.contains("the last 2"), "{:?}", soup.notes);
    }

    #[test]
    fn triangles_with_a_wild_index_are_left_out_and_counted() {
        let soup = read_glb(&[0, 1, 2, 0, 1, 255, 5, 6, 7, 2, 1, 3], &json!({})).expect("readable");
        assert_eq!(soup.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(soup.notes.len(), 1);
        let message = &soup.notes[0].message;
        assert!(message.starts_with("meshes[0].primitives[0]: ") && message.ends_with(": 2"), "{message}");
        assert!(soup.notes[0].repaired);
        assert!(error_of(&[7, 8, 9], &json!({})).starts_with("there are no triangles: "));
    }

    #[test]
    fn meshes_become_bodies_and_primitives_groups() {
        let part = |material: u32| json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": material });
        let lines = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
        let parts = json!({
            "materials": [{ "name": "Red" }, {}],
            "meshes": [
                { "name": "wire", "primitives": [lines, lines] },
                { "name": "two", "primitives": [part(0), lines, part(1)] },
                { "primitives": [part(9)] }
            ],
            "nodes": [{ "mesh": 2 }, { "mesh": 0 }, { "mesh": 1, "name": "n", "scale": [1, 2, 3] }]
        });
        let soup = read_glb(&[0, 1, 2], &parts).expect("readable");
        let group = |name: &str, faces| Group { name: name.into(), faces };
        assert_eq!(soup.bodies, [group("two", 0..2), group("", 2..3)]);
        assert_eq!(soup.groups, [group("Red", 0..1), group("", 1..2), group("", 2..3)]);
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 1, 2], [5, 6, 7]], "shared within a mesh, not between meshes");
        assert_eq!(soup.positions.len(), 10);
        let scene = soup.scene.expect("always");
        assert_eq!(scene.nodes.iter().map(|n| n.body).collect::<Vec<_>>(), [Some(1), None, Some(0)]);
        assert_eq!(scene.roots, [0, 1, 2]);
        let transform = Transform::Parts { translation: None, rotation: None, scale: Some([1.0, 2.0, 3.0]) };
        assert_eq!((scene.nodes[2].name.as_str(), &scene.nodes[2].transform), ("n", &transform));
        assert_eq!(soup.notes.len(), 1);
        assert!(!soup.notes[0].repaired && soup.notes[0].message.ends_with("3, the first is meshes[0].primitives[0]"));
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
    fn a_node_has_one_parent_and_no_cycle() {
        for (nodes, path) in [
            (json!([{ "children": [0] }]), "nodes[0].children: "),
            (json!([{}, { "children": [3] }, { "children": [1] }, { "children": [2, 4] }, {}]), "nodes["),
            (json!([{ "children": [2] }, { "children": [2] }, {}]), "nodes[1].children[0]: "),
            (json!([{ "children": [1, 1] }, {}]), "nodes[0].children[1]: "),
        ] {
            let error = error_of(&[0, 1, 2], &json!({ "nodes": nodes }));
            assert!(error.starts_with(path), "{error}");
        }
    }

    #[test]
    fn the_default_scene_gives_the_roots() {
        let roots = |parts: &Value| {
            let soup = read_glb(&[0, 1, 2], parts).expect("readable");
            (soup.scene.expect("always").roots, soup.notes.len())
        };
        let nodes = json!([{ "children": [1] }, {}, {}]);
        assert_eq!(roots(&json!({ "nodes": nodes })), (vec![0, 2], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [2] }, { "nodes": [0] }] })), (vec![2], 0));
        assert_eq!(
            roots(&json!({ "nodes": nodes, "scene": 1, "scenes": [{ "nodes": [2] }, { "nodes": [0] }] })),
            (vec![0], 0)
        );
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "name": "empty" }] })), (vec![], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [1] }] })), (vec![1], 0));
        assert_eq!(roots(&json!({ "nodes": nodes, "scenes": [{ "nodes": [1, 2, 0] }] })), (vec![2, 0], 1));
    }

    #[test]
    fn a_chain_of_many_nodes_does_not_exhaust_the_stack() {
        let count = 100_000;
        let nodes: Vec<Value> = (1..=count)
            .map(|next| if next < count { json!({ "children": [next] }) } else { json!({ "mesh": 0 }) })
            .collect();
        let soup = read_glb(&[0, 1, 2], &json!({ "nodes": nodes })).expect("readable");
        assert_eq!(soup.scene.expect("always").roots, [0]);
        let mut nodes = nodes;
        nodes[count - 1] = json!({ "children": [0] });
        assert!(error_of(&[0, 1, 2], &json!({ "nodes": nodes })).contains("descendant of itself"));
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
    fn shared_accessors_cannot_expand_a_small_file_without_end() {
        let mesh = json!({ "primitives": [{ "attributes": { "POSITION": 0 } }] });
        let parts = json!({
            "accessors": [{ "componentType": 5126, "count": 65_000, "type": "VEC3" }],
            "meshes": vec![mesh; 300]
        });
        let error = error_of(&[], &parts);
        assert!(error.starts_with("meshes[") && error.contains("shared accessors"), "{error}");
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
