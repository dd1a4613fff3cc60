//! The fit for surfaces without noise: the smallest implicit surface that explains a window. Four windows at
//! a time, one in each lane.

use crate::curvature::fit::around::batch::Batch;
use crate::curvature::fit::ground::quantum::Quantum;
use crate::curvature::fit::solve::choice::{Check, Chosen, SizedModel, penalties};
use crate::curvature::fit::solve::equations::{Factor, Normal, residual};
use crate::curvature::fit::solve::prior::priors;
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::fit::surface::implicit::Implicit;
use crate::curvature::fit::surface::polynomial::{
    CYCLIDE, MOST, PARABOLOID, PLANE, Polynomial, SIZES, basis, basis_along,
};
use crate::curvature::fit::surface::shape::{half_angle, tangents};
use crate::curvature::vectors::four::{F4, Kernel, LANES, Real, V3, run, which};
use glam::{DMat3, DVec3};

/// A fitted surface and how far to trust it.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Fit {
    pub(in crate::curvature::fit) surface: Implicit,
    /// The best surface of at most 13 terms, for faces that lie beside the window's middle.
    pub(in crate::curvature::fit) simple: Polynomial<f64>,
    /// Largest distance of a sample from the middle, in file units.
    pub(in crate::curvature::fit) radius: f64,
    /// Share of the window's vertices without border or sharp edge.
    pub(super) coverage: f64,
    /// Standard deviation of the samples about the surface of at most 13 terms, in file units.
    pub(super) misfit: f64,
    /// Standard error of the shape tensor (its Frobenius norm) that the misfit of the chosen surface
    /// implies, 1/length.
    pub(super) error: f64,
}

impl Fit {
    /// The plane through the middle of the same window, in which vertices lie up to a distance.
    pub(super) fn on_plane(&self, normal: DVec3, misfit: f64) -> Option<Self> {
        let frame = self.surface.frame;
        let surface = Implicit::plane(frame, normal)?;
        Some(Fit { surface, simple: surface.f, misfit, error: misfit / frame.unit.powi(2), ..*self })
    }

    /// True for a plane.
    pub(super) fn is_flat(&self) -> bool {
        self.surface.f.size == PLANE
    }
}

/// What became of a window.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "four at a time, on the stack")]
pub(super) enum Outcome {
    Fitted(Fit),
    /// The vertices lie on too few lines to tell a surface without rulings.
    NeedsRulings,
    /// The vertices are too few or no surface passes the checks.
    None,
}

/// Below this least eigenvalue the vertices do not determine a paraboloid.
const SINGULAR: f64 = 1e-10;
/// Variance of rounded samples, in squares of the largest error that rounding may leave: a third at most, and less for
/// coordinates nearer to zero.
const ROUNDED: f64 = 0.09;
/// That of the arithmetic, in units of the window squared.
const ARITHMETIC: f64 = 1e-26;
/// Weight of a row that asks for a straight ruling, against one for a vertex.
const RULING_WEIGHT: f64 = 1e-3;

/// Fits four windows at a time.
pub(super) struct Fitter {
    quantum: Quantum,
    /// What sizes cost, by the number of points.
    penalties: Vec<[f64; SIZES.len()]>,
    windows: WindowRows,
}

/// The samples of windows in their frames, and their rows in the bases.
struct WindowRows {
    points: Vec<V3<F4>>,
    normals: Vec<V3<F4>>,
    values: Vec<F4>,
    rows: Vec<[F4; CYCLIDE]>,
    wide_rows: Vec<[F4; MOST]>,
}

/// The frames of windows side by side, without their origins, which are the windows' middles.
#[derive(Clone, Copy)]
struct Axes {
    /// Two tangents and the normal.
    columns: [V3<F4>; 3],
    unit: F4,
}

/// What came of four windows.
pub(super) struct Fits {
    axes: Axes,
    /// Largest distance of a point from the middle, in units of the frame.
    radius: F4,
    plane: [F4; 3],
    is_flat: [bool; LANES],
    needs_rulings: [bool; LANES],
    simple: Chosen,
    surface: Chosen,
    deviation: F4,
    error: F4,
    /// Rounding of coordinates, in units of the frames.
    rounding: F4,
}

