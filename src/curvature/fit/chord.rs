//! Height polynomials in chord-length coordinates: the fit for noisy surfaces.
//!
//! Let o be a point of the surface with unit normal n, p a sample, L = |p - o|, z = (p - o) . n and t the
//! azimuth of p around n. The circle through o and p that touches the tangent plane at o has curvature
//! 2 |z| / L^2, at any distance along a circular section. So in the coordinates (X, Y) = L (cos t, sin t)
//! a sphere is a paraboloid exactly, and few terms describe what would take a height function many.
//!
//! The surface is z = P(X, Y) with P of degree 3 or 4, with constant and linear terms; the frame is
//! moved and tilted until these are small.

use super::abreast::{Abreast, Frames};
use super::equations::{Factor, Normal, residual};
use super::foot::{Foot, Sides};
use super::frame::Frame;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::polynomial::Symmetric;
use super::shape::Shape;
use glam::DVec3;

/// Number of terms by degree.
const TERMS: [usize; 5] = [1, 3, 6, 10, 15];
const WIDEST: usize = TERMS[4];

/// A fitted surface patch. The frame's unit is the radius of its window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) frame: Frame,
    pub(super) coefficients: [f64; WIDEST],
}

/// Fits four windows at a time.
pub(super) struct ChordFitter {
    paraboloids: Rows<{ TERMS[2] }>,
    cubics: Rows<{ TERMS[3] }>,
    quartics: Rows<{ TERMS[4] }>,
}

/// The fits to four windows, whose frames they have moved.
pub(super) struct ChordFits {
    /// By degree.
    models: [Model; 5],
    highest: [usize; LANES],
    counts: [usize; LANES],
}

/// The polynomials of one degree, in units of the frames.
#[derive(Clone, Copy)]
struct Model {
    coefficients: [F4; WIDEST],
    /// Sums of squared residuals.
    residual: F4,
    /// Variances of the shape tensors at the middle (their squared Frobenius norms) for samples of unit variance.
    variance: F4,
}

/// Monomials at samples and the heights they are to explain, all times the roots of the weights.
struct Rows<const N: usize> {
    monomials: Vec<[F4; N]>,
    heights: Vec<F4>,
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

impl<const N: usize> Rows<N> {
    const NONE: Self = Rows { monomials: Vec::new(), heights: Vec::new() };

    #[inline(always)]
    fn fill(&mut self, abreast: &Abreast, frames: Frames) {
        self.monomials.clear();
        self.heights.clear();
        for (&p, &root) in abreast.points.iter().zip(&abreast.roots) {
            let p = frames.to_local(p);
            let (x, y) = chord(p, p.z);
            let all = monomials(F4::ONE, x, y);
            let mut row = [F4::ZERO; N];
            for (value, monomial) in row.iter_mut().zip(all) {
                *value = monomial * root;
            }
            self.monomials.push(row);
            self.heights.push(p.z * root);
        }
    }

    /// The equations of the windows, factored.
    #[inline(always)]
    fn factor(&mut self, abreast: &Abreast, frames: Frames) -> Factor<N> {
        self.fill(abreast, frames);
        let mut factor = Factor::new(&Normal::new(&self.monomials, &self.heights));
        factor.factor(N);
        factor
    }

    /// The models of degree 2 and higher, as far as the rows reach.
    #[inline(always)]
    fn models(&mut self, abreast: &Abreast, highest: [usize; LANES]) -> [Model; 5] {
        let factor = self.factor(abreast, abreast.frames);
        let mut models = [Model::ZERO; 5];
        for (degree, model) in models.iter_mut().enumerate().skip(2) {
            let is_asked_for = degree > 2 || highest.contains(&2);
            if TERMS[degree] > N || !is_asked_for {
                continue;
            }
            let size = TERMS[degree];
            let coefficients = factor.solve(size);
            model.residual = residual(&self.monomials, &self.heights, &coefficients, size);
            model.coefficients[..size].copy_from_slice(&coefficients[..size]);
            model.variance = factor.tensor_variance([size; LANES], size);
        }
        models
    }
}

impl Model {
    const ZERO: Model = Model { coefficients: [F4::ZERO; WIDEST], residual: F4::ZERO, variance: F4::ZERO };
}

struct FitLanes<'f> {
    fitter: &'f mut ChordFitter,
    abreast: &'f mut Abreast,
    degrees: [usize; LANES],
    rounds: usize,
}

impl Kernel for FitLanes<'_> {
    type Output = ChordFits;

    #[inline(always)]
    fn run(self) -> ChordFits {
        let FitLanes { fitter, abreast, degrees, rounds } = self;
        let counts = abreast.counts;
        let carried = counts.map(|count| (2..=4).rev().find(|&d| TERMS[d] + 3 <= count).unwrap_or(0));
        for _ in 0..rounds {
            let factor = fitter.cubics.factor(abreast, abreast.frames);
            let c = factor.solve_each(carried.map(|degree| TERMS[degree.min(3)]));
            abreast.frames = abreast.frames.moved(c[0], c[1], c[2]);
        }
        let highest: [usize; LANES] = std::array::from_fn(|lane| carried[lane].min(degrees[lane]));
        let models = match highest.into_iter().max() {
            Some(4) => fitter.quartics.models(abreast, highest),
            Some(3) => fitter.cubics.models(abreast, highest),
            _ => fitter.paraboloids.models(abreast, highest),
        };
        ChordFits { models, highest, counts }
    }
}

