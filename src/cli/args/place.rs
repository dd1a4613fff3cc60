//! Where on the surface.

use crate::cli::parse::{pair, vector};
use clap::Args;
use glam::DVec3;

/// A point of the surface.
#[derive(Debug, Args)]
#[command(next_help_heading = "Place")]
pub(in crate::cli) struct PlaceArgs {
    /// The face, by its number from 0 in the order of the input
    #[arg(long, value_name = "N")]
    pub(in crate::cli) face: Option<u64>,

    /// Where in the face: shares of the way along its first and its last edge from its first corner,
    /// both 0 or more, their sum at most 1. Default: the barycentre
    #[arg(long, value_name = "U,V", value_parser = pair, requires = "face", allow_hyphen_values = true)]
    pub(in crate::cli) at: Option<[f64; 2]>,

    /// The point of the mesh nearest to this one, in the input's coordinates; at most a tenth of the
    /// mesh's size away
    #[arg(long, value_name = "X,Y,Z", value_parser = vector, conflicts_with = "face", allow_hyphen_values = true)]
    pub(in crate::cli) point: Option<DVec3>,
}
