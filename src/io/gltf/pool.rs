//! Vertices of an original: which primitives share them, and their attributes after a split.

use super::accessor::Accessors;
use super::document::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, index_type};
use super::draft::{Draft, Piece};
use super::geometry::{DRACO, corners_of};
use super::layout::Stream;
use super::references::{Kind, Object, counts, each_primitive, index};
use super::strip::{our_attributes, take_extension};
use super::vertices::Vertices;
use crate::error::ParseError;
use crate::mesh::Face;
use crate::numbers::Numbers;
use crate::soup::{Note, PrimitiveFaces};
use gltf_json as json;
use json::mesh::Mode;
use json::validation::Checked;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Copies of vertices may take so many bytes for nothing, and beyond that so many for each byte of the
/// input: thousands of attributes can share the bytes of one.
const FREE_BYTES: u64 = 1 << 33;
const BYTES_PER_BYTE: u64 = 1 << 10;

/// Primitives of a mesh whose vertices are the same accessors.
pub(super) struct Pool {
    pub(super) mesh: usize,
    pub(super) primitives: Vec<PrimitiveFaces>,
    /// Attributes that have a name of ours but are not.
    pub(super) foreign: Vec<String>,
    /// Number of vertices.
    given: u32,
}

/// Puts primitives that share all their vertices together.
///
/// An attribute that does not fit the positions is left out. One that has a name of ours, in a mesh that
/// is not ours, stays, or is left out with `force`. `notes` says so.
pub(super) fn collect(
    draft: &mut Draft<'_>,
    primitives: &[PrimitiveFaces],
    accessors: &Accessors<'_>,
    force: bool,
    notes: &mut Vec<Note>,
) -> Result<Vec<Pool>, ParseError> {
    let mut pools: Vec<Pool> = Vec::new();
    let mut known: HashMap<(usize, String), usize> = HashMap::new();
    let mut dropped = BTreeSet::new();
    let mut refused: BTreeMap<String, String> = BTreeMap::new();
    for place in primitives {
        let path = format!("meshes[{}].primitives[{}]", place.mesh, place.primitive);
        let Some(primitive) = primitive_mut(draft, place) else {
            return Err(ParseError::json(path, "must be an object"));
        };
        let Some(given) = attribute(primitive, "POSITION") else {
            return Err(ParseError::json(path, "has no POSITION any more"));
        };
        let from = format!("{path}.attributes.POSITION");
        let given = accessors.any(json::Index::new(given as u32), &from)?.len();
        let mut foreign = Vec::new();
        for (at, map) in maps_mut(primitive) {
            let mut unfit = Vec::new();
            for (name, accessor) in map.iter() {
                let from = format!("{path}.{at}.{name}");
                let number = index(accessor).and_then(|a| u32::try_from(a).ok());
                let number = number.ok_or_else(|| ParseError::json(&from, "must be the number of an accessor"))?;
                let count = accessors.any(json::Index::new(number), &from)?.len();
                let is_foreign = at == "attributes" && our_attributes().any(|ours| ours == *name);
                if count != given {
                    let what = format!("{from} has {count} elements for {given} vertices and was left out");
                    notes.push(Note::repaired(what));
                    unfit.push(name.clone());
                } else if is_foreign && force {
                    unfit.push(name.clone());
                } else if is_foreign {
                    refused.entry(name.clone()).or_insert_with(|| path.clone());
                    foreign.push(name.clone());
                }
            }
            dropped.extend(unfit.iter().filter_map(|name| index(&map.remove(name)?)));
        }
        let given =
            u32::try_from(given).map_err(|_| ParseError::json(&from, "has more vertices than can be numbered"))?;
        let key = (place.mesh, maps_mut(primitive).map(|(_, map)| Value::Object(map.clone()).to_string()).collect());
        let pool = *known.entry(key).or_insert_with(|| {
            pools.push(Pool { mesh: place.mesh, primitives: Vec::new(), foreign, given });
            pools.len() - 1
        });
        pools[pool].primitives.push(place.clone());
    }
    draft.free_unused(Kind::Accessor, &dropped);
    for (name, path) in refused {
        notes.push(Note::info(format!(
            "{path} has an attribute {name} of its own, which stays; ours is left out there (--force replaces it)"
        )));
    }
    Ok(pools)
}

/// What to do with vertices that several faces use.
pub(super) enum Sharing<'s> {
    /// Split them where faces differ; `None`: everywhere.
    Split(Option<&'s dyn Fn(Face, Face) -> bool>),
    /// Keep them, and see to it that the primitives are lists of triangles.
    Keep,
}

/// A pool and what became of its vertices.
pub(super) struct Done {
    pub(super) pool: Pool,
    pub(super) vertices: Arc<Vertices>,
    /// How many faces each primitive has.
    pub(super) counts: Vec<usize>,
    /// The faces of each primitive and their vertices, where those were kept.
    pub(super) corners: Vec<(Numbers, Vec<[u32; 3]>)>,
}

