//! What the construction of a mesh found: counts, extent and defects.

use super::edges::EdgeKind;
use super::ids::{Face, HalfEdge};
use super::orientation::{Orientation, boundary_loops};
use super::topology::Topology;
use crate::wording::counted;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

/// Number of edges of each kind. An edge counts once, however many faces it has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct EdgeCounts {
    /// Two faces at an angle up to the feature angle.
    pub inner: usize,
    /// One face.
    pub boundary: usize,
    /// Two faces at an angle above the feature angle.
    pub feature: usize,
    /// Three or more faces.
    pub non_manifold: usize,
}

/// An axis-parallel box, in the input's own axes and units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Least coordinates.
    pub min: DVec3,
    /// Greatest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The box around the points that are finite; `None` if there are none.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().filter(|p| p.is_finite()).fold(None, |bounds: Option<Bounds>, p| {
            let (min, max) = bounds.map_or((p, p), |b| (b.min.min(p), b.max.max(p)));
            Some(Bounds { min, max })
        })
    }

    /// The eight corners of the box.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let of = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(of(0), of(1), of(2))
        })
    }

    /// Edge lengths of the box.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The middle of the box.
    pub fn center(&self) -> DVec3 {
        self.min + 0.5 * self.size()
    }
}

/// What is wrong with a face, if anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceState {
    /// Has three vertices and an area.
    Sound,
    /// Three different vertices on a line: walks cross it, but it has no curvature of its own.
    NoArea,
    /// Two corners are one vertex: an edge rather than a face, left out of the topology.
    RepeatedVertex,
    /// A coordinate is NaN or infinite: left out of the topology.
    NotFinite,
    /// The same three vertices as an earlier face: left out of the topology, given its values.
    Duplicate,
}

/// Facts about a mesh and its defects. Serialises to the object that `inspect` and `--stats` print.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MeshReport {
    /// Triangles, all of them, sound or not.
    pub faces: usize,
    /// Welded vertices that a face uses.
    pub vertices: usize,
    /// Edges of each kind.
    pub edges: EdgeCounts,
    /// Components: faces connected over edges with two faces.
    pub components: usize,
    /// Loops of boundary edges.
    pub boundary_loops: usize,
    /// Faces without area, faces that use a vertex twice included.
    pub degenerate_faces: usize,
    /// Second and later faces over the same three vertices.
    pub duplicate_faces: usize,
    /// Faces with a NaN or infinite coordinate.
    pub non_finite_faces: usize,
    /// Faces that wind against the majority of their component.
    pub flipped_faces: usize,
    /// Components without a consistent winding (Moebius strips).
    pub non_orientable_components: usize,
    /// Closed components whose normals point inwards.
    pub inside_out_components: usize,
    /// Vertices that the weld distance merged, beyond those at equal positions.
    pub vertices_merged_by_distance: usize,
    /// True when every face has a neighbour on every side.
    pub closed: bool,
    /// The first few faces of each kind of defect.
    pub first_defects: FirstDefects,
    /// Extent of all finite vertices.
    pub bounds: Option<Bounds>,
}

/// The first few faces that each kind of defect concerns.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FirstDefects {
    /// Faces without area.
    pub degenerate: Vec<u32>,
    /// Faces over the vertices of an earlier face.
    pub duplicate: Vec<u32>,
    /// Faces with a NaN or infinite coordinate.
    pub non_finite: Vec<u32>,
    /// Faces that wind against their component.
    pub flipped: Vec<u32>,
    /// Faces at an edge with three or more faces.
    pub non_manifold: Vec<u32>,
}

const FEW: usize = 5;

/// A mesh that has just been built, to be counted.
pub(super) struct Built<'m> {
    pub(super) topology: &'m Topology,
    /// Faces that take no part in the topology.
    pub(super) left_out: &'m [bool],
    pub(super) states: &'m [FaceState],
    pub(super) kinds: &'m [EdgeKind],
    pub(super) orientation: &'m Orientation,
    pub(super) non_manifold_edges: usize,
    pub(super) vertices: usize,
    pub(super) vertices_merged_by_distance: usize,
    pub(super) bounds: Option<Bounds>,
}

