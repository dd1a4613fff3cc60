//! The fit for surfaces without noise: the smallest implicit surface that explains a window.

use super::implicit::{Frame, Implicit, SIZES, basis, basis_along};
use super::least_squares::{Factor, MOST, Rows};
use super::window::{Window, oriented_area};
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::{DMat3, DVec3};

/// A fitted surface and how far to trust it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) surface: Implicit,
    /// The best surface of at most 13 terms, for faces that lie beside the window's middle.
    pub(super) simple: Implicit,
    /// Largest distance of a sample from the middle, in file units.
    pub(super) radius: f64,
    /// Share of the window's faces without border or sharp edge.
    pub(super) coverage: f64,
    /// Standard deviation of the samples about the surface of at most 13 terms, in file units.
    pub(super) misfit: f64,
    /// Standard error of the shape tensor (its Frobenius norm) that the misfit of the chosen surface
    /// implies, 1/length.
    pub(super) error: f64,
}

/// Vertices for a fit, where the patch has them.
pub(super) const WANTED: usize = 24;

/// Weight of a row that asks for a straight ruling, against one for a vertex.
const RULING_WEIGHT: f64 = 1e-3;
/// Below this least eigenvalue the vertices do not determine a paraboloid.
const SINGULAR: f64 = 1e-10;
/// Curvature, in turns per window, below which priors do not get any narrower.
const LEAST_BEND: f64 = 0.03;

/// Memory that fits share.
pub(super) struct Scratch {
    rows: Rows,
    points: Vec<DVec3>,
    faces: Vec<(DVec3, DVec3)>,
}

impl Scratch {
    pub(super) fn new() -> Self {
        Scratch { rows: Rows::new(), points: Vec::new(), faces: Vec::new() }
    }
}

/// A frame at `origin` for samples at `points`: the normal as given, the tangents along the principal
/// axes of the samples, the unit their root mean square distance.
pub(super) fn frame_for(origin: DVec3, normal: DVec3, points: impl Iterator<Item = DVec3> + Clone) -> Option<Frame> {
    let normal = normal.try_normalize()?;
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let (mut total, mut count) = (0.0, 0);
    let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
    for p in points {
        let d = p - origin;
        let (a, b) = (d.dot(u), d.dot(v));
        uu += a * a;
        uv += a * b;
        vv += b * b;
        total += d.length_squared();
        count += 1;
    }
    let unit = (total / f64::from(count)).sqrt();
    let (sin, cos) = (0.5 * (2.0 * uv).atan2(uu - vv)).sin_cos();
    let x = cos * u + sin * v;
    let axes = DMat3::from_cols(x, normal.cross(x), normal);
    (unit > 0.0 && unit.is_finite()).then_some(Frame { origin, axes, unit })
}

