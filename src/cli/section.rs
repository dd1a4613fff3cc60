//! `osculate section`.

use super::Outcome;
use super::args::SectionArgs;
use super::messages::Messages;
use super::place::{extension, read_mesh};
use super::progress::Bars;
use osculate::{Error, Layer, LineScene, Output, Plane, Polyline, Space};
use serde_json::json;

pub(super) fn run(args: &SectionArgs, messages: &Messages) -> Result<Outcome, Error> {
    let extension = extension(&args.output, &["glb", "svg"])?;
    let input = read_mesh(&args.input, &[&args.output], &args.mesh, messages)?;
    let mesh = &input.mesh;
    let [a, b, c, d] = args.plane.plane;
    let plane = Plane::of_equation(mesh, args.plane.plane);
    let lines = osculate::cut(mesh, &plane, &Bars::new(messages.wants_progress()));
    if lines.is_empty() {
        return Err(Error::Usage(format!(
            "the plane {a} x + {b} y + {c} z + {d} = 0 does not cut {}; see its bounds with osculate inspect",
            args.input.path.display()
        )));
    }
    let lengths: Vec<f64> = lines.iter().map(Polyline::length).collect();
    let closed = lines.iter().filter(|line| line.closed).count();

    let mut out = Output::create(&args.output)?;
    if extension == "svg" {
        osculate::write_svg(&lines, &plane, mesh.origin(), &mut out)?;
    } else {
        let extras = json!({ "osculate": {
            "plane": args.plane.plane, "lengths": lengths, "closed": lines.iter().map(|l| l.closed).collect::<Vec<_>>(),
        } });
        let open = lines.len() - closed;
        let layers = [Layer {
            name: format!("section: {closed} closed, {open} open"),
            color: [0, 0, 0],
            lines,
            values: Vec::new(),
        }];
        let space: Space = args.space.space(input.format)?;
        osculate::write_lines(&LineScene { layers: &layers, origin: mesh.origin(), space, extras }, &mut out)?;
    }
    out.finish()?;
    let total: f64 = lengths.iter().sum();
    messages.info(&format!("{closed} closed and {} open polylines, total length {total}", lengths.len() - closed));
    Ok(Outcome::of(input.has_defects))
}
