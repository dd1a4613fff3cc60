//! `osculate disk`.

use super::args::DiskArgs;
use super::messages::Messages;
use super::place::{extension, read_mesh};
use super::{Outcome, open};
use glam::DVec3;
use osculate::{CurvatureOptions, Disk, Error, FaceCurvature, Frame, Layer, LineScene, Mesh, Output, Polyline};
use serde_json::json;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

pub(super) fn run(args: &DiskArgs, messages: &Messages) -> Result<Outcome, Error> {
    extension(&args.output, &["glb"])?;
    let options = args.estimation.options();
    let values = args.values.as_deref().filter(|path| *path != Path::new("-"));
    let outputs: Vec<_> = std::iter::once(args.output.as_path()).chain(values).collect();
    let input = read_mesh(&args.input, &outputs, &args.mesh, messages)?;
    let mesh = &input.mesh;
    let place = args.place.find(mesh)?;
    let (disk, frame, value) = osculate::disk_at(mesh, place, &options)?;

    let layers = layers(mesh, place.face, &disk, &frame, &value);
    let extras = json!({ "osculate": {
        "face": place.face.0, "weights": place.weights, "k_max": value.k_max, "k_min": value.k_min,
        "gauss_perimeter": value.gauss_perimeter, "radius": value.radius, "coverage": value.coverage,
        "class": value.class, "estimator": options.estimator,
    } });
    let scene = LineScene { layers: &layers, origin: mesh.origin(), space: args.space.space(input.format)?, extras };
    let mut out = Output::create(&args.output)?;
    osculate::write_lines(&scene, &mut out)?;
    let mut values = args.values.as_deref().map(open).transpose()?;
    if let Some(out) = &mut values {
        out.write_all(diameters(&disk, &options).as_bytes()).map_err(|e| out.error(e))?;
    }
    Output::finish_all(values.into_iter().chain([out]).collect())?;
    messages.info(&format!(
        "face {}: k_max {}, k_min {}, radius {}, coverage {}, {}",
        place.face.0,
        value.k_max,
        value.k_min,
        value.radius,
        value.coverage,
        value.class.name()
    ));
    Ok(Outcome::of(input.has_defects))
}

/// Legs, rim and the two principal directions, the longer one that of k_max (the paper's figures).
fn layers(mesh: &Mesh, face: osculate::Face, disk: &Disk, frame: &Frame, value: &FaceCurvature) -> Vec<Layer> {
    let legs = disk.paths(mesh, face, frame).map(Polyline::open);
    let rim = disk.legs().iter().enumerate().map(|(i, leg)| frame.lift(disk.direction(frame, i), leg.end));
    let principal = |direction: DVec3, length: f64| {
        let half = 0.5 * length * disk.radius() * direction;
        vec![Polyline::open([frame.centre - half, frame.centre + half])]
    };
    let layer = |name: &str, color, lines| Layer { name: name.into(), color, lines, values: Vec::new() };
    vec![
        layer("legs", [90, 90, 90], legs.collect()),
        layer("rim", [0, 0, 0], vec![Polyline::closed(rim)]),
        layer("dir_max", [213, 94, 0], principal(value.dir_max.as_dvec3(), 1.6)),
        layer("dir_min", [0, 114, 178], principal(value.dir_min.as_dvec3(), 0.8)),
    ]
}

/// One row per diameter.
fn diameters(disk: &Disk, options: &CurvatureOptions) -> String {
    let mut csv =
        String::from("angle_degrees,curvature,length_forward,length_backward,chord,stop_forward,stop_backward\n");
    for d in disk.diameters() {
        let curvature = osculate::normal_curvature(&d, options.estimator).map(|k| k.to_string()).unwrap_or_default();
        let along = d.forward.end.x + d.backward.end.x;
        let chord = along.hypot(d.forward.end.y - d.backward.end.y);
        // Writing to a string cannot fail.
        let _ = writeln!(
            csv,
            "{},{curvature},{},{},{chord},{},{}",
            d.angle.to_degrees(),
            d.forward.length,
            d.backward.length,
            d.forward.stop.name(),
            d.backward.stop.name()
        );
    }
    csv
}
