//! `osculate section`.

use super::{CommonArgs, InputArgs, MeshArgs, SpaceArgs};
use crate::cli::parse::plane;
use clap::Args;
use std::path::PathBuf;

/// A plane.
#[derive(Debug, Args)]
pub(in crate::cli) struct PlaneArgs {
    /// The plane a x + b y + c z + d = 0, in the input's coordinates; a, b, c not all 0
    #[arg(long, value_name = "A,B,C,D", value_parser = plane, allow_hyphen_values = true)]
    pub(in crate::cli) plane: [f64; 4],
}

#[derive(Debug, Args)]
pub(in crate::cli) struct SectionArgs {
    #[command(flatten)]
    pub(in crate::cli) input: InputArgs,

    #[command(flatten)]
    pub(in crate::cli) plane: PlaneArgs,

    /// File to write; its extension chooses the format: .glb or .svg
    #[arg(short, long, value_name = "FILE")]
    pub(in crate::cli) output: PathBuf,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) space: SpaceArgs,

    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
}
