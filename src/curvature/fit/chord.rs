//! Height polynomials in chord-length coordinates: the fit for noisy surfaces.
//!
//! Let o be a point of the surface with unit normal n, p a sample, L = |p - o|, z = (p - o) . n and t the
//! azimuth of p around n. The circle through o and p that touches the tangent plane at o has curvature
//! 2 |z| / L^2, at any distance along a circular section. So in the coordinates (X, Y) = L (cos t, sin t)
//! a sphere is a paraboloid exactly, and few terms describe what would take a height function many.
//!
//! The surface is z = P(X, Y) with P of degree 3 or 4, with constant and linear terms; the frame is
//! moved and tilted until these are small.

use super::frame::Frame;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::least_squares::{Factor, Rows};
use super::shape::Shape;
use glam::{DMat3, DVec3};

/// Number of terms by degree.
pub(super) const TERMS: [usize; 5] = [1, 3, 6, 10, 15];
const WIDEST: usize = 15;

/// A fitted surface patch. The frame's unit is the radius of its window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) frame: Frame,
    pub(super) coefficients: [f64; WIDEST],
}

/// The normal equations of a window in its final frame, for all degrees up to 4.
pub(super) struct ChordFit {
    pub(super) frame: Frame,
    factor: Factor,
    count: usize,
    /// Sums of squared residuals by degree, in units of the frame.
    residuals: [f64; 5],
    highest: usize,
}

#[inline(always)]
fn monomials<T: Real>(one: T, x: T, y: T) -> [T; WIDEST] {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    [one, x, y, xx, xy, yy, xx * x, xx * y, x * yy, yy * y, xx * xx, xx * xy, xx * yy, xy * yy, yy * yy]
}

/// Chord coordinates of a local point whose height over the tangent plane is `z`.
#[inline(always)]
fn chord<T: Real>(p: V3<T>, z: T) -> (T, T) {
    let planar = p.x * p.x + p.y * p.y;
    let one = T::splat(1.0);
    let stretch = planar.if_positive((one + z * z / planar).min(T::splat(9.0)).sqrt(), one);
    (p.x * stretch, p.y * stretch)
}

/// Fills rows with the monomials at samples, each times the root of its weight.
struct FillRows<'f> {
    frame: &'f Frame,
    samples: &'f [DVec3],
    weights: &'f [f64],
    width: usize,
    rows: &'f mut Rows,
}

impl Kernel for FillRows<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let FillRows { frame, samples, weights, width, rows } = self;
        let axes = [frame.axes.x_axis, frame.axes.y_axis, frame.axes.z_axis].map(V3::splat);
        let scale = F4::splat(1.0 / frame.unit);
        for lane in 0..rows.lanes() {
            let first = lane * LANES;
            let (mut d, mut weight) = (V3::ZERO, F4::ZERO);
            for i in 0..LANES.min(samples.len() - first) {
                d.set(i, samples[first + i] - frame.origin);
                weight.0[i] = weights.get(first + i).copied().unwrap_or(1.0);
            }
            let p = V3::new(d.dot(axes[0]), d.dot(axes[1]), d.dot(axes[2])).scaled(scale);
            let (x, y) = chord(p, p.z);
            let root = weight.sqrt();
            let mut values = monomials(F4::ONE, x, y);
            for value in &mut values {
                *value = *value * root;
            }
            rows.set_lane(lane, &values[..width], p.z * root);
        }
    }
}

fn tilted(normal: DVec3, x: DVec3) -> DMat3 {
    let x = (x - x.dot(normal) * normal).normalize_or(normal.any_orthonormal_vector());
    DMat3::from_cols(x, normal.cross(x), normal)
}

impl ChordFit {
    /// Fits samples around `frame.origin`, none of them further from it than about `frame.unit`, and
    /// refits `rounds` times in the frame that the fit before suggests.
    pub(super) fn new(frame: Frame, samples: &[DVec3], rounds: usize, rows: &mut Rows) -> Option<Self> {
        ChordFit::weighted(frame, samples, &[], 4, rounds, rows)
    }

