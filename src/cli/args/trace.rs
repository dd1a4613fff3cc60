//! `osculate trace`.

use super::{CommonArgs, EstimationArgs, InputArgs, MeshArgs, PlaceArgs, SpaceArgs};
use crate::cli::choices::AlongArg;
use crate::cli::parse::seeds;
use clap::Args;
use osculate::TraceOptions;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct TraceArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    /// File to write; its extension chooses the format: .glb or .csv
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    /// Direction to follow
    #[arg(long, value_enum, default_value_t = AlongArg::Max, help_heading = "Path")]
    pub(in crate::cli) along: AlongArg,

    /// Most steps, each as long as the disk's radius; 1 to 1000000
    #[arg(long, value_name = "M", default_value_t = TraceOptions::default().steps, help_heading = "Path")]
    pub(in crate::cli) steps: usize,

    /// Go both ways from each seed
    #[arg(long, help_heading = "Path")]
    pub(in crate::cli) both: bool,

    /// Trace from this many faces spread evenly over the area, instead of from one place
    #[arg(long, value_name = "N", conflicts_with_all = ["face", "point"], value_parser = seeds, help_heading = "Path")]
    pub(in crate::cli) seeds: Option<usize>,

    #[command(flatten)]
    pub(in crate::cli) place: PlaceArgs,

    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) space: SpaceArgs,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}