/// Splits the vertices of every pool and replaces attributes and indices where that made copies. Only
/// `faces` stay.
pub(super) fn split<'a>(
    draft: &mut Draft<'a>,
    accessors: &'a Accessors<'_>,
    meshes: &[json::Mesh],
    pools: Vec<Pool>,
    faces: &Numbers,
    sharing: &Sharing<'_>,
) -> Result<Vec<Done>, ParseError> {
    let mut done = Vec::with_capacity(pools.len());
    let mut changed: Vec<Change> = Vec::new();
    for pool in pools {
        let mut corners = Vec::with_capacity(pool.primitives.len());
        let mut fits = true;
        for place in &pool.primitives {
            let path = format!("meshes[{}].primitives[{}]", place.mesh, place.primitive);
            let primitive = meshes.get(place.mesh).and_then(|mesh| mesh.primitives.get(place.primitive));
            let primitive = primitive.ok_or_else(|| ParseError::json(&path, "is not there any more"))?;
            let mut triangles = corners_of(accessors, primitive, &path, pool.given)?;
            if triangles.len() != place.faces.len() {
                return Err(ParseError::json(path, "has other faces than were read"));
            }
            fits &= !has_wild_corners(accessors, primitive, &path, triangles.len())?;
            fits &= !matches!(sharing, Sharing::Keep) || primitive.mode == Checked::Valid(Mode::Triangles);
            let kept = faces.within(&place.faces);
            if kept.len() < triangles.len() {
                triangles = kept.iter().map(|f| triangles[(f - place.faces.start) as usize]).collect();
                fits = false;
            }
            corners.push((kept, triangles));
        }
        let most = corners.iter().map(|(_, c)| 3 * c.len() as u64).sum::<u64>() + u64::from(pool.given);
        if most >= u64::from(u32::MAX) {
            let what = "split, its vertices would be more than can be numbered; use --layout indexed";
            return Err(ParseError::json(format!("meshes[{}]", pool.mesh), what));
        }
        let vertices = Arc::new(match sharing {
            Sharing::Split(same) => Vertices::split(pool.given, &mut corners, *same),
            Sharing::Keep => Vertices::kept(pool.given, corners.iter().map(|(faces, c)| (faces, c.as_slice()))),
        });
        let counts = corners.iter().map(|(faces, _)| faces.len()).collect();
        let kept = if matches!(sharing, Sharing::Keep) { corners.clone() } else { Vec::new() };
        if !vertices.is_unchanged() || !fits {
            changed.push(Change { pool: done.len(), corners: corners.into_iter().map(|(_, c)| c).collect() });
        }
        done.push(Done { pool, vertices, counts, corners: kept });
    }
    replace(draft, accessors, &done, changed)?;
    Ok(done)
}

/// True when indices beyond the vertices made the reader leave triangles out.
fn has_wild_corners(
    accessors: &Accessors<'_>,
    primitive: &json::mesh::Primitive,
    path: &str,
    faces: usize,
) -> Result<bool, ParseError> {
    let (Some(indices), Checked::Valid(Mode::Triangles)) = (primitive.indices, primitive.mode) else {
        return Ok(false);
    };
    Ok(accessors.indices(indices, &format!("{path}.indices"))?.len() / 3 != faces)
}

/// A pool with new vertices or indices.
struct Change {
    pool: usize,
    /// Corners of the faces of each of its primitives.
    corners: Vec<Vec<[u32; 3]>>,
}