    /// The same with a weight for each sample and up to a degree.
    pub(super) fn weighted(
        mut frame: Frame,
        samples: &[DVec3],
        weights: &[f64],
        degree: usize,
        rounds: usize,
        rows: &mut Rows,
    ) -> Option<Self> {
        let carried = (2..=4).rev().find(|&d| TERMS[d] + 3 <= samples.len())?;
        let highest = carried.min(degree);
        for round in 0.. {
            let last = round == rounds;
            let degree = if last { highest } else { carried.min(3) };
            let width = TERMS[degree];
            rows.reset(samples.len(), width);
            run(FillRows { frame: &frame, samples, weights, width, rows });
            let factor = rows.factor();
            if last {
                let mut residuals = [0.0; 5];
                for d in 2..=degree {
                    residuals[d] = rows.residual(&factor.solve(TERMS[d])[..TERMS[d]], samples.len());
                }
                return Some(ChordFit { frame, factor, count: samples.len(), residuals, highest });
            }
            let c = factor.solve(width);
            frame.origin += frame.axes.z_axis * (c[0] * frame.unit);
            let normal = (frame.axes * DVec3::new(-c[1], -c[2], 1.0)).normalize();
            frame.axes = tilted(normal, frame.axes.x_axis);
            if !frame.origin.is_finite() || !normal.is_finite() {
                return None;
            }
        }
        None
    }

    /// The highest degree that the samples allow.
    pub(super) fn highest(&self) -> usize {
        self.highest
    }

    /// Variance of the samples about the surface of a degree, in file units squared.
    pub(super) fn deviation_squared(&self, degree: usize) -> f64 {
        self.residuals[degree] * self.frame.unit.powi(2) / (self.count - TERMS[degree]) as f64
    }

    /// Variance of the shape tensor at the middle (its squared Frobenius norm) for samples of unit
    /// variance, 1/length^4.
    pub(super) fn tensor_variance(&self, degree: usize) -> f64 {
        self.factor.tensor_variance(TERMS[degree]) / self.frame.unit.powi(4)
    }

    pub(super) fn surface(&self, degree: usize) -> Chord {
        let c = self.factor.solve(TERMS[degree]);
        Chord { frame: self.frame, coefficients: std::array::from_fn(|i| c[i]) }
    }
}

/// A function of two variables with its first and second derivatives.
#[derive(Clone, Copy)]
struct Jet {
    value: f64,
    first: [f64; 2],
    /// xx, xy, yy
    second: [f64; 3],
}

impl Jet {
    fn times(self, o: Jet) -> Jet {
        let [ax, ay] = self.first;
        let [bx, by] = o.first;
        Jet {
            value: self.value * o.value,
            first: [ax * o.value + self.value * bx, ay * o.value + self.value * by],
            second: [
                self.second[0] * o.value + 2.0 * ax * bx + self.value * o.second[0],
                self.second[1] * o.value + ax * by + ay * bx + self.value * o.second[1],
                self.second[2] * o.value + 2.0 * ay * by + self.value * o.second[2],
            ],
        }
    }

    /// f(self) for a function with these derivatives at the value.
    fn mapped(self, f: f64, df: f64, ddf: f64) -> Jet {
        let [x, y] = self.first;
        Jet {
            value: f,
            first: [df * x, df * y],
            second: [
                ddf * x * x + df * self.second[0],
                ddf * x * y + df * self.second[1],
                ddf * y * y + df * self.second[2],
            ],
        }
    }
}

impl Chord {
    /// The polynomial at chord coordinates.
    fn height(&self, x: f64, y: f64) -> Jet {
        let c = &self.coefficients;
        let (xx, xy, yy) = (x * x, x * y, y * y);
        Jet {
            value: monomials(1.0, x, y).iter().zip(c).map(|(m, c)| m * c).sum(),
            first: [
                c[1] + 2.0 * c[3] * x
                    + c[4] * y
                    + 3.0 * c[6] * xx
                    + 2.0 * c[7] * xy
                    + c[8] * yy
                    + 4.0 * c[10] * xx * x
                    + 3.0 * c[11] * xx * y
                    + 2.0 * c[12] * x * yy
                    + c[13] * yy * y,
                c[2] + c[4] * x
                    + 2.0 * c[5] * y
                    + c[7] * xx
                    + 2.0 * c[8] * xy
                    + 3.0 * c[9] * yy
                    + c[11] * xx * x
                    + 2.0 * c[12] * xx * y
                    + 3.0 * c[13] * x * yy
                    + 4.0 * c[14] * yy * y,
            ],
            second: [
                2.0 * c[3] + 6.0 * c[6] * x + 2.0 * c[7] * y + 12.0 * c[10] * xx + 6.0 * c[11] * xy + 2.0 * c[12] * yy,
                c[4] + 2.0 * c[7] * x + 2.0 * c[8] * y + 3.0 * c[11] * xx + 4.0 * c[12] * xy + 3.0 * c[13] * yy,
                2.0 * c[5] + 2.0 * c[8] * x + 6.0 * c[9] * y + 2.0 * c[12] * xx + 6.0 * c[13] * xy + 12.0 * c[14] * yy,
            ],
        }
    }

