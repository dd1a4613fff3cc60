//! Commands and options. Defaults come from the library; ranges and units stand on each line.

use super::choices::{
    AlongArg, CarrierArg, ColorByArg, EstimatorArg, FormatArg, InputFormatArg, LayoutArg, LogFormat, ReportFormat,
    ShapeArg, UnitArg, UpArg,
};
use super::parse::{cells, pair, plane, quantity, radius, radius_factor, range, seeds, threads, vector};
use clap::{Args, Parser, Subcommand};
use glam::DVec3;
use osculate::{
    AnnotateOptions, Colormap, CurvatureOptions, InputFormat, MeshOptions, Radius, Range, ReadOptions, Selection,
    Space, TraceOptions,
};
use std::path::PathBuf;

const AFTER_HELP: &str = "\
Exit codes: 0 done; 1 failed, nothing written; 2 bad usage; 3 done, but the input
was repaired or has defects (they are listed on standard error).

Examples:
  osculate annotate scan.ply -o scan.glb
  osculate annotate part.stl -o part.glb --unit mm --color-by k_max
  osculate annotate part.stl -o part.csv
  osculate inspect part.stl
  osculate section part.stl --plane 0,0,1,-5 -o cut.svg

By default (--estimator auto) surfaces are fitted to the vertices around every face, as
many and of the kind that explain the mesh best; sharp edges end the window, and
confidence tells how far to trust a face. --radius asks for curvature at a scale: all
vertices within that distance. The other estimators lay a disk around every face instead:
legs of one length, the radius, walked over the mesh in normal planes.";

/// Curvature of every face of a triangle mesh, written as glTF attributes and colour maps.
#[derive(Debug, Parser)]
#[command(name = "osculate", version, about, after_help = AFTER_HELP, max_term_width = 100)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Command,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Estimate the curvature of every face and write it to a .glb, .gltf, .ply, .csv or .npz
    Annotate(Box<AnnotateArgs>),
    /// Say what is in a mesh file: counts, extent, edge kinds, defects, suggested settings
    Inspect(InspectArgs),
    /// Draw the disk of one face: its legs, rim and principal directions, as glTF lines
    Disk(Box<DiskArgs>),
    /// Step along a principal direction, from one face or many, as glTF lines or CSV
    Trace(Box<TraceArgs>),
    /// Cut the whole mesh with a plane, as glTF lines or SVG
    Section(SectionArgs),
    /// Make a synthetic mesh whose curvature is known exactly
    Synth(SynthArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page (roff); view with: osculate man | man -l -
    Man,
}

impl Command {
    pub(super) fn common(&self) -> Option<&CommonArgs> {
        match self {
            Command::Annotate(args) => Some(&args.common),
            Command::Inspect(args) => Some(&args.common),
            Command::Disk(args) => Some(&args.common),
            Command::Trace(args) => Some(&args.common),
            Command::Section(args) => Some(&args.common),
            Command::Synth(args) => Some(&args.common),
            Command::Completions { .. } | Command::Man => None,
        }
    }
}

#[derive(Debug, Args)]
pub(super) struct AnnotateArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// File to write; its extension chooses the format: .glb, .gltf, .ply, .csv or .npz. - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Output format, where the extension does not tell
    #[arg(long, value_enum)]
    pub(super) format: Option<FormatArg>,

    #[command(flatten)]
    pub(super) estimation: EstimationArgs,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) look: LookArgs,

    /// Take the values that a glTF input carries from an earlier run instead of estimating them
    #[arg(long, help_heading = "Estimation")]
    reuse: bool,

    /// Also write a picture of the colour scales (.png or .svg)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) legend: Option<PathBuf>,

    /// Also write the boundary, feature and non-manifold edges as glTF lines (.glb)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) edges: Option<PathBuf>,

    /// With --edges: also the silhouette for this direction from the viewer to the mesh, in the
    /// input's axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "edges", allow_hyphen_values = true,
          help_heading = "Output")]
    pub(super) view: Option<DVec3>,

    /// Also write counts, seconds per stage and percentiles of the values as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) stats: Option<PathBuf>,

    /// Fail if the output exists instead of replacing it
    #[arg(long, help_heading = "Output")]
    pub(super) no_clobber: bool,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(super) struct ReadingArgs {
    /// Input format, where the content does not tell
    #[arg(long, value_enum, value_name = "FORMAT")]
    input_format: Option<InputFormatArg>,

    /// Also read files in this folder that the input names, such as a glTF's buffers; may be given
    /// several times. Default: only those beside the input and below
    #[arg(long, value_name = "DIR")]
    allow_folder: Vec<PathBuf>,
}