struct FitExact<'f> {
    windows: &'f mut WindowRows,
    batch: &'f Batch,
    quantum: Quantum,
    penalties: [F4; SIZES.len()],
}

impl Fitter {
    /// For coordinates that are rounded so.
    pub(super) fn new(quantum: Quantum) -> Self {
        let windows = WindowRows { points: vec![], normals: vec![], values: vec![], rows: vec![], wide_rows: vec![] };
        Fitter { quantum, penalties: (0..64).map(penalties).collect(), windows }
    }

    /// Fits all windows of a batch.
    pub(super) fn fit(&mut self, batch: &Batch) -> Fits {
        let mut costs = [F4::ZERO; SIZES.len()];
        for (lane, &count) in batch.counts.iter().enumerate() {
            let of_count = self.penalties.get(count).copied().unwrap_or_else(|| penalties(count));
            costs.iter_mut().zip(of_count).for_each(|(to, from)| to.0[lane] = from);
        }
        run(FitExact { windows: &mut self.windows, batch, quantum: self.quantum, penalties: costs })
    }
}

impl Kernel for FitExact<'_> {
    type Output = Fits;

    #[inline(always)]
    fn run(self) -> Fits {
        let FitExact { windows, batch, quantum, penalties } = self;
        let count = F4::of(batch.counts, |c| c as f64);
        let axes = windows.enter(batch);
        let around = |lane: usize| quantum.around(batch.centres[lane], axes.unit.0[lane]);
        let rounding = F4([around(0), around(1), around(2), around(3)]) / axes.unit;
        let floor = count * (rounding * rounding * ROUNDED + F4::splat(ARITHMETIC));
        let normal = windows.equations(batch, &axes);
        let mut factor = Factor::new(&normal);
        factor.factor(PARABOLOID);

        let plane = factor.solve(PLANE);
        let (mut farthest, mut radius) = (F4::ZERO, F4::ZERO);
        for p in &windows.points {
            farthest = farthest.max((p.z - plane[0] - plane[1] * p.x - plane[2] * p.y).abs());
            radius = radius.max(p.dot(*p));
        }
        let mut fits = Fits {
            axes,
            radius: radius.sqrt(),
            plane: [plane[0], plane[1], plane[2]],
            is_flat: which(|i| i >= batch.seeds.len() || farthest.0[i] <= 4.0 * rounding.0[i] + 1e-14),
            needs_rulings: [false; LANES],
            simple: Chosen::NONE,
            surface: Chosen::NONE,
            deviation: F4::ZERO,
            error: F4::ZERO,
            rounding,
        };
        if !fits.is_flat.contains(&false) {
            return fits;
        }
        let least = factor.least_eigenvalue(PARABOLOID);
        fits.needs_rulings = which(|i| least.0[i] < SINGULAR && batch.rulings[i].is_empty());
        factor.add_priors(&priors(factor.paraboloid(), rounding));
        factor.factor(CYCLIDE);
        let [simple_penalties @ .., wide_penalty] = penalties;
        let mut models = [SizedModel::ZERO; SIZES.len() - 1];
        for ((model, &penalty), size) in models.iter_mut().zip(&simple_penalties).zip(SIZES) {
            let coefficients = factor.solve(size);
            model.residual = residual(&windows.rows, &windows.values, &coefficients, size);
            model.cost = (model.residual + floor) * penalty;
            model.coefficients[..CYCLIDE].copy_from_slice(&coefficients);
        }
        let reach = batch.reaches / axes.unit;
        let simple = Chosen::among(&models, &fits.is_flat, &Sanity { windows, reach });
        let degrees = count - F4::of(simple.sizes, |s| s as f64);
        fits.deviation = ((simple.residual + floor) / degrees).sqrt();
        fits.error = fits.deviation * factor.tensor_variance(simple.sizes, CYCLIDE).sqrt();
        (fits.simple, fits.surface) = (simple, simple);

        let wants_more = which(|i| {
            let is_unexplained = simple.residual.0[i] > 2.0 * floor.0[i];
            // Between rims, only rulings hold the terms of the large basis.
            let has_rulings = !batch.rulings[i].is_empty();
            simple.found[i] && is_unexplained && batch.counts[i] >= MOST + 2 && !fits.is_flat[i] && !has_rulings
        });
        if wants_more.contains(&true) {
            let (wide, wide_error) = windows.fit_wide(batch, rounding, floor, wide_penalty);
            let wide_surface = Polynomial { coefficients: wide.coefficients, size: MOST };
            let is_sane = Sanity { windows, reach }.passes(&wide_surface);
            for i in 0..LANES {
                if wants_more[i] && is_sane[i] && wide.cost.0[i] < simple.cost.0[i] {
                    fits.surface.take(i, &wide, MOST);
                    fits.error.0[i] = wide_error.0[i];
                }
            }
        }
        fits
    }
}

