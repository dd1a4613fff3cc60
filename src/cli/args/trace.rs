//! `osculate trace`.

use super::{CommonArgs, EstimationArgs, InputArgs, MeshArgs, PathArgs, PlaceArgs, SpaceArgs};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct TraceArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    /// File to write; its extension chooses the format: .glb or .csv
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    #[command(flatten)]
    pub(in crate::cli) path: PathArgs,

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
