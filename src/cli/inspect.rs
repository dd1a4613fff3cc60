//! `osculate inspect`.

use super::args::InspectArgs;
use super::choices::ReportFormat;
use super::messages::Messages;
use super::progress::Bars;
use super::{Outcome, print};
use crate::wording::{rounded, short};
use osculate::{Bounds, Error, Inspection};
use std::fmt::Write;

pub(super) fn run(args: &InspectArgs, messages: &Messages) -> Result<Outcome, Error> {
    let bars = Bars::new(messages.wants_progress());
    let input = &args.input;
    let inspection =
        osculate::inspect_with(&input.path, &input.reading.options()?, &args.mesh.options(), args.view.view, &bars)?;
    let text = match args.format {
        ReportFormat::Json => serde_json::to_string_pretty(&inspection).unwrap_or_default() + "\n",
        ReportFormat::Text => describe(&inspection),
    };
    print(text.as_bytes())?;
    Ok(Outcome::of(inspection.has_defects()))
}

/// A page for people. Writing to a string cannot fail, so results of `writeln!` are dropped.
fn describe(found: &Inspection) -> String {
    let mut page = String::new();
    let report = &found.report;
    let mut line = |label: &str, value: &str| {
        let _ = writeln!(page, "{label:16}{value}");
    };
    line("file", &format!("{} ({})", found.input, found.format.name()));
    line("faces", &report.faces.to_string());
    line("vertices", &report.vertices.to_string());
    let edges = &report.edges;
    line(
        "edges",
        &format!(
            "{} inner, {} boundary, {} feature (above {} degrees), {} non-manifold",
            edges.inner, edges.boundary, edges.feature, found.feature_angle, edges.non_manifold
        ),
    );
    if let Some(lengths) = found.edge_lengths {
        line(
            "edge lengths",
            &format!(
                "{} mean, {} median, {} to {} without the outer tenth, {} to {} in all",
                short(lengths.mean),
                short(lengths.p50),
                short(lengths.p5),
                short(lengths.p95),
                short(lengths.min),
                short(lengths.max)
            ),
        );
    }
    line("area", &short(found.area));
    if let Some(bounds) = report.bounds {
        line("bounds", &describe_bounds(bounds));
    }
    line("components", &report.components.to_string());
    line("boundary loops", &report.boundary_loops.to_string());
    if let Some(metres) = found.metres_per_unit {
        line("unit", &format!("{} m, as the file says", short(metres)));
    }
    let orientable = if report.non_orientable_components > 0 {
        "not orientable"
    } else if report.flipped_faces > 0 {
        "not oriented"
    } else {
        "oriented"
    };
    let manifold = if edges.non_manifold > 0 { "not manifold" } else { "manifold" };
    line("surface", &format!("{}, {orientable}, {manifold}", if report.closed { "closed" } else { "open" }));
    if let Some(count) = found.silhouette_edges {
        line("silhouette", &format!("{count} edges"));
    }
    if found.groups > 0 {
        line("groups", &found.groups.to_string());
    }
    if let Some(scene) = found.scene {
        line("scene", &format!("{} meshes placed, {} faces", scene.instances, scene.faces));
        if let Some(bounds) = scene.bounds {
            line("scene bounds", &describe_bounds(bounds));
        }
    }
    for (defect, sentence) in found.defects.iter().zip(report.defects()) {
        let at = |p: &[f64; 3]| format!("({})", p.map(short).join(" "));
        let places: Vec<String> = defect.places.iter().filter_map(|place| place.at.as_ref().map(at)).collect();
        let places = if places.is_empty() { String::new() } else { format!(" at {}", places.join(", ")) };
        line("defect", &format!("{sentence}{places}"));
    }
    for note in &found.notes {
        line(if note.repaired { "repaired" } else { "note" }, &note.message);
    }
    for suggestion in &found.suggestions {
        line("suggestion", suggestion);
    }
    page
}

fn describe_bounds(Bounds { min, max }: Bounds) -> String {
    let size = max - min;
    let extent = size.max_element();
    // Far from zero, as many more as it takes to tell one end from the other.
    let digits = |value: f64| (value.abs() / extent).log10().ceil().clamp(0.0, 11.0) as usize + 5;
    let [min, max] = [min, max].map(|v| v.to_array().map(|value| rounded(value, digits(value))).join(" "));
    format!("({min}) to ({max}), size {}", size.to_array().map(short).join(" x "))
}
