//! The document of an output: that of the input where it is glTF, or a new one, with curvature added.

use super::accessor::Accessors;
use super::cull::cull;
use super::draft::{Draft, Piece};
use super::fresh::fresh;
use super::indexed;
use super::layout::Stream;
use super::looks::{Axis, Looks, Slot, slots};
use super::metadata;
use super::opened::Opened;
use super::pool::{self, Done, Pool, Sharing};
use super::references::{Kind, Object};
use super::strip::{FACE_VALUES, MARK, Primary, VARIANTS};
use super::vertices::Owners;
use crate::annotation::{Annotation, ColorCarrier, Layout};
use crate::error::Error;
use crate::io::text::quoted;
use crate::numbers::Numbers;
use crate::quantity::Quantity;
use crate::soup::{Note, PrimitiveFaces};
use crate::wording::counted;
use serde_json::{Value, json};

pub(super) const ARRAY_BUFFER: u32 = 34962;
pub(super) const FLOAT: u32 = 5126;
pub(super) const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
pub(super) const UNSIGNED_INT: u32 = 5125;
/// As many vertices have numbers of 16 bits: the largest number is left to those who restart strips with it.
const MOST_NARROW: usize = u16::MAX as usize;

/// Whether numbers of so many vertices are of 32 bits, and the type of their accessor.
pub(super) fn index_type(vertices: usize) -> (bool, u32) {
    if vertices > MOST_NARROW { (true, UNSIGNED_INT) } else { (false, UNSIGNED_SHORT) }
}

/// A document with all that Osculate adds.
pub(super) struct Document<'a> {
    pub(super) draft: Draft<'a>,
    pub(super) looks: Looks<'a>,
}

