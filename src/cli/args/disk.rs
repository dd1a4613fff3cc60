//! `osculate disk`.

use super::{CommonArgs, EstimationArgs, InputArgs, MeshArgs, PlaceArgs, SpaceArgs};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(in crate::cli) struct DiskArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    /// File to write: .glb
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    /// Also write the value of every diameter as CSV: angle, curvature, lengths, chord, stops. - for standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(in crate::cli) values: Option<PathBuf>,

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
