//! `osculate batch`.

use super::{CommonArgs, ReadingArgs, SettingsArgs};
use crate::cli::choices::{FormatArg, PictureFormat};
use clap::Args;
use osculate::AnnotateOptions;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct BatchArgs {
    /// Mesh files, folders with all mesh files in and below them, and quoted patterns such as
    /// "scans/**/*.stl"
    #[arg(required = true, value_name = "IN")]
    pub(in crate::cli) inputs: Vec<PathBuf>,

    #[command(flatten)]
    reading: ReadingArgs,

    /// Folder to write to, made where it is missing. It mirrors the tree below the deepest folder that
    /// holds all inputs; osculate-batch.jsonl in it tells what became of each file
    #[arg(short, long, value_name = "DIR")]
    pub(in crate::cli) output: PathBuf,

    /// Format of all outputs
    #[arg(long, value_enum, default_value_t = FormatArg::Glb)]
    pub(in crate::cli) format: FormatArg,

    /// Skip inputs whose output is newer and was made with the same settings by the same version, as
    /// osculate-batch.jsonl tells
    #[arg(long)]
    pub(in crate::cli) resume: bool,

    /// Name the output of part.stl part.stl.glb instead of part.glb
    #[arg(long)]
    pub(in crate::cli) keep_extension: bool,

    #[command(flatten)]
    pub(in crate::cli) settings: SettingsArgs,

    /// Also write a picture of the colour scales beside each output, as NAME.legend.png or .svg
    #[arg(long, value_enum, value_name = "FORMAT", help_heading = "Output")]
    pub(in crate::cli) legend: Option<PictureFormat>,

    /// Also write the boundary, feature and non-manifold edges as glTF lines beside each output, as
    /// NAME.edges.glb
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) edges: bool,

    /// Also write counts, seconds per stage and percentiles of the values beside each output, as
    /// NAME.stats.json
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) stats: bool,

    /// Fail where an output exists instead of replacing it
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) no_clobber: bool,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}

impl BatchArgs {
    /// What holds for every file; the files written besides come with each.
    pub(in crate::cli) fn options(&self) -> Result<AnnotateOptions, osculate::Error> {
        Ok(AnnotateOptions { summarise: self.stats, ..self.settings.options(&self.reading)? })
    }
}
