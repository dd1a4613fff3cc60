//! `osculate synth`.

use super::CommonArgs;
use crate::cli::choices::ShapeArg;
use crate::cli::parse::{cells, vector};
use clap::Args;
use glam::DVec3;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct SynthArgs {
    /// What to make
    #[arg(value_enum)]
    pub(in crate::cli) shape: ShapeArg,

    /// Mesh to write; its extension chooses the format: .stl, .ply or .obj
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    /// Also write the exact curvature of every face as CSV: that of the surface without noise,
    /// nearest to the face's barycentre
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) exact: Option<PathBuf>,

    /// Radius of the sphere or cylinder, radius of the torus' centre circle; above 0
    #[arg(long, value_name = "LENGTH", default_value_t = 3.0, help_heading = "Shape")]
    pub(in crate::cli) radius: f64,

    /// Radius of the torus' tube; above 0, below --radius
    #[arg(long, value_name = "LENGTH", default_value_t = 1.0, help_heading = "Shape")]
    pub(in crate::cli) tube: f64,

    /// Height of the cylinder; above 0
    #[arg(long, value_name = "LENGTH", default_value_t = 6.0, help_heading = "Shape")]
    pub(in crate::cli) height: f64,

    /// Lengths of the box, or axes of the ellipsoid, along x, y and z; above 0
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, default_value = "4,3,2", help_heading = "Shape")]
    pub(in crate::cli) size: DVec3,

    /// Radius of the fillets of the fillet-box; below half the shortest length
    #[arg(long, value_name = "LENGTH", default_value_t = 0.5, help_heading = "Shape")]
    pub(in crate::cli) fillet: f64,

    /// Number of faces, roughly; 4 to 100000000
    #[arg(long, value_name = "N", default_value_t = 10_000, help_heading = "Mesh")]
    pub(in crate::cli) faces: usize,

    /// Cells are this many times as long along u (around) as along v; 0.001 to 1000
    #[arg(long, value_name = "A", default_value_t = 1.0, help_heading = "Mesh")]
    pub(in crate::cli) aspect: f64,

    /// Cells along u and v instead of --faces and --aspect; boxes: along a flat and across half a
    /// fillet
    #[arg(long, value_name = "U,V", value_parser = cells, conflicts_with_all = ["faces", "aspect"], help_heading = "Mesh")]
    pub(in crate::cli) cells: Option<[usize; 2]>,

    /// Parameters move by up to this share of a cell at random; 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, help_heading = "Mesh")]
    pub(in crate::cli) jitter: f64,

    /// Standard deviation of a random displacement of every coordinate, in mean edges; 0 or more
    #[arg(long, value_name = "EDGES", default_value_t = 0.0, help_heading = "Mesh")]
    pub(in crate::cli) noise: f64,

    /// Noise of a range scanner: standard deviation, in mean edges, of errors along --scan-view that
    /// are alike at neighbouring vertices, in steps of half of it; 0 or more
    #[arg(long, value_name = "EDGES", default_value_t = 0.0, help_heading = "Mesh")]
    pub(in crate::cli) scan_noise: f64,

    /// Direction in which the scanner of --scan-noise looks
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, default_value = "1,2,3", allow_hyphen_values = true,
          help_heading = "Mesh")]
    pub(in crate::cli) scan_view: DVec3,

    /// Chooses the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Mesh")]
    pub(in crate::cli) seed: u64,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}
