//! Height polynomials in chord-length coordinates: the fit for noisy surfaces.
//!
//! Let o be a point of the surface with unit normal n, p a sample, L = |p - o|, z = (p - o) . n and t the
//! azimuth of p around n. The circle through o and p that touches the tangent plane at o has curvature
//! 2 |z| / L^2, at any distance along a circular section. So in the coordinates (X, Y) = L (cos t, sin t)
//! a sphere is a paraboloid exactly, and few terms describe what would take a height function many.
//!
//! The surface is z = P(X, Y) with P of degree 3 or 4, with constant and linear terms; the frame is
//! moved and tilted until these are small.

use super::abreast::Abreast;
use super::equations::Factor;
use super::foot::{Below, Foot};
use super::frame::Frame;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::moments::{HIGHEST, Samples, WIDEST, terms, value};
use super::polynomial::Symmetric;
use super::shape::Shape;
use glam::DVec3;

/// A fitted surface patch. The frame's unit is the radius of its window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord {
    pub(super) frame: Frame,
    pub(super) coefficients: [f64; WIDEST],
}

/// Fits four windows at a time.
pub(super) struct ChordFitter {
    /// In chord coordinates.
    samples: Samples,
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

/// Chord coordinates of a local point whose height over the tangent plane is `z`.
#[inline(always)]
fn chord<T: Real>(p: V3<T>, z: T) -> (T, T) {
    let planar = p.x * p.x + p.y * p.y;
    let one = T::splat(1.0);
    let stretch = planar.if_positive((one + z * z / planar).min(T::splat(9.0)).sqrt(), one);
    (p.x * stretch, p.y * stretch)
}

impl ChordFitter {
    /// The equations of the windows, factored.
    #[inline(always)]
    fn factor<const N: usize>(&mut self, abreast: &Abreast, degree: usize) -> Factor<N> {
        self.samples.clear();
        for (&p, &root) in abreast.points.iter().zip(&abreast.roots) {
            let p = abreast.frames.to_local(p);
            let (x, y) = chord(p, p.z);
            self.samples.push(x, y, p.z, root * root);
        }
        let mut factor = Factor::new(&self.samples.equations(degree));
        factor.factor(N);
        factor
    }

    /// The models of the degrees asked for and of the highest of each lane, `most` with its `N` terms among them.
    #[inline(always)]
    fn models<const N: usize>(
        &mut self,
        abreast: &Abreast,
        asked: &[usize],
        highest: [usize; LANES],
        most: usize,
    ) -> [Model; 5] {
        let factor = self.factor::<N>(abreast, most);
        let mut models = [Model::ZERO; 5];
        for (degree, model) in models.iter_mut().enumerate().take(most + 1).skip(2) {
            if !asked.contains(&degree) && !highest.contains(&degree) {
                continue;
            }
            let size = terms(degree);
            let coefficients = factor.solve(size);
            model.coefficients[..size].copy_from_slice(&coefficients[..size]);
            model.residual = self.samples.residual(degree, &model.coefficients);
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
    asked: &'f [usize],
    degrees: [usize; LANES],
    rounds: usize,
}

impl Kernel for FitLanes<'_> {
    type Output = ChordFits;

    #[inline(always)]
    fn run(self) -> ChordFits {
        let FitLanes { fitter, abreast, asked, degrees, rounds } = self;
        let counts = abreast.counts;
        let carried = counts.map(|count| (2..=4).rev().find(|&d| terms(d) + 3 <= count).unwrap_or(0));
        for _ in 0..rounds {
            let factor = fitter.factor::<{ terms(3) }>(abreast, 3);
            let c = factor.solve_each(carried.map(|degree| terms(degree.min(3))));
            abreast.frames = abreast.frames.moved(c[0], c[1], c[2]);
        }
        let highest: [usize; LANES] = std::array::from_fn(|lane| carried[lane].min(degrees[lane]));
        let models = match highest.into_iter().max() {
            Some(4) => fitter.models::<{ terms(4) }>(abreast, asked, highest, 4),
            Some(3) => fitter.models::<{ terms(3) }>(abreast, asked, highest, 3),
            _ => fitter.models::<{ terms(2) }>(abreast, asked, highest, 2),
        };
        ChordFits { models, highest, counts }
    }
}

impl ChordFitter {
    pub(super) fn new() -> Self {
        ChordFitter { samples: Samples::default() }
    }

