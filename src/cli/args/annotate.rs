//! `osculate annotate`.

use super::{CommonArgs, InputArgs, SettingsArgs};
use crate::cli::choices::FormatArg;
use clap::Args;
use osculate::AnnotateOptions;
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
    pub(in crate::cli) settings: SettingsArgs,

    /// Also write a picture of the colour scales (.png or .svg)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) legend: Option<PathBuf>,

    /// Also write the boundary, feature and non-manifold edges as glTF lines (.glb)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) edges: Option<PathBuf>,

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
            legend: self.legend.clone(),
            edges: self.edges.clone(),
            reserved: self.stats.iter().cloned().collect(),
            // Percentiles are only told where someone asks.
            summarise: self.stats.is_some() || self.common.verbose,
            ..self.settings.options(&self.input.reading)?
        })
    }
}
