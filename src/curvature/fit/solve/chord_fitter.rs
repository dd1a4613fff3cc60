//! Least squares for [`Chord`]s, four windows at a time: the fit for noisy surfaces.

use super::abreast::Abreast;
use super::equations::Factor;
use super::moments::Heights;
use crate::curvature::fit::surface::bivariate::{CUBIC, HIGHEST, QUADRATIC, WIDEST, terms};
use crate::curvature::fit::surface::chord::{Chord, chord};
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::vectors::four::{F4, Kernel, LANES, run};

/// Fits four windows at a time.
pub(in crate::curvature::fit) struct ChordFitter {
    /// In chord coordinates.
    heights: Heights,
}

/// The fits to four windows, whose frames they have moved.
pub(in crate::curvature::fit) struct ChordFits {
    /// By degree.
    models: [DegreeModel; HIGHEST + 1],
    highest: [usize; LANES],
    counts: [usize; LANES],
}

/// The polynomials of one degree, in units of the frames.
#[derive(Clone, Copy)]
struct DegreeModel {
    coefficients: [F4; WIDEST],
    /// Sums of squared residuals.
    residual: F4,
    /// Variances of the shape tensors at the middle (their squared Frobenius norms) for samples of unit variance.
    variance: F4,
}

impl ChordFitter {
    /// The equations of the windows, factored.
    #[inline(always)]
    fn factor<const N: usize>(&mut self, abreast: &Abreast, degree: usize) -> Factor<N> {
        self.heights.clear();
        for (&p, &root) in abreast.points.iter().zip(&abreast.roots) {
            let p = abreast.frames.to_local(p);
            let (x, y) = chord(p, p.z);
            self.heights.push(x, y, p.z, root * root);
        }
        let mut factor = Factor::new(&self.heights.equations(degree));
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
    ) -> [DegreeModel; HIGHEST + 1] {
        let factor = self.factor::<N>(abreast, most);
        let mut models = [DegreeModel::ZERO; HIGHEST + 1];
        for (degree, model) in models.iter_mut().enumerate().take(most + 1).skip(QUADRATIC) {
            if !asked.contains(&degree) && !highest.contains(&degree) {
                continue;
            }
            let size = terms(degree);
            let coefficients = factor.solve(size);
            model.coefficients[..size].copy_from_slice(&coefficients[..size]);
            model.residual = self.heights.residual(degree, &model.coefficients);
            model.variance = factor.tensor_variance([size; LANES], size);
        }
        models
    }
}

impl DegreeModel {
    const ZERO: DegreeModel = DegreeModel { coefficients: [F4::ZERO; WIDEST], residual: F4::ZERO, variance: F4::ZERO };
}

struct FitChords<'f> {
    fitter: &'f mut ChordFitter,
    abreast: &'f mut Abreast,
    asked: &'f [usize],
    degrees: [usize; LANES],
    rounds: usize,
}

impl Kernel for FitChords<'_> {
    type Output = ChordFits;

    #[inline(always)]
    fn run(self) -> ChordFits {
        let FitChords { fitter, abreast, asked, degrees, rounds } = self;
        let counts = abreast.counts;
        let carried = counts.map(|count| (QUADRATIC..=HIGHEST).rev().find(|&d| terms(d) + 3 <= count).unwrap_or(0));
        for _ in 0..rounds {
            let factor = fitter.factor::<{ terms(CUBIC) }>(abreast, CUBIC);
            let c = factor.solve_each(carried.map(|degree| terms(degree.min(CUBIC))));
            abreast.frames = abreast.frames.moved(c[0], c[1], c[2]);
        }
        let highest: [usize; LANES] = std::array::from_fn(|lane| carried[lane].min(degrees[lane]));
        let models = match highest.into_iter().max() {
            Some(HIGHEST) => fitter.models::<WIDEST>(abreast, asked, highest, HIGHEST),
            Some(CUBIC) => fitter.models::<{ terms(CUBIC) }>(abreast, asked, highest, CUBIC),
            _ => fitter.models::<{ terms(QUADRATIC) }>(abreast, asked, highest, QUADRATIC),
        };
        ChordFits { models, highest, counts }
    }
}