fn replace<'a>(
    draft: &mut Draft<'a>,
    accessors: &'a Accessors<'_>,
    pools: &[Done],
    changed: Vec<Change>,
) -> Result<(), ParseError> {
    let mut references = counts(&mut draft.root, Kind::Accessor);
    // First the numbers: an accessor that nobody else needs keeps its number and gives up its views.
    let mut views = BTreeSet::new();
    let mut plans = Vec::with_capacity(changed.len());
    for change in &changed {
        let Done { pool, vertices, .. } = &pools[change.pool];
        let mut attributes: BTreeMap<usize, usize> = BTreeMap::new();
        if !vertices.is_unchanged() {
            for place in &pool.primitives {
                let Some(primitive) = primitive_mut(draft, place) else { continue };
                for (_, map) in maps_mut(primitive) {
                    map.values().filter_map(index).for_each(|a| *attributes.entry(a).or_default() += 1);
                }
            }
        }
        let mut targets: BTreeMap<usize, usize> = BTreeMap::new();
        for (accessor, uses) in attributes {
            targets.insert(accessor, take_over(draft, &mut references, &mut views, accessor, uses));
        }
        let mut indices = Vec::with_capacity(pool.primitives.len());
        for place in &pool.primitives {
            let old = primitive_mut(draft, place).and_then(|primitive| index(primitive.get("indices")?));
            indices.push(old.map(|old| take_over(draft, &mut references, &mut views, old, 1)));
        }
        plans.push((targets, indices));
    }
    draft.free_unused(Kind::View, &views);

    let bytes = accessors.bytes_at_hand() as u64;
    for (change, (targets, indices)) in changed.into_iter().zip(plans) {
        let Done { pool, vertices, .. } = &pools[change.pool];
        for (&old, &new) in &targets {
            let path = format!("accessors[{old}]");
            let array = accessors.any(json::Index::new(old as u32), &path)?;
            let stride = array.size().next_multiple_of(4);
            let padded = (stride != array.size()).then_some(stride);
            let raw = array.raw()?;
            let piece = Piece::Stream(Stream::Copied { raw, stride, vertices: Arc::clone(vertices) });
            let view = draft.add_view(piece, Some(ARRAY_BUFFER), padded);
            draft.replace(new, vertices.len(), view);
            if draft.new_bytes() > FREE_BYTES.max(bytes.saturating_mul(BYTES_PER_BYTE)) {
                let what =
                    format!("shared accessors expand {bytes} bytes to {} bytes, which is refused", draft.new_bytes());
                return Err(ParseError::json(path, what));
            }
        }
        for ((place, corners), indices) in pool.primitives.iter().zip(change.corners).zip(indices) {
            let (wide, component) = index_type(vertices.len());
            let count = 3 * corners.len();
            let view =
                draft.add_view(Piece::Stream(Stream::Indices { corners, wide }), Some(ELEMENT_ARRAY_BUFFER), None);
            let number = indices.unwrap_or_else(|| draft.add(Kind::Accessor, serde_json::json!({ "type": "SCALAR" })));
            draft.replace(number, count, view);
            if let Some(accessor) = draft.list("accessors").get_mut(number).and_then(Value::as_object_mut) {
                for old in ["min", "max", "normalized"] {
                    accessor.remove(old);
                }
                accessor.insert("componentType".into(), component.into());
            }
            let Some(primitive) = primitive_mut(draft, place) else { continue };
            primitive.insert("indices".into(), number.into());
            if primitive.get("mode").is_some_and(|mode| mode != 4) {
                primitive.remove("mode");
            }
            // What is compressed there has the vertices of before.
            take_extension(primitive, DRACO);
            for (_, map) in maps_mut(primitive) {
                for accessor in map.values_mut() {
                    if let Some(&new) = index(accessor).and_then(|old| targets.get(&old)) {
                        *accessor = new.into();
                    }
                }
            }
        }
    }
    forget_draco(draft);
    Ok(())
}

/// The number under which an accessor's new content goes: its own where only these `uses` refer to it.
fn take_over(
    draft: &mut Draft<'_>,
    references: &mut [usize],
    views: &mut BTreeSet<usize>,
    accessor: usize,
    uses: usize,
) -> usize {
    let Some(left) = references.get_mut(accessor) else { return accessor };
    *left = left.saturating_sub(uses);
    if *left > 0 {
        let copy = draft.list("accessors")[accessor].clone();
        return draft.append(Kind::Accessor, copy);
    }
    views.extend(draft.detach(accessor));
    accessor
}

/// Takes a compression out of `extensionsUsed` that no primitive has any more.
fn forget_draco(draft: &mut Draft<'_>) {
    let mut used = false;
    each_primitive(&mut draft.root, &mut |p| used |= p.get("extensions").is_some_and(|e| e.get(DRACO).is_some()));
    if !used {
        super::strip::remove_name(&mut draft.root, DRACO);
    }
}

fn primitive_mut<'d>(draft: &'d mut Draft<'_>, place: &PrimitiveFaces) -> Option<&'d mut Object> {
    draft.list("meshes").get_mut(place.mesh)?.get_mut("primitives")?.get_mut(place.primitive)?.as_object_mut()
}

fn attribute(primitive: &Object, name: &str) -> Option<usize> {
    index(primitive.get("attributes")?.get(name)?)
}

/// The attributes of a primitive and of its morph targets.
fn maps_mut(primitive: &mut Object) -> impl Iterator<Item = (&'static str, &mut Object)> {
    primitive.iter_mut().flat_map(|(key, value)| {
        let maps: Vec<(&'static str, &mut Object)> = match (key.as_str(), value) {
            ("attributes", Value::Object(map)) => vec![("attributes", map)],
            ("targets", Value::Array(list)) => {
                list.iter_mut().filter_map(Value::as_object_mut).map(|map| ("targets", map)).collect()
            }
            _ => Vec::new(),
        };
        maps
    })
}