impl Built<'_> {
    fn edges(&self) -> EdgeCounts {
        let mut sides = [0; 4];
        for (three, _) in self.kinds.as_chunks::<3>().0.iter().zip(self.left_out).filter(|(_, left_out)| !**left_out) {
            three.iter().for_each(|&kind| sides[kind as usize] += 1);
        }
        EdgeCounts {
            inner: sides[EdgeKind::Inner as usize] / 2,
            boundary: sides[EdgeKind::Boundary as usize],
            feature: sides[EdgeKind::Feature as usize] / 2,
            non_manifold: self.non_manifold_edges,
        }
    }

    /// The first few faces for which `wrong` holds, and how many there are.
    fn first_few(&self, wrong: impl Fn(Face) -> bool + Sync) -> (usize, Vec<u32>) {
        let count = self.topology.face_count();
        let is_wrong = |f: &u32| wrong(Face(*f));
        match (0..count as u32).into_par_iter().filter(is_wrong).count() {
            0 => (0, Vec::new()),
            total => (total, (0..count as u32).filter(is_wrong).take(FEW).collect()),
        }
    }
}

impl MeshReport {
    /// Counts what there is and what is wrong with it.
    pub(super) fn of(built: &Built<'_>) -> Self {
        let Built { topology, left_out, states, kinds, orientation, .. } = *built;
        let are = |wrong: &[FaceState]| built.first_few(|f| wrong.contains(&states[f.index()]));
        let (degenerate_faces, degenerate) = are(&[FaceState::NoArea, FaceState::RepeatedVertex]);
        let (non_finite_faces, non_finite) = are(&[FaceState::NotFinite]);
        let (duplicate_faces, duplicate) = are(&[FaceState::Duplicate]);
        let (flipped_faces, flipped) = built.first_few(|f| orientation.flipped[f.index()]);
        let is_non_manifold = |h: HalfEdge| kinds[h.index()] == EdgeKind::NonManifold;
        let (_, non_manifold) = built.first_few(|f| f.half_edges().into_iter().any(is_non_manifold));
        let edges = built.edges();
        MeshReport {
            faces: topology.face_count(),
            vertices: built.vertices,
            edges,
            components: orientation.components,
            boundary_loops: boundary_loops(topology, left_out),
            degenerate_faces,
            duplicate_faces,
            non_finite_faces,
            flipped_faces,
            non_orientable_components: orientation.non_orientable,
            inside_out_components: orientation.inside_out,
            vertices_merged_by_distance: built.vertices_merged_by_distance,
            closed: edges.boundary + edges.non_manifold == 0,
            first_defects: FirstDefects { degenerate, duplicate, non_finite, flipped, non_manifold },
            bounds: built.bounds,
        }
    }

    /// True when something is wrong that makes a run end in exit code 3: degenerate, duplicate,
    /// non-finite or flipped faces, or edges with three or more faces.
    pub fn has_defects(&self) -> bool {
        self.degenerate_faces
            + self.duplicate_faces
            + self.non_finite_faces
            + self.flipped_faces
            + self.edges.non_manifold
            > 0
    }

    /// One sentence for each thing that is no defect but changes how values are to be read.
    pub fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if self.inside_out_components > 0 {
            remarks.push(format!(
                "{} with normals that point inwards: curvature there has the opposite sign",
                counted(self.inside_out_components, "closed component")
            ));
        }
        if self.non_orientable_components > 0 {
            remarks.push(format!(
                "{} with no consistent winding: the sign of each face there is its own",
                counted(self.non_orientable_components, "component")
            ));
        }
        remarks
    }

    /// One sentence for each defect, with the first few places.
    pub fn defects(&self) -> Vec<String> {
        let places = |count: usize, faces: &[u32]| {
            let list: Vec<String> = faces.iter().map(u32::to_string).collect();
            // As many edges may be at more faces.
            let is_all = faces.len() < FEW || faces.len() == count;
            let more = if is_all { "" } else { ", ..." };
            format!("face {}{more}", list.join(", "))
        };
        let first = &self.first_defects;
        let mut defects = Vec::new();
        let mut tell = |count: usize, thing: &str, what: &str, faces: &[u32]| {
            if count > 0 {
                defects.push(format!("{}{what} ({})", counted(count, thing), places(count, faces)));
            }
        };
        tell(self.degenerate_faces, "face", " without area, not estimated", &first.degenerate);
        tell(self.non_finite_faces, "face", " with NaN or infinite coordinates, not estimated", &first.non_finite);
        tell(
            self.duplicate_faces,
            "duplicate face",
            ", over the vertices of an earlier face, given its values",
            &first.duplicate,
        );
        tell(self.flipped_faces, "flipped face", ", wound against the component, given its sign", &first.flipped);
        tell(self.edges.non_manifold, "edge", " with three or more faces, where disks end", &first.non_manifold);
        defects
    }
}
