//! The fit for surfaces without noise: the smallest implicit surface that explains a window. Four windows at
//! a time, one in each lane.

use super::batch::Batch;
use super::equations::{Factor, Normal, residual};
use super::frame::Frame;
use super::implicit::Implicit;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::polynomial::{MOST, Polynomial, SIZES, basis, basis_along};
use super::shape::tangents;
use glam::DMat3;

/// A fitted surface and how far to trust it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    pub(super) surface: Implicit,
    /// The best surface of at most 13 terms, for faces that lie beside the window's middle.
    pub(super) simple: Polynomial<f64>,
    /// Largest distance of a sample from the middle, in file units.
    pub(super) radius: f64,
    /// Share of the window's vertices without border or sharp edge.
    pub(super) coverage: f64,
    /// Standard deviation of the samples about the surface of at most 13 terms, in file units.
    pub(super) misfit: f64,
    /// Standard error of the shape tensor (its Frobenius norm) that the misfit of the chosen surface
    /// implies, 1/length.
    pub(super) error: f64,
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

/// Terms of the largest basis that every window tries, and of the one that only some do.
const SIMPLE: usize = 13;
/// Below this least eigenvalue the vertices do not determine a paraboloid.
const SINGULAR: f64 = 1e-10;
/// Curvature, in turns per window, below which priors do not get any narrower.
const LEAST_BEND: f64 = 0.03;
/// Weight of a row that asks for a straight ruling, against one for a vertex.
const RULING_WEIGHT: f64 = 1e-3;

/// Fits four windows at a time.
pub(super) struct Fitter {
    /// Rounding of coordinates, in file units.
    quantum: f64,
    /// What sizes cost, by the number of points.
    penalties: Vec<[f64; SIZES.len()]>,
    samples: Samples,
}

/// Windows in their frames, and their rows in the bases.
struct Samples {
    points: Vec<V3<F4>>,
    normals: Vec<V3<F4>>,
    values: Vec<F4>,
    rows: Vec<[F4; SIMPLE]>,
    wide_rows: Vec<[F4; MOST]>,
}

/// Frames side by side.
#[derive(Clone, Copy)]
struct Frames {
    axes: [V3<F4>; 3],
    unit: F4,
}

/// What a model of some size makes of the windows.
#[derive(Clone, Copy)]
struct Model {
    coefficients: [F4; MOST],
    residual: F4,
    /// Grows with the residual and the size; infinite where the points are too few.
    cost: F4,
}

/// A model for each lane.
#[derive(Clone, Copy)]
struct Chosen {
    coefficients: [F4; MOST],
    sizes: [usize; LANES],
    residual: F4,
    cost: F4,
    /// Lanes for which a surface passed the checks.
    found: [bool; LANES],
}

/// What came of four windows.
pub(super) struct Fits {
    frames: Frames,
    /// Largest distance of a point from the middle, in units of the frame.
    radius: F4,
    plane: [F4; 3],
    is_flat: [bool; LANES],
    needs_rulings: [bool; LANES],
    simple: Chosen,
    surface: Chosen,
    deviation: F4,
    error: F4,
    quantum: f64,
}

struct FitLanes<'f> {
    samples: &'f mut Samples,
    batch: &'f Batch,
    quantum: f64,
    penalties: [F4; SIZES.len()],
}

impl Fitter {
    /// For coordinates rounded to `quantum`, in file units.
    pub(super) fn new(quantum: f64) -> Self {
        let samples = Samples { points: vec![], normals: vec![], values: vec![], rows: vec![], wide_rows: vec![] };
        Fitter { quantum, penalties: (0..64).map(penalties).collect(), samples }
    }

    /// Fits all windows of a batch.
    pub(super) fn fit(&mut self, batch: &Batch) -> Fits {
        let mut costs = [F4::ZERO; SIZES.len()];
        for (lane, &count) in batch.counts.iter().enumerate() {
            let of_count = self.penalties.get(count).copied().unwrap_or_else(|| penalties(count));
            costs.iter_mut().zip(of_count).for_each(|(to, from)| to.0[lane] = from);
        }
        run(FitLanes { samples: &mut self.samples, batch, quantum: self.quantum, penalties: costs })
    }
}

