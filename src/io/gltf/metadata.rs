//! Values of faces for readers of `EXT_mesh_features` and `EXT_structural_metadata`: a number of a row in
//! every vertex, and a table with a column for each quantity.

use super::document::{ARRAY_BUFFER, FLOAT, Target, primitive};
use super::draft::{Draft, Piece};
use super::layout::Stream;
use super::references::{Kind, Object, each_primitive, index};
use super::strip::{remove_name, take_extension};
use crate::annotation::Annotation;
use crate::curvature::FaceClass;
use crate::error::ParseError;
use crate::quantity::Quantity;
use serde_json::{Value, json};
use std::collections::BTreeSet;

pub(super) const FEATURES: &str = "EXT_mesh_features";
pub(super) const METADATA: &str = "EXT_structural_metadata";

/// The class of our table, the label of our feature ids: by it they are known as ours.
const CLASS: &str = "osculate_face";
const CLASSES: &str = "osculate_class";

/// Refuses an original whose schema is in a file of its own.
///
/// # Errors
/// Place and reason.
pub(super) fn check(root: &Object) -> Result<(), ParseError> {
    let metadata = root.get("extensions").and_then(|extensions| extensions.get(METADATA));
    if metadata.is_some_and(|metadata| metadata.get("schemaUri").is_some()) {
        let what = "the schema is in a file of its own, which cannot be added to; leave --metadata out";
        return Err(ParseError::json(format!("extensions.{METADATA}.schemaUri"), what));
    }
    let of_others = metadata.and_then(|metadata| metadata.pointer(&format!("/schema/classes/{CLASS}")));
    if of_others.is_some_and(|class| class.pointer("/extras/osculate").is_none()) {
        let what = format!("has a class {CLASS} that does not come from Osculate; leave --metadata out");
        return Err(ParseError::json(format!("extensions.{METADATA}.schema.classes"), what));
    }
    Ok(())
}

/// Adds the table and the rows.
pub(super) fn add(annotation: &Annotation<'_>, draft: &mut Draft<'_>, targets: &[Target], quantities: &[Quantity]) {
    let table = add_table(annotation, draft, quantities);
    draft.use_extension(FEATURES);
    draft.use_extension(METADATA);
    let faces = annotation.faces();
    for target in targets {
        let stream = Stream::Row { owners: target.owners.clone(), faces: faces.clone() };
        let count = target.owners.len();
        let view = draft.add_view(Piece::Stream(stream), Some(ARRAY_BUFFER), None);
        let rows = json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": "SCALAR" });
        let rows = draft.add(Kind::Accessor, rows);
        for (&p, &count) in target.primitives.iter().zip(&target.faces) {
            let Some(primitive) = primitive(draft, target.mesh, p) else { continue };
            let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) else { continue };
            let set = (0..).find(|set| !attributes.contains_key(&attribute(*set))).unwrap_or(0);
            attributes.insert(attribute(set), rows.into());
            let extension = member(member(primitive, "extensions"), FEATURES);
            let ids = extension.entry("featureIds").or_insert_with(|| json!([]));
            if let Some(ids) = ids.as_array_mut() {
                ids.push(json!({ "label": CLASS, "featureCount": count, "attribute": set, "propertyTable": table }));
            }
        }
    }
}

/// Adds our class to the schema, and the table; gives its number.
fn add_table(annotation: &Annotation<'_>, draft: &mut Draft<'_>, quantities: &[Quantity]) -> usize {
    let faces = annotation.faces();
    let mut columns = json!({});
    let mut properties = json!({});
    for &quantity in quantities {
        let stream = Stream::Column { faces: faces.clone(), quantity };
        let view = draft.add_view(Piece::Stream(stream), None, None);
        columns[quantity.token()] = json!({ "values": view });
        properties[quantity.token()] = property(annotation, quantity);
    }
    let metadata = member(member(&mut draft.root, "extensions"), METADATA);
    let schema = member(metadata, "schema");
    schema.entry("id").or_insert_with(|| "osculate".into());
    let class = json!({
        "name": "Face", "description": "Curvature of a face", "properties": properties, "extras": { "osculate": {} },
    });
    member(schema, "classes").insert(CLASS.into(), class);
    if quantities.contains(&Quantity::Class) {
        let values: Vec<Value> =
            FaceClass::ALL.iter().map(|c| json!({ "name": c.name().replace(' ', "_"), "value": c.code() })).collect();
        member(schema, "enums").insert(CLASSES.into(), json!({ "valueType": "INT8", "values": values }));
    }
    let tables = metadata.entry("propertyTables").or_insert_with(|| json!([]));
    if !tables.is_array() {
        *tables = json!([]);
    }
    let Some(tables) = tables.as_array_mut() else { return 0 };
    tables.push(json!({ "name": "faces", "class": CLASS, "count": faces.len(), "properties": columns }));
    tables.len() - 1
}

