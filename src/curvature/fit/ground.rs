//! What all windows of a mesh share.

use super::stars::Stars;
use super::window::scaled_normal;
use super::work::Work;
use crate::mesh::{Face, FaceState, Mesh};
use glam::{DVec3, Vec3};

/// A mesh prepared for windows.
pub(super) struct Ground<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) stars: Stars<'m>,
    /// Whether windows reach over sharp edges.
    pub(super) over_features: bool,
    /// A normal at every vertex, as long as its faces are wide against the mesh.
    pub(super) normals: Vec<Vec3>,
    /// Told of all that is done, so that it can be cancelled.
    pub(super) work: &'m Work<'m>,
}

impl<'m> Ground<'m> {
    pub(super) fn new(mesh: &'m Mesh, over_features: bool, work: &'m Work<'m>) -> Self {
        let mut normals = vec![Vec3::ZERO; mesh.positions().len()];
        for (f, normal) in sound_normals(mesh) {
            for v in mesh.topology().corners(f) {
                normals[v.index()] += normal;
            }
        }
        Ground { mesh, stars: Stars::new(mesh, over_features), over_features, normals, work }
    }

    pub(super) fn position(&self, vertex: u32) -> DVec3 {
        self.mesh.positions()[vertex as usize]
    }
}

/// The sound faces and their normals, as long as they are wide against the mesh: so that 32 bits hold the squares too.
pub(super) fn sound_normals(mesh: &Mesh) -> impl Iterator<Item = (Face, Vec3)> {
    let scale = mesh.report().bounds.map_or(1.0, |b| 1.0 / b.size().max_element());
    let sound = (0..mesh.face_count() as u32).map(Face).filter(|&f| mesh.face_state(f) == FaceState::Sound);
    sound.map(move |f| (f, (scaled_normal(mesh, f) * scale).as_vec3()))
}
