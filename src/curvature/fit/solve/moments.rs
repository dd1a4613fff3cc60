//! Polynomials in two variables by least squares: sums over samples of the products of powers, and equations from them.
//!
//! The product of two monomials is a monomial, so of the many entries of the normal equations few differ: 45 of 120 for
//! a quartic. Only these are summed, and no row of monomials is ever written to memory.

use super::equations::Normal;
use crate::curvature::fit::surface::bivariate::{CUBIC, HIGHEST, POWERS, QUADRATIC, WIDEST, value};
use crate::curvature::vectors::four::F4;

/// Samples of heights z over (x, y), four windows side by side, each as its weight says; a weight of zero where a lane
/// has no more.
#[derive(Default)]
pub(super) struct Heights {
    pub(super) x: Vec<F4>,
    pub(super) y: Vec<F4>,
    pub(super) z: Vec<F4>,
    pub(super) weights: Vec<F4>,
}

/// Sums of w x^i y^j by j and i.
type Sums = [[F4; 2 * HIGHEST + 1]; 2 * HIGHEST + 1];

impl Heights {
    pub(super) fn clear(&mut self) {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.weights].into_iter().for_each(Vec::clear);
    }

    #[inline(always)]
    pub(super) fn push(&mut self, x: F4, y: F4, z: F4, weight: F4) {
        self.x.push(x);
        self.y.push(y);
        self.z.push(z);
        self.weights.push(weight);
    }

    /// The normal equations of the polynomial of `N` terms, those up to a degree.
    #[inline(always)]
    pub(super) fn equations<const N: usize>(&self, degree: usize) -> Normal<N> {
        /// Samples whose powers stay in the nearest cache.
        const TILE: usize = 64;
        let zero = [[F4::ZERO; 2 * HIGHEST + 1]; 2 * HIGHEST + 1];
        let (mut moments, mut heights): (Sums, Sums) = (zero, zero);
        let tiles = self.x.chunks(TILE).zip(self.y.chunks(TILE));
        for ((x, y), (z, weights)) in tiles.zip(self.z.chunks(TILE).zip(self.weights.chunks(TILE))) {
            let mut leads = [F4::ZERO; TILE];
            leads[..x.len()].copy_from_slice(weights);
            add_powers(&mut moments, 2 * degree, x, y, &mut leads[..x.len()]);
            for (lead, (&z, &weight)) in leads.iter_mut().zip(z.iter().zip(weights)) {
                *lead = z * weight;
            }
            add_powers(&mut heights, degree, x, y, &mut leads[..x.len()]);
        }
        let entry = |[i, j]: [usize; 2], [k, l]: [usize; 2]| moments[j + l][i + k];
        Normal::of(|a, b| entry(POWERS[a], POWERS[b]), |a| heights[POWERS[a][1]][POWERS[a][0]])
    }

    /// The weighted sum of squares that a polynomial of a degree leaves of the heights.
    #[inline(always)]
    pub(super) fn residual(&self, degree: usize, c: &[F4; WIDEST]) -> F4 {
        match degree {
            QUADRATIC => self.residual_of::<QUADRATIC>(c),
            CUBIC => self.residual_of::<CUBIC>(c),
            _ => self.residual_of::<HIGHEST>(c),
        }
    }

    #[inline(always)]
    fn residual_of<const D: usize>(&self, c: &[F4; WIDEST]) -> F4 {
        let mut total = F4::ZERO;
        for ((&x, &y), (&z, &weight)) in self.x.iter().zip(&self.y).zip(self.z.iter().zip(&self.weights)) {
            let left = z - value::<D, F4>(c, x, y);
            total += left * left * weight;
        }
        total
    }
}

/// Adds the sums of lead x^i y^j for i + j up to `most`; what leads were is lost.
#[inline(always)]
fn add_powers(sums: &mut Sums, most: usize, x: &[F4], y: &[F4], leads: &mut [F4]) {
    for (j, sums) in sums[..=most].iter_mut().enumerate() {
        if j > 0 {
            for (lead, &y) in leads.iter_mut().zip(y) {
                *lead = *lead * y;
            }
        }
        match most - j {
            8 => add_row::<9>(sums, x, leads),
            7 => add_row::<8>(sums, x, leads),
            6 => add_row::<7>(sums, x, leads),
            5 => add_row::<6>(sums, x, leads),
            4 => add_row::<5>(sums, x, leads),
            3 => add_row::<4>(sums, x, leads),
            2 => add_row::<3>(sums, x, leads),
            1 => add_row::<2>(sums, x, leads),
            _ => add_row::<1>(sums, x, leads),
        }
    }
}

/// Adds the sums of lead x^i for the first `K` powers, which stay in registers.
#[inline(always)]
fn add_row<const K: usize>(sums: &mut [F4], x: &[F4], leads: &[F4]) {
    let mut row = [F4::ZERO; K];
    for (&x, &lead) in x.iter().zip(leads) {
        let mut power = lead;
        for (i, sum) in row.iter_mut().enumerate() {
            if i > 0 {
                power = power * x;
            }
            *sum += power;
        }
    }
    for (to, from) in sums.iter_mut().zip(row) {
        *to += from;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::solve::equations::Factor;
    use crate::curvature::fit::surface::bivariate::terms;
    use crate::curvature::vectors::four::Real;

    /// Terms at a point, one by one.
    fn row(x: f64, y: f64) -> [f64; WIDEST] {
        POWERS.map(|[i, j]| x.powi(i as i32) * y.powi(j as i32))
    }

    #[test]
    fn a_quartic_is_found_again_and_leaves_nothing() {
        let wanted: [f64; WIDEST] = std::array::from_fn(|i| 0.3 - 0.05 * (i * 7 % 11) as f64);
        let mut samples = Heights::default();
        for n in 0..90 {
            let (x, y) = ((f64::from(n) * 0.37).sin(), (f64::from(n) * 0.61).cos());
            let z: f64 = row(x, y).iter().zip(&wanted).map(|(f, c)| f * c).sum();
            samples.push(F4::splat(x), F4::splat(y), F4::splat(z), F4::splat(if n % 3 == 0 { 0.5 } else { 2.0 }));
        }
        // Without weight, whatever it is.
        samples.push(F4::splat(7.0), F4::splat(-3.0), F4::splat(1e6), F4::ZERO);
        let mut factor = Factor::<WIDEST>::new(&samples.equations(HIGHEST));
        factor.factor(WIDEST);
        let c = factor.solve(WIDEST);
        assert!(c.iter().zip(wanted).all(|(got, wanted)| (got.0[2] - wanted).abs() < 1e-8), "{c:?}");
        assert!(samples.residual(HIGHEST, &c).0[1] < 1e-14);
        // The best cubic leaves what is perpendicular to all its terms.
        let cubic = factor.solve(terms(3));
        let mut left = [0.0; terms(3)];
        let mut total = 0.0;
        for n in 0..90 {
            let row = row(samples.x[n].0[0], samples.y[n].0[0]);
            let rest = samples.z[n].0[0] - row.iter().zip(&cubic).map(|(f, c)| f * c.0[0]).sum::<f64>();
            let weight = samples.weights[n].0[0];
            left.iter_mut().zip(row).for_each(|(sum, f)| *sum += weight * f * rest);
            total += weight * rest * rest;
        }
        assert!(left.iter().all(|left| left.abs() < 1e-8), "{left:?}");
        assert!((samples.residual(3, &cubic).0[3] - total).abs() < 1e-9 * total);
    }
}