impl ChordFitter {
    pub(super) fn new() -> Self {
        ChordFitter { paraboloids: Rows::NONE, cubics: Rows::NONE, quartics: Rows::NONE }
    }

    /// Fits polynomials, in each lane up to a degree, to samples around the origins of their frames, none of them further
    /// from it than about a unit; before that, `rounds` times, a cubic that says how the frame is to be moved and tilted.
    pub(super) fn fit(&mut self, abreast: &mut Abreast, degrees: [usize; LANES], rounds: usize) -> ChordFits {
        run(FitLanes { fitter: self, abreast, degrees, rounds })
    }
}

impl ChordFits {
    /// True where a lane's samples carry a fit.
    pub(super) fn is_carried(&self, lane: usize) -> bool {
        self.highest[lane] > 0
    }

    /// The highest degree of a lane that was asked for and that its samples carry.
    pub(super) fn highest(&self, lane: usize) -> usize {
        self.highest[lane]
    }

    /// Variance of a lane's samples about the surface of a degree, in file units squared.
    pub(super) fn deviation_squared(&self, lane: usize, degree: usize, frame: &Frame) -> f64 {
        let left = (self.counts[lane] - TERMS[degree]) as f64;
        self.models[degree].residual.0[lane] * frame.unit.powi(2) / left
    }

    /// Variance of the shape tensor at the middle (its squared Frobenius norm) for samples of unit
    /// variance, 1/length^4.
    pub(super) fn tensor_variance(&self, lane: usize, degree: usize, frame: &Frame) -> f64 {
        self.models[degree].variance.0[lane] / frame.unit.powi(4)
    }

    /// The frame that a lane's surface lies flat in at its middle: for a fit to a larger window.
    pub(super) fn settled(&self, lane: usize, frame: &Frame) -> Option<Frame> {
        let [c, x, y] = [0, 1, 2].map(|i| self.models[self.highest[lane]].coefficients[i].0[lane]);
        frame.moved(c, x, y)
    }

    pub(super) fn surface(&self, lane: usize, degree: usize, frame: Frame) -> Chord {
        Chord { frame, coefficients: self.models[degree].coefficients.map(|c| c.0[lane]) }
    }
}

/// A function of two variables with its first and second derivatives.
#[derive(Clone, Copy)]
struct Jet<T> {
    value: T,
    first: [T; 2],
    /// xx, xy, yy
    second: [T; 3],
}

impl<T: Real> Jet<T> {
    #[inline(always)]
    fn times(self, o: Jet<T>) -> Jet<T> {
        let [ax, ay] = self.first;
        let [bx, by] = o.first;
        Jet {
            value: self.value * o.value,
            first: [ax * o.value + self.value * bx, ay * o.value + self.value * by],
            second: [
                self.second[0] * o.value + ax * bx * 2.0 + self.value * o.second[0],
                self.second[1] * o.value + ax * by + ay * bx + self.value * o.second[1],
                self.second[2] * o.value + ay * by * 2.0 + self.value * o.second[2],
            ],
        }
    }