impl ChordFitter {
    pub(in crate::curvature::fit) fn new() -> Self {
        ChordFitter { heights: Heights::default() }
    }

    /// Fits polynomials to samples around the origins of their frames, none of them further from it than about a unit:
    /// of the degrees `asked` for and, in each lane, of the highest that is wanted and that the samples carry. Before
    /// that, `rounds` times, a cubic says how the frame is to be moved and tilted.
    pub(in crate::curvature::fit) fn fit(
        &mut self,
        abreast: &mut Abreast,
        asked: &[usize],
        degrees: [usize; LANES],
        rounds: usize,
    ) -> ChordFits {
        run(FitChords { fitter: self, abreast, asked, degrees, rounds })
    }
}

impl ChordFits {
    /// True where a lane's samples carry a fit.
    pub(in crate::curvature::fit) fn is_carried(&self, lane: usize) -> bool {
        self.highest[lane] > 0
    }

    /// True where a lane's samples determine a paraboloid, if it was asked for: those on two rims, as of a cylinder's
    /// long facets, do not.
    pub(in crate::curvature::fit) fn is_firm(&self, lane: usize) -> bool {
        /// Variance of the tensor, in units of the frame, times the number of samples: about 700 for a disk of them,
        /// 5,000 for some beside sharp edges and on scans, and 1e13 on two rims.
        const MOST: f64 = 10_000.0;
        self.models[QUADRATIC].variance.0[lane] * self.counts[lane] as f64 <= MOST
    }

    /// The highest degree of a lane that was asked for and that its samples carry.
    pub(in crate::curvature::fit) fn highest(&self, lane: usize) -> usize {
        self.highest[lane]
    }

    /// Variance of a lane's samples about the surface of a degree, in file units squared.
    pub(in crate::curvature::fit) fn deviation_squared(&self, lane: usize, degree: usize, frame: &LocalFrame) -> f64 {
        let left = (self.counts[lane] - terms(degree)) as f64;
        self.models[degree].residual.0[lane] * frame.unit.powi(2) / left
    }

    /// Variance of the shape tensor at the middle (its squared Frobenius norm) for samples of unit
    /// variance, 1/length^4.
    pub(in crate::curvature::fit) fn tensor_variance(&self, lane: usize, degree: usize, frame: &LocalFrame) -> f64 {
        self.models[degree].variance.0[lane] / frame.unit.powi(4)
    }

    /// The frame that a lane's surface lies flat in at its middle: for a fit to a larger window.
    pub(in crate::curvature::fit) fn settled(&self, lane: usize, frame: &LocalFrame) -> Option<LocalFrame> {
        let [c, x, y] = [0, 1, 2].map(|i| self.models[self.highest[lane]].coefficients[i].0[lane]);
        frame.moved(c, x, y)
    }

    /// The mean of a lane's paraboloid and its surface of the highest degree, which follows what the surface does
    /// within the window, if it is smooth, and whatever else there is, if it is not. Each has the more weight the less
    /// its misfit makes its shape tensor uncertain. With the samples' standard deviation, in file units, and the
    /// standard error of the tensor, 1/length.
    pub(in crate::curvature::fit) fn mean(&self, lane: usize, frame: LocalFrame) -> (Chord, f64, f64) {
        let [low, high] = [QUADRATIC, self.highest[lane]].map(|degree| {
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

    pub(in crate::curvature::fit) fn surface(&self, lane: usize, degree: usize, frame: LocalFrame) -> Chord {
        Chord { frame, coefficients: self.models[degree].coefficients.map(|c| c.0[lane]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

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
            LocalFrame { origin: DVec3::new(0.0, 0.0, 0.1), axes, unit: 2.5 },
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
