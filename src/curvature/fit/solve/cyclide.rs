//! Cyclides through noisy samples.

use super::abreast::Abreast;
use super::equations::{Factor, Normal, residual};
use super::prior::priors;
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::fit::surface::implicit::Implicit;
use crate::curvature::fit::surface::polynomial::{CYCLIDE, MOST, PARABOLOID, Polynomial, basis};
use crate::curvature::vectors::four::{F4, Kernel, LANES, Real, V3, run, which};

/// Samples that a fit needs.
const LEAST: usize = CYCLIDE + 8;

/// Fits cyclides to noisy samples, four windows at a time: the least sum of squared distances from the surface. The
/// residuals of its equation will not do, since noise stands on both sides of it.
pub(in crate::curvature::fit) struct CyclideFitter {
    points: Vec<V3<F4>>,
    rows: Vec<[F4; CYCLIDE]>,
    values: Vec<F4>,
}

/// What came of four windows.
pub(in crate::curvature::fit) struct Cyclides {
    coefficients: [F4; CYCLIDE],
    /// Lanes whose surface neither folds nor is far from a sample.
    found: [bool; LANES],
    residual: F4,
    variance: F4,
    counts: [usize; LANES],
}

/// A cyclide through noisy samples.
pub(in crate::curvature::fit) struct Cyclide {
    pub(in crate::curvature::fit) surface: Implicit,
    /// Variance of the shape tensor at the middle for samples of unit variance, 1/length^4.
    pub(in crate::curvature::fit) tensor_variance: f64,
    /// Variance of the samples, in file units squared.
    pub(in crate::curvature::fit) misfit: f64,
}

impl CyclideFitter {
    pub(in crate::curvature::fit) fn new() -> Self {
        CyclideFitter { points: Vec::new(), rows: Vec::new(), values: Vec::new() }
    }

    /// Fits the windows; `noise` is the standard deviation of their samples, in file units.
    pub(in crate::curvature::fit) fn fit(&mut self, abreast: &Abreast, noise: F4) -> Cyclides {
        run(FitCyclides { fitter: self, abreast, noise })
    }

    #[inline(always)]
    fn factor(&self, noise: F4) -> Factor<CYCLIDE> {
        let mut factor = Factor::new(&Normal::new(&self.rows, &self.values));
        factor.factor(PARABOLOID);
        factor.add_priors(&priors(factor.paraboloid(), noise));
        factor.factor(CYCLIDE);
        factor
    }

    /// Fills rows with the distances of samples from a surface, linear in the coefficients: that of the foot, and from
    /// there to the sample. False for lanes where the surface folds or is far from a sample.
    #[inline(always)]
    fn fill(&mut self, roots: &[F4], f: &Polynomial<F4>) -> [bool; LANES] {
        /// A gradient this small, against one at the middle, belongs to a fold of the surface.
        const LEAST_SLOPE: f64 = 0.05;
        let (mut farthest, mut least) = (F4::ZERO, F4::splat(f64::INFINITY));
        self.rows.clear();
        self.values.clear();
        for (&p, &root) in self.points.iter().zip(roots) {
            let gradient = f.gradient(p);
            let foot = p - gradient.scaled(f.value(p) / gradient.dot(gradient));
            let gradient = f.gradient(foot);
            let slope = gradient.dot(gradient).sqrt();
            let way = p - foot;
            // What is not a number counts as far; beyond the end of a window nothing counts.
            let far = (F4::splat(0.25) - way.dot(way)).if_positive(F4::ZERO, F4::ONE);
            farthest += root.if_positive(far, F4::ZERO);
            least = least.min(root.if_positive(slope - F4::splat(LEAST_SLOPE), F4::ONE));
            let share = root.if_positive(root / slope, F4::ZERO);
            self.rows.push(scaled(basis(foot, F4::ONE), share));
            self.values.push((foot.z + gradient.dot(way)) * share);
        }
        which(|lane| farthest.0[lane] == 0.0 && least.0[lane] > 0.0)
    }
}

#[inline(always)]
fn scaled(mut row: [F4; CYCLIDE], by: F4) -> [F4; CYCLIDE] {
    for value in &mut row {
        *value = *value * by;
    }
    row
}

struct FitCyclides<'f> {
    fitter: &'f mut CyclideFitter,
    abreast: &'f Abreast,
    noise: F4,
}

impl Kernel for FitCyclides<'_> {
    type Output = Cyclides;

    #[inline(always)]
    fn run(self) -> Cyclides {
        const ROUNDS: usize = 1;
        let FitCyclides { fitter, abreast, noise } = self;
        let (frames, roots) = (abreast.frames, &abreast.roots[..]);
        let noise = noise / frames.unit;
        fitter.points.clear();
        fitter.rows.clear();
        fitter.values.clear();
        for (&p, &root) in abreast.points.iter().zip(roots) {
            let p = frames.to_local(p);
            fitter.points.push(p);
            fitter.rows.push(scaled(basis(p, F4::ONE), root));
            fitter.values.push(p.z * root);
        }
        let mut factor = fitter.factor(noise);
        let mut coefficients = factor.solve(CYCLIDE);
        let mut found = abreast.counts.map(|count| count >= LEAST);
        for _ in 0..ROUNDS {
            let mut f = Polynomial { coefficients: [F4::ZERO; MOST], size: CYCLIDE };
            f.coefficients[..CYCLIDE].copy_from_slice(&coefficients);
            let is_sane = fitter.fill(roots, &f);
            found = which(|lane| found[lane] && is_sane[lane]);
            factor = fitter.factor(noise);
            coefficients = factor.solve(CYCLIDE);
        }
        let residual = residual(&fitter.rows, &fitter.values, &coefficients, CYCLIDE);
        let variance = factor.tensor_variance([CYCLIDE; LANES], CYCLIDE);
        Cyclides { coefficients, found, residual, variance, counts: abreast.counts }
    }
}

impl Cyclides {
    /// The surface of a lane, in the frame it was fitted in; `None` where it folds, is far from a sample, or the
    /// samples are too few.
    pub(in crate::curvature::fit) fn of(&self, lane: usize, frame: LocalFrame) -> Option<Cyclide> {
        let mut f = Polynomial { coefficients: [0.0; MOST], size: CYCLIDE };
        f.coefficients.iter_mut().zip(&self.coefficients).for_each(|(to, from)| *to = from.0[lane]);
        let tensor_variance = self.variance.0[lane] / frame.unit.powi(4);
        let degrees = self.counts[lane] as f64 - CYCLIDE as f64;
        let misfit = self.residual.0[lane] * frame.unit.powi(2) / degrees;
        let is_found = self.found[lane] && misfit.is_finite();
        is_found.then_some(Cyclide { surface: Implicit { frame, f }, tensor_variance, misfit })
    }
}
