//! The document of an output: that of the input where it is glTF, or a new one, with curvature added.

use super::accessor::Accessors;
use super::draft::{Draft, Piece};
use super::indexed;
use super::layout::{Stream, stored_bounds};
use super::looks::{Axis, Looks, Slot, slots};
use super::opened::Opened;
use super::pool::{self, Done, Pool, Sharing};
use super::references::{Kind, Object};
use super::strip::{FACE_VALUES, MARK, Primary, VARIANTS};
use super::vertices::{Owners, Vertices};
use crate::annotation::{Annotation, ColorCarrier, Layout};
use crate::error::Error;
use crate::quantity::Quantity;
use crate::soup::{Note, Transform};
use serde_json::{Value, json};
use std::ops::Range;
use std::sync::Arc;

pub(super) const ARRAY_BUFFER: u32 = 34962;
pub(super) const FLOAT: u32 = 5126;
const UNSIGNED_BYTE: u32 = 5121;

/// A document with all that Osculate adds.
pub(super) struct Document<'a> {
    pub(super) draft: Draft<'a>,
    pub(super) looks: Looks<'a>,
}

/// Primitives that share their vertices and get values.
struct Target {
    mesh: usize,
    primitives: Vec<usize>,
    owners: Owners,
    /// Attributes of others, which ours do not replace.
    foreign: Vec<String>,
    /// In layout `indexed`: faces of each primitive and their corners.
    corners: Vec<(Range<u32>, Vec<[u32; 3]>)>,
}

/// Builds the document of an annotation. `images` gives the URI of an image in a file of its own, by its
/// number among ours.
///
/// # Errors
/// [`Error::Parse`] where the original cannot be carried over.
pub(super) fn build<'a>(
    annotation: &'a Annotation<'a>,
    original: Option<(&'a Opened<'_>, &'a Accessors<'_>)>,
    keep_image_files: bool,
    images: &dyn Fn(usize) -> Option<String>,
) -> Result<Document<'a>, Error> {
    let mut looks = Looks::new(annotation);
    let (mut draft, targets, primary) = match original {
        Some((opened, accessors)) => {
            let (mut draft, primary, pools) = prepare(opened, accessors, annotation.force, &mut Vec::new())?;
            if !keep_image_files {
                carry_images(&mut draft, opened);
            }
            let targets = split(annotation, &mut draft, opened, accessors, pools)?;
            (draft, targets, Some(primary))
        }
        None => {
            let (draft, targets) = plain(annotation);
            (draft, targets, None)
        }
    };
    let quantities = annotation.gltf_quantities();
    for target in &targets {
        if annotation.layout == Layout::Indexed {
            for (&p, (faces, corners)) in target.primitives.iter().zip(&target.corners) {
                let extension = indexed::face_values(annotation, &mut draft, &quantities, faces.clone(), corners);
                add_extension(&mut draft, target.mesh, p, FACE_VALUES, extension);
            }
        } else {
            add_values(&mut draft, target, &quantities);
        }
        let of_vertices = annotation.vertex_columns().map(|(quantity, _)| quantity);
        for quantity in of_vertices.filter(|&quantity| !target.foreign.contains(&vertex_attribute(quantity))) {
            let stream = Stream::VertexValue { owners: target.owners.clone(), quantity };
            let accessor = add_attribute(&mut draft, stream, target.owners.len(), FLOAT, "SCALAR");
            set_attribute(&mut draft, target, &vertex_attribute(quantity), accessor);
        }
        add_look(annotation, &mut draft, &mut looks, target, primary.as_ref());
    }
    mark(annotation, &mut draft, &targets);
    looks.finish(&mut draft, images);
    Ok(Document { draft, looks })
}

/// The original without what an earlier run added, and its vertices; `notes` gets what was refused.
pub(super) fn prepare<'a>(
    opened: &Opened<'_>,
    accessors: &Accessors<'_>,
    force: bool,
    notes: &mut Vec<Note>,
) -> Result<(Draft<'a>, Primary, Vec<Pool>), Error> {
    let mut draft = Draft::new(opened.root().map_err(|e| opened.error(e))?);
    let primary = super::strip::strip(&mut draft);
    let pools = pool::collect(&mut draft, opened.primitives, accessors, force, notes).map_err(|e| opened.error(e))?;
    Ok((draft, primary, pools))
}

