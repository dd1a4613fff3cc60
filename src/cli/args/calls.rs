//! What the calls of bindings take: groups of the commands' options.

use super::{
    AttributesArgs, EstimationArgs, LookArgs, MeshArgs, OutputsArgs, PathArgs, PlaceArgs, ReadingArgs, ThreadsArgs,
    ViewArgs,
};
use clap::Args;

/// Calls by the groups of options that each takes.
macro_rules! calls {
    ($($(#[$what:meta])* $name:ident { $($group:ident: $args:ty),+ })+) => {$(
        $(#[$what])*
        #[derive(Debug, Args)]
        pub(in crate::cli) struct $name {
            $(
                #[command(flatten)]
                pub(in crate::cli) $group: $args,
            )+
        }
    )+};
}

calls! {
    /// A mesh from arrays.
    BuildCall { mesh: MeshArgs, threads: ThreadsArgs }
    /// A mesh from a file.
    ReadCall { reading: ReadingArgs, mesh: MeshArgs, threads: ThreadsArgs }
    /// The curvature of a mesh.
    EstimateCall { estimation: EstimationArgs, attributes: AttributesArgs, threads: ThreadsArgs }
    /// The curvature of a mesh from arrays.
    ArraysCall { estimation: EstimationArgs, mesh: MeshArgs, attributes: AttributesArgs, threads: ThreadsArgs }
    /// A mesh and its curvature, written.
    WriteCall { look: LookArgs, outputs: OutputsArgs, threads: ThreadsArgs }
    /// What is in a file.
    InspectCall { reading: ReadingArgs, view: ViewArgs, mesh: MeshArgs, threads: ThreadsArgs }
    /// The disk of one face.
    DiskCall { place: PlaceArgs, estimation: EstimationArgs, threads: ThreadsArgs }
    /// Paths along a principal direction.
    TraceCall { path: PathArgs, place: PlaceArgs, estimation: EstimationArgs, threads: ThreadsArgs }
}