impl ReadingArgs {
    pub(super) fn options(&self) -> Result<ReadOptions, osculate::Error> {
        if let Some(folder) = self.allow_folder.iter().find(|folder| !folder.is_dir()) {
            return Err(osculate::Error::Usage(format!("--allow-folder {}: is no folder", folder.display())));
        }
        Ok(ReadOptions { format: self.input_format.map(Into::into), allowed_folders: self.allow_folder.clone() })
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Estimation")]
pub(super) struct EstimationArgs {
    /// How curvature is estimated
    #[arg(long, value_enum, default_value_t = EstimatorArg::from(CurvatureOptions::default().estimator))]
    estimator: EstimatorArg,

    /// Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or
    /// auto: chosen for every face
    #[arg(long, value_name = "LENGTH|auto", conflicts_with = "radius_factor", value_parser = radius,
          allow_hyphen_values = true, default_value = "auto")]
    radius: Radius,

    /// The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most 1000
    #[arg(long, value_name = "F[:face|mesh]", value_parser = radius_factor, allow_hyphen_values = true)]
    radius_factor: Option<Radius>,

    /// Diameters of a disk, 3 to 360; not used by auto
    #[arg(long, value_name = "N", default_value_t = CurvatureOptions::default().diameters)]
    diameters: usize,

    /// Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1
    #[arg(long, value_name = "T", default_value_t = CurvatureOptions::default().class_tolerance,
          allow_hyphen_values = true)]
    class_tolerance: f64,
}

impl EstimationArgs {
    pub(super) fn options(&self) -> CurvatureOptions {
        CurvatureOptions {
            estimator: self.estimator.into(),
            radius: self.radius_factor.unwrap_or(self.radius),
            diameters: self.diameters,
            class_tolerance: self.class_tolerance,
            perimeter: false,
        }
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Mesh")]
pub(super) struct MeshArgs {
    /// Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to
    /// 180 (180: no features)
    #[arg(long, value_name = "DEGREES", default_value_t = MeshOptions::default().feature_angle,
          allow_hyphen_values = true)]
    feature_angle: f64,

    /// Weld vertices up to this far apart, in file units; 0 welds equal positions only
    #[arg(long, value_name = "DISTANCE", default_value_t = MeshOptions::default().weld, allow_hyphen_values = true)]
    weld: f64,
}

impl MeshArgs {
    pub(super) fn options(&self) -> MeshOptions {
        MeshOptions { weld: self.weld, feature_angle: self.feature_angle }
    }
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct LookArgs {
    #[command(flatten)]
    space: SpaceArgs,

    /// Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss,
    /// gauss_perimeter, shape_index, curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all,
    /// none
    #[arg(long, value_name = "LIST", value_parser = Selection::parse, default_value = "default")]
    attributes: Selection,

    /// Quantity that the colours show
    #[arg(long, value_enum, value_name = "QUANTITY", default_value_t = ColorByArg::Mean)]
    color_by: ColorByArg,

    /// Quantities between whose colours a viewer of a glTF file can choose (KHR_materials_variants),
    /// separated by commas; --color-by is shown first where it is among them, otherwise the first is
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = quantity)]
    variants: Vec<osculate::Quantity>,

    /// Colours; default: blue-red for signed quantities, viridis for others, one colour per class
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(Colormap::names()))]
    colormap: Option<String>,

    /// Values of the first and last colour, in the quantity's unit in the input; auto takes the 95th
    /// percentile of the magnitudes. Of several variants it is the first's
    #[arg(long, value_name = "LOW:HIGH|auto", value_parser = range, default_value = "auto", allow_hyphen_values = true)]
    range: Range,

    /// How glTF carries the colours: a palette texture (right everywhere), vertex colours in linear
    /// light (by the specification), vertex colours in sRGB (for MeshLab), or not at all
    #[arg(long, value_enum, value_name = "CARRIER", default_value_t = CarrierArg::Texture)]
    color: CarrierArg,

    /// How glTF attaches values to faces: vertices of its own for every face with values as attributes
    /// (right in every client), or vertices shared as in the input and values in an extension of the
    /// primitive (under half the size, without colours, for readers that know it)
    #[arg(long, value_enum, value_name = "LAYOUT", default_value_t = LayoutArg::Faces)]
    layout: LayoutArg,

    /// Also write values of vertices: the mean of the faces around, by area. glTF: attributes ..._VERTEX;
    /// PLY: vertex quality and properties; NPZ: arrays vertex_...
    #[arg(long)]
    vertex_values: bool,

    /// Replace attributes of a glTF input that have one of the names above but come from elsewhere;
    /// without it they stay and Osculate's are left out
    #[arg(long)]
    force: bool,
}

