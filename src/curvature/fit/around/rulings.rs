//! How the surface runs in strips whose vertices all lie on two rims.

use crate::curvature::fit::ground::normals::{oriented_area, scaled_normal};
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::{DMat3, DVec3};

/// A fold this much below the sharpest is a diagonal of a flat cell.
pub(in crate::curvature::fit) const NO_FOLD: f64 = 1e-3;

/// Inner edges and how sharply the surface folds there.
pub(in crate::curvature::fit) struct Folds {
    folds: Vec<Fold>,
    /// Sine of the sharpest fold.
    sharpest: f64,
    /// True where some edges are no folds but divide flat cells.
    pub(in crate::curvature::fit) has_diagonals: bool,
}

/// An edge between two faces.
pub(in crate::curvature::fit) struct Fold {
    pub(in crate::curvature::fit) ends: [DVec3; 2],
    /// Sum of the normals of both faces, as long as the roots of their areas.
    pub(in crate::curvature::fit) normal: DVec3,
    /// Sine of the angle between them.
    sine: f64,
}

impl Folds {
    /// Folds at half-edges; those without a face across are left out.
    pub(in crate::curvature::fit) fn of(mesh: &Mesh, edges: impl IntoIterator<Item = HalfEdge>) -> Self {
        let topology = mesh.topology();
        let fold = |h: HalfEdge| {
            let twin = topology.twin(h)?;
            let normals = [h, twin].map(|h| scaled_normal(mesh, h.face()));
            let units = normals.map(DVec3::normalize_or_zero);
            let ends = [topology.origin(h), topology.target(h)].map(|v| mesh.position(v));
            Some(Fold { ends, normal: normals[0] + normals[1], sine: units[0].cross(units[1]).length() })
        };
        let folds: Vec<Fold> = edges.into_iter().filter_map(fold).collect();
        let sharpest = folds.iter().map(|f| f.sine).fold(0.0, f64::max);
        let has_diagonals = folds.iter().any(|f| f.sine < NO_FOLD * sharpest);
        Folds { folds, sharpest, has_diagonals }
    }

    /// The folds of all inner edges of some faces.
    pub(super) fn within(mesh: &Mesh, faces: &[u32]) -> Self {
        let is_first = |h: &HalfEdge| mesh.topology().twin(*h).is_some_and(|t| *h < t);
        let half_edges = faces.iter().flat_map(|&f| Face(f).half_edges());
        Folds::of(mesh, half_edges.filter(|h| mesh.edge_kind(*h) == EdgeKind::Inner && is_first(h)))
    }

    /// True where the edge of that number divides a flat cell.
    pub(in crate::curvature::fit) fn is_diagonal(&self, at: usize) -> bool {
        self.folds[at].sine < NO_FOLD * self.sharpest
    }

    /// Those at which the surface does fold.
    pub(in crate::curvature::fit) fn sharp(&self) -> impl Iterator<Item = &Fold> {
        self.folds.iter().filter(|f| f.sine >= NO_FOLD * self.sharpest)
    }
}

/// Places and directions in which the surface through the corners of faces is straight, for corners that all lie
/// on two rims: there, nothing else tells how the surface runs from rim to rim.
///
/// Where the strip consists of flat cells, the folds between them are the rulings. Elsewhere, as
/// between rims whose vertices alternate, the direction to which all normals are most nearly
/// perpendicular stands for them.
pub(in crate::curvature::fit) fn rulings(mesh: &Mesh, faces: &[u32], folds: Option<&Folds>) -> Vec<(DVec3, DVec3)> {
    if let Some(folds) = folds {
        // Not in the middle, where the product of both rims' planes has no slope.
        let quarters = |f: &Fold| [0.25, 0.75].map(|t| (f.ends[0].lerp(f.ends[1], t), f.ends[1] - f.ends[0]));
        return folds.sharp().flat_map(quarters).collect();
    }
    let mut spread = DMat3::ZERO;
    let faces = || faces.iter().map(|&f| (Face(f), oriented_area(mesh, Face(f))));
    for (_, area) in faces() {
        let n = area.normalize_or_zero();
        spread += DMat3::from_cols(area * n.x, area * n.y, area * n.z);
    }
    let ruling = least_eigenvector(spread);
    faces().map(|(f, area)| (mesh.barycentre(f), ruling.reject_from(area))).collect()
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
