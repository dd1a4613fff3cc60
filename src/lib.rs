//! Curvature of every face of a triangle mesh.
//!
//! Data flows one way: a file becomes a [`Soup`] (triangles as the file gives them), the soup a
//! [`Mesh`] (welded, connected, every edge classified), the mesh one [`FaceCurvature`] per face, and
//! mesh and values together an [`Annotation`], which is written as glTF, PLY or CSV.
//!
//! ```
//! use osculate::{CurvatureOptions, Mesh, MeshOptions, NoProgress, Positions, Soup, estimate};
//!
//! // A tetrahedron; `osculate::read` gives a soup from a file.
//! let corners = vec![[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
//! let faces = vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
//! let soup = Soup::new(Positions::F64(corners), faces);
//!
//! // Its edges are sharper than the default feature angle, so every face is flat.
//! let mesh = Mesh::from_soup(&soup, &MeshOptions::default())?;
//! let values = estimate(&mesh, &CurvatureOptions::default(), &NoProgress)?;
//! assert!(values.iter().all(|v| v.k_max == 0.0 && v.is_estimated()));
//! # Ok::<(), osculate::Error>(())
//! ```
//!
//! The whole job in one call, as the command line does it, is [`annotate`]; a page to look at is
//! [`report`](report()). What every quantity means, with formula, unit, sign and range: `docs/quantities.md`. Why
//! things are as they are: `docs/decisions.md`.

// The command line calls the library by the name that everybody uses, and sees little more of it than everybody.
#[cfg(feature = "cli")]
extern crate self as osculate;

mod annotate;
mod annotated;
mod annotation;
// For the program and for bindings; no part of the interface.
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
mod color;
mod condition;
mod curvature;
mod cut;
mod disk;
mod edge_lines;
mod error;
mod inspect;
mod io;
mod legend;
mod lines;
mod mesh;
mod numbers;
mod options;
mod order_statistics;
mod place;
mod progress;
mod quantity;
mod report;
mod section;
mod soup;
mod space;
mod statistics;
mod stored;
pub mod synth;
mod trace;
mod triangulate;
mod unfolding;
mod value_notes;
mod vertex_values;
mod wording;

/// Single stages, for benches; no part of the interface.
#[doc(hidden)]
pub mod stages {
    pub use crate::mesh::stages::{connect, weld};
}

/// The vectors of the interface, whose version is part of it.
pub use glam;

pub use annotate::annotate;
pub use annotated::{Annotated, Written};
pub use annotation::{Annotation, ColorCarrier, Layout};
pub use color::{ColorRange, ColorScale, Colormap, Rgb};
pub use condition::Condition;
pub use curvature::{
    CurvatureOptions, Estimator, FaceClass, FaceCurvature, Method, Radius, disk_at, estimate, estimate_owned,
    from_disk, normal_curvature,
};
pub use cut::cut;
pub use disk::{Diameter, Disk, Frame, Leg};
pub use edge_lines::edge_layers;
pub use error::{Error, FilePlace, ParseError};
pub use inspect::{Defect, DefectPlace, EdgeLengths, Inspection, SceneSummary, inspect, inspect_with};
pub use io::{
    Destination, InputFormat, LineScene, Output, OutputFormat, ReadOptions, read, read_bytes, read_with, stored_values,
    write, write_lines, write_mesh, write_svg,
};
/// What programs need that write many files; no part of the interface.
#[doc(hidden)]
pub use io::{abandon_outputs_at_exit, check_folder, check_outputs, real_path, remove_abandoned_outputs};
pub use lines::{Layer, Polyline};
pub use mesh::{
    Across, Bounds, EdgeCounts, EdgeKind, Face, FaceState, FirstDefects, HalfEdge, Mesh, MeshOptions, MeshReport,
    PositionsRef, SameVertex, Topology, Vertex,
};
pub use options::AnnotateOptions;
pub use place::Place;
pub use progress::{NoProgress, Progress, Stage};
pub use quantity::{Quantity, Selection};
pub use report::{PictureOptions, ReportOptions, Reported, ViewFrom, report};
pub use section::{Crossing, Features, Plane, Stop};
pub use soup::{Group, MAX_FACES, Node, Note, Original, Positions, PrimitiveFaces, Scene, Soup, Transform};
pub use space::{Space, Unit, UpAxis};
pub use statistics::{CurvatureSummary, Percentiles, Seconds, Summary};
pub use stored::StoredValues;
pub use trace::{Along, Trace, TraceEnd, TraceOptions, TracePoint, spread_seeds, trace};
pub use vertex_values::VertexValues;
