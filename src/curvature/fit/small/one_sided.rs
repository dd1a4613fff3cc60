//! Faces beside a jump of curvature, such as the line where a fillet runs out.
//!
//! No smooth surface explains a window across the jump, but one explains each side. The face takes the
//! fit of a neighbour whose window lies on its own side, as schemes for shocks take the smoother stencil
//! (essentially non-oscillatory schemes).

use super::exact::Fit;
use super::first::Quality;
use crate::curvature::fit::around::window::Window;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::normals::oriented_area;
use crate::curvature::fit::surface::implicit::Implicit;
use crate::curvature::fit::surface::shape::Principal;
use crate::mesh::{EdgeKind, Face, Mesh};
use glam::DVec3;
use rayon::prelude::*;

/// A neighbour's fit must explain its window this much better. Smooth surfaces reach a tenth by chance.
const BETTER: f64 = 0.02;
/// Most neighbours tried.
const TRIED: usize = 16;

/// True when a triangle is one of the surface that a fit found: its corners within the fit's misfit, its middle within
/// half its width, and no side of it from one sheet of the surface to another.
pub(in crate::curvature::fit) fn lies_on(fit: &Fit, triangle: [DVec3; 3]) -> bool {
    // Along a circle the normals at both ends lean against the chord alike.
    const LEAN: f64 = 0.1;
    let surface = Implicit { f: fit.simple, ..fit.surface };
    let corners = triangle.map(|p| surface.frame.to_local(p));
    let gradients = corners.map(|p| surface.gradient(p));
    let reach = 3.0 * fit.misfit / surface.frame.unit;
    let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    let longest = (0..3).map(|i| corners[i].distance_squared(corners[(i + 1) % 3])).fold(0.0, f64::max).sqrt();
    let width = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() / longest;
    if DVec3::from(surface.f.foot(middle.into())).distance(middle) > 0.5 * width {
        return false;
    }
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        let lean = (gradients[i].normalize_or_zero() + gradients[j].normalize_or_zero()).dot(corners[j] - corners[i]);
        surface.value(corners[i]).abs() <= reach * gradients[i].length()
            && lean.abs() <= LEAN * corners[j].distance(corners[i])
    })
}

/// True where a surface turns over a face by no more than a few times what the mesh does around it. One of two sheets may
/// hold all vertices, and turn from one to the other between them.
pub(in crate::curvature::fit) fn turns_as_mesh(mesh: &Mesh, face: Face, principal: &Principal) -> bool {
    /// Facets that share an edge fold by what half of each turns, unless they are of very different widths.
    const MOST: f64 = 4.0;
    /// Turns that mean nothing, in radians.
    const SLIGHT: f64 = 1e-3;
    let across = |face: Face| {
        let sides = face.half_edges().into_iter().filter(|&h| mesh.edge_kind(h) == EdgeKind::Inner);
        sides.filter_map(|h| Some(mesh.topology().twin(h)?.face()))
    };
    let normal = mesh.normal(face);
    let fold = |other: Face| normal.cross(mesh.normal(other)).length();
    let folds = across(face).flat_map(|other| across(other).chain([other])).map(fold);
    let most = MOST * folds.fold(0.0, f64::max);
    let corners = mesh.triangle(face);
    let turn = |k: f64, direction: DVec3| {
        let along = corners.map(|p| p.dot(direction));
        k.abs() * (along.into_iter().fold(f64::MIN, f64::max) - along.into_iter().fold(f64::MAX, f64::min))
    };
    let turns = turn(principal.k_max, principal.dir_max.into()).max(turn(principal.k_min, principal.dir_min.into()));
    turns <= most.max(SLIGHT)
}

/// True where a misfit is so much less than a face's own that a jump may lie between.
pub(in crate::curvature::fit) fn is_better(misfit: f32, own: f32) -> bool {
    misfit.is_finite() && f64::from(misfit) <= BETTER * f64::from(own)
}

/// For every vertex, the least misfit of a face within as many rings as [`candidates`] come from on meshes that are no
/// strips: where it is not much less than a face's own, there are none.
pub(in crate::curvature::fit) fn least_around(ground: &Ground<'_>, quality: &[Quality]) -> Vec<f32> {
    /// Rings of vertices beyond a face's own; windows of regular meshes have three.
    const RINGS: usize = 6;
    let topology = ground.mesh.topology();
    let mut least = vec![f32::INFINITY; ground.mesh.positions().len()];
    for (corners, quality) in topology.faces().iter().zip(quality) {
        for &v in corners {
            least[v as usize] = least[v as usize].min(quality.misfit);
        }
    }
    for _ in 0..RINGS {
        let of = |v: usize| ground.stars.neighbours(v as u32).iter().fold(least[v], |m, &w| m.min(least[w as usize]));
        least = (0..least.len()).into_par_iter().map(of).collect();
    }
    least
}

/// Seeds of the fits that serve the faces around, by how well they explain their windows, in powers of ten,
/// then by the distance of the face.
pub(in crate::curvature::fit) fn candidates(
    mesh: &Mesh,
    centre: DVec3,
    own: f32,
    faces: &[u32],
    quality: &[Quality],
) -> Vec<Face> {
    let mut others: Vec<(i32, f64, Face)> = faces
        .iter()
        .filter(|&&g| is_better(quality[g as usize].misfit, own))
        .map(|&g| {
            let ratio = f64::from(quality[g as usize].misfit) / f64::from(own);
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
pub(in crate::curvature::fit) fn is_mostly_plane(mesh: &Mesh, seed: Face, window: &Window, fit: &Fit) -> bool {
    const MOST: f64 = 0.6;
    let Some(normal) = oriented_area(mesh, seed).try_normalize() else { return true };
    let (centre, reach) = (mesh.barycentre(seed), 3.0 * fit.misfit + 1e-12 * fit.radius);
    let lies = |&&v: &&u32| (mesh.positions()[v as usize] - centre).dot(normal).abs() <= reach;
    window.vertices.iter().filter(lies).count() as f64 > MOST * window.vertices.len() as f64
}
