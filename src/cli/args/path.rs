//! How a trace goes.

use crate::cli::choices::AlongArg;
use crate::cli::parse::seeds;
use clap::Args;
use osculate::TraceOptions;

#[derive(Debug, Args)]
#[command(next_help_heading = "Path")]
pub(in crate::cli) struct PathArgs {
    /// Direction to follow
    #[arg(long, value_enum, default_value_t = AlongArg::Max)]
    along: AlongArg,

    /// Most steps, each as long as the disk's radius; 1 to 1000000
    #[arg(long, value_name = "M", default_value_t = TraceOptions::default().steps)]
    steps: usize,

    /// Go both ways from each seed
    #[arg(long)]
    both: bool,

    /// Trace from this many faces spread evenly over the area, instead of from one place
    #[arg(long, value_name = "N", conflicts_with_all = ["face", "point"], value_parser = seeds)]
    pub(in crate::cli) seeds: Option<usize>,
}

impl PathArgs {
    pub(in crate::cli) fn options(&self) -> TraceOptions {
        TraceOptions { along: self.along.into(), steps: self.steps, both_ways: self.both }
    }
}