impl Fits {
    /// What became of the window in a lane.
    pub(super) fn outcome(&self, batch: &Batch, lane: usize) -> Outcome {
        let unit = self.axes.unit.0[lane];
        if lane >= batch.seeds.len() || !(unit > 0.0 && unit.is_finite()) {
            return Outcome::None;
        }
        let [x, y, z] = &self.axes.columns;
        let axes = DMat3::from_cols(x.get(lane), y.get(lane), z.get(lane));
        let frame = LocalFrame { origin: batch.centres[lane], axes, unit };
        let (radius, coverage) = (self.radius.0[lane] * unit, batch.coverage[lane]);
        if self.is_flat[lane] {
            let mut simple = Polynomial { coefficients: [0.0; MOST], size: PLANE };
            simple.coefficients.iter_mut().zip(&self.plane).for_each(|(to, from)| *to = from.0[lane]);
            let surface = Implicit { frame, f: simple };
            // Whatever bends less than rounding does looks flat.
            let rounding = self.rounding.0[lane];
            let (misfit, error) = (rounding * unit, rounding / unit);
            return Outcome::Fitted(Fit { surface, simple, radius, coverage, misfit, error });
        }
        if batch.counts[lane] < PARABOLOID + 2 {
            return Outcome::None;
        }
        if self.needs_rulings[lane] {
            return Outcome::NeedsRulings;
        }
        if !self.simple.found[lane] {
            return Outcome::None;
        }
        let surface = Implicit { frame, f: self.surface.polynomial(lane) };
        let simple = self.simple.polynomial(lane);
        let misfit = self.deviation.0[lane] * unit;
        // What a plane leaves may be how the surface bends.
        let error = if surface.f.size < PARABOLOID { 2.0 * self.deviation.0[lane] } else { self.error.0[lane] } / unit;
        Outcome::Fitted(Fit { surface, simple, radius, coverage, misfit, error })
    }
}

impl WindowRows {
    /// Sets up frames and takes all points into them: the normal is the mean of the normals, the tangents
    /// are the principal axes of the points, the unit is their root mean square distance.
    #[inline(always)]
    fn enter(&mut self, batch: &Batch) -> Axes {
        let sum = batch.uprights;
        let length = sum.dot(sum).sqrt();
        let n = sum.scaled(F4::ONE / length);
        let (u, v) = tangents(n);
        let (mut uu, mut uv, mut vv, mut total) = (F4::ZERO, F4::ZERO, F4::ZERO, F4::ZERO);
        for p in &batch.points {
            let (a, b) = (p.dot(u), p.dot(v));
            uu += a * a;
            uv += a * b;
            vv += b * b;
            total += p.dot(*p);
        }
        let count = F4::of(batch.counts, |c| c as f64);
        let unit = (total / count).sqrt();
        let (half, cross) = ((uu - vv) * 0.5, uv);
        let (cos, sin) = half_angle(half, cross, (half * half + cross * cross).sqrt());
        let x = u.scaled(cos) + v.scaled(sin);
        let y = n.cross(x);
        let inverse = F4::ONE / unit;
        self.points.clear();
        self.normals.clear();
        self.values.clear();
        for (p, normal) in batch.points.iter().zip(&batch.normals) {
            let p = V3::new(p.dot(x), p.dot(y), p.dot(n)).scaled(inverse);
            self.points.push(p);
            self.values.push(p.z);
            self.normals.push(V3::new(normal.dot(x), normal.dot(y), normal.dot(n)));
        }
        Axes { columns: [x, y, n], unit }
    }