    /// Fits polynomials to samples around the origins of their frames, none of them further from it than about a unit:
    /// of the degrees `asked` for and, in each lane, of the highest that is wanted and that the samples carry. Before
    /// that, `rounds` times, a cubic says how the frame is to be moved and tilted.
    pub(super) fn fit(
        &mut self,
        abreast: &mut Abreast,
        asked: &[usize],
        degrees: [usize; LANES],
        rounds: usize,
    ) -> ChordFits {
        run(FitLanes { fitter: self, abreast, asked, degrees, rounds })
    }
}

impl ChordFits {
    /// True where a lane's samples carry a fit.
    pub(super) fn is_carried(&self, lane: usize) -> bool {
        self.highest[lane] > 0
    }

    /// True where a lane's samples determine a paraboloid, if it was asked for: those on two rims, as of a cylinder's
    /// long facets, do not.
    pub(super) fn is_firm(&self, lane: usize) -> bool {
        /// Variance of the tensor, in units of the frame, times the number of samples: about 700 for a disk of them,
        /// 5,000 for some beside sharp edges and on scans, and 1e13 on two rims.
        const MOST: f64 = 10_000.0;
        self.models[2].variance.0[lane] * self.counts[lane] as f64 <= MOST
    }

    /// The highest degree of a lane that was asked for and that its samples carry.
    pub(super) fn highest(&self, lane: usize) -> usize {
        self.highest[lane]
    }

    /// Variance of a lane's samples about the surface of a degree, in file units squared.
    pub(super) fn deviation_squared(&self, lane: usize, degree: usize, frame: &Frame) -> f64 {
        let left = (self.counts[lane] - terms(degree)) as f64;
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

    /// The mean of a lane's paraboloid and its surface of the highest degree, which follows what the surface does
    /// within the window, if it is smooth, and whatever else there is, if it is not. Each has the more weight the less
    /// its misfit makes its shape tensor uncertain. With the samples' standard deviation, in file units, and the
    /// standard error of the tensor, 1/length.
    pub(super) fn mean(&self, lane: usize, frame: Frame) -> (Chord, f64, f64) {
        let [low, high] = [2, self.highest[lane]].map(|degree| {
            let square = self.deviation_squared(lane, degree, &frame);
            (
                self.surface(lane, degree, frame),
                square.sqrt(),
                (square * self.tensor_variance(lane, degree, &frame)).sqrt(),
            )
        });
        let share = match (low.2.powi(4), high.2.powi(4)) {
            (low, high) if low + high > 0.0 => low / (low + high),
            _ => 1.0,
        };
        let between = |low: f64, high: f64| low + share * (high - low);
        let coefficients = std::array::from_fn(|i| between(low.0.coefficients[i], high.0.coefficients[i]));
        (Chord { frame, coefficients }, between(low.1, high.1), between(low.2, high.2))
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
    Jet {
        value: value::<HIGHEST, T>(c, x, y),
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
    /// The plane that a frame lies in.
    pub(super) fn plane(frame: Frame) -> Self {
        Chord { frame, coefficients: [0.0; WIDEST] }
    }

    /// Height of a point over the surface, and the shape of the surface below it. `None` where the
    /// surface has turned over.
    pub(super) fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        foot_of(&self.coefficients, self.frame.to_local(point).into()).in_space(&self.frame)
    }

    /// The same surface, for points side by side.
    #[inline(always)]
    pub(super) fn side_by_side(&self) -> ChordAbreast {
        ChordAbreast(self.coefficients.map(F4::splat))
    }
}

/// A [`Chord`] that is looked at from points side by side.
pub(super) struct ChordAbreast([F4; WIDEST]);

impl Below for ChordAbreast {
    #[inline(always)]
    fn foot(&self, points: V3<F4>) -> Foot<F4> {
        foot_of(&self.0, points)
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
        let fits = ChordFitter::new().fit(&mut abreast, &[3], [4; LANES], 6);
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
