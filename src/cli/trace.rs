//! `osculate trace`.

use super::Outcome;
use super::args::TraceArgs;
use super::messages::Messages;
use super::place::{extension, read_mesh};
use super::progress::Bars;
use osculate::{Along, Error, Layer, LineScene, Mesh, Output, Trace, TraceEnd};
use serde_json::json;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::Write as _;

pub(super) fn run(args: &TraceArgs, messages: &Messages) -> Result<Outcome, Error> {
    let extension = extension(&args.output, &["glb", "csv"])?;
    let curvature = args.estimation.options();
    let options = args.path.options();
    let input = read_mesh(&args.input, &[&args.output], &args.mesh, messages)?;
    let mesh = &input.mesh;
    let seeds = args.path.seeds_on(mesh, &args.place)?;
    let traces = osculate::trace(mesh, &seeds, &curvature, &options, &Bars::new(messages.wants_progress()))?;

    let mut out = Output::create(&args.output)?;
    if extension == "csv" {
        out.write_all(csv(mesh, &traces, options.along).as_bytes()).map_err(|e| out.error(e))?;
    } else {
        let (name, color) = match options.along {
            Along::Max => ("traces of dir_max", [213, 94, 0]),
            Along::Min => ("traces of dir_min", [0, 114, 178]),
        };
        let lines = traces.iter().map(|trace| trace.path.clone()).collect();
        let layers = [Layer { name: name.into(), color, lines, values: Vec::new() }];
        let ends: Vec<_> = traces.iter().map(|trace| (trace.backward_end, trace.end)).collect();
        let extras = json!({ "osculate": { "steps": options.steps, "ends": ends, "estimator": curvature.estimator } });
        let space = args.space.space(input.format)?;
        osculate::write_lines(&LineScene { layers: &layers, origin: mesh.origin(), space, extras }, &mut out)?;
    }
    out.finish()?;
    messages.info(&tell(&traces));
    Ok(Outcome::of(input.has_defects))
}

/// How many traces ended why.
fn tell(traces: &[Trace]) -> String {
    let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
    for end in traces.iter().flat_map(|t| t.backward_end.into_iter().chain([t.end])) {
        *ends.entry(reason(end)).or_default() += 1;
    }
    let ends: Vec<String> = ends.iter().map(|(reason, n)| format!("{n} {reason}")).collect();
    let points: usize = traces.iter().map(|t| t.points.len()).sum();
    format!("{} traces, {points} centres; ended: {}", traces.len(), ends.join(", "))
}

fn reason(end: TraceEnd) -> &'static str {
    match end {
        TraceEnd::Steps => "after all steps",
        TraceEnd::Boundary => "at a boundary",
        TraceEnd::Feature => "at a feature",
        TraceEnd::NonManifold => "at a non-manifold edge",
        TraceEnd::Umbilic => "where no direction is principal",
        TraceEnd::Stuck => "where no step was possible",
    }
}

/// One row per centre, in the input's own coordinates.
fn csv(mesh: &Mesh, traces: &[Trace], along: Along) -> String {
    let mut csv =
        String::from("trace,step,x,y,z,face,weight_a,weight_b,weight_c,k_max,k_min,dir_x,dir_y,dir_z,along\n");
    let along = if along == Along::Max { "max" } else { "min" };
    for (t, trace) in traces.iter().enumerate() {
        for (step, centre) in trace.points.iter().enumerate() {
            let p = centre.point + mesh.origin();
            let [a, b, c] = centre.place.weights;
            let d = centre.direction;
            // A place without estimate, where a trace ends, has no curvature to tell.
            let [k_max, k_min] = [centre.curvature.k_max, centre.curvature.k_min]
                .map(|k| if k.is_finite() { k.to_string() } else { String::new() });
            // Writing to a string cannot fail.
            let _ = writeln!(
                csv,
                "{t},{step},{},{},{},{},{a},{b},{c},{},{},{},{},{},{along}",
                p.x, p.y, p.z, centre.place.face.0, k_max, k_min, d.x, d.y, d.z
            );
        }
    }
    csv
}