    /// f(self) for a function with these derivatives at the value.
    #[inline(always)]
    fn mapped(self, f: T, df: T, ddf: T) -> Jet<T> {
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

/// The polynomial at chord coordinates.
#[inline(always)]
fn height<T: Real>(c: &[T; WIDEST], x: T, y: T) -> Jet<T> {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    let mut value = c[0];
    for (&c, monomial) in c.iter().zip(monomials(T::splat(1.0), x, y)).skip(1) {
        value += c * monomial;
    }
    Jet {
        value,
        first: [
            c[1] + c[3] * x * 2.0
                + c[4] * y
                + c[6] * xx * 3.0
                + c[7] * xy * 2.0
                + c[8] * yy
                + c[10] * xx * x * 4.0
                + c[11] * xx * y * 3.0
                + c[12] * x * yy * 2.0
                + c[13] * yy * y,
            c[2] + c[4] * x
                + c[5] * y * 2.0
                + c[7] * xx
                + c[8] * xy * 2.0
                + c[9] * yy * 3.0
                + c[11] * xx * x
                + c[12] * xx * y * 2.0
                + c[13] * x * yy * 3.0
                + c[14] * yy * y * 4.0,
        ],
        second: [
            c[3] * 2.0 + c[6] * x * 6.0 + c[7] * y * 2.0 + c[10] * xx * 12.0 + c[11] * xy * 6.0 + c[12] * yy * 2.0,
            c[4] + c[7] * x * 2.0 + c[8] * y * 2.0 + c[11] * xx * 3.0 + c[12] * xy * 4.0 + c[13] * yy * 3.0,
            c[5] * 2.0 + c[8] * x * 2.0 + c[9] * y * 6.0 + c[12] * xx * 2.0 + c[13] * xy * 6.0 + c[14] * yy * 12.0,
        ],
    }
}

/// The shape of the surface below a local point, in the local frame; see [`Foot`].
#[inline(always)]
fn foot_of<T: Real>(c: &[T; WIDEST], p: V3<T>) -> Foot<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (x, y) = chord(p, p.z - c[0] - c[1] * p.x - c[2] * p.y);
    let z = height(c, x, y);
    // Heights over the tangent plane alone shorten the way along it from chord to foot.
    let bent = Jet {
        value: z.value - c[0] - c[1] * x - c[2] * y,
        first: [z.first[0] - c[1], z.first[1] - c[2]],
        second: z.second,
    };
    let square = x * x + y * y;
    let is_away = square - T::splat(1e-6);
    let inverse = one / square;
    let of_square = Jet { value: square, first: [x * 2.0, y * 2.0], second: [T::splat(2.0), zero, T::splat(2.0)] };
    let of_square = of_square.mapped(inverse, -(inverse * inverse), inverse * inverse * inverse * 2.0);
    let steep = bent.times(bent).times(of_square);
    // Where this is not above zero the surface has turned over.
    let left = is_away.if_positive(one - steep.value, one);
    let root = left.sqrt();
    let Jet { first: [x1, y1], second: [x2, xy, y2], .. } =
        steep.mapped(root, T::splat(-0.5) / root, T::splat(-0.25) / (left * root));
    let away = |d: T| is_away.if_positive(d, zero);
    let shortened = Jet { value: root, first: [away(x1), away(y1)], second: [away(x2), away(xy), away(y2)] };
    let px = Jet { value: x, first: [one, zero], second: [zero; 3] }.times(shortened);
    let py = Jet { value: y, first: [zero, one], second: [zero; 3] }.times(shortened);
    let a = V3::new(px.first[0], py.first[0], z.first[0]);
    let b = V3::new(px.first[1], py.first[1], z.first[1]);
    let cross = a.cross(b);
    let length = cross.dot(cross).sqrt();
    let normal = cross.scaled(one / length);
    // Dual tangents, and the second form on them.
    let (da, db) = (b.cross(normal).scaled(one / length), normal.cross(a).scaled(one / length));
    let form = |i: usize| -(normal.x * px.second[i] + normal.y * py.second[i] + normal.z * z.second[i]);
    let across = Symmetric::outer(da, db, form(1) * 2.0);
    let tensor = Symmetric::outer(da, da, form(0)).plus(across).plus(Symmetric::outer(db, db, form(2)));
    let upright = (left - T::splat(0.05)).min(normal.z);
    Foot { height: (p.z - z.value) * normal.z, normal, tensor, upright }
}

impl Chord {
    /// Height of a point over the surface, and the shape of the surface below it. `None` where the
    /// surface has turned over.
    pub(super) fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        foot_of(&self.coefficients, self.frame.to_local(point).into()).in_space(&self.frame)
    }

    /// Below a point on four surfaces, in space.
    #[inline(always)]
    pub(super) fn feet(surfaces: [&Chord; LANES], point: DVec3) -> Foot<F4> {
        let sides = Sides::of(surfaces.map(|s| &s.frame), point);
        let mut coefficients = [F4::ZERO; WIDEST];
        for (i, c) in coefficients.iter_mut().enumerate() {
            *c = F4::of(surfaces, |s| s.coefficients[i]);
        }
        sides.in_space(&foot_of(&coefficients, sides.point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

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
        let x = normal.any_orthonormal_vector();
        let axes = DMat3::from_cols(x, normal.cross(x), normal);
        let mut abreast = Abreast::new();
        abreast.load(
            2,
            Frame { origin: DVec3::new(0.0, 0.0, 0.1), axes, unit: 2.5 },
            samples.iter().map(|&p| (p, 1.0)),
        );
        let fits = ChordFitter::new().fit(&mut abreast, [4; LANES], 6);
        let frame = abreast.frame(2).expect("a frame");
        assert!(fits.highest(2) == 4 && !fits.is_carried(1));
        for degree in [3, 4] {
            let deviation = fits.deviation_squared(2, degree, &frame);
            assert!(deviation < 1e-12, "{deviation}");
            let surface = fits.surface(2, degree, frame);
            for &p in &samples[..120] {
                let (height, shape) = surface.shape_at(p).expect("a shape");
                let k = shape.principal();
                assert!(height.abs() < 1e-5 && (k.k_max - 0.5).abs() < 1e-4 && (k.k_min - 0.5).abs() < 1e-4, "{k:?}");
                assert!(shape.normal.dot((p + 2.0 * DVec3::Z) / 2.0) > 1.0 - 1e-6);
            }
        }
    }
}