/// Puts images that lie in files of their own into the buffer. One that cannot be read stays where
/// it is.
fn carry_images(draft: &mut Draft<'_>, opened: &Opened<'_>) {
    let images = draft.root.get("images").and_then(Value::as_array).map_or(0, Vec::len);
    for i in 0..images {
        let Some(uri) = draft.list("images")[i].get("uri").and_then(super::opened::is_relative).map(str::to_owned)
        else {
            continue;
        };
        let Some(bytes) = opened.image(&uri) else { continue };
        let stated = draft.list("images")[i].get("mimeType").and_then(Value::as_str).map(str::to_owned);
        let Some(kind) = stated.or_else(|| super::opened::media_type(&bytes, &uri).map(str::to_owned)) else {
            continue;
        };
        let view = draft.add_view(Piece::Bytes(bytes), None, None);
        if let Some(image) = draft.list("images")[i].as_object_mut() {
            image.remove("uri");
            image.insert("bufferView".into(), view.into());
            image.insert("mimeType".into(), kind.into());
        }
    }
}

/// Splits the vertices of an original where faces of different values meet.
fn split<'a>(
    annotation: &'a Annotation<'a>,
    draft: &mut Draft<'a>,
    opened: &Opened<'_>,
    accessors: &'a Accessors<'_>,
    pools: Vec<Pool>,
) -> Result<Vec<Target>, Error> {
    let quantities = annotation.gltf_quantities();
    let numbered = quantities.contains(&Quantity::Face);
    let same = |a: crate::Face, b: crate::Face| same_values(annotation, &quantities, a, b);
    let same: Option<&dyn Fn(crate::Face, crate::Face) -> bool> = if numbered { None } else { Some(&same) };
    let sharing = match annotation.layout {
        Layout::Faces => Sharing::Split(same),
        Layout::Indexed => Sharing::Keep,
    };
    let split = pool::split(draft, accessors, &opened.document.meshes, pools, &sharing).map_err(|e| opened.error(e))?;
    Ok(split
        .into_iter()
        .map(|Done { pool, vertices, corners }| Target {
            mesh: pool.mesh,
            primitives: pool.primitives.iter().map(|p| p.primitive).collect(),
            owners: Owners::Vertices(vertices),
            foreign: pool.foreign,
            corners: pool.primitives.iter().map(|p| p.faces.clone()).zip(corners).collect(),
        })
        .collect())
}

/// True when two faces could share a vertex: all that is written of them is equal.
fn same_values(annotation: &Annotation<'_>, quantities: &[Quantity], a: crate::Face, b: crate::Face) -> bool {
    let stored = |quantity: Quantity, component| {
        let stored = super::layout::stored_value(annotation, quantity, component);
        stored(Some(a)).to_bits() == stored(Some(b)).to_bits()
    };
    quantities.iter().all(|&q| (0..q.columns().len()).all(|component| stored(q, component)))
        && annotation.colors.iter().all(|colors| {
            colors.color_index(&annotation.values[a.index()]) == colors.color_index(&annotation.values[b.index()])
        })
}

/// A document for a mesh that comes from no glTF file.
fn plain<'a>(annotation: &Annotation<'_>) -> (Draft<'a>, Vec<Target>) {
    let mut root = Object::new();
    let generator = format!("osculate {}", env!("CARGO_PKG_VERSION"));
    root.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
    let mut draft = Draft::new(root);
    let mut targets = Vec::new();
    for (m, body) in annotation.mesh.bodies().iter().enumerate() {
        let faces = body.faces.clone();
        let mut corners = Vec::new();
        let mut owners = Owners::Corners(faces.clone());
        let primitive = match annotation.layout {
            Layout::Faces => {
                json!({ "attributes": { "POSITION": add_corners(annotation, &mut draft, faces.clone()) } })
            }
            Layout::Indexed => {
                let (primitive, of_faces) = indexed::shared_vertices(annotation, &mut draft, faces.clone());
                let count = of_faces.as_flattened().iter().max().map_or(0, |last| last + 1);
                owners = Owners::Vertices(Arc::new(Vertices::kept(count, [(faces.start, of_faces.as_slice())])));
                corners.push((faces.clone(), of_faces));
                primitive
            }
        };
        let mut mesh = json!({ "primitives": [primitive] });
        let name = if body.name.is_empty() { &annotation.name } else { &body.name };
        if !name.is_empty() {
            mesh["name"] = name.as_str().into();
        }
        draft.list("meshes").push(mesh);
        targets.push(Target { mesh: m, primitives: vec![0], owners, foreign: Vec::new(), corners });
    }
    let (nodes, roots) = nodes(annotation);
    draft.root.insert("nodes".into(), nodes);
    draft.root.insert("scenes".into(), json!([{ "nodes": roots }]));
    draft.root.insert("scene".into(), 0.into());
    (draft, targets)
}

