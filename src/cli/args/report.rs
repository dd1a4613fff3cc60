//! `osculate report`.

use super::input::ReadingArgs;
use super::{CommonArgs, EstimationArgs, MeshArgs, SpaceArgs};
use crate::cli::choices::ColorByArg;
use crate::cli::parse::{range, size, view};
use crate::options::OF_ESTIMATION;
use clap::Args;
use clap::builder::ArgPredicate;
use osculate::{ColorRange, Colormap, PictureOptions, ReportOptions, ViewFrom};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct ReportArgs {
    /// Mesh to read, or two to compare: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is
    /// undone first. - for standard input. Values that an annotated glTF carries are shown as they are
    #[arg(required = true, num_args = 1..=2)]
    pub(in crate::cli) inputs: Vec<PathBuf>,

    #[command(flatten)]
    reading: ReadingArgs,

    /// Page to write: .html, one file that needs nothing else. - for standard output
    #[arg(short, long, value_name = "FILE", required_unless_present = "png")]
    pub(in crate::cli) output: Option<PathBuf>,

    /// Picture to write (.png), of the first mesh, rendered without a browser
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) png: Option<PathBuf>,

    /// Estimate the values also where an annotated glTF carries them, as any other option of estimation does,
    /// --feature-angle and --weld
    #[arg(long, help_heading = "Estimation",
          default_value_ifs = OF_ESTIMATION.map(|id| (id, ArgPredicate::IsPresent, "true")))]
    no_reuse: bool,

    #[command(flatten)]
    estimation: EstimationArgs,

    #[command(flatten)]
    mesh: MeshArgs,

    #[command(flatten)]
    space: SpaceArgs,

    /// Quantity that the colours show first
    #[arg(long, value_enum, value_name = "QUANTITY", default_value_t = ColorByArg::Mean, help_heading = "Look")]
    color_by: ColorByArg,

    /// Colours to begin with; default: blue-red for signed quantities, viridis for others, one colour per class
    #[arg(long, value_name = "NAME", help_heading = "Look",
          value_parser = clap::builder::PossibleValuesParser::new(Colormap::names()))]
    colormap: Option<String>,

    /// Values of the first and last colour to begin with, in the quantity's unit; auto takes the 95th percentile of
    /// the magnitudes
    #[arg(long, value_name = "LOW:HIGH|auto", value_parser = range, default_value = "auto", allow_hyphen_values = true,
          help_heading = "Look")]
    range: ColorRange,

    /// Faces that a page draws of each mesh, 1000 to 16000000; one with more is thinned for display, and the page
    /// says so
    #[arg(long, value_name = "N", default_value_t = ReportOptions::default().most_faces, help_heading = "Look")]
    max_faces: usize,

    /// With --png: where the viewer stands: iso, the positive end of an axis (x, y, z), or a direction from the
    /// viewer to the mesh in the input's axes
    #[arg(long, value_name = "iso|x|y|z|X,Y,Z", value_parser = view, default_value = "iso", requires = "png",
          allow_hyphen_values = true, help_heading = "Picture")]
    view: ViewFrom,

    /// With --png: width and height in pixels, each 64 to 8192
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1200x900", requires = "png", help_heading = "Picture")]
    size: [u32; 2],

    /// With --png: no background
    #[arg(long, requires = "png", help_heading = "Picture")]
    transparent: bool,

    /// With --png: no legend
    #[arg(long, requires = "png", help_heading = "Picture")]
    no_legend: bool,

    /// Fail if an output exists instead of replacing it
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) no_clobber: bool,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}

impl ReportArgs {
    pub(in crate::cli) fn options(&self) -> Result<ReportOptions, osculate::Error> {
        let color_by: Option<osculate::Quantity> = self.color_by.into();
        Ok(ReportOptions {
            read: self.reading.options()?,
            mesh: self.mesh.options(),
            curvature: self.estimation.options(),
            reuse: !self.no_reuse,
            color_by: color_by
                .ok_or_else(|| osculate::Error::Usage("a report shows colours; give --color-by a quantity".into()))?,
            colormap: self.colormap.as_deref().map(Colormap::named).transpose()?,
            range: self.range,
            up: self.space.up.map(Into::into),
            unit: self.space.unit.map(Into::into),
            most_faces: self.max_faces,
            picture: PictureOptions {
                size: self.size,
                view: self.view,
                transparent: self.transparent,
                legend: !self.no_legend,
            },
        })
    }
}
