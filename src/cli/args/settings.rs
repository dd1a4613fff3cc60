//! What annotating one file and annotating many have in common.

use super::{EstimationArgs, LookArgs, MeshArgs, ReadingArgs};
use crate::cli::parse::vector;
use clap::Args;
use glam::DVec3;
use osculate::AnnotateOptions;

#[derive(Debug, Args)]
pub(in crate::cli) struct SettingsArgs {
    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) look: LookArgs,

    /// Take the values that a glTF input carries from an earlier run instead of estimating them
    #[arg(long, help_heading = "Estimation")]
    reuse: bool,

    /// With --edges: also the silhouette for this direction from the viewer to the mesh, in the
    /// input's axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, requires = "edges", allow_hyphen_values = true,
          help_heading = "Output")]
    view: Option<DVec3>,
}

impl SettingsArgs {
    /// The library's options, without the files that are written besides.
    pub(in crate::cli) fn options(&self, reading: &ReadingArgs) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions {
            read: reading.options()?,
            mesh: self.mesh.options(),
            curvature: self.estimation.options(),
            select: self.look.select.clone(),
            selection: self.look.attributes.attributes.clone(),
            color_by: self.look.colors.color_by.into(),
            colormap: self.look.colors.colormap()?,
            range: self.look.colors.range,
            carrier: self.look.color.into(),
            variants: self.look.variants.clone(),
            layout: self.look.layout.into(),
            force: self.look.force,
            metadata: self.look.metadata,
            compress: self.look.compress.into(),
            up: self.look.space.up.map(Into::into),
            unit: self.look.space.unit.map(Into::into),
            reuse: self.reuse,
            vertex_values: self.look.vertex_values,
            view: self.view,
            ..AnnotateOptions::default()
        })
    }
}
