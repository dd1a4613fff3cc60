//! `osculate inspect`.

use super::{CommonArgs, InputArgs, MeshArgs};
use crate::cli::choices::ReportFormat;
use crate::cli::parse::vector;
use clap::Args;
use glam::DVec3;

/// A direction to look from.
#[derive(Debug, Args)]
pub(in crate::cli) struct ViewArgs {
    /// Also count the silhouette edges for this direction from the viewer to the mesh, in the input's
    /// axes
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, allow_hyphen_values = true)]
    pub(in crate::cli) view: Option<DVec3>,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct InspectArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    /// For people or for machines
    #[arg(long, value_enum, default_value_t = ReportFormat::Text)]
    pub(in crate::cli) format: ReportFormat,

    #[command(flatten)]
    pub(in crate::cli) view: ViewArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}