    /// The normal equations of the simple bases, with rulings if there are any.
    #[inline(always)]
    fn equations(&mut self, batch: &Batch, axes: &Axes) -> Normal<CYCLIDE> {
        self.rows.clear();
        for (i, &p) in self.points.iter().enumerate() {
            self.rows.push(basis(p, is_inside(batch, i)));
        }
        let mut normal = Normal::new(&self.rows, &self.values);
        for_rulings(batch, axes, |lane, row, value| normal.add(lane, &std::array::from_fn(|i| row[i]), value));
        normal
    }

    /// The model of all 22 terms.
    #[inline(always)]
    fn fit_wide(&mut self, batch: &Batch, rounding: F4, floor: F4, penalty: F4) -> (SizedModel, F4) {
        self.wide_rows.clear();
        for (i, &p) in self.points.iter().enumerate() {
            self.wide_rows.push(basis(p, is_inside(batch, i)));
        }
        let normal = Normal::new(&self.wide_rows, &self.values);
        let mut factor = Factor::new(&normal);
        factor.factor(PARABOLOID);
        factor.add_priors(&priors(factor.paraboloid(), rounding));
        factor.factor(MOST);
        let coefficients = factor.solve(MOST);
        let residual = residual(&self.wide_rows, &self.values, &coefficients, MOST);
        let degrees = F4::of(batch.counts, |c| c as f64 - MOST as f64);
        let error = ((residual + floor) / degrees).sqrt() * factor.tensor_variance([MOST; LANES], MOST).sqrt();
        (SizedModel { coefficients, residual, cost: (residual + floor) * penalty }, error)
    }
}

/// True for a surface that does not turn over within its window: an implicit surface may explain its samples with two
/// sheets, of which the faces see the wrong one. Nor is it further from the middle than `reach`: it would not be the
/// one the middle belongs to.
struct Sanity<'s> {
    windows: &'s WindowRows,
    reach: F4,
}

impl Check for Sanity<'_> {
    #[inline(always)]
    fn passes(&self, f: &Polynomial<F4>) -> [bool; LANES] {
        /// Square of the least slope of F within the window, in slopes at its middle.
        const LEAST_SLOPE: f64 = 0.3 * 0.3;
        let middle = f.gradient(V3::ZERO);
        let least = middle.dot(middle) * LEAST_SLOPE;
        let (mut slope, mut facing, mut turned) = (F4::splat(f64::INFINITY), F4::splat(0.0), F4::splat(0.0));
        for (&p, &normal) in self.windows.points.iter().zip(&self.windows.normals) {
            let gradient = f.gradient(p);
            let along = gradient.dot(normal);
            slope = slope.min(gradient.dot(gradient) - least);
            facing = facing.min(along);
            turned = turned.min(along * along - least * normal.dot(normal));
        }
        let foot = f.foot(V3::ZERO);
        let left = self.reach * self.reach - foot.dot(foot);
        which(|i| slope.0[i] >= 0.0 && facing.0[i] >= 0.0 && turned.0[i] >= 0.0 && left.0[i] >= 0.0)
    }
}

/// One where a lane's window has so many points, zero elsewhere.
#[inline(always)]
fn is_inside(batch: &Batch, point: usize) -> F4 {
    F4::of(batch.counts, |count| if point < count { 1.0 } else { 0.0 })
}

/// The rows that ask for straight rulings.
fn for_rulings(batch: &Batch, axes: &Axes, mut row: impl FnMut(usize, &[f64; MOST], f64)) {
    for (lane, rulings) in batch.rulings.iter().enumerate() {
        let [x, y, z] = &axes.columns;
        let turn = DMat3::from_cols(x.get(lane), y.get(lane), z.get(lane)).transpose();
        for &(at, along) in rulings {
            let at = turn * ((at - batch.centres[lane]) / axes.unit.0[lane]);
            let along = turn * along.normalize_or_zero();
            row(lane, &basis_along(at.into(), along.into()).map(|d| RULING_WEIGHT * d), RULING_WEIGHT * along.z);
        }
    }
}