impl AnnotateArgs {
    pub(super) fn options(&self) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions {
            read: self.reading.options()?,
            mesh: self.mesh.options(),
            curvature: self.estimation.options(),
            selection: self.look.attributes.clone(),
            color_by: self.look.color_by.into(),
            colormap: self.look.colormap.as_deref().map(Colormap::named).transpose()?,
            range: self.look.range,
            carrier: self.look.color.into(),
            variants: self.look.variants.clone(),
            layout: self.look.layout.into(),
            force: self.look.force,
            up: self.look.space.up.map(Into::into),
            unit: self.look.space.unit.map(Into::into),
            reuse: self.reuse,
            vertex_values: self.look.vertex_values,
            legend: self.legend.clone(),
            edges: self.edges.clone(),
            view: self.view,
            reserved: self.stats.iter().cloned().collect(),
            // Percentiles are only told where someone asks.
            summarise: self.stats.is_some() || self.common.verbose,
        })
    }
}

#[derive(Debug, Args)]
pub(super) struct InspectArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// For people or for machines
    #[arg(long, value_enum, default_value_t = ReportFormat::Text)]
    pub(super) format: ReportFormat,

    /// Also count the silhouette edges for this direction from the viewer to the mesh, in the input's
    /// axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub(super) view: Option<DVec3>,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

/// A point of the surface.
#[derive(Debug, Args)]
#[command(next_help_heading = "Place")]
pub(super) struct PlaceArgs {
    /// The face, by its number from 0 in the order of the input
    #[arg(long, value_name = "N")]
    pub(super) face: Option<u64>,

    /// Where in the face: shares of the way along its first and its last edge from its first corner,
    /// both 0 or more, their sum at most 1. Default: the barycentre
    #[arg(long, value_name = "U,V", value_parser = pair, requires = "face", allow_hyphen_values = true)]
    pub(super) at: Option<[f64; 2]>,

    /// The point of the mesh nearest to this one, in the input's coordinates; at most a tenth of the
    /// mesh's size away
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, conflicts_with = "face", allow_hyphen_values = true)]
    pub(super) point: Option<DVec3>,
}

/// Axes and units of a glTF output.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct SpaceArgs {
    /// The input's up axis; glTF output is turned so that it becomes +Y. Default: z for STL, y otherwise
    #[arg(long, value_enum)]
    up: Option<UpArg>,

    /// The input's unit; glTF output is scaled to metres. Default: lengths stay as they are
    #[arg(long, value_enum)]
    unit: Option<UnitArg>,
}

impl SpaceArgs {
    pub(super) fn space(&self, input: InputFormat) -> Result<Space, osculate::Error> {
        Space::to_gltf(input, self.up.map(Into::into), self.unit.map(Into::into))
    }
}

#[derive(Debug, Args)]
pub(super) struct DiskArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// File to write: .glb
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Also write the value of every diameter as CSV: angle, curvature, lengths, chord, stops
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(super) values: Option<PathBuf>,

    #[command(flatten)]
    pub(super) place: PlaceArgs,

    #[command(flatten)]
    pub(super) estimation: EstimationArgs,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) space: SpaceArgs,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

#[derive(Debug, Args)]
pub(super) struct TraceArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// File to write; its extension chooses the format: .glb or .csv
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Direction to follow
    #[arg(long, value_enum, default_value_t = AlongArg::Max, help_heading = "Path")]
    pub(super) along: AlongArg,

    /// Most steps, each as long as the disk's radius; 1 to 1000000
    #[arg(long, value_name = "M", default_value_t = TraceOptions::default().steps, help_heading = "Path")]
    pub(super) steps: usize,

    /// Go both ways from each seed
    #[arg(long, help_heading = "Path")]
    pub(super) both: bool,

    /// Trace from this many faces spread evenly over the area, instead of from one place
    #[arg(long, value_name = "N", conflicts_with_all = ["face", "point"], value_parser = seeds, help_heading = "Path")]
    pub(super) seeds: Option<usize>,

    #[command(flatten)]
    pub(super) place: PlaceArgs,

    #[command(flatten)]
    pub(super) estimation: EstimationArgs,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) space: SpaceArgs,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

#[derive(Debug, Args)]
pub(super) struct SectionArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    pub(super) input: PathBuf,

    #[command(flatten)]
    pub(super) reading: ReadingArgs,

    /// The plane a x + b y + c z + d = 0, in the input's coordinates; a, b, c not all 0
    #[arg(long, value_name = "A,B,C,D", value_parser = plane, allow_hyphen_values = true)]
    pub(super) plane: [f64; 4],

    /// File to write; its extension chooses the format: .glb or .svg
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    #[command(flatten)]
    pub(super) mesh: MeshArgs,

    #[command(flatten)]
    pub(super) space: SpaceArgs,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