/// What a column holds.
fn property(annotation: &Annotation<'_>, quantity: Quantity) -> Value {
    let unit = annotation.space.unit_of(quantity);
    let mut property = match quantity {
        Quantity::Face => json!({ "type": "SCALAR", "componentType": "UINT32" }),
        Quantity::Class => json!({ "type": "ENUM", "enumType": CLASSES }),
        Quantity::DirMax | Quantity::DirMin => json!({ "type": "VEC3", "componentType": "FLOAT32" }),
        _ => json!({ "type": "SCALAR", "componentType": "FLOAT32" }),
    };
    property["required"] = true.into();
    if !unit.is_empty() {
        property["description"] = format!("in {unit}").into();
    }
    property
}

/// Takes out what an earlier run added.
pub(super) fn strip(draft: &mut Draft<'_>) {
    let Some(metadata) = draft.root.get_mut("extensions").and_then(|e| e.get_mut(METADATA)) else { return };
    let Some(metadata) = metadata.as_object_mut() else { return };
    let is_ours = metadata.get("schema").and_then(|s| s.pointer(&format!("/classes/{CLASS}/extras/osculate")));
    if is_ours.is_none() {
        return;
    }
    let mut views = BTreeSet::new();
    let mut renumbered: Vec<Option<usize>> = Vec::new();
    if let Some(tables) = metadata.get_mut("propertyTables").and_then(Value::as_array_mut) {
        let mut next = 0..;
        tables.retain(|table| {
            let ours = table.get("class").is_some_and(|class| class == CLASS);
            let properties = table.get("properties").and_then(Value::as_object).filter(|_| ours);
            views.extend(properties.into_iter().flat_map(Object::values).filter_map(|p| index(p.get("values")?)));
            renumbered.push(if ours { None } else { next.next() });
            !ours
        });
        if tables.is_empty() {
            metadata.remove("propertyTables");
        }
    }
    let schema = member(metadata, "schema");
    for (list, name) in [("classes", CLASS), ("enums", CLASSES)] {
        let list_of = member(schema, list);
        list_of.remove(name);
        if list_of.is_empty() {
            schema.remove(list);
        }
    }
    if schema.keys().all(|key| key == "id") && schema.get("id").is_some_and(|id| id == "osculate") {
        metadata.remove("schema");
    }
    if metadata.is_empty() {
        take_extension(&mut draft.root, METADATA);
        remove_name(&mut draft.root, METADATA);
    }
    let accessors = strip_features(&mut draft.root, &renumbered);
    draft.free_unused(Kind::Accessor, &accessors);
    draft.free_unused(Kind::View, &views);
}

/// Takes our feature ids out of the primitives and renumbers the tables of others; gives the accessors that
/// were ours.
fn strip_features(root: &mut Object, tables: &[Option<usize>]) -> BTreeSet<usize> {
    let mut accessors = BTreeSet::new();
    let mut used = false;
    each_primitive(root, &mut |primitive| {
        let features = primitive.get_mut("extensions").and_then(|e| e.get_mut(FEATURES));
        let Some(ids) = features.and_then(|f| f.get_mut("featureIds")?.as_array_mut()) else { return };
        let mut names = Vec::new();
        ids.retain_mut(|id| {
            let table = id.get("propertyTable").and_then(index);
            if id.get("label").is_some_and(|label| label == CLASS) {
                names.extend(id.get("attribute").and_then(index).map(attribute));
                return false;
            }
            if let Some(new) = table.and_then(|table| *tables.get(table)?) {
                id["propertyTable"] = new.into();
            }
            true
        });
        if ids.is_empty() {
            take_extension(primitive, FEATURES);
        } else {
            used = true;
        }
        if let Some(attributes) = primitive.get_mut("attributes").and_then(Value::as_object_mut) {
            accessors.extend(names.iter().filter_map(|name| index(&attributes.remove(name)?)));
        }
    });
    if !used {
        remove_name(root, FEATURES);
    }
    accessors
}

fn attribute(set: usize) -> String {
    format!("_FEATURE_ID_{set}")
}

/// The object under a key, made where there is none.
fn member<'o>(object: &'o mut Object, key: &str) -> &'o mut Object {
    let value = object.entry(key).or_insert(Value::Null);
    if !value.is_object() {
        *value = json!({});
    }
    match value {
        Value::Object(object) => object,
        _ => unreachable!("it has just been made one"),
    }
}
