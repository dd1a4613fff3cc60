//! Which face lies across which edge. Knows vertex numbers, never positions.

use super::connect::connect;
use super::ids::{Face, HalfEdge, Vertex};
use rayon::prelude::*;

/// What lies across a half-edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// The half-edge of the one other face on this edge.
    Twin(HalfEdge),
    /// Nothing: the edge has one face, or its face takes no part in the topology.
    Boundary,
    /// Several faces: the edge has three or more.
    NonManifold,
}

pub(super) const BOUNDARY: u32 = u32::MAX;
pub(super) const NON_MANIFOLD: u32 = u32::MAX - 1;

/// Faces as vertex triples and the half-edge across each half-edge.
///
/// Two faces that meet in an edge are neighbours whatever their windings: where both run along the
/// edge in the same direction, one of them is flipped (see [`Topology::is_flipped`]). Faces can be
/// left out; they keep their number, have no neighbours and are no one's neighbour.
#[derive(Clone, Debug)]
pub struct Topology {
    faces: Vec<[u32; 3]>,
    across: Vec<u32>,
}

/// What [`Topology::new`] found besides.
#[derive(Default)]
pub(super) struct Found {
    /// Pairs (face, earlier face) with the same three vertices, ordered by face.
    pub(super) duplicates: Vec<(Face, Face)>,
    /// Number of edges with three or more faces.
    pub(super) non_manifold_edges: usize,
}

impl Topology {
    /// Connects faces over shared edges, leaving out those for which `left_out` is true and the
    /// second and later copies of a face. Linear in the number of faces.
    pub(super) fn new(faces: Vec<[u32; 3]>, vertex_count: usize, left_out: &[bool]) -> (Self, Found) {
        let (across, found) = connect(&faces, vertex_count, left_out);
        if found.duplicates.is_empty() {
            return (Topology { faces, across }, found);
        }
        let mut out = left_out.to_vec();
        for (copy, _) in &found.duplicates {
            out[copy.index()] = true;
        }
        drop(across);
        let (across, again) = connect(&faces, vertex_count, &out);
        let found = Found { duplicates: found.duplicates, non_manifold_edges: again.non_manifold_edges };
        (Topology { faces, across }, found)
    }

    /// The same neighbours for faces in another order: `faces` has the old number of every new face, `corners` their
    /// new vertices, `moved` takes an old half-edge to its new number.
    pub(super) fn renumbered(self, corners: Vec<[u32; 3]>, faces: &[Face], moved: impl Fn(u32) -> u32 + Sync) -> Self {
        let old = self.across;
        drop(self.faces);
        let across = |f: &Face| {
            f.half_edges().map(|h| match old[h.index()] {
                kind @ (BOUNDARY | NON_MANIFOLD) => kind,
                twin => moved(twin),
            })
        };
        let across: Vec<[u32; 3]> = faces.par_iter().map(across).collect();
        Topology { faces: corners, across: across.into_flattened() }
    }

    /// Number of faces.
    #[inline]
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// The corners of a face, in its winding.
    #[inline]
    pub fn corners(&self, face: Face) -> [Vertex; 3] {
        self.faces[face.index()].map(Vertex)
    }

    /// Vertex numbers of all faces.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// The vertex a half-edge starts from.
    #[inline]
    pub fn origin(&self, h: HalfEdge) -> Vertex {
        Vertex(self.faces.as_flattened()[h.index()])
    }

    /// The vertex a half-edge runs to.
    #[inline]
    pub fn target(&self, h: HalfEdge) -> Vertex {
        self.origin(h.next())
    }

    /// The corner of the half-edge's face that is not on the half-edge.
    #[inline]
    pub fn apex(&self, h: HalfEdge) -> Vertex {
        self.origin(h.prev())
    }

    /// Of the other two sides of a half-edge's face the one at `hub`, which is one end of the half-edge: the way around
    /// that vertex, whatever the windings there.
    #[inline]
    pub(crate) fn other_side_at(&self, h: HalfEdge, hub: Vertex) -> HalfEdge {
        if self.origin(h) == hub { h.prev() } else { h.next() }
    }

    /// What lies across a half-edge.
    #[inline]
    pub fn across(&self, h: HalfEdge) -> Across {
        match self.across[h.index()] {
            BOUNDARY => Across::Boundary,
            NON_MANIFOLD => Across::NonManifold,
            twin => Across::Twin(HalfEdge(twin)),
        }
    }

    /// The half-edge of the one other face on this edge.
    #[inline]
    pub fn twin(&self, h: HalfEdge) -> Option<HalfEdge> {
        match self.across(h) {
            Across::Twin(twin) => Some(twin),
            _ => None,
        }
    }

    /// True when the two faces of an edge wind against each other.
    #[inline]
    pub fn is_flipped(&self, h: HalfEdge, twin: HalfEdge) -> bool {
        self.origin(h) == self.origin(twin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connect(faces: &[[u32; 3]]) -> (Topology, Found) {
        let vertices = faces.iter().flatten().max().map_or(0, |v| v + 1);
        Topology::new(faces.to_vec(), vertices as usize, &vec![false; faces.len()])
    }

    #[test]
    fn neighbours_are_found_across_either_winding() {
        for (second, flipped) in [([2, 1, 3], false), ([1, 2, 3], true)] {
            let (t, _) = connect(&[[0, 1, 2], second]);
            let twin = t.twin(HalfEdge(1)).expect("the faces share an edge");
            assert_eq!(twin.face(), Face(1));
            assert_eq!(t.is_flipped(HalfEdge(1), twin), flipped);
            assert_eq!(t.across(HalfEdge(0)), Across::Boundary);
        }
    }

    #[test]
    fn the_way_around_a_vertex_does_not_depend_on_windings() {
        for second in [[2, 1, 3], [1, 2, 3]] {
            let (t, _) = connect(&[[0, 1, 2], second]);
            let twin = t.twin(HalfEdge(1)).expect("the faces share an edge");
            for hub in [Vertex(1), Vertex(2)] {
                let side = t.other_side_at(twin, hub);
                let mut ends = [t.origin(side), t.target(side)];
                ends.sort();
                assert_eq!((side.face(), ends), (Face(1), [hub, Vertex(3)]));
            }
        }
    }

    #[test]
    fn three_faces_on_an_edge_have_no_twins_there() {
        let (t, found) = connect(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!(found.non_manifold_edges, 1);
        assert_eq!(t.across(HalfEdge(0)), Across::NonManifold);
        assert!(found.duplicates.is_empty());
    }

    #[test]
    fn copies_of_a_face_are_found_and_left_out() {
        let (t, found) = connect(&[[0, 1, 2], [2, 1, 3], [1, 0, 2], [0, 1, 2]]);
        assert_eq!(found.duplicates, [(Face(2), Face(0)), (Face(3), Face(0))]);
        assert_eq!(found.non_manifold_edges, 0);
        assert_eq!(t.twin(HalfEdge(1)), Some(HalfEdge(3)));
        assert_eq!(t.twin(HalfEdge(9)), None);
    }
}
