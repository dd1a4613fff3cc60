//! The mesh prepared for windows: what lies around every vertex, and what all windows share.

mod blocks;
pub(super) mod cells;
pub(super) mod fans;
pub(super) mod lists;
pub(super) mod normals;
pub(super) mod quantum;
pub(super) mod seeds;
pub(super) mod sites;
pub(super) mod stars;
mod width;
pub(super) mod work;

use crate::mesh::{EdgeKind, HalfEdge, Mesh};
use blocks::Blocks;
use glam::{DVec3, Vec3};
use normals::vertex_normals;
use stars::Stars;
use width::typical_width;
use work::Work;

/// A mesh prepared for windows.
pub(super) struct Ground<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) stars: Stars<'m>,
    /// Whether windows reach over sharp edges.
    pub(super) over_features: bool,
    /// How wide faces are, nearly.
    pub(super) width: f64,
    /// A normal at every vertex, as long as its faces are wide against others.
    pub(super) normals: Vec<Vec3>,
    /// Told of all that is done, so that it can be cancelled.
    pub(super) work: &'m Work<'m>,
}

impl<'m> Ground<'m> {
    pub(super) fn new(mesh: &'m Mesh, over_features: bool, work: &'m Work<'m>) -> Self {
        let blocks = Blocks::new(mesh);
        let width = typical_width(mesh);
        let normals = vertex_normals(mesh, &blocks, width);
        Ground { mesh, stars: Stars::new(mesh, &blocks, over_features), over_features, width, normals, work }
    }

    pub(super) fn position(&self, vertex: u32) -> DVec3 {
        self.mesh.positions()[vertex as usize]
    }

    /// True where windows reach over an edge.
    #[inline]
    pub(super) fn is_open(&self, h: HalfEdge) -> bool {
        match self.mesh.edge_kind(h) {
            EdgeKind::Inner => true,
            EdgeKind::Feature => self.over_features,
            EdgeKind::Boundary | EdgeKind::NonManifold => false,
        }
    }
}
