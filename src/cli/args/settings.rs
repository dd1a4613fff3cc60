//! What annotating one file and annotating many have in common.

use super::{EstimationArgs, LookArgs, MeshArgs, ReadingArgs};
use crate::options::OF_ESTIMATION;
use clap::Args;
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
    #[arg(long, help_heading = "Estimation", conflicts_with_all = OF_ESTIMATION)]
    reuse: bool,
}

impl SettingsArgs {
    /// The library's options, without the files that are written besides.
    pub(in crate::cli) fn options(&self, reading: &ReadingArgs) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions {
            read: reading.options()?,
            mesh: self.mesh.options(),
            curvature: self.estimation.options(),
            reuse: self.reuse,
            ..self.look.options()?
        })
    }
}
