//! What all windows of a mesh share.

use super::blocks::Blocks;
use super::stars::Stars;
use super::width::typical_width;
use super::window::scaled_normal;
use super::work::Work;
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::{DVec3, Vec3};
use std::ops::Range;

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

fn vertex_normals(mesh: &Mesh, blocks: &Blocks, width: f64) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; mesh.positions().len()];
    let later = blocks.fill(&mut normals, |faces, own, normals| {
        let mut later = Vec::new();
        for (f, normal) in sound_normals(mesh, faces, width) {
            for v in mesh.topology().corners(f) {
                match own.contains(&v.index()) {
                    true => normals[v.index() - own.start] += normal,
                    false => later.push((v, normal)),
                }
            }
        }
        later
    });
    later.into_iter().for_each(|(v, normal)| normals[v.index()] += normal);
    normals
}

/// The sound faces of a range and their normals, as long as they are wide against a `width`: so that 32 bits hold the
/// squares too.
pub(super) fn sound_normals(mesh: &Mesh, faces: Range<u32>, width: f64) -> impl Iterator<Item = (Face, Vec3)> {
    let scale = 1.0 / width;
    let sound = faces.map(Face).filter(|&f| mesh.is_sound(f));
    sound.map(move |f| (f, (scaled_normal(mesh, f) * scale).as_vec3()))
}
