//! What a page knows besides its arrays: one JSON object.

use super::ReportOptions;
use super::display::Display;
use super::pack::Packed;
use super::subject::Subject;
use crate::color::{ColorRange, Colormap, class_index};
use crate::curvature::FaceClass;
use crate::mesh::Face;
use crate::quantity::Quantity;
use crate::space::Unit;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Groups listed by name; a file may have one for every face.
const MOST_GROUPS: usize = 500;

/// The quantities that faces can be coloured by, in the order of the page's menu.
pub(super) const SHOWN: [Quantity; 9] = [
    Quantity::Mean,
    Quantity::Gauss,
    Quantity::KMax,
    Quantity::KMin,
    Quantity::ShapeIndex,
    Quantity::Curvedness,
    Quantity::Class,
    Quantity::Coverage,
    Quantity::Confidence,
];

/// What all meshes of a page share: schema, colour maps, quantities and the look that it opens with.
pub(super) fn shared(options: &ReportOptions) -> Value {
    let palettes: serde_json::Map<String, Value> = Colormap::all()
        .map(|map| (map.name().to_owned(), STANDARD.encode(map.palette().as_flattened()).into()))
        .collect();
    let quantities = SHOWN.into_iter().chain([Quantity::GaussPerimeter]).map(|q| {
        json!({
            "name": q.token(),
            "dimension": q.dimension(),
            "signed": q.is_signed(),
            "map": Colormap::default_for(q).name(),
        })
    });
    json!({
        "schema": 1,
        "version": env!("CARGO_PKG_VERSION"),
        "palettes": palettes,
        "quantities": quantities.collect::<Vec<_>>(),
        "classes": FaceClass::ALL.iter().map(|c| json!({
            "code": c.code(), "name": c.name(), "index": class_index(*c),
        })).collect::<Vec<_>>(),
        "methods": crate::Method::ALL.map(crate::Method::name),
        "start": {
            "quantity": options.color_by.token(),
            "map": options.colormap.map(Colormap::name),
            "range": match options.range { ColorRange::Auto => Value::Null, ColorRange::Fixed(low, high) => json!([low, high]) },
        },
    })
}

/// What is told of one mesh.
pub(super) fn of(subject: &Subject, display: &Display, packed: &Packed) -> Value {
    let origin = subject.mesh.origin();
    let mut sentences = Vec::new();
    let all = subject.mesh.face_count();
    if let Some(numbers) = &display.numbers {
        sentences.push(format!(
            "Thinned for display: {} of {} faces are drawn, each with its own values and number. Plots and selections count the faces drawn, the tables all faces; edges are not drawn.",
            numbers.len(), all
        ));
    }
    if display.instances_left_out > 0 {
        sentences.push(format!(
            "The scene shows some meshes more than once; each is drawn where it stands first, {} further placements are not drawn.",
            display.instances_left_out
        ));
    }
    if subject.values.iter().all(|v| !v.is_estimated()) {
        sentences.push(
            "No face has an estimate: its curvature is beyond what 32-bit floats can hold, or the file's values say so. The mesh is shown in grey.".into(),
        );
    }
    let mut inspection = json!(subject.inspection);
    // A page travels; where the file lay on the sender's machine is nobody's business.
    let path = std::path::Path::new(&subject.inspection.input);
    let file = path.file_name().filter(|_| !subject.name.is_empty());
    inspection["input"] = json!(file.map_or("standard input".into(), |name| name.to_string_lossy()));
    if subject.unit.is_some() {
        let others = subject.inspection.suggestions.iter().filter(|suggestion| !suggestion.contains("--unit"));
        inspection["suggestions"] = others.cloned().collect();
    }
    let mut groups: Vec<Value> = subject
        .groups
        .iter()
        .filter(|group| !group.name.is_empty())
        .map(|group| json!({ "name": group.name, "from": group.faces.start, "to": group.faces.end }))
        .collect();
    let groups_left_out = groups.len().saturating_sub(MOST_GROUPS);
    groups.truncate(MOST_GROUPS);
    json!({
        "name": if subject.name.is_empty() { "standard input" } else { &subject.name },
        "unit": subject.unit.map(Unit::symbol),
        "up": if subject.space.z_up { "z" } else { "y" },
        "inspection": inspection,
        "defects": subject.inspection.report.defects(),
        "notes": subject.notes,
        "sentences": sentences,
        "settings": subject.settings,
        "seconds": subject.seconds.iter().map(|&(stage, seconds)| json!([stage, seconds])).collect::<Vec<_>>(),
        "classes": classes(subject),
        "estimated": subject.values.iter().filter(|v| v.is_estimated()).count(),
        "groups": groups,
        "groups_left_out": groups_left_out,
        "bodies": display.bodies.iter().map(|b| json!({ "from": b.faces.start, "to": b.faces.end, "scale": b.scale })).collect::<Vec<_>>(),
        "faces": display.corners.len(),
        "vertices": packed.vertices,
        "low": (packed.low + origin).to_array(),
        "step": packed.step,
        "size": packed.size,
        "arrays": packed.arrays.iter().map(|a| json!({ "name": a.name, "count": a.count, "planes": a.planes })).collect::<Vec<_>>(),
    })
}

/// Count and area of every class, over all faces.
fn classes(subject: &Subject) -> Value {
    let mut shares = FaceClass::ALL.map(|class| (class, 0_usize, 0.0));
    for (value, f) in subject.values.iter().zip(0..) {
        let share = &mut shares[(value.class.code() + 1) as usize];
        let area = subject.mesh.area(Face(f));
        share.1 += 1;
        share.2 += if area.is_finite() { area } else { 0.0 };
    }
    json!(shares.map(|(class, count, area)| json!({ "class": class.code(), "count": count, "area": area })))
}