/// Positions of the corners of faces.
fn add_corners(annotation: &Annotation<'_>, draft: &mut Draft<'_>, faces: Range<u32>) -> usize {
    let [min, max] = stored_bounds(annotation, faces.clone());
    let count = 3 * faces.len();
    let view = draft.add_view(Piece::Stream(Stream::Corners { faces }), Some(ARRAY_BUFFER), None);
    let accessor =
        json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max });
    draft.add(Kind::Accessor, accessor)
}

/// The placement of the bodies, or one node at the mesh's origin; and the roots.
fn nodes(annotation: &Annotation<'_>) -> (Value, Value) {
    let name = |name: &str, node: &mut Value| {
        if !name.is_empty() {
            node["name"] = name.into();
        }
    };
    let Some(scene) = annotation.mesh.scene() else {
        let origin = annotation.node_translation().as_vec3().to_array();
        let mut node = json!({ "mesh": 0 });
        name(&annotation.name, &mut node);
        if origin != [0.0; 3] {
            node["translation"] = json!(origin);
        }
        return (json!([node]), json!([0]));
    };
    let nodes: Vec<Value> = (scene.nodes.iter())
        .map(|given| {
            let mut node = json!({});
            name(&given.name, &mut node);
            if let Some(body) = given.body {
                node["mesh"] = body.into();
            }
            if !given.children.is_empty() {
                node["children"] = json!(given.children);
            }
            match &given.transform {
                Transform::Matrix(matrix) => node["matrix"] = json!(matrix),
                Transform::Parts { translation, rotation, scale } => {
                    let parts =
                        [("translation", json!(translation)), ("rotation", json!(rotation)), ("scale", json!(scale))];
                    parts.into_iter().filter(|(_, part)| !part.is_null()).for_each(|(key, part)| node[key] = part);
                }
            }
            node
        })
        .collect();
    (json!(nodes), json!(scene.roots))
}

/// Writes settings, units and legends into the extras of every mesh with values: by them the mesh is
/// known as ours. Where its extras are no object, those of its primitives take them.
fn mark(annotation: &Annotation<'_>, draft: &mut Draft<'_>, targets: &[Target]) {
    let extras = annotation.extras();
    let put = |object: &mut Object| {
        let theirs = object.entry("extras").or_insert_with(|| json!({})).as_object_mut();
        theirs.map(|theirs| theirs.insert(MARK.into(), extras[MARK].clone())).is_some()
    };
    for target in targets {
        let mesh = draft.list("meshes").get_mut(target.mesh).and_then(Value::as_object_mut);
        if mesh.is_none_or(put) {
            continue;
        }
        for &p in &target.primitives {
            primitive(draft, target.mesh, p).map(put);
        }
    }
}

/// Adds an attribute to the primitives of a target.
fn set_attribute(draft: &mut Draft<'_>, target: &Target, name: &str, accessor: usize) {
    let Some(mesh) = draft.list("meshes").get_mut(target.mesh) else { return };
    for &p in &target.primitives {
        let attributes =
            mesh.get_mut("primitives").and_then(|all| all.get_mut(p)?.get_mut("attributes")?.as_object_mut());
        if let Some(attributes) = attributes {
            attributes.insert(name.to_owned(), accessor.into());
        }
    }
}

fn add_values<'a>(draft: &mut Draft<'a>, target: &Target, quantities: &[Quantity]) {
    for &quantity in quantities {
        for (component, name) in quantity.attributes().iter().enumerate() {
            if target.foreign.iter().any(|foreign| foreign == name) {
                continue;
            }
            let stream = Stream::Value { owners: target.owners.clone(), quantity, component };
            let accessor = add_attribute(draft, stream, target.owners.len(), FLOAT, "SCALAR");
            set_attribute(draft, target, name, accessor);
        }
    }
}

/// The attribute with the values of vertices.
pub(super) fn vertex_attribute(quantity: Quantity) -> String {
    format!("{}_VERTEX", quantity.attributes().first().unwrap_or(&"_"))
}

fn add_attribute<'a>(draft: &mut Draft<'a>, stream: Stream<'a>, count: usize, component: u32, shape: &str) -> usize {
    let view = draft.add_view(Piece::Stream(stream), Some(ARRAY_BUFFER), None);
    let mut accessor = json!({ "bufferView": view, "componentType": component, "count": count, "type": shape });
    if component == UNSIGNED_BYTE {
        accessor["normalized"] = true.into();
    }
    draft.add(Kind::Accessor, accessor)
}

