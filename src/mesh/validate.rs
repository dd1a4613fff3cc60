//! Checks that a mesh keeps its own promises; tests call it after every construction.

use super::{EdgeKind, Face, FaceState, HalfEdge, Mesh};
use crate::mesh::Across;

impl Mesh {
    /// Panics with the first broken promise. Meant for tests: it visits every half-edge.
    #[doc(hidden)]
    pub fn sanity_check(&self) {
        let topology = self.topology();
        let n = self.face_count();
        assert_eq!(self.kinds.len(), 3 * n);
        assert_eq!(self.states.len(), n);
        assert_eq!(self.flipped.len(), n);
        assert_eq!(self.bodies().iter().map(|b| b.faces.len()).sum::<usize>(), n, "bodies cover all faces");
        let mut used = vec![false; self.positions().len()];
        for f in (0..n as u32).map(Face) {
            let state = self.face_state(f);
            assert_eq!(state == FaceState::Duplicate, self.duplicate_of(f).is_some());
            for h in f.half_edges() {
                assert_eq!(h.face(), f);
                assert_eq!(h.next().next().next(), h);
                assert_eq!(h.next().prev(), h);
                used[topology.origin(h).index()] = true;
                self.check_edge(h);
            }
            if let Some(first) = self.duplicate_of(f) {
                assert!(first < f && self.duplicate_of(first).is_none());
                let sorted = |f: Face| {
                    let mut corners = topology.corners(f);
                    corners.sort_unstable();
                    corners
                };
                assert_eq!(sorted(f), sorted(first));
            }
        }
        assert!(used.iter().all(|&u| u), "every vertex belongs to a face");
    }

    fn check_edge(&self, h: HalfEdge) {
        let topology = self.topology();
        let in_topology = self.is_in_surface(h.face());
        match topology.across(h) {
            Across::Boundary => assert_eq!(self.edge_kind(h), EdgeKind::Boundary),
            Across::NonManifold => {
                assert!(in_topology);
                assert_eq!(self.edge_kind(h), EdgeKind::NonManifold);
            }
            Across::Twin(twin) => {
                assert!(in_topology);
                assert_ne!(twin, h);
                assert_eq!(topology.twin(twin), Some(h), "twins are mutual");
                assert_eq!(self.edge_kind(h), self.edge_kind(twin));
                assert!(matches!(self.edge_kind(h), EdgeKind::Inner | EdgeKind::Feature));
                let ends = |h: HalfEdge| {
                    let (a, b) = (topology.origin(h), topology.target(h));
                    (a.min(b), a.max(b))
                };
                assert_eq!(ends(h), ends(twin), "twins lie on one edge");
            }
        }
    }
}
