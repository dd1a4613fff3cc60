//! Reads back the values that an earlier run wrote into a glTF file.

use super::accessor::Accessors;
use super::geometry::corners_of;
use super::opened::Opened;
use super::references::{Object, index};
use super::strip::FACE_VALUES;
use crate::error::{Error, ParseError};
use crate::quantity::Quantity;
use crate::soup::{PrimitiveFaces, Scene};
use crate::stored::{NEEDED, StoredValues};
use gltf_json as json;
use json::accessor::ComponentType;
use json::validation::Checked;
use serde_json::Value;
use std::collections::BTreeMap;

/// The values of all faces; `None` where a primitive has none.
pub(in crate::io) fn read_values(scene: &Scene) -> Result<Option<StoredValues>, Error> {
    let Some(opened) = Opened::new(scene)? else { return Ok(None) };
    let read = || {
        let root = opened.root()?;
        let accessors = opened.accessors();
        let faces = scene.primitives.last().map_or(0, |place| place.faces.end as usize);
        let mut columns: BTreeMap<&'static str, Vec<f32>> = BTreeMap::new();
        let mut settings = None;
        for (n, place) in scene.primitives.iter().enumerate() {
            let Some((mark, primitive)) = marked(&root, place) else { return Ok(None) };
            settings.get_or_insert_with(|| mark.get("settings").cloned().unwrap_or_default());
            let mut found = 0;
            for (name, attribute) in names() {
                let values = match accessor_of(primitive, name, attribute) {
                    Some((accessor, true)) => floats(&opened, &accessors, accessor)?,
                    Some((accessor, false)) => {
                        at_corners(&opened, &accessors, place, &floats(&opened, &accessors, accessor)?)?
                    }
                    None => continue,
                };
                if values.len() != place.faces.len() {
                    let path = format!("meshes[{}].primitives[{}]", place.mesh, place.primitive);
                    let what = format!("{} values of {name} for {} faces", values.len(), place.faces.len());
                    return Err(ParseError::json(path, what));
                }
                found += 1;
                // A column counts where every primitive has it.
                if n == 0 {
                    columns.insert(name, Vec::with_capacity(faces));
                }
                if let Some(column) = columns.get_mut(name) {
                    column.extend(values);
                }
            }
            if found == 0 {
                return Ok(None);
            }
            columns.retain(|_, column| column.len() == place.faces.end as usize);
        }
        Ok(settings.map(|settings| StoredValues { columns, settings }))
    };
    read().map_err(|e| opened.error(e))
}

/// True where all primitives have values that look as if they could be used again; what they are is not read.
pub(in crate::io) fn are_there(scene: &Scene) -> bool {
    let are_there = |opened: Opened<'_>| {
        let root = opened.root().ok()?;
        let is_there = |place: &PrimitiveFaces| {
            let (_, primitive) = marked(&root, place)?;
            let mut needed = names().filter(|(name, _)| NEEDED.contains(name));
            Some(needed.all(|(name, attribute)| {
                accessor_of(primitive, name, attribute).is_some_and(|(accessor, _)| is_float(&opened, accessor))
            }))
        };
        Some(scene.primitives.iter().all(|place| is_there(place).unwrap_or(false)))
    };
    Opened::new(scene).ok().flatten().and_then(are_there).unwrap_or(false)
}

/// The accessor of a column's values, and whether it has one for each triangle.
fn accessor_of(primitive: &Value, name: &str, attribute: &str) -> Option<(usize, bool)> {
    let of_triangles = per_triangle(primitive, name).map(|accessor| (accessor, true));
    of_triangles.or_else(|| Some((index(primitive.get("attributes")?.get(attribute)?)?, false)))
}

/// CSV column and glTF attribute of every component of every quantity.
fn names() -> impl Iterator<Item = (&'static str, &'static str)> {
    Quantity::ALL.into_iter().flat_map(|q| q.columns().iter().copied().zip(q.attributes().iter().copied()))
}

/// What marks a primitive as ours, and the primitive.
fn marked<'r>(root: &'r Object, place: &PrimitiveFaces) -> Option<(&'r Value, &'r Value)> {
    let mesh = root.get("meshes")?.get(place.mesh)?;
    let primitive = mesh.get("primitives")?.get(place.primitive)?;
    let mark = mesh.pointer("/extras/osculate").or_else(|| primitive.pointer("/extras/osculate"))?;
    Some((mark, primitive))
}

fn per_triangle(primitive: &Value, name: &str) -> Option<usize> {
    index(primitive.get("extensions")?.get(FACE_VALUES)?.get("values")?.get(name)?.get("accessor")?)
}

fn is_float(opened: &Opened<'_>, accessor: usize) -> bool {
    opened.document.accessors.get(accessor).is_some_and(|accessor| match &accessor.component_type {
        Checked::Valid(component) => component.0 == ComponentType::F32,
        Checked::Invalid => false,
    })
}

fn floats(opened: &Opened<'_>, accessors: &Accessors<'_>, number: usize) -> Result<Vec<f32>, ParseError> {
    let path = format!("accessors[{number}]");
    if !is_float(opened, number) {
        return Err(ParseError::json(path, "values of faces must be 32-bit floats"));
    }
    let array = accessors.any(json::Index::new(number as u32), &path)?;
    let count = array.len() as u32;
    let raw = array.raw()?;
    Ok((0..count).map(|i| raw.get(i).first_chunk().map_or(0.0, |&bytes| f32::from_le_bytes(bytes))).collect())
}

/// The value at the first corner of each face.
fn at_corners(
    opened: &Opened<'_>,
    accessors: &Accessors<'_>,
    place: &PrimitiveFaces,
    values: &[f32],
) -> Result<Vec<f32>, ParseError> {
    let path = format!("meshes[{}].primitives[{}]", place.mesh, place.primitive);
    let primitive = opened.document.meshes.get(place.mesh).and_then(|mesh| mesh.primitives.get(place.primitive));
    let Some(primitive) = primitive else { return Ok(Vec::new()) };
    let corners = corners_of(accessors, primitive, &path, values.len() as u32)?;
    Ok(corners.into_iter().map(|[a, _, _]| values[a as usize]).collect())
}