/// Adds texture coordinates or colours, and the materials that show them.
fn add_look<'a>(
    annotation: &'a Annotation<'a>,
    draft: &mut Draft<'a>,
    looks: &mut Looks<'a>,
    target: &Target,
    primary: Option<&Primary>,
) {
    let is_primary = |p: usize| primary.is_none_or(|primary| primary.contains(&(target.mesh, p)));
    // Vertices that several faces share have no colour of their own.
    let has_colors = !annotation.colors.is_empty() && annotation.layout == Layout::Faces;
    if !has_colors || annotation.carrier != ColorCarrier::Texture {
        if has_colors && annotation.carrier != ColorCarrier::None {
            let stream = Stream::VertexColor { owners: target.owners.clone() };
            let accessor = add_attribute(draft, stream, target.owners.len(), UNSIGNED_BYTE, "VEC4");
            set_attribute(draft, target, "COLOR_0", accessor);
        }
        for &p in target.primitives.iter().filter(|&&p| is_primary(p)) {
            let material = looks.plain(draft);
            set_material(draft, target.mesh, p, material);
        }
        return;
    }
    let taken = sets_of(draft, target);
    let slots: Vec<Slot> = slots(annotation.colors.len(), taken);
    for set in 0..=slots.last().map_or(0, |slot| slot.set) {
        let scale = |axis| slots.iter().position(|slot| *slot == Slot { set, axis });
        let Some(u) = scale(Axis::U) else { continue };
        let stream = Stream::PaletteCoordinate { owners: target.owners.clone(), u, v: scale(Axis::V) };
        let accessor = add_attribute(draft, stream, target.owners.len(), FLOAT, "VEC2");
        set_attribute(draft, target, &format!("TEXCOORD_{}", taken + set), accessor);
    }
    let materials: Vec<usize> = (slots.iter().enumerate())
        .map(|(scale, slot)| looks.material(draft, scale, taken + slot.set, slot.axis))
        .collect();
    for &p in &target.primitives {
        if is_primary(p) {
            set_material(draft, target.mesh, p, materials[0]);
            if materials.len() == 1 {
                continue;
            }
        }
        for (scale, &material) in materials.iter().enumerate() {
            let variant = looks.variant(draft, scale);
            add_mapping(draft, target.mesh, p, material, variant);
        }
    }
}

/// Sets of texture coordinates that the primitives of a target have.
fn sets_of(draft: &mut Draft<'_>, target: &Target) -> usize {
    let mesh = draft.list("meshes").get(target.mesh);
    let primitive = mesh.and_then(|mesh| mesh.get("primitives")?.get(*target.primitives.first()?));
    let attributes = primitive.and_then(|primitive| primitive.get("attributes")?.as_object());
    (0..).find(|set| attributes.is_none_or(|a| !a.contains_key(&format!("TEXCOORD_{set}")))).unwrap_or(0)
}

fn primitive<'d>(draft: &'d mut Draft<'_>, mesh: usize, primitive: usize) -> Option<&'d mut Object> {
    draft.list("meshes").get_mut(mesh)?.get_mut("primitives")?.get_mut(primitive)?.as_object_mut()
}

fn set_material(draft: &mut Draft<'_>, mesh: usize, p: usize, material: usize) {
    if let Some(primitive) = primitive(draft, mesh, p) {
        primitive.insert("material".into(), material.into());
    }
}

fn add_extension(draft: &mut Draft<'_>, mesh: usize, p: usize, name: &str, extension: Value) {
    draft.use_extension(name);
    let extensions = primitive(draft, mesh, p).map(|p| p.entry("extensions").or_insert_with(|| json!({})));
    if let Some(extensions) = extensions.and_then(Value::as_object_mut) {
        extensions.insert(name.into(), extension);
    }
}

fn add_mapping(draft: &mut Draft<'_>, mesh: usize, p: usize, material: usize, variant: usize) {
    let extensions = primitive(draft, mesh, p).map(|p| p.entry("extensions").or_insert_with(|| json!({})));
    let Some(extensions) = extensions.and_then(Value::as_object_mut) else { return };
    let variants = extensions.entry(VARIANTS).or_insert_with(|| json!({ "mappings": [] }));
    if let Some(mappings) = variants.get_mut("mappings").and_then(Value::as_array_mut) {
        mappings.push(json!({ "material": material, "variants": [variant] }));
    }
}
