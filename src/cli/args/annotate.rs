//! `osculate annotate`.

use super::{CommonArgs, InputArgs, OutputsArgs, SettingsArgs};
use clap::Args;
use osculate::AnnotateOptions;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(in crate::cli) struct AnnotateArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    #[command(flatten)]
    pub(in crate::cli) settings: SettingsArgs,

    #[command(flatten)]
    pub(in crate::cli) outputs: OutputsArgs,

    /// Also write counts, seconds per stage and percentiles of the values, in the input's unit, as JSON. - for standard
    /// output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) stats: Option<PathBuf>,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}

impl AnnotateArgs {
    pub(in crate::cli) fn options(&self) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions {
            reserved: self.stats.iter().filter(|path| *path != Path::new("-")).cloned().collect(),
            // Percentiles are only told where someone asks.
            summarise: self.stats.is_some() || self.common.verbose,
            ..self.outputs.add_to(self.settings.options(&self.input.reading)?)
        })
    }
}
