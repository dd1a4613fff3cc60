//! What the calls of bindings take: groups of the commands' options.

use super::{AttributesArgs, EstimationArgs, MeshArgs, PathArgs, PlaceArgs, ReadingArgs, ThreadsArgs, ViewArgs};
use clap::Args;

/// A mesh from arrays.
#[derive(Debug, Args)]
pub(in crate::cli) struct BuildCall {
    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// A mesh from a file.
#[derive(Debug, Args)]
pub(in crate::cli) struct ReadCall {
    #[command(flatten)]
    pub(in crate::cli) reading: ReadingArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// The curvature of a mesh.
#[derive(Debug, Args)]
pub(in crate::cli) struct EstimateCall {
    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) attributes: AttributesArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// The curvature of a mesh from arrays.
#[derive(Debug, Args)]
pub(in crate::cli) struct ArraysCall {
    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) attributes: AttributesArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// What is in a file.
#[derive(Debug, Args)]
pub(in crate::cli) struct InspectCall {
    #[command(flatten)]
    pub(in crate::cli) reading: ReadingArgs,

    #[command(flatten)]
    pub(in crate::cli) view: ViewArgs,

    #[command(flatten)]
    pub(in crate::cli) mesh: MeshArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// The disk of one face.
#[derive(Debug, Args)]
pub(in crate::cli) struct DiskCall {
    #[command(flatten)]
    pub(in crate::cli) place: PlaceArgs,

    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}

/// Paths along a principal direction.
#[derive(Debug, Args)]
pub(in crate::cli) struct TraceCall {
    #[command(flatten)]
    pub(in crate::cli) path: PathArgs,

    #[command(flatten)]
    pub(in crate::cli) place: PlaceArgs,

    #[command(flatten)]
    pub(in crate::cli) estimation: EstimationArgs,

    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,
}
