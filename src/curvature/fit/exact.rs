//! The fit for surfaces without noise: the smallest implicit surface that explains a window.

use super::basis::{SIZES, factor_with_prior, fill};
use super::frame::Frame;
use super::implicit::Implicit;
use super::least_squares::{Factor, MOST, Rows};
use super::rulings::add_rulings;
use super::window::{Window, oriented_area};
use crate::mesh::{Face, Mesh};
use glam::DVec3;

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

/// Below this least eigenvalue the vertices do not determine a paraboloid.
const SINGULAR: f64 = 1e-10;

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

/// Fits a window. `quantum` is the rounding of coordinates in file units. `None` where the vertices
/// are too few or no surface passes the checks.
pub(super) fn fit(mesh: &Mesh, seed: Face, window: &Window, quantum: f64, scratch: &mut Scratch) -> Option<Fit> {
    let positions = mesh.positions();
    let points = window.vertices.iter().map(|&v| positions[v as usize]);
    let frame = Frame::around(mesh.barycentre(seed), window.area_vector(mesh), points.clone())?;
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
    let reach = 0.5 * mesh.least_height(seed) / frame.unit;
    let is_sane = |surface: Implicit| {
        let is_near = || surface.foot(DVec3::ZERO).is_some_and(|foot| foot.length() <= reach);
        keeps_one_sheet(&surface, &scratch.points, &scratch.faces) && is_near()
    };

    let mut steps = Steps { count: count as f64, penalty: 0.0, last: SIZES[0] };
    let sizes = SIZES.into_iter().filter(|&s| s <= width);
    let mut choices: Vec<Choice> = sizes.map(|size| steps.judge(rows, &factor, size, count, floor)).collect();
    choices.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let chosen = choices.into_iter().find(|c| is_sane(c.surface(frame)))?;
    let misfit = chosen.deviation(count, floor) * frame.unit;
    let mut error = chosen.error(&factor, count, floor);
    let mut surface = chosen.surface(frame);
    if width == 13 && enough(22) && chosen.residual > 2.0 * floor {
        fill(rows, &scratch.points, MOST, 0);
        let factor = factor_with_prior(rows, rounding);
        let choice = steps.judge(rows, &factor, 22, count, floor);
        if choice.cost < chosen.cost && is_sane(choice.surface(frame)) {
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
fn keeps_one_sheet(surface: &Implicit, points: &[DVec3], faces: &[(DVec3, DVec3)]) -> bool {
    let middle = surface.gradient(DVec3::ZERO);
    let least = 0.3 * middle.length();
    middle.z > 0.0
        && points.iter().all(|&p| surface.gradient(p).length() >= least)
        && faces.iter().all(|&(at, normal)| surface.gradient(at).dot(normal) >= least)
}
