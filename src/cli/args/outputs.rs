//! Where the results of one mesh go.

use crate::cli::choices::FormatArg;
use clap::Args;
use osculate::AnnotateOptions;
use std::path::PathBuf;

/// The output and what is written beside it.
#[derive(Debug, Args)]
pub(in crate::cli) struct OutputsArgs {
    /// File to write; its extension chooses the format: .glb, .gltf, .ply, .csv or .npz. - for standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Output", display_order = 0)]
    pub(in crate::cli) output: PathBuf,

    /// Output format, where the extension does not tell
    #[arg(long, value_enum, help_heading = "Output", display_order = 0)]
    pub(in crate::cli) format: Option<FormatArg>,

    /// Also write a picture of the colour scales (.png or .svg)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    legend: Option<PathBuf>,

    /// Also write the boundary, feature and non-manifold edges as glTF lines (.glb)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    edges: Option<PathBuf>,

    /// Fail if the output exists instead of replacing it
    #[arg(long, help_heading = "Output")]
    pub(in crate::cli) no_clobber: bool,
}

impl OutputsArgs {
    /// The options with what is written besides.
    pub(in crate::cli) fn add_to(&self, options: AnnotateOptions) -> AnnotateOptions {
        AnnotateOptions { legend: self.legend.clone(), edges: self.edges.clone(), ..options }
    }
}
