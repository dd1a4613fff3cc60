//! Cyclides through noisy samples.

use super::basis::{basis, factor_with_prior, fill};
use super::frame::Frame;
use super::implicit::Implicit;
use super::least_squares::{Factor, Rows};
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
        fill(rows, &points, TERMS, 0);
        let mut factor = factor_with_prior(rows, noise);
        let mut surface = Implicit { frame, coefficients: factor.solve(TERMS), size: TERMS };
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
                rows.set(row, &basis(foot).map(|f| f / slope)[..TERMS], value / slope);
            }
            factor = factor_with_prior(rows, noise);
            surface.coefficients = factor.solve(TERMS);
        }
        let residual = rows.residual(&surface.coefficients[..TERMS], samples.len());
        let misfit = residual * frame.unit.powi(2) / (samples.len() - TERMS) as f64;
        misfit.is_finite().then_some(Cyclide { surface, factor, misfit })
    }

    pub(super) fn tensor_variance(&self) -> f64 {
        self.factor.tensor_variance(TERMS) / self.surface.frame.unit.powi(4)
    }
}
