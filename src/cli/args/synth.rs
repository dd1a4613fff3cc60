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
    /// nearest to the face's barycentre. - for standard output
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) exact: Option<PathBuf>,

    /// Radius of the sphere or cylinder, radius of the torus' centre circle; above 0 [default: 3]
    #[arg(long, value_name = "LENGTH", help_heading = "Shape")]
    radius: Option<f64>,

    /// Radius of the torus' tube; above 0, below --radius [default: 1]
    #[arg(long, value_name = "LENGTH", help_heading = "Shape")]
    tube: Option<f64>,

    /// Height of the cylinder; above 0 [default: 6]
    #[arg(long, value_name = "LENGTH", help_heading = "Shape")]
    height: Option<f64>,

    /// Lengths of the box, or axes of the ellipsoid, along x, y and z; above 0 [default: 4,3,2]
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, help_heading = "Shape")]
    size: Option<DVec3>,

    /// Radius of the fillets of the fillet-box; below half the shortest length [default: 0.5]
    #[arg(long, value_name = "LENGTH", help_heading = "Shape")]
    fillet: Option<f64>,

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

    /// Parameters move by up to this share of a cell at random; 0 or more, below 0.5
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

impl SynthArgs {
    /// Radius of the sphere or cylinder, or of the torus' centre circle.
    pub(in crate::cli) fn radius(&self) -> f64 {
        self.radius.unwrap_or(3.0)
    }

    /// Radius of the torus' tube.
    pub(in crate::cli) fn tube(&self) -> f64 {
        self.tube.unwrap_or(1.0)
    }

    /// Height of the cylinder.
    pub(in crate::cli) fn height(&self) -> f64 {
        self.height.unwrap_or(6.0)
    }

    /// Lengths of the box, or axes of the ellipsoid.
    pub(in crate::cli) fn size(&self) -> DVec3 {
        self.size.unwrap_or(DVec3::new(4.0, 3.0, 2.0))
    }

    /// Radius of the fillets of the fillet-box.
    pub(in crate::cli) fn fillet(&self) -> f64 {
        self.fillet.unwrap_or(0.5)
    }

    /// An option that is given and that the shape has no use for.
    pub(in crate::cli) fn unused(&self) -> Option<&'static str> {
        use ShapeArg::{Box, Cylinder, Ellipsoid, FilletBox, Sphere, Torus};
        let is = |shapes: &[ShapeArg]| shapes.contains(&self.shape);
        let options = [
            ("--radius", self.radius.is_some(), is(&[Sphere, Cylinder, Torus])),
            ("--tube", self.tube.is_some(), is(&[Torus])),
            ("--height", self.height.is_some(), is(&[Cylinder])),
            ("--size", self.size.is_some(), is(&[Ellipsoid, Box, FilletBox])),
            ("--fillet", self.fillet.is_some(), is(&[FilletBox])),
            ("--jitter", self.jitter != 0.0, !is(&[Box, FilletBox])),
            ("--aspect", self.aspect != 1.0, !is(&[Box, FilletBox])),
        ];
        options.into_iter().find_map(|(name, is_given, is_used)| (is_given && !is_used).then_some(name))
    }
}
