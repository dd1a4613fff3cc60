//! Strips whose vertices all lie on two rims.

use super::window::{Window, oriented_area};
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::{DMat3, DVec3};

/// Places and directions in which the surface through a window's vertices is straight, for vertices that all lie
/// on two rims: there, nothing else tells how the surface runs from rim to rim.
///
/// Where the strip consists of flat cells, the folds between them are the rulings. Elsewhere, as
/// between rims whose vertices alternate, the direction to which all normals are most nearly
/// perpendicular stands for them.
pub(super) fn rulings(mesh: &Mesh, window: &Window) -> Vec<(DVec3, DVec3)> {
    /// A fold this much below the sharpest is a diagonal of a flat cell.
    const NO_FOLD: f64 = 1e-3;
    let folds = folds(mesh, window);
    let sharpest = folds.iter().map(|f| f.1).fold(0.0, f64::max);
    if folds.iter().any(|f| f.1 < NO_FOLD * sharpest) {
        let sharp = folds.iter().filter(|f| f.1 >= NO_FOLD * sharpest);
        // Not in the middle, where the product of both rims' planes has no slope.
        return sharp.flat_map(|&([a, b], _)| [0.25, 0.75].map(|t| (a.lerp(b, t), b - a))).collect();
    }
    let mut spread = DMat3::ZERO;
    let faces = || window.faces.iter().map(|&f| (Face(f), oriented_area(mesh, Face(f))));
    for (_, area) in faces() {
        let n = area.normalize_or_zero();
        spread += DMat3::from_cols(area * n.x, area * n.y, area * n.z);
    }
    let ruling = least_eigenvector(spread);
    faces().map(|(f, area)| (mesh.barycentre(f), ruling.reject_from(area))).collect()
}

/// The ends of every inner edge of a window and the sine of the angle there.
fn folds(mesh: &Mesh, window: &Window) -> Vec<([DVec3; 2], f64)> {
    let topology = mesh.topology();
    let inner = |h: HalfEdge| topology.twin(h).filter(|&t| h < t && mesh.edge_kind(h) == EdgeKind::Inner);
    let half_edges = window.faces.iter().flat_map(|&f| Face(f).half_edges());
    half_edges
        .filter_map(|h| {
            let twin = inner(h)?;
            let normals = [h, twin].map(|h| oriented_area(mesh, h.face()).normalize_or_zero());
            let ends = [topology.origin(h), topology.target(h)].map(|v| mesh.position(v));
            Some((ends, normals[0].cross(normals[1]).length()))
        })
        .collect()
}

/// A unit vector nearly along the eigenvector of the least eigenvalue of a symmetric positive matrix.
fn least_eigenvector(m: DMat3) -> DVec3 {
    let trace = m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let m = m + DMat3::from_diagonal(DVec3::splat(1e-12 * trace));
    // The adjugate is the inverse up to a factor; its powers leave the eigenvector alone.
    let [a, b, c] = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    let mut power = DMat3::from_cols(a, b, c);
    let largest = |m: &DMat3| {
        let columns = [m.x_axis, m.y_axis, m.z_axis].into_iter();
        columns.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared())).unwrap_or(DVec3::ZERO)
    };
    for _ in 0..5 {
        power = power * (1.0 / largest(&power).length());
        power = power * power;
    }
    largest(&power).normalize_or_zero()
}