#[derive(Debug, Args)]
pub(super) struct SynthArgs {
    /// What to make
    #[arg(value_enum)]
    pub(super) shape: ShapeArg,

    /// Mesh to write; its extension chooses the format: .stl, .ply or .obj
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,

    /// Also write the exact curvature of every face as CSV: that of the surface without noise,
    /// nearest to the face's barycentre
    #[arg(long, value_name = "FILE")]
    pub(super) exact: Option<PathBuf>,

    /// Radius of the sphere or cylinder, radius of the torus' centre circle; above 0
    #[arg(long, value_name = "LENGTH", default_value_t = 3.0, help_heading = "Shape")]
    pub(super) radius: f64,

    /// Radius of the torus' tube; above 0, below --radius
    #[arg(long, value_name = "LENGTH", default_value_t = 1.0, help_heading = "Shape")]
    pub(super) tube: f64,

    /// Height of the cylinder; above 0
    #[arg(long, value_name = "LENGTH", default_value_t = 6.0, help_heading = "Shape")]
    pub(super) height: f64,

    /// Lengths of the box, or axes of the ellipsoid, along x, y and z; above 0
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, default_value = "4,3,2", help_heading = "Shape")]
    pub(super) size: DVec3,

    /// Radius of the fillets of the fillet-box; below half the shortest length
    #[arg(long, value_name = "LENGTH", default_value_t = 0.5, help_heading = "Shape")]
    pub(super) fillet: f64,

    /// Number of faces, roughly; 4 to 100000000
    #[arg(long, value_name = "N", default_value_t = 10_000, help_heading = "Mesh")]
    pub(super) faces: usize,

    /// Cells are this many times as long along u (around) as along v; 0.001 to 1000
    #[arg(long, value_name = "A", default_value_t = 1.0, help_heading = "Mesh")]
    pub(super) aspect: f64,

    /// Cells along u and v instead of --faces and --aspect; boxes: along a flat and across half a
    /// fillet
    #[arg(long, value_name = "U,V", value_parser = cells, conflicts_with_all = ["faces", "aspect"], help_heading = "Mesh")]
    pub(super) cells: Option<[usize; 2]>,

    /// Parameters move by up to this share of a cell at random; 0 to 0.5
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, help_heading = "Mesh")]
    pub(super) jitter: f64,

    /// Standard deviation of a random displacement of every coordinate, in mean edges; 0 or more
    #[arg(long, value_name = "EDGES", default_value_t = 0.0, help_heading = "Mesh")]
    pub(super) noise: f64,

    /// Noise of a range scanner: standard deviation, in mean edges, of errors along --scan-view that
    /// are alike at neighbouring vertices, in steps of half of it; 0 or more
    #[arg(long, value_name = "EDGES", default_value_t = 0.0, help_heading = "Mesh")]
    pub(super) scan_noise: f64,

    /// Direction in which the scanner of --scan-noise looks
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, default_value = "1,2,3", allow_hyphen_values = true,
          help_heading = "Mesh")]
    pub(super) scan_view: DVec3,

    /// Chooses the random numbers
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Mesh")]
    pub(super) seed: u64,

    #[command(flatten)]
    pub(super) common: CommonArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(super) struct CommonArgs {
    /// Threads to use, 1 or more; default: one per core. The output does not depend on it
    #[arg(short = 'j', long, value_name = "N", value_parser = threads)]
    pub(super) threads: Option<usize>,

    /// Say more
    #[arg(short, long, conflicts_with = "quiet")]
    pub(super) verbose: bool,

    /// Say nothing but errors
    #[arg(short, long)]
    pub(super) quiet: bool,

    /// Messages for people, or one JSON object per line
    #[arg(long, value_enum, default_value_t = LogFormat::Text)]
    pub(super) log: LogFormat,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_are_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn defaults_are_the_librarys() {
        let cli = Cli::try_parse_from(["osculate", "annotate", "a.stl", "-o", "a.glb"]).expect("valid");
        let Command::Annotate(args) = cli.command else { panic!("another command") };
        let expected = AnnotateOptions { summarise: false, ..AnnotateOptions::default() };
        assert_eq!(args.options().expect("valid"), expected);
    }

    #[test]
    fn values_may_begin_with_a_hyphen() {
        let cli =
            Cli::try_parse_from(["osculate", "annotate", "a.stl", "-o", "-", "--format", "csv", "--range", "-5:5"]);
        let Ok(Cli { command: Command::Annotate(args) }) = cli else { panic!("{cli:?}") };
        assert_eq!(args.look.range, Range::Fixed(-5.0, 5.0));
    }
}