/// Fits a window. `quantum` is the rounding of coordinates in file units. `None` where the vertices
/// are too few or no surface passes the checks.
pub(super) fn fit(mesh: &Mesh, seed: Face, window: &Window, quantum: f64, scratch: &mut Scratch) -> Option<Fit> {
    let positions = mesh.positions();
    let points = window.vertices.iter().map(|&v| positions[v as usize]);
    let frame = frame_for(mesh.barycentre(seed), window.area_vector(mesh), points.clone())?;
    scratch.points.clear();
    scratch.points.extend(points.map(|p| frame.to_local(p)));
    let count = scratch.points.len();
    let rounding = quantum / frame.unit;
    let radius = scratch.points.iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt() * frame.unit;
    let coverage = window.coverage(mesh);
    let floor = count as f64 * ((0.3 * rounding).powi(2) + 1e-26);
    let enough = |size: usize| size + 2 <= count;
    let width = SIZES.into_iter().rev().find(|&s| s <= 13 && enough(s)).unwrap_or(3);

    let rows = &mut scratch.rows;
    fill(rows, &scratch.points, width, 0);
    let mut factor = factor_with_prior(rows, rounding);
    let plane = Implicit { frame, coefficients: factor.solve(3), size: 3 };
    if scratch.points.iter().all(|&p| plane.value(p).abs() <= 4.0 * rounding + 1e-14) {
        return Some(Fit { surface: plane, simple: plane, radius, coverage, misfit: quantum, error: 0.0 });
    }
    if !enough(6) {
        return None;
    }
    if factor.least_eigenvalue(6) < SINGULAR {
        add_rulings(rows, &scratch.points, mesh, window, frame, width);
        factor = factor_with_prior(rows, rounding);
    }
    load_faces(mesh, window, frame, &mut scratch.faces);
    // A surface further from the seed than half its width would not be the one it belongs to.
    let reach = 0.5 * width_of(mesh, seed) / frame.unit;
    let is_sane = |surface: &Implicit, points: &[DVec3], faces: &[(DVec3, DVec3)]| {
        is_sane(surface, points, faces) && surface.foot(DVec3::ZERO).is_some_and(|foot| foot.length() <= reach)
    };

    let mut steps = Steps { count: count as f64, penalty: 0.0, last: SIZES[0] };
    let sizes = SIZES.into_iter().filter(|&s| s <= width);
    let mut choices: Vec<Choice> = sizes.map(|size| steps.judge(rows, &factor, size, count, floor)).collect();
    choices.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let chosen = choices.into_iter().find(|c| is_sane(&c.surface(frame), &scratch.points, &scratch.faces))?;
    let misfit = chosen.deviation(count, floor) * frame.unit;
    let mut error = chosen.error(&factor, count, floor);
    let mut surface = chosen.surface(frame);
    if width == 13 && enough(22) && chosen.residual > 2.0 * floor {
        fill(rows, &scratch.points, MOST, 0);
        let factor = factor_with_prior(rows, rounding);
        let choice = steps.judge(rows, &factor, 22, count, floor);
        if choice.cost < chosen.cost && is_sane(&choice.surface(frame), &scratch.points, &scratch.faces) {
            surface = choice.surface(frame);
            error = choice.error(&factor, count, floor);
        }
    }
    Some(Fit { surface, simple: chosen.surface(frame), radius, coverage, misfit, error: error / frame.unit })
}

struct Choice {
    size: usize,
    coefficients: [f64; MOST],
    residual: f64,
    cost: f64,
}

impl Choice {
    fn surface(&self, frame: Frame) -> Implicit {
        Implicit { frame, coefficients: self.coefficients, size: self.size }
    }

    /// Standard deviation of the samples, in units of the frame.
    fn deviation(&self, count: usize, floor: f64) -> f64 {
        ((self.residual + floor) / (count - self.size) as f64).sqrt()
    }

    fn error(&self, factor: &Factor, count: usize, floor: f64) -> f64 {
        if self.size < 6 {
            return 0.0;
        }
        self.deviation(count, floor) * factor.tensor_variance(self.size).sqrt()
    }
}

/// What each further size costs: the stricter of generalised cross-validation and Schwarz' criterion.
struct Steps {
    count: f64,
    penalty: f64,
    last: usize,
}

impl Steps {
    fn judge(&mut self, rows: &Rows, factor: &Factor, size: usize, count: usize, floor: f64) -> Choice {
        let (n, k, before) = (self.count, size as f64, self.last as f64);
        let validation = 2.0 * ((n - before) / (n - k)).ln();
        self.penalty += validation.max((k - before) * n.ln() / n);
        self.last = size;
        let coefficients = factor.solve(size);
        let residual = rows.residual(&coefficients[..size], count);
        Choice { size, coefficients, residual, cost: (residual + floor).ln() + self.penalty }
    }
}

pub(super) fn fill(rows: &mut Rows, points: &[DVec3], width: usize, extra: usize) {
    rows.reset(points.len() + extra, width);
    for (row, &p) in points.iter().enumerate() {
        rows.set(row, &basis(p)[..width], p.z);
    }
}