impl Kernel for FitLanes<'_> {
    type Output = Fits;

    #[inline(always)]
    fn run(self) -> Fits {
        let FitLanes { samples, batch, quantum, penalties } = self;
        let count = F4::of(batch.counts, |c| c as f64);
        let frames = samples.enter(batch);
        let rounding = F4::splat(quantum) / frames.unit;
        let floor = count * (rounding * rounding * 0.09 + F4::splat(1e-26));
        let normal = samples.equations(batch, &frames);
        let mut factor = Factor::new(&normal);
        factor.factor(6);

        let plane = factor.solve(3);
        let (mut farthest, mut radius) = (F4::ZERO, F4::ZERO);
        for p in &samples.points {
            farthest = farthest.max((p.z - plane[0] - plane[1] * p.x - plane[2] * p.y).abs());
            radius = radius.max(p.dot(*p));
        }
        let nothing = Chosen {
            coefficients: [F4::ZERO; MOST],
            sizes: [3; LANES],
            residual: F4::ZERO,
            cost: F4::ZERO,
            found: [false; LANES],
        };
        let mut fits = Fits {
            frames,
            radius: radius.sqrt(),
            plane: [plane[0], plane[1], plane[2]],
            is_flat: which(|i| i >= batch.seeds.len() || farthest.0[i] <= 4.0 * rounding.0[i] + 1e-14),
            needs_rulings: [false; LANES],
            simple: nothing,
            surface: nothing,
            deviation: F4::ZERO,
            error: F4::ZERO,
            quantum,
        };
        if !fits.is_flat.contains(&false) {
            return fits;
        }
        let least = factor.least_eigenvalue(6);
        fits.needs_rulings = which(|i| least.0[i] < SINGULAR && batch.rulings[i].is_empty());
        add_priors(&mut factor, rounding);
        factor.factor(SIMPLE);
        let mut models = [Model { coefficients: [F4::ZERO; MOST], residual: F4::ZERO, cost: F4::ZERO }; 4];
        for (m, model) in models.iter_mut().enumerate() {
            let coefficients = factor.solve(SIZES[m]);
            model.residual = residual(&samples.rows, &samples.values, &coefficients, SIZES[m]);
            model.cost = (model.residual + floor) * penalties[m];
            model.coefficients[..SIMPLE].copy_from_slice(&coefficients);
        }
        let reach = batch.reaches / frames.unit;
        let simple = samples.choose(&models, reach, &fits.is_flat, nothing);
        let degrees = count - F4::of(simple.sizes, |s| s as f64);
        fits.deviation = ((simple.residual + floor) / degrees).sqrt();
        fits.error = fits.deviation * factor.tensor_variance(simple.sizes, SIMPLE).sqrt();
        (fits.simple, fits.surface) = (simple, simple);

        let wants_more = which(|i| {
            let is_unexplained = simple.residual.0[i] > 2.0 * floor.0[i];
            // Between rims, only rulings hold the terms of the large basis.
            let has_rulings = !batch.rulings[i].is_empty();
            simple.found[i] && is_unexplained && batch.counts[i] >= MOST + 2 && !fits.is_flat[i] && !has_rulings
        });
        if wants_more.contains(&true) {
            let (wide, wide_error) = samples.fit_wide(batch, rounding, floor, penalties[4]);
            let is_sane = samples.is_sane(&Polynomial { coefficients: wide.coefficients, size: MOST }, reach);
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

impl Chosen {
    /// Takes the model of one lane.
    #[inline(always)]
    fn take(&mut self, lane: usize, model: &Model, size: usize) {
        for (to, from) in self.coefficients.iter_mut().zip(&model.coefficients) {
            to.0[lane] = from.0[lane];
        }
        self.sizes[lane] = size;
        self.residual.0[lane] = model.residual.0[lane];
        self.cost.0[lane] = model.cost.0[lane];
    }

    fn polynomial(&self, lane: usize) -> Polynomial<f64> {
        let size = self.sizes[lane];
        let mut coefficients = [0.0; MOST];
        coefficients[..size].iter_mut().zip(&self.coefficients).for_each(|(to, from)| *to = from.0[lane]);
        Polynomial { coefficients, size }
    }
}

impl Fits {
    /// What became of the window in a lane.
    pub(super) fn outcome(&self, batch: &Batch, lane: usize) -> Outcome {
        let unit = self.frames.unit.0[lane];
        if lane >= batch.seeds.len() || !(unit > 0.0 && unit.is_finite()) {
            return Outcome::None;
        }
        let [x, y, z] = &self.frames.axes;
        let axes = DMat3::from_cols(x.get(lane), y.get(lane), z.get(lane));
        let frame = Frame { origin: batch.centres[lane], axes, unit };
        let (radius, coverage) = (self.radius.0[lane] * unit, batch.coverage[lane]);
        if self.is_flat[lane] {
            let mut simple = Polynomial { coefficients: [0.0; MOST], size: 3 };
            simple.coefficients.iter_mut().zip(&self.plane).for_each(|(to, from)| *to = from.0[lane]);
            let surface = Implicit { frame, f: simple };
            return Outcome::Fitted(Fit { surface, simple, radius, coverage, misfit: self.quantum, error: 0.0 });
        }
        if batch.counts[lane] < 6 + 2 {
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
        let error = if surface.f.size < 6 { 0.0 } else { self.error.0[lane] / unit };
        Outcome::Fitted(Fit { surface, simple, radius, coverage, misfit, error })
    }
}

impl Samples {
    /// Sets up frames and takes all points into them: the normal is the mean of the normals, the tangents
    /// are the principal axes of the points, the unit is their root mean square distance.
    #[inline(always)]
    fn enter(&mut self, batch: &Batch) -> Frames {
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
        // The larger principal axis: half the angle of (uu - vv, 2 uv).
        let (half, cross) = ((uu - vv) * 0.5, uv);
        let sum = (half * half + cross * cross).sqrt() + half.abs();
        let x = half.select(sum, cross.abs());
        let y = half.select(cross, cross.select(sum, -sum));
        let length = (x * x + y * y).sqrt();
        let (cos, sin) = (length.if_positive(x / length, F4::ONE), length.if_positive(y / length, F4::ZERO));
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
        Frames { axes: [x, y, n], unit }
    }

    /// The normal equations of the simple bases, with rulings if there are any.
    #[inline(always)]
    fn equations(&mut self, batch: &Batch, frames: &Frames) -> Normal<SIMPLE> {
        self.rows.clear();
        for (i, &p) in self.points.iter().enumerate() {
            self.rows.push(basis(p, is_inside(batch, i)));
        }
        let mut normal = Normal::new(&self.rows, &self.values);
        for_rulings(batch, frames, |lane, row, value| normal.add(lane, &std::array::from_fn(|i| row[i]), value));
        normal
    }

    /// The model of all 22 terms.
    #[inline(always)]
    fn fit_wide(&mut self, batch: &Batch, rounding: F4, floor: F4, penalty: F4) -> (Model, F4) {
        self.wide_rows.clear();
        for (i, &p) in self.points.iter().enumerate() {
            self.wide_rows.push(basis(p, is_inside(batch, i)));
        }
        let normal = Normal::new(&self.wide_rows, &self.values);
        let mut factor = Factor::new(&normal);
        factor.factor(6);
        add_priors(&mut factor, rounding);
        factor.factor(MOST);
        let coefficients = factor.solve(MOST);
        let residual = residual(&self.wide_rows, &self.values, &coefficients, MOST);
        let degrees = F4::of(batch.counts, |c| c as f64 - MOST as f64);
        let error = ((residual + floor) / degrees).sqrt() * factor.tensor_variance([MOST; LANES], MOST).sqrt();
        (Model { coefficients, residual, cost: (residual + floor) * penalty }, error)
    }

    /// In each lane the cheapest model that passes the checks.
    #[inline(always)]
    fn choose(&self, models: &[Model; 4], reach: F4, is_flat: &[bool; LANES], mut chosen: Chosen) -> Chosen {
        let mut left = [[true; 4]; LANES];
        for _ in 0..models.len() {
            for (i, left) in left.iter_mut().enumerate() {
                if chosen.found[i] {
                    continue;
                }
                let mut best = 0;
                for m in 1..models.len() {
                    let is_less = models[m].cost.0[i] < models[best].cost.0[i];
                    if left[m] && (is_less || !left[best]) {
                        best = m;
                    }
                }
                left[best] = false;
                chosen.take(i, &models[best], SIZES[best]);
            }
            let is_sane = self.is_sane(&Polynomial { coefficients: chosen.coefficients, size: SIMPLE }, reach);
            let cost = chosen.cost.0;
            chosen.found = which(|i| chosen.found[i] || is_sane[i] && cost[i] < f64::INFINITY);
            if !which(|i| !chosen.found[i] && !is_flat[i]).contains(&true) {
                break;
            }
        }
        chosen
    }

    /// False for a surface that turns over within its window: an implicit surface may explain its samples
    /// with two sheets, of which the faces see the wrong one. False too where it is further from the middle
    /// than `reach`: it would not be the one the middle belongs to.
    #[inline(always)]
    fn is_sane(&self, f: &Polynomial<F4>, reach: F4) -> [bool; LANES] {
        let middle = f.gradient(V3::ZERO);
        let least = middle.dot(middle) * 0.09;
        let (mut slope, mut facing, mut turned) = (F4::splat(f64::INFINITY), F4::splat(0.0), F4::splat(0.0));
        for (&p, &normal) in self.points.iter().zip(&self.normals) {
            let gradient = f.gradient(p);
            let along = gradient.dot(normal);
            slope = slope.min(gradient.dot(gradient) - least);
            facing = facing.min(along);
            turned = turned.min(along * along - least * normal.dot(normal));
        }
        let foot = f.foot(V3::ZERO);
        let left = reach * reach - foot.dot(foot);
        which(|i| slope.0[i] >= 0.0 && facing.0[i] >= 0.0 && turned.0[i] >= 0.0 && left.0[i] >= 0.0)
    }
}

#[inline(always)]
fn which(is: impl Fn(usize) -> bool) -> [bool; LANES] {
    [is(0), is(1), is(2), is(3)]
}

/// One where a lane's window has so many points, zero elsewhere.
#[inline(always)]
fn is_inside(batch: &Batch, point: usize) -> F4 {
    F4::of(batch.counts, |count| if point < count { 1.0 } else { 0.0 })
}

/// The rows that ask for straight rulings.
fn for_rulings(batch: &Batch, frames: &Frames, mut row: impl FnMut(usize, &[f64; MOST], f64)) {
    for (lane, rulings) in batch.rulings.iter().enumerate() {
        let axes = DMat3::from_cols(frames.axes[0].get(lane), frames.axes[1].get(lane), frames.axes[2].get(lane));
        let axes = axes.transpose();
        for &(at, along) in rulings {
            let at = axes * ((at - batch.centres[lane]) / frames.unit.0[lane]);
            let along = axes * along.normalize_or_zero();
            row(lane, &basis_along(at.into(), along.into()).map(|d| RULING_WEIGHT * d), RULING_WEIGHT * along.z);
        }
    }
}

/// Priors on the terms beyond the paraboloid: where rounding is strong, terms that a surface bending as
/// this one does has no use for stay small. The paraboloid's columns are factored already.
#[inline(always)]
fn add_priors<const N: usize>(factor: &mut Factor<N>, rounding: F4) {
    let paraboloid = factor.solve(6);
    let [a, b, c] = [paraboloid[3], paraboloid[4], paraboloid[5]];
    let bend = ((a + c).abs() + ((a - c) * (a - c) + b * b).sqrt()).max(F4::splat(LEAST_BEND));
    let tight = rounding / (bend * 0.3);
    let first = tight * tight;
    let second = first / (bend * bend);
    let third = second / (bend * bend);
    for column in 6..N {
        let prior = match column {
            6..=8 => first,
            9..=16 => second,
            _ => third,
        };
        factor.add_prior(column, prior);
    }
}

/// What the sizes cost a window of `count` points, as factors of its residual: the stricter of generalised
/// cross-validation and Schwarz' criterion, step by step. Infinite for sizes that leave fewer than two points over.
fn penalties(count: usize) -> [f64; SIZES.len()] {
    let n = count as f64;
    let (mut penalty, mut before) = (0.0, SIZES[0] as f64);
    SIZES.map(|size| {
        if size + 2 > count {
            return f64::INFINITY;
        }
        let k = size as f64;
        let validation: f64 = 2.0 * ((n - before) / (n - k)).ln();
        penalty += validation.max((k - before) * n.ln() / n);
        before = k;
        penalty.exp()
    })
}
