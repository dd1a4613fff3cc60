//! Normals of faces and vertices, oriented and of lengths that tell how much they count.

use super::blocks::Blocks;
use crate::mesh::{Face, Mesh};
use glam::{DVec3, Vec3};
use std::ops::Range;

/// A face's normal, as long as the root of its area.
pub(in crate::curvature::fit) fn scaled_normal(mesh: &Mesh, face: Face) -> DVec3 {
    let area = oriented_area(mesh, face);
    area.normalize_or_zero() * area.length().sqrt()
}

/// Twice a face's area as a vector along its oriented normal.
pub(in crate::curvature::fit) fn oriented_area(mesh: &Mesh, face: Face) -> DVec3 {
    let [a, b, c] = mesh.triangle(face);
    let area = (b - a).cross(c - a);
    if mesh.is_flipped(face) { -area } else { area }
}

/// A normal at every vertex, as long as its faces are wide against a `width`.
pub(super) fn vertex_normals(mesh: &Mesh, blocks: &Blocks, width: f64) -> Vec<Vec3> {
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