/// Primitives that share their vertices and get values.
pub(super) struct Target {
    pub(super) mesh: usize,
    pub(super) primitives: Vec<usize>,
    pub(super) owners: Owners,
    /// How many faces each primitive has.
    pub(super) faces: Vec<usize>,
    /// Attributes of others, which ours do not replace.
    pub(super) foreign: Vec<String>,
    /// In layout `indexed`: faces of each primitive and their corners.
    pub(super) corners: Vec<(Numbers, Vec<[u32; 3]>)>,
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
    let mut empty = Vec::new();
    let (mut draft, targets, primary) = match original {
        Some((opened, accessors)) => {
            let faces = annotation.faces();
            let (kept, lost): (Vec<_>, Vec<_>) =
                opened.primitives.iter().cloned().partition(|place| faces.within(&place.faces).len() > 0);
            empty.extend(lost.into_iter().map(|place| (place.mesh, place.primitive)));
            let (mut draft, primary, pools) = prepare(opened, accessors, &kept, annotation.force, &mut Vec::new())?;
            if !keep_image_files {
                carry_images(&mut draft, opened);
            }
            let targets = split(annotation, &mut draft, opened, accessors, pools)?;
            (draft, targets, Some(primary))
        }
        None => {
            let (draft, targets) = fresh(annotation);
            (draft, targets, None)
        }
    };
    let quantities = annotation.gltf_quantities();
    for target in &targets {
        if annotation.layout == Layout::Indexed {
            for (&p, (faces, corners)) in target.primitives.iter().zip(&target.corners) {
                let extension = indexed::face_values(annotation, &mut draft, &quantities, faces, corners);
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
    if annotation.metadata {
        metadata::add(annotation, &mut draft, &targets, &quantities);
    }
    mark(annotation, &mut draft, &targets);
    cull(&mut draft, &empty);
    looks.finish(&mut draft, images);
    Ok(Document { draft, looks })
}

/// The original without what an earlier run added, and its vertices; `notes` gets what was refused.
pub(super) fn prepare<'a>(
    opened: &Opened<'_>,
    accessors: &Accessors<'_>,
    primitives: &[PrimitiveFaces],
    force: bool,
    notes: &mut Vec<Note>,
) -> Result<(Draft<'a>, Primary, Vec<Pool>), Error> {
    let mut draft = Draft::new(opened.root().map_err(|e| opened.error(e))?);
    correct_bounds(&mut draft, accessors, notes).map_err(|e| opened.error(e))?;
    let primary = super::strip::strip(&mut draft);
    let pools = pool::collect(&mut draft, primitives, accessors, force, notes).map_err(|e| opened.error(e))?;
    Ok((draft, primary, pools))
}

/// States the bounds of what compressed views decode to, where a packer stated others.
fn correct_bounds(
    draft: &mut Draft<'_>,
    accessors: &Accessors<'_>,
    notes: &mut Vec<Note>,
) -> Result<(), crate::ParseError> {
    let corrected = accessors.corrected_bounds()?;
    if let Some(first) = corrected.first() {
        notes.push(Note::info(format!(
            "min and max of {} compressed accessors, accessors[{}] first, were not those of their data and were corrected",
            corrected.len(),
            first.accessor
        )));
    }
    for corrected in corrected {
        let accessor = draft.list("accessors").get_mut(corrected.accessor).and_then(Value::as_object_mut);
        if let Some(accessor) = accessor {
            accessor.insert("min".into(), corrected.min);
            accessor.insert("max".into(), corrected.max);
        }
    }
    Ok(())
}

/// The content and the media type of an image in a file of its own, or why it cannot be carried over; `None` for one
/// that is not in such a file.
fn image_file(image: &Value, opened: &Opened<'_>) -> Option<Result<(Vec<u8>, String), String>> {
    let uri = super::opened::is_relative(image.get("uri")?)?;
    Some(opened.image(uri).and_then(|bytes| {
        let stated = image.get("mimeType").and_then(Value::as_str).or_else(|| super::opened::media_type(&bytes, uri));
        let kind =
            stated.map(str::to_owned).ok_or_else(|| format!("{} is of no known type", quoted(uri.as_bytes())))?;
        Ok((bytes, kind))
    }))
}

/// What is to be said of images that cannot be carried over.
pub(super) fn note_of_lost_images(draft: &Draft<'_>, opened: &Opened<'_>) -> Option<Note> {
    let images = draft.root.get("images").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let lost: Vec<String> = images.iter().filter_map(|image| image_file(image, opened)?.err()).collect();
    let first = lost.first()?;
    let count = counted(lost.len(), "image");
    Some(Note::repaired(format!("{count} not carried over: {first}")))
}

/// Puts images that lie in files of their own into the buffer. One that cannot be carried over keeps its name.
fn carry_images(draft: &mut Draft<'_>, opened: &Opened<'_>) {
    let images = draft.root.get("images").and_then(Value::as_array).map_or(0, Vec::len);
    for i in 0..images {
        let Some(Ok((bytes, kind))) = image_file(&draft.list("images")[i], opened) else { continue };
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
    let numbered = annotation.metadata || quantities.contains(&Quantity::Face);
    let same = |a: crate::Face, b: crate::Face| same_values(annotation, &quantities, a, b);
    let same: Option<&dyn Fn(crate::Face, crate::Face) -> bool> = if numbered { None } else { Some(&same) };
    let sharing = match annotation.layout {
        Layout::Faces => Sharing::Split(same),
        Layout::Indexed => Sharing::Keep,
    };
    let meshes = &opened.document.meshes;
    let split =
        pool::split(draft, accessors, meshes, pools, &annotation.faces(), &sharing).map_err(|e| opened.error(e))?;
    Ok(split
        .into_iter()
        .map(|Done { pool, vertices, counts, corners }| Target {
            mesh: pool.mesh,
            faces: counts,
            primitives: pool.primitives.iter().map(|p| p.primitive).collect(),
            owners: Owners::Vertices(vertices),
            foreign: pool.foreign,
            corners,
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

/// Writes settings, units and legends into the extras of every mesh with values: by them the mesh is
/// known as ours. Where its extras are no object, those of its primitives take them.
fn mark(annotation: &Annotation<'_>, draft: &mut Draft<'_>, targets: &[Target]) {
    let extras = annotation.extras(annotation.space);
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

pub(super) fn primitive<'d>(draft: &'d mut Draft<'_>, mesh: usize, primitive: usize) -> Option<&'d mut Object> {
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
