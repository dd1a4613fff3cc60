//! Takes out of a document what an earlier run added, so that annotating twice equals annotating once.
//!
//! What Osculate adds is marked by an entry `osculate` in its `extras`, which other programs keep when
//! they renumber a document. Attributes cannot be marked: they are ours by name where the mesh is.

use super::document::vertex_attribute;
use super::draft::Draft;
use super::references::{Kind, Object, index};
use crate::quantity::Quantity;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The entry of `extras` that marks what is ours.
pub(super) const MARK: &str = "osculate";

/// The extension by which a viewer chooses between looks.
pub(super) const VARIANTS: &str = "KHR_materials_variants";

/// Our extension of primitives: values of faces.
pub(super) const FACE_VALUES: &str = "OSCULATE_face_values";

/// Primitives (mesh, primitive) whose own look was ours: there is no original look behind it.
pub(super) type Primary = BTreeSet<(usize, usize)>;

/// Removes everything that is ours; its numbers become free.
pub(super) fn strip(draft: &mut Draft<'_>) -> Primary {
    let root = &mut draft.root;
    let looks = our_looks(root);
    let variants = strip_variants(root);
    let mut primary = Primary::new();
    let mut accessors = BTreeSet::new();
    for (m, mesh) in members(root, "meshes").enumerate() {
        let is_ours = is_marked(mesh);
        let primitives = mesh.get_mut("primitives").and_then(Value::as_array_mut);
        for (p, primitive) in primitives.into_iter().flatten().enumerate() {
            let is_ours = is_ours || is_marked(primitive);
            unmark(primitive);
            let Some(primitive) = primitive.as_object_mut() else { continue };
            let mut names: Vec<String> = Vec::new();
            if is_ours {
                names.extend(our_attributes());
                if let Some(extension) = take_extension(primitive, FACE_VALUES) {
                    accessors_in(&extension, &mut accessors);
                }
            }
            let materials = materials_of(primitive);
            names.extend(materials.iter().filter_map(|m| looks.get(m)?.clone()));
            if primitive.get("material").and_then(index).is_some_and(|m| looks.contains_key(&m)) {
                primitive.remove("material");
                primary.insert((m, p));
            }
            strip_mappings(primitive, &looks, &variants);
            if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
                accessors.extend(names.iter().filter_map(|name| index(&attributes.remove(name)?)));
            }
        }
        unmark(mesh);
    }
    remove_name(root, FACE_VALUES);
    super::metadata::strip(draft);
    for kind in [Kind::Material, Kind::Texture, Kind::Image, Kind::Sampler] {
        let ours: Vec<usize> =
            members(&mut draft.root, kind.list()).enumerate().filter(|(_, v)| is_marked(v)).map(|(i, _)| i).collect();
        draft.free(kind, ours);
    }
    draft.free_unused(Kind::Accessor, &accessors);
    primary
}

/// The names of all attributes that Osculate writes.
pub(super) fn our_attributes() -> impl Iterator<Item = String> {
    let of_faces = Quantity::ALL.into_iter().flat_map(|q| q.attributes()).map(|&name| name.to_owned());
    of_faces.chain(Quantity::ALL.into_iter().filter(|q| q.is_number()).map(vertex_attribute))
}

/// True for an object that Osculate added or annotated.
fn is_marked(object: &Value) -> bool {
    object.pointer("/extras/osculate").is_some_and(Value::is_object)
}

fn unmark(object: &mut Value) {
    if !is_marked(object) {
        return;
    }
    if let Some(extras) = object.get_mut("extras").and_then(Value::as_object_mut) {
        extras.remove(MARK);
        if extras.is_empty()
            && let Some(object) = object.as_object_mut()
        {
            object.remove("extras");
        }
    }
}

/// The members of a list of the document.
fn members<'r>(root: &'r mut Object, list: &str) -> impl Iterator<Item = &'r mut Value> {
    root.get_mut(list).and_then(Value::as_array_mut).into_iter().flatten()
}