    /// Height of a point over the surface, and the shape of the surface below it. `None` where the
    /// surface has turned over.
    pub(super) fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        let c = &self.coefficients;
        let p = self.frame.to_local(point);
        let (x, y) = chord(p.into(), p.z - c[0] - c[1] * p.x - c[2] * p.y);
        let z = self.height(x, y);
        // Heights over the tangent plane alone shorten the way along it from chord to foot.
        let bent = Jet {
            value: z.value - c[0] - c[1] * x - c[2] * y,
            first: [z.first[0] - c[1], z.first[1] - c[2]],
            second: z.second,
        };
        let square = x * x + y * y;
        let shortened = if square > 1e-6 {
            let inverse = Jet { value: square, first: [2.0 * x, 2.0 * y], second: [2.0, 0.0, 2.0] };
            let inverse = inverse.mapped(1.0 / square, -1.0 / (square * square), 2.0 / square.powi(3));
            let steep = bent.times(bent).times(inverse);
            let left = 1.0 - steep.value;
            if left < 0.05 {
                return None;
            }
            let root = left.sqrt();
            steep.mapped(root, -0.5 / root, -0.25 / (left * root))
        } else {
            Jet { value: 1.0, first: [0.0; 2], second: [0.0; 3] }
        };
        let along = |value: f64, axis: usize| {
            let mut first = [0.0; 2];
            first[axis] = 1.0;
            Jet { value, first, second: [0.0; 3] }
        };
        let (px, py) = (along(x, 0).times(shortened), along(y, 1).times(shortened));
        let first = |i: usize| DVec3::new(px.first[i], py.first[i], z.first[i]);
        let second = |i: usize| DVec3::new(px.second[i], py.second[i], z.second[i]);
        let (a, b) = (first(0), first(1));
        let cross = a.cross(b);
        let normal = cross.try_normalize()?;
        // Dual tangents, and the second form on them.
        let (da, db) = (b.cross(normal) / cross.length(), normal.cross(a) / cross.length());
        let form: [f64; 3] = std::array::from_fn(|i| -normal.dot(second(i)) / self.frame.unit);
        let outer = |u: DVec3, v: DVec3| DMat3::from_cols(u * v.x, u * v.y, u * v.z);
        let tensor = outer(da, da) * form[0] + (outer(da, db) + outer(db, da)) * form[1] + outer(db, db) * form[2];
        let axes = self.frame.axes;
        let tensor = axes * tensor * axes.transpose();
        let height = (p.z - z.value) * normal.z * self.frame.unit;
        (tensor.is_finite() && normal.z > 0.0).then(|| (height, Shape { normal: axes * normal, tensor }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_is_exact_also_far_from_the_middle() {
        // Half a sphere of radius 2 under a frame that leans.
        let samples: Vec<DVec3> = (0..200)
            .map(|i| {
                let (t, s) = (f64::from(i) * 2.4, 1.2 * (f64::from(i) / 200.0).sqrt());
                2.0 * DVec3::new(s.sin() * t.cos(), s.sin() * t.sin(), s.cos() - 1.0)
            })
            .collect();
        let normal = DVec3::new(0.1, -0.05, 1.0).normalize();
        let frame = Frame { origin: DVec3::new(0.0, 0.0, 0.1), axes: tilted(normal, DVec3::X), unit: 2.5 };
        let fit = ChordFit::new(frame, &samples, 6, &mut Rows::new()).expect("a fit");
        for degree in [2, 3, 4] {
            assert!(fit.deviation_squared(degree) < 1e-12, "{}", fit.deviation_squared(degree));
            let surface = fit.surface(degree);
            for &p in &samples[..120] {
                let (height, shape) = surface.shape_at(p).expect("a shape");
                let k = shape.principal();
                assert!(height.abs() < 1e-5 && (k.k_max - 0.5).abs() < 1e-4 && (k.k_min - 0.5).abs() < 1e-4, "{k:?}");
                assert!(shape.normal.dot((p + 2.0 * DVec3::Z) / 2.0) > 1.0 - 1e-6);
            }
        }
    }
}
