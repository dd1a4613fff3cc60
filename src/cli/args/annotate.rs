//! `osculate annotate`.

use super::{CommonArgs, EstimationArgs, InputArgs, LookArgs, MeshArgs};
use crate::cli::choices::FormatArg;
use crate::cli::parse::vector;
use clap::Args;
use glam::DVec3;
use osculate::{AnnotateOptions, Colormap};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct AnnotateArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    /// File to write; its extension chooses the format: .glb, .gltf, .ply, .csv or .npz. - for standard output
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    /// Output format, where the extension does not tell
    #[arg(long, value_enum)]
    pub(in crate::cli) format: Option<FormatArg>,

    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) look: LookArgs,

    /// Take the values that a glTF input carries from an earlier run instead of estimating them
    #[arg(long, help_heading = "Estimation")]
    reuse: bool,

    /// Also write a picture of the colour scales (.png or .svg)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) legend: Option<PathBuf>,

    /// Also write the boundary, feature and non-manifold edges as glTF lines (.glb)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) edges: Option<PathBuf>,

    /// With --edges: also the silhouette for this direction from the viewer to the mesh, in the
    /// input's axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "edges", allow_hyphen_values = true,
          help_heading = "Output")]
    pub(in crate::cli) view: Option<DVec3>,

    /// Also write counts, seconds per stage and percentiles of the values as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) stats: Option<PathBuf>,

    /// Fail if the output exists instead of replacing it
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) no_clobber: bool,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}

impl AnnotateArgs {
    pub(in crate::cli) fn options(&self) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions {
            read: self.input.reading.options()?,
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