/// Our materials, each with the attribute that its colours come from.
fn our_looks(root: &mut Object) -> BTreeMap<usize, Option<String>> {
    let ours = members(root, "materials").enumerate().filter(|(_, material)| is_marked(material));
    ours.map(|(m, material)| {
        let texture = material.pointer("/pbrMetallicRoughness/baseColorTexture");
        let colors = material.pointer("/extras/osculate/attribute").and_then(Value::as_str);
        let set = texture.map(|t| t.get("texCoord").and_then(Value::as_u64).unwrap_or(0));
        (m, set.map(|set| format!("TEXCOORD_{set}")).or(colors.map(str::to_owned)))
    })
    .collect()
}

/// The materials of a primitive: its own and those of variants.
fn materials_of(primitive: &Object) -> Vec<usize> {
    let mappings = primitive.get("extensions").and_then(|e| e.get(VARIANTS)?.get("mappings")?.as_array());
    let variants = mappings.into_iter().flatten().filter_map(|mapping| mapping.get("material"));
    primitive.get("material").into_iter().chain(variants).filter_map(index).collect()
}

/// Removes our variants and gives the new number of each variant that stays.
fn strip_variants(root: &mut Object) -> Vec<Option<usize>> {
    let mut renumbered = Vec::new();
    let list = root.get_mut("extensions").and_then(|e| e.get_mut(VARIANTS)?.get_mut("variants")?.as_array_mut());
    let Some(list) = list else { return renumbered };
    let mut next = 0..;
    renumbered.extend(list.iter().map(|variant| if is_marked(variant) { None } else { next.next() }));
    list.retain(|variant| !is_marked(variant));
    if list.is_empty() && !renumbered.is_empty() {
        take_extension(root, VARIANTS);
        remove_name(root, VARIANTS);
    }
    renumbered
}

/// Removes the mappings to our materials and variants and renumbers the variants of others.
fn strip_mappings(primitive: &mut Object, looks: &BTreeMap<usize, Option<String>>, variants: &[Option<usize>]) {
    let list = primitive.get_mut("extensions").and_then(|e| e.get_mut(VARIANTS)?.get_mut("mappings")?.as_array_mut());
    let Some(list) = list else { return };
    let before = list.len();
    list.retain_mut(|mapping| {
        if mapping.get("material").and_then(index).is_some_and(|m| looks.contains_key(&m)) {
            return false;
        }
        let Some(numbers) = mapping.get_mut("variants").and_then(Value::as_array_mut) else { return true };
        let had = numbers.len();
        *numbers = (numbers.iter())
            .filter_map(|number| match index(number).and_then(|i| variants.get(i)) {
                Some(renumbered) => renumbered.map(Value::from),
                None => Some(number.clone()),
            })
            .collect();
        !numbers.is_empty() || had == 0
    });
    if list.is_empty() && before > 0 {
        take_extension(primitive, VARIANTS);
    }
}

/// Removes an extension of an object, and `extensions` with the last one.
pub(super) fn take_extension(object: &mut Object, name: &str) -> Option<Value> {
    let extensions = object.get_mut("extensions")?.as_object_mut()?;
    let taken = extensions.remove(name)?;
    if extensions.is_empty() {
        object.remove("extensions");
    }
    Some(taken)
}

/// Removes a name from `extensionsUsed`, and the list with the last one.
pub(super) fn remove_name(root: &mut Object, name: &str) {
    let Some(used) = root.get_mut("extensionsUsed").and_then(Value::as_array_mut) else { return };
    let had = used.len();
    used.retain(|used| used != name);
    if used.is_empty() && had > 0 {
        root.remove("extensionsUsed");
    }
}

/// The accessors that our extension names: every number in it that stands under `accessor`.
fn accessors_in(extension: &Value, found: &mut BTreeSet<usize>) {
    match extension {
        Value::Object(object) => {
            for (key, value) in object {
                match index(value) {
                    Some(accessor) if key == "accessor" => _ = found.insert(accessor),
                    _ => accessors_in(value, found),
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| accessors_in(value, found)),
        _ => {}
    }
}
