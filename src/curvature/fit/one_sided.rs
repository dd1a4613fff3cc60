//! Faces beside a jump of curvature, such as the line where a fillet runs out.
//!
//! No smooth surface explains a window across the jump, but one explains each side. The face takes the
//! fit of a neighbour whose window lies on its own side, as schemes for shocks take the smoother stencil
//! (essentially non-oscillatory schemes).

use super::exact::Fit;
use super::first::Quality;
use super::implicit::Implicit;
use super::window::{Window, oriented_area};
use crate::mesh::{Face, Mesh};
use glam::DVec3;

/// A neighbour's fit must explain its window this much better. Smooth surfaces reach a tenth by chance.
pub(super) const BETTER: f64 = 0.02;
/// Most neighbours tried.
pub(super) const TRIED: usize = 16;

/// True when a triangle is one of the surface that a fit found: its corners within the fit's misfit, and
/// no side of it from one sheet of the surface to another.
pub(super) fn lies_on(fit: &Fit, triangle: [DVec3; 3]) -> bool {
    // Along a circle the normals at both ends lean against the chord alike.
    const LEAN: f64 = 0.1;
    let surface = Implicit { f: fit.simple, ..fit.surface };
    let corners = triangle.map(|p| surface.frame.to_local(p));
    let gradients = corners.map(|p| surface.gradient(p));
    let reach = 3.0 * fit.misfit / surface.frame.unit;
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        let lean = (gradients[i].normalize_or_zero() + gradients[j].normalize_or_zero()).dot(corners[j] - corners[i]);
        surface.value(corners[i]).abs() <= reach * gradients[i].length()
            && lean.abs() <= LEAN * corners[j].distance(corners[i])
    })
}

/// Seeds of the fits that serve the faces around, by how well they explain their windows, in powers of ten,
/// then by the distance of the face.
pub(super) fn candidates(mesh: &Mesh, centre: DVec3, own: f32, faces: &[u32], quality: &[Quality]) -> Vec<Face> {
    let mut others: Vec<(i32, f64, Face)> = faces
        .iter()
        .map(|&g| (f64::from(quality[g as usize].misfit) / f64::from(own), g))
        .filter(|&(ratio, _)| ratio <= BETTER)
        .map(|(ratio, g)| {
            let power = ratio.max(1e-8).log10().floor() as i32;
            (power, mesh.barycentre(Face(g)).distance_squared(centre), quality[g as usize].seed)
        })
        .collect();
    others.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut seeds = Vec::new();
    for (_, _, seed) in others {
        if !seeds.contains(&seed) && seeds.len() < TRIED {
            seeds.push(seed);
        }
    }
    seeds
}

/// True when most vertices of a seed's window lie in the plane of the seed: then a surface of two sheets
/// explains the others, however they lie, and the second sheet means nothing.
pub(super) fn is_mostly_plane(mesh: &Mesh, seed: Face, window: &Window, fit: &Fit) -> bool {
    const MOST: f64 = 0.6;
    let Some(normal) = oriented_area(mesh, seed).try_normalize() else { return true };
    let (centre, reach) = (mesh.barycentre(seed), 3.0 * fit.misfit + 1e-12 * fit.radius);
    let lies = |&&v: &&u32| (mesh.positions()[v as usize] - centre).dot(normal).abs() <= reach;
    window.vertices.iter().filter(lies).count() as f64 > MOST * window.vertices.len() as f64
}
