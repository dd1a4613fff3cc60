//! Cyclides through noisy samples.

use super::frame::Frame;
use super::implicit::Implicit;
use super::lanes::V3;
use super::least_squares::{Factor, MOST, Rows};
use super::polynomial::{Polynomial, basis};
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
        /// A gradient this small, against one at the middle, belongs to a fold of the surface.
        const LEAST_SLOPE: f64 = 0.05;
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
        let mut surface = Implicit { frame, f: Polynomial { coefficients: factor.solve(TERMS), size: TERMS } };
        for _ in 0..ROUNDS {
            for (row, &p) in points.iter().enumerate() {
                // The distance, linear in the coefficients: that of the foot, and from there to the sample.
                let gradient = surface.gradient(p);
                let foot = p - gradient * (surface.value(p) / gradient.length_squared());
                let gradient = surface.gradient(foot);
                let slope = gradient.length();
                let is_near = foot.distance_squared(p) <= 0.25;
                if !(is_near && slope > LEAST_SLOPE) {
                    return None;
                }
                let value = foot.z + gradient.dot(p - foot);
                rows.set(row, &terms(foot).map(|f| f / slope), value / slope);
            }
            factor = factor_with_prior(rows, noise);
            surface.f.coefficients = factor.solve(TERMS);
        }
        let residual = rows.residual(&surface.f.coefficients[..TERMS], samples.len());
        let misfit = residual * frame.unit.powi(2) / (samples.len() - TERMS) as f64;
        misfit.is_finite().then_some(Cyclide { surface, factor, misfit })
    }

    pub(super) fn tensor_variance(&self) -> f64 {
        self.factor.tensor_variance(TERMS) / self.surface.frame.unit.powi(4)
    }
}

fn terms(p: DVec3) -> [f64; TERMS] {
    basis(V3::from(p), 1.0)
}

/// Curvature, in turns per window, below which priors do not get any narrower.
const LEAST_BEND: f64 = 0.03;

/// The normal equations with a prior on the terms beyond the paraboloid: where noise is strong, terms that
/// a surface bending as this one does has no use for stay small.
fn factor_with_prior(rows: &Rows, noise: f64) -> Factor {
    let mut prior = [0.0; MOST];
    let normal = rows.normal();
    let paraboloid = normal.factor(6, &prior).solve(6);
    let [a, b, c] = [paraboloid[3], paraboloid[4], paraboloid[5]];
    let bend = ((a + c).abs() + (a - c).hypot(b)).max(LEAST_BEND);
    prior[6..9].fill((noise / (0.3 * bend)).powi(2));
    prior[9..TERMS].fill((noise / (0.3 * bend * bend)).powi(2));
    normal.factor(TERMS, &prior)
}
