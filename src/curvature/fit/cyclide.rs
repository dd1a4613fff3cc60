//! Cyclides through noisy samples.

use super::frame::Frame;
use super::implicit::Implicit;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::least_squares::{Factor, MOST, Rows};
use super::polynomial::{self, Polynomial, basis};
use super::prior::priors;
use glam::DVec3;

/// Terms of a Darboux cyclide.
pub(super) const TERMS: usize = 13;

/// A cyclide through noisy samples: the least sum of squared distances from the surface. The residuals
/// of its equation will not do, since noise stands on both sides of it.
pub(super) struct Cyclide {
    pub(super) surface: Implicit,
    factor: Factor,
    /// Variance of the samples, in file units squared.
    pub(super) misfit: f64,
}

impl Cyclide {
    pub(super) fn fit(frame: Frame, samples: &[DVec3], noise: f64, rows: &mut Rows) -> Option<Self> {
        const ROUNDS: usize = 3;
        if samples.len() < TERMS + 8 {
            return None;
        }
        let noise = noise / frame.unit;
        let points: Vec<DVec3> = samples.iter().map(|&p| frame.to_local(p)).collect();
        rows.reset(points.len(), TERMS);
        for (row, &p) in points.iter().enumerate() {
            rows.set(row, &terms(p), p.z);
        }
        let mut factor = factor_with_prior(rows, noise);
        let mut surface = Implicit { frame, f: Polynomial { coefficients: widened(factor.solve(TERMS)), size: TERMS } };
        for _ in 0..ROUNDS {
            if !run(FillRows { f: &surface.f, points: &points, rows }) {
                return None;
            }
            factor = factor_with_prior(rows, noise);
            surface.f.coefficients = widened(factor.solve(TERMS));
        }
        let residual = rows.residual(&surface.f.coefficients[..TERMS], samples.len());
        let misfit = residual * frame.unit.powi(2) / (samples.len() - TERMS) as f64;
        misfit.is_finite().then_some(Cyclide { surface, factor, misfit })
    }

    pub(super) fn tensor_variance(&self) -> f64 {
        self.factor.tensor_variance(TERMS) / self.surface.frame.unit.powi(4)
    }
}

/// Fills rows with the distances of samples from a surface, linear in the coefficients: that of the foot,
/// and from there to the sample. False where the surface folds or is far from a sample.
struct FillRows<'f> {
    f: &'f Polynomial<f64>,
    points: &'f [DVec3],
    rows: &'f mut Rows,
}

impl Kernel for FillRows<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        /// A gradient this small, against one at the middle, belongs to a fold of the surface.
        const LEAST_SLOPE: f64 = 0.05;
        let FillRows { f, points, rows } = self;
        let f = f.splat();
        let (mut farthest, mut least) = (F4::ZERO, F4::splat(f64::INFINITY));
        for lane in 0..rows.lanes() {
            let first = lane * LANES;
            // Lanes beyond the last point repeat it, with no weight.
            let (mut p, mut weight) = (V3::ZERO, F4::ZERO);
            for i in 0..LANES {
                p.set(i, points[(first + i).min(points.len() - 1)]);
                weight.0[i] = if first + i < points.len() { 1.0 } else { 0.0 };
            }
            let gradient = f.gradient(p);
            let foot = p - gradient.scaled(f.value(p) / gradient.dot(gradient));
            let gradient = f.gradient(foot);
            let slope = gradient.dot(gradient).sqrt();
            let way = p - foot;
            // What is not a number counts as far.
            farthest = (F4::splat(0.25) - way.dot(way)).if_positive(farthest, F4::splat(f64::INFINITY));
            least = least.min(slope - F4::splat(LEAST_SLOPE));
            let share = weight / slope;
            let mut values: [F4; TERMS] = basis(foot, F4::ONE);
            for value in &mut values {
                *value = *value * share;
            }
            rows.set_lane(lane, &values, (foot.z + gradient.dot(way)) * share);
        }
        farthest == F4::ZERO && least.0.iter().all(|&left| left > 0.0)
    }
}

/// Coefficients in the largest basis.
fn widened(coefficients: [f64; MOST]) -> [f64; polynomial::MOST] {
    let mut all = [0.0; polynomial::MOST];
    all[..TERMS].copy_from_slice(&coefficients[..TERMS]);
    all
}

fn terms(p: DVec3) -> [f64; TERMS] {
    basis(V3::from(p), 1.0)
}

/// The normal equations with a prior on the terms beyond the paraboloid.
fn factor_with_prior(rows: &Rows, noise: f64) -> Factor {
    let normal = rows.normal();
    let paraboloid = normal.factor(6, &[0.0; MOST]).solve(6);
    normal.factor(TERMS, &priors([paraboloid[3], paraboloid[4], paraboloid[5]], noise))
}
