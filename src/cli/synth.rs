//! `osculate synth`.

use super::args::SynthArgs;
use super::choices::ShapeArg;
use super::messages::Messages;
use super::{Outcome, open};
use crate::wording::counted;
use clap::ValueEnum;
use glam::DVec3;
use osculate::Error;
use osculate::synth::{Grid, RoundedBox, ScanNoise, Surface, Synthetic};
use std::io::Write;

pub(super) fn run(args: &SynthArgs, messages: &Messages) -> Result<Outcome, Error> {
    check(args)?;
    if args.exact.as_ref().is_some_and(|exact| osculate::real_path(exact) == osculate::real_path(&args.output)) {
        return Err(Error::Usage(format!("{} is named for two outputs", args.output.display())));
    }
    // Opened before any work, so that a wrong folder is known at once.
    let exact = args.exact.as_deref().map(open).transpose()?;
    let scan = ScanNoise { deviation: args.scan_noise, view: args.scan_view, seed: args.seed };
    let synthetic = scan.apply(build(args)?);
    osculate::write_mesh(&synthetic.soup, &args.output)?;
    if let Some(mut out) = exact {
        out.write_all(synthetic.exact_csv().as_bytes()).map_err(|e| out.error(e))?;
        out.finish()?;
    }
    messages.info(&format!("{}: {}", args.output.display(), counted(synthetic.soup.face_count(), "face")));
    Ok(Outcome::Done)
}

const MOST_FACES: usize = 100_000_000;

/// Faces of a shape of so many cells, about.
fn faces_of(shape: ShapeArg, u: usize, v: usize) -> usize {
    match shape {
        ShapeArg::Box => 12 * u * u,
        ShapeArg::FilletBox => 12 * (u + 2 * v) * (u + 2 * v),
        _ => 2 * u * v,
    }
}

fn check(args: &SynthArgs) -> Result<(), Error> {
    let usage = |what: &str| Err(Error::Usage(what.to_owned()));
    /// So that coordinates are numbers of 32 bits.
    const LONGEST: f64 = 1e30;
    let shortest = args.size().min_element();
    let lengths = [args.radius(), args.tube(), args.height(), args.size().max_element()];
    if let Some(option) = args.unused() {
        let shape = args.shape.to_possible_value();
        return Err(Error::Usage(format!(
            "{option} does not apply to {}",
            shape.as_ref().map_or("", |s| s.get_name())
        )));
    }
    match args.shape {
        _ if !(shortest > 0.0 && lengths.into_iter().all(|length| length > 0.0 && length <= LONGEST)) => {
            usage("--radius, --tube, --height and --size must be above 0 and at most 1e30")
        }
        ShapeArg::Torus if args.tube() >= args.radius() => {
            usage("--tube must be below --radius, or the torus cuts itself")
        }
        ShapeArg::FilletBox if !(args.fillet() > 0.0 && 2.0 * args.fillet() < shortest) => {
            usage("--fillet must be above 0 and below half the shortest of --size")
        }
        _ if !(0.0..0.5).contains(&args.jitter) => {
            usage("--jitter must be 0 or more and below 0.5, or triangles turn over")
        }
        _ if !(args.noise >= 0.0 && args.noise.is_finite()) => usage("--noise must be 0 or more"),
        _ if !(args.scan_noise >= 0.0 && args.scan_noise.is_finite()) => usage("--scan-noise must be 0 or more"),
        _ if args.scan_view.try_normalize().is_none() => usage("--scan-view must not be 0,0,0"),
        _ if !(0.001..=1000.0).contains(&args.aspect) => usage("--aspect must be 0.001 to 1000"),
        _ if !(4..=MOST_FACES).contains(&args.faces) => usage("--faces must be 4 to 100000000"),
        _ if args.cells.is_some_and(|[u, v]| faces_of(args.shape, u, v) > MOST_FACES) => {
            usage("--cells makes more than 100000000 faces")
        }
        _ => Ok(()),
    }
}

fn build(args: &SynthArgs) -> Result<Synthetic, Error> {
    let surface = match args.shape {
        ShapeArg::Plane => Surface::Plane,
        ShapeArg::Sphere => Surface::Sphere { radius: args.radius() },
        ShapeArg::Cylinder => Surface::Cylinder { radius: args.radius(), height: args.height() },
        ShapeArg::Torus => Surface::Torus { major: args.radius(), minor: args.tube() },
        ShapeArg::Ellipsoid => Surface::Ellipsoid { axes: 0.5 * args.size() },
        ShapeArg::Saddle => Surface::Saddle,
        ShapeArg::MonkeySaddle => Surface::MonkeySaddle,
        ShapeArg::Wave => Surface::Wave,
        ShapeArg::Box => return Ok(rounded_box(args, 0.0).build()),
        ShapeArg::FilletBox => return Ok(rounded_box(args, args.fillet()).build()),
    };
    let grid = match args.cells {
        Some([u, v]) => {
            let [least_u, least_v] = surface.least_cells();
            if u < least_u || v < least_v {
                return Err(Error::Usage(format!("--cells must be at least {least_u},{least_v} for this shape")));
            }
            Grid::new(surface, u, v)
        }
        None => Grid::with_faces(surface, args.faces, args.aspect),
    };
    Ok(Grid { jitter: args.jitter, noise: args.noise, seed: args.seed, ..grid }.build())
}

/// Cells of a flat and of half a fillet: as given, or so that both are about as long.
fn rounded_box(args: &SynthArgs, fillet: f64) -> RoundedBox {
    let DVec3 { x, y, z } = args.size();
    let flat = (x + y + z) / 3.0 - 2.0 * fillet;
    let arc = std::f64::consts::FRAC_PI_4 * fillet;
    let [flat_cells, fillet_cells] = args.cells.unwrap_or_else(|| {
        let across = (args.faces as f64 / 12.0).sqrt();
        let cell = (flat + 2.0 * arc) / across;
        [(flat / cell).round().max(1.0) as usize, (arc / cell).round().max(1.0) as usize]
    });
    RoundedBox { size: args.size(), fillet, flat_cells, fillet_cells, noise: args.noise, seed: args.seed }
}
