//! The choice among models of different size, in each lane for itself.

use crate::curvature::fit::surface::polynomial::{MOST, PLANE, Polynomial, SIZES};
use crate::curvature::vectors::four::{F4, LANES, which};

/// What a model of some size makes of the windows.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct SizedModel {
    pub(in crate::curvature::fit) coefficients: [F4; MOST],
    pub(in crate::curvature::fit) residual: F4,
    /// Grows with the residual and the size; infinite where the points are too few.
    pub(in crate::curvature::fit) cost: F4,
}

/// A model for each lane.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Chosen {
    pub(super) coefficients: [F4; MOST],
    pub(in crate::curvature::fit) sizes: [usize; LANES],
    pub(in crate::curvature::fit) residual: F4,
    pub(in crate::curvature::fit) cost: F4,
    /// Lanes for which a surface passed the checks.
    pub(in crate::curvature::fit) found: [bool; LANES],
}

/// What a surface must be like. Not a closure: those are not compiled for wider vectors where they are not inlined.
pub(in crate::curvature::fit) trait Check {
    /// Whether the surface of each lane passes.
    fn passes(&self, f: &Polynomial<F4>) -> [bool; LANES];
}

impl SizedModel {
    pub(in crate::curvature::fit) const ZERO: SizedModel =
        SizedModel { coefficients: [F4::ZERO; MOST], residual: F4::ZERO, cost: F4::ZERO };
}

impl Chosen {
    pub(in crate::curvature::fit) const NONE: Chosen = Chosen {
        coefficients: [F4::ZERO; MOST],
        sizes: [PLANE; LANES],
        residual: F4::ZERO,
        cost: F4::ZERO,
        found: [false; LANES],
    };

    /// The cheapest of the models of the first sizes that passes a check; lanes that are `done` need none.
    #[inline(always)]
    pub(in crate::curvature::fit) fn among<const M: usize>(
        models: &[SizedModel; M],
        done: &[bool; LANES],
        check: &impl Check,
    ) -> Self {
        let mut chosen = Chosen::NONE;
        let mut left = [[true; M]; LANES];
        for _ in 0..M {
            for (i, left) in left.iter_mut().enumerate() {
                if chosen.found[i] {
                    continue;
                }
                let mut best = 0;
                for m in 1..M {
                    let is_less = models[m].cost.0[i] < models[best].cost.0[i];
                    if left[m] && (is_less || !left[best]) {
                        best = m;
                    }
                }
                left[best] = false;
                chosen.take(i, &models[best], SIZES[best]);
            }
            let passes = check.passes(&Polynomial { coefficients: chosen.coefficients, size: SIZES[M - 1] });
            let cost = chosen.cost.0;
            chosen.found = which(|i| chosen.found[i] || passes[i] && cost[i] < f64::INFINITY);
            if !which(|i| !chosen.found[i] && !done[i]).contains(&true) {
                break;
            }
        }
        chosen
    }

    /// Takes the model of one lane.
    #[inline(always)]
    pub(in crate::curvature::fit) fn take(&mut self, lane: usize, model: &SizedModel, size: usize) {
        for (to, from) in self.coefficients.iter_mut().zip(&model.coefficients) {
            to.0[lane] = from.0[lane];
        }
        self.sizes[lane] = size;
        self.residual.0[lane] = model.residual.0[lane];
        self.cost.0[lane] = model.cost.0[lane];
    }

    pub(in crate::curvature::fit) fn polynomial(&self, lane: usize) -> Polynomial<f64> {
        let size = self.sizes[lane];
        let mut coefficients = [0.0; MOST];
        coefficients[..size].iter_mut().zip(&self.coefficients).for_each(|(to, from)| *to = from.0[lane]);
        Polynomial { coefficients, size }
    }
}

/// What the sizes cost a window of `count` points, as factors of its residual: the stricter of generalised
/// cross-validation and Schwarz' criterion, step by step. Infinite for sizes that leave fewer than two points over.
pub(in crate::curvature::fit) fn penalties(count: usize) -> [f64; SIZES.len()] {
    let n = count as f64;
    let (mut penalty, mut before) = (0.0, PLANE as f64);
    SIZES.map(|size| {
        if size + 2 > count {
            return f64::INFINITY;
        }
        let k = size as f64;
        let validation: f64 = 2.0 * ((n - before) / (n - k)).ln();
        penalty += validation.max((k - before) * n.ln() / n);
        before = k;
        penalty.exp()
    })
}
