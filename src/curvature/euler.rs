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

/// Principal curvatures and the angle of the direction of k_max.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Principal {
    pub(super) k_max: f64,
    pub(super) k_min: f64,
    pub(super) angle: f64,
}

const TERMS: usize = 5;

/// Normal equations of the fit, lower triangle.
#[derive(Clone, Debug)]
pub(super) struct EulerFit {
    gram: [[f64; TERMS]; TERMS],
    right: [f64; TERMS],
}

/// Weight of the wish for zero, per term, against that of one full diameter.
///
/// For Euler's terms it only matters where the diameters leave a direction of the fit open: of all
/// curvatures that explain them, the least is taken, so that a single bent diameter means a cylinder.
/// The fourth harmonic must be shown by the data: where a border leaves a few diameters only, it is
/// held back.
const RIDGE: [f64; TERMS] = [1e-9, 1e-9, 1e-9, 0.05, 0.05];

impl EulerFit {
    pub(super) fn new() -> Self {
        EulerFit { gram: [[0.0; TERMS]; TERMS], right: [0.0; TERMS] }
    }

    pub(super) fn add(&mut self, angle: f64, sample: Sample) {
        let (sin, cos) = (2.0 * angle).sin_cos();
        let row = [1.0, cos, sin, cos * cos - sin * sin, 2.0 * sin * cos];
        for i in 0..TERMS {
            for j in 0..=i {
                self.gram[i][j] += sample.weight * row[i] * row[j];
            }
            self.right[i] += sample.weight * row[i] * sample.curvature;
        }
    }

    /// The fitted principal curvatures; zero where no sample had any weight.
    pub(super) fn solve(&self) -> Principal {
        let [mean, a, b, c, d] = self.coefficients();
        let amplitude = a.hypot(b);
        // At the angle of k_max, 4 t is twice the angle of (a, b).
        let fourth =
            if amplitude > 0.0 { (c * (a * a - b * b) + d * 2.0 * a * b) / (amplitude * amplitude) } else { 0.0 };
        let (along, across) = (mean + amplitude + fourth, mean - amplitude + fourth);
        Principal { k_max: along, k_min: across, angle: 0.5 * b.atan2(a) }
    }

    /// Solves the normal equations by Cholesky's factorisation; the ridge keeps every pivot positive.
    fn coefficients(&self) -> [f64; TERMS] {
        let scale = self.gram[0][0];
        let mut x = [0.0; TERMS];
        if scale <= 0.0 {
            return x;
        }
        let mut l = [[0.0; TERMS]; TERMS];
        for i in 0..TERMS {
            let mut y = self.right[i];
            for j in 0..i {
                let dot: f64 = (0..j).map(|k| l[i][k] * l[j][k]).sum();
                l[i][j] = (self.gram[i][j] - dot) / l[j][j];
                y -= l[i][j] * x[j];
            }
            let dot: f64 = (0..i).map(|k| l[i][k] * l[i][k]).sum();
            let ridge = RIDGE[i] * scale;
            l[i][i] = (self.gram[i][i] + ridge - dot).max(ridge).sqrt();
            x[i] = y / l[i][i];
        }
        for i in (0..TERMS).rev() {
            for j in i + 1..TERMS {
                x[i] -= l[j][i] * x[j];
            }
            x[i] /= l[i][i];
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn fit(samples: impl IntoIterator<Item = (f64, f64, f64)>) -> Principal {
        let mut fit = EulerFit::new();
        for (angle, curvature, weight) in samples {
            fit.add(angle, Sample { curvature, weight });
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
        assert!((p.angle - 0.3).abs() < 1e-6, "{p:?}");
    }

    #[test]
    fn one_diameter_means_a_cylinder() {
        let p = fit([(0.7, 4.0, 1.0)]);
        assert!((p.k_max - 4.0).abs() < 1e-6 && p.k_min.abs() < 1e-6 && (p.angle - 0.7).abs() < 1e-6, "{p:?}");
    }

    #[test]
    fn no_weight_means_flat() {
        assert_eq!(fit([(0.0, 3.0, 0.0)]), Principal { k_max: 0.0, k_min: 0.0, angle: 0.0 });
    }
}
