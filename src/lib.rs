//! Curvature of every face of a triangle mesh.

mod annotate;
mod annotation;
mod color;
mod curvature;
mod disk;
mod error;
mod inspect;
mod io;
mod mesh;
mod progress;
mod quantity;
mod section;
mod soup;
mod statistics;
pub mod synth;
mod triangulate;

pub use annotate::{AnnotateOptions, UpAxis, annotate};
pub use annotation::{Annotation, ColorCarrier, LARGEST_EXACT_FACE, Space, Unit};
pub use color::{ColorScale, Colormap, PALETTE, Range, Rgb};
pub use curvature::{CurvatureOptions, Estimator, FaceClass, FaceCurvature, Radius, estimate, from_disk};
pub use disk::{Diameter, Disk, Frame, Leg};
pub use error::{Error, ParseError, Place};
pub use inspect::{EdgeLengths, Inspection, SceneSummary, inspect};
pub use io::{Destination, InputFormat, Output, OutputFormat, check_size, read, read_bytes, write};
pub use mesh::{
    Across, Bounds, EdgeCounts, EdgeKind, Face, FaceState, FirstDefects, HalfEdge, Mesh, MeshOptions, MeshReport,
    Topology, Vertex,
};
pub use progress::{NoProgress, Progress, Stage};
pub use quantity::{Quantity, Selection};
pub use section::{Crossing, Plane, Stop};
pub use soup::{Group, MAX_FACES, Node, Note, Positions, Scene, Soup, Transform};
pub use statistics::{CurvatureSummary, Percentiles, Seconds, Summary};