/// The normal equations with a prior on the terms beyond the paraboloid: where rounding (or noise)
/// is strong, terms that a surface bending as this one does has no use for stay small.
pub(super) fn factor_with_prior(rows: &Rows, noise: f64) -> Factor {
    let mut prior = [0.0; MOST];
    let normal = rows.normal();
    if rows.width() <= 6 {
        return normal.factor(rows.width(), &prior);
    }
    let paraboloid = normal.factor(6, &prior).solve(6);
    let [a, b, c] = [paraboloid[3], paraboloid[4], paraboloid[5]];
    let bend = ((a + c).abs() + (a - c).hypot(b)).max(LEAST_BEND);
    for (column, prior) in prior.iter_mut().enumerate().skip(6) {
        let expected = match column {
            6..=8 => bend,
            9..=16 => bend * bend,
            _ => bend * bend * bend,
        };
        *prior = (noise / (0.3 * expected)).powi(2);
    }
    normal.factor(rows.width(), &prior)
}

/// The least height of a face.
fn width_of(mesh: &Mesh, face: Face) -> f64 {
    let [a, b, c] = mesh.triangle(face);
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)).sqrt();
    2.0 * mesh.area(face) / longest
}

/// Rows that ask the surface to be straight along its rulings, for vertices that all lie on two rims:
/// there, nothing else tells how the surface runs from rim to rim.
///
/// Where the strip consists of flat cells, the folds between them are the rulings. Elsewhere, as
/// between rims whose vertices alternate, the direction to which all normals are most nearly
/// perpendicular stands for them.
fn add_rulings(rows: &mut Rows, points: &[DVec3], mesh: &Mesh, window: &Window, frame: Frame, width: usize) {
    /// A fold this much below the sharpest is a diagonal of a flat cell.
    const NO_FOLD: f64 = 1e-3;
    let folds = folds(mesh, window);
    let sharpest = folds.iter().map(|f| f.1).fold(0.0, f64::max);
    let mut rulings: Vec<(DVec3, DVec3)> = Vec::new();
    if folds.iter().any(|f| f.1 < NO_FOLD * sharpest) {
        let sharp = folds.iter().filter(|f| f.1 >= NO_FOLD * sharpest);
        // Not in the middle, where the product of both rims' planes has no slope.
        rulings.extend(sharp.flat_map(|&([a, b], _)| [0.25, 0.75].map(|t| (a.lerp(b, t), b - a))));
    } else {
        let mut spread = DMat3::ZERO;
        let faces = || window.faces.iter().map(|&f| (Face(f), oriented_area(mesh, Face(f))));
        for (_, area) in faces() {
            let n = area.normalize_or_zero();
            spread += DMat3::from_cols(area * n.x, area * n.y, area * n.z);
        }
        let ruling = least_eigenvector(spread);
        rulings.extend(faces().map(|(f, area)| (mesh.barycentre(f), ruling.reject_from(area))));
    }
    fill(rows, points, width, rulings.len());
    for (i, (at, along)) in rulings.into_iter().enumerate() {
        let along = frame.axes.transpose() * along.normalize_or_zero();
        let row = basis_along(frame.to_local(at), along).map(|d| RULING_WEIGHT * d);
        rows.set(points.len() + i, &row[..width], RULING_WEIGHT * along.z);
    }
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

/// Barycentres and unit normals of the window's faces, in the frame.
fn load_faces(mesh: &Mesh, window: &Window, frame: Frame, out: &mut Vec<(DVec3, DVec3)>) {
    out.clear();
    let axes = frame.axes.transpose();
    for f in window.faces.iter().map(|&f| Face(f)) {
        if let Some(normal) = oriented_area(mesh, f).try_normalize() {
            out.push((frame.to_local(mesh.barycentre(f)), axes * normal));
        }
    }
}

/// False for a surface that turns over within its window: an implicit surface may explain its samples
/// with two sheets, of which the faces see the wrong one.
fn is_sane(surface: &Implicit, points: &[DVec3], faces: &[(DVec3, DVec3)]) -> bool {
    let middle = surface.gradient(DVec3::ZERO);
    let least = 0.3 * middle.length();
    middle.z > 0.0
        && points.iter().all(|&p| surface.gradient(p).length() >= least)
        && faces.iter().all(|&(at, normal)| surface.gradient(at).dot(normal) >= least)
}
