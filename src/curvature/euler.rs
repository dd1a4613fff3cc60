//! Principal curvatures from normal curvatures in several directions.
//!
//! Euler's formula k(t) = mean + a cos 2t + b sin 2t is fitted to all diameters by weighted least
//! squares, together with c cos 4t + d sin 4t. The principal direction is that of the second
//! harmonic, and then as fine as the data allow, not as the angular step: picking the best of 24 planes
//! is 2 to 4 degrees off where the fit is 0.1 to 2.
//!
//! The fourth harmonic is what a leg of finite length adds: on a cylinder the sections in slanting
//! planes are ellipses, which bend more further out, while those along and across it are exact. The
//! principal curvatures are read off the whole fit in the two principal directions, so that they are
//! exact there too.

use super::Sample;
use super::vectors::four::Real;

/// Principal curvatures and the direction of k_max.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PlanarPrincipal<R = f64> {
    pub(super) k_max: R,
    pub(super) k_min: R,
    /// Cosine and sine of the angle of the direction of k_max, the cosine zero or more.
    pub(super) direction: [R; 2],
}

impl PlanarPrincipal {
    /// The larger of both curvatures without their signs.
    pub(super) fn largest(&self) -> f64 {
        self.k_max.abs().max(self.k_min.abs())
    }
}

pub(super) const TERMS: usize = 5;

/// Normal equations of the fit, lower triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EulerFit<R = f64> {
    pub(super) gram: [[R; TERMS]; TERMS],
    pub(super) right: [R; TERMS],
}

/// Weight of the wish for zero, per term, against that of one full diameter.
///
/// For Euler's terms it only matters where the diameters leave a direction of the fit open: of all
/// curvatures that explain them, the least is taken, so that a single bent diameter means a cylinder.
/// The fourth harmonic must be shown by the data: where a border leaves a few diameters only, it is
/// held back.
const RIDGE: [f64; TERMS] = [1e-9, 1e-9, 1e-9, 0.05, 0.05];

/// The terms of the fit in the direction of an angle.
pub(super) fn terms(angle: f64) -> [f64; TERMS] {
    let (sin, cos) = (2.0 * angle).sin_cos();
    [1.0, cos, sin, cos * cos - sin * sin, 2.0 * sin * cos]
}

impl<R: Real> EulerFit<R> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        let zero = R::splat(0.0);
        EulerFit { gram: [[zero; TERMS]; TERMS], right: [zero; TERMS] }
    }

    /// Adds what a section shows in the direction that [`terms`] are of.
    #[inline(always)]
    pub(super) fn add(&mut self, terms: &[R; TERMS], sample: Sample<R>) {
        for i in 0..TERMS {
            let weighed = sample.weight * terms[i];
            for (entry, &term) in self.gram[i][..=i].iter_mut().zip(terms) {
                *entry += weighed * term;
            }
            self.right[i] += weighed * sample.curvature;
        }
    }

    /// The fitted principal curvatures; zero where no sample had any weight.
    #[inline(always)]
    pub(super) fn solve(&self) -> PlanarPrincipal<R> {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let [mean, a, b, c, d] = self.coefficients();
        let squared = a * a + b * b;
        let amplitude = squared.sqrt();
        // At the angle of k_max, 4 t is twice the angle of (a, b).
        let fourth = squared.if_positive((c * (a * a - b * b) + d * a * b * 2.0) / squared, zero);
        // Half the angle of (a, b): its larger part by the root, the other from their product.
        let larger = ((one + a.abs() / amplitude) * 0.5).sqrt();
        let lesser = b.abs() / (amplitude * larger * 2.0);
        let sign = b.select(one, -one);
        let [x, y] = [a.select(larger, lesser), sign * a.select(lesser, larger)];
        PlanarPrincipal {
            k_max: mean + amplitude + fourth,
            k_min: mean - amplitude + fourth,
            direction: [squared.if_positive(x, one), squared.if_positive(y, zero)],
        }
    }

    /// Solves the normal equations by Cholesky's factorisation; the ridge keeps every pivot positive.
    #[inline(always)]
    fn coefficients(&self) -> [R; TERMS] {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let scale = self.gram[0][0];
        let mut x = [zero; TERMS];
        let mut l = [[zero; TERMS]; TERMS];
        let mut inverse = [zero; TERMS];
        for i in 0..TERMS {
            let mut y = self.right[i];
            for j in 0..i {
                let mut rest = self.gram[i][j];
                for (&a, &b) in l[i][..j].iter().zip(&l[j]) {
                    rest -= a * b;
                }
                l[i][j] = rest * inverse[j];
                y -= l[i][j] * x[j];
            }
            let ridge = scale * RIDGE[i];
            let mut rest = self.gram[i][i] + ridge;
            for &a in &l[i][..i] {
                rest -= a * a;
            }
            inverse[i] = one / rest.max(ridge).sqrt();
            x[i] = y * inverse[i];
        }
        for i in (0..TERMS).rev() {
            for j in i + 1..TERMS {
                x[i] -= l[j][i] * x[j];
            }
            x[i] = scale.if_positive(x[i] * inverse[i], zero);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn fit(samples: impl IntoIterator<Item = (f64, f64, f64)>) -> PlanarPrincipal {
        let mut fit = EulerFit::<f64>::new();
        for (angle, curvature, weight) in samples {
            fit.add(&terms(angle), Sample { curvature, weight });
        }
        fit.solve()
    }

    #[test]
    fn uneven_weights_do_not_bend_the_answer() {
        let curvature = |t: f64| 2.0 * (t - 0.3).cos().powi(2) - 5.0 * (t - 0.3).sin().powi(2);
        let p =
            fit((0..12)
                .map(|i| (f64::from(i) * PI / 12.0, curvature(f64::from(i) * PI / 12.0), 0.1 + f64::from(i % 5))));
        assert!((p.k_max - 2.0).abs() < 1e-6 && (p.k_min + 5.0).abs() < 1e-6, "{p:?}");
        assert!((p.direction[1].atan2(p.direction[0]) - 0.3).abs() < 1e-6, "{p:?}");
    }

    #[test]
    fn one_diameter_means_a_cylinder() {
        let p = fit([(0.7, 4.0, 1.0)]);
        assert!(
            (p.k_max - 4.0).abs() < 1e-6
                && p.k_min.abs() < 1e-6
                && (p.direction[1].atan2(p.direction[0]) - 0.7).abs() < 1e-6,
            "{p:?}"
        );
    }

    #[test]
    fn no_weight_means_flat() {
        assert_eq!(fit([(0.0, 3.0, 0.0)]), PlanarPrincipal { k_max: 0.0, k_min: 0.0, direction: [1.0, 0.0] });
    }

    /// In every quadrant of the two terms.
    #[test]
    fn the_direction_is_half_the_angle_of_the_second_harmonic() {
        for i in -17..=18 {
            let angle = f64::from(i) * PI / 36.0;
            let curvature = |t: f64| 1.0 + 3.0 * (2.0 * (t - angle)).cos();
            let p = fit((0..8).map(|i| (f64::from(i) * PI / 8.0, curvature(f64::from(i) * PI / 8.0), 1.0)));
            let [x, y] = p.direction;
            assert!(x >= 0.0 && (x * x + y * y - 1.0).abs() < 1e-12, "{angle}: {p:?}");
            assert!((x * angle.sin() - y * angle.cos()).abs() < 1e-7, "{angle}: {p:?}");
        }
    }
}
