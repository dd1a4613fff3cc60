//! The choice among windows of nested sizes, by Lepski's rule.
//!
//! Variances follow from the noise and the fits. The bias of a fit is bounded by how far it is from less biased ones beyond
//! what the variances explain. The least sum of both wins. All statistics are means over neighbouring seeds.

use super::probe::{Choice, LEVELS, MODELS, POLYNOMIALS, Probe, unexplained};
use super::rough::{self, Noise};

/// All models of all levels, level by level.
const CANDIDATES: usize = LEVELS.len() * MODELS;

/// Growth of the variance of samples from the first to the second level that says that the surface is
/// smooth and its fits too coarse, not that it is noisy.
pub(super) const SMOOTH: f64 = 6.8;

/// The choice for a seed, or none where the surface is smooth.
pub(super) fn choose(probe: &Probe, probes: &[Probe], kind: Noise) -> Option<Choice> {
    let around: Vec<&Probe> = probe.neighbours.iter().map(|&i| &probes[i as usize]).collect();
    let quartic = |p: &Probe, level: usize| p.at(level).misfits[1];
    if mean(&around, |p| (quartic(p, 1) / quartic(p, 0)).ln()).exp() > SMOOTH {
        return None;
    }
    // Those that have been looked at with windows of a level.
    let looked: [Vec<&Probe>; LEVELS.len()] =
        std::array::from_fn(|level| around.iter().copied().filter(|p| p.levels() > level).collect());
    let of_all = |of: &dyn Fn(&Probe, usize, usize) -> f64| -> [f64; CANDIDATES] {
        std::array::from_fn(|j| mean(&looked[level_of(j)], |p| of(p, level_of(j), model_of(j))))
    };
    let tensor = |p: &Probe, j: usize| p.at(level_of(j)).tensors[model_of(j)];
    let between = |i: usize, j: usize| {
        mean(&looked[level_of(i).max(level_of(j))], |p| distance_squared(&tensor(p, i), &tensor(p, j)))
    };
    let unit = of_all(&|p, level, model| p.at(level).variances[model]);
    let misfit = of_all(&|p, level, model| p.at(level).misfits[model]);
    let there = |j: usize| unit[j].is_finite() && probe.may_have(level_of(j), model_of(j));
    let is_alike = kind == Noise::Alike;
    let least = mean(&around, |p| p.noise);
    let noise = if is_alike {
        let polynomials: [f64; CANDIDATES] =
            std::array::from_fn(|j| if is_polynomial(j) && there(j) { unit[j] } else { f64::INFINITY });
        rough::alike(&polynomials, between).map_or(least, |alike| alike.max(least))
    } else {
        least
    };
    let variance = unit.map(|unit| noise * unit);
    // Alike noise is left in part by large windows only, as detail is: misfits tell nothing.
    let detail = |j: usize| if is_alike { 0.0 } else { unexplained(misfit[j], noise, level_of(j)) };
    // Only polynomials that explain their window bear witness to the bias of others.
    let is_witness: [bool; CANDIDATES] =
        std::array::from_fn(|i| is_polynomial(i) && there(i) && (level_of(i) < 2 || detail(i) == 0.0));
    // A cyclide is believed where it explains its window better than a polynomial does.
    let is_believed = |j: usize| is_polynomial(j) || misfit[j] < misfit[j - 1];

    let mut best = (f64::INFINITY, usize::MAX);
    for j in (0..CANDIDATES).filter(|&j| there(j) && is_believed(j)) {
        let mut bias = 0.0_f64;
        for i in (0..CANDIDATES).filter(|&i| is_witness[i]) {
            if let Some(chance) = kind.chance(variance[i], variance[j]) {
                bias = bias.max(between(i, j) - chance);
            }
        }
        let risk = variance[j] * (1.0 + detail(j)) + bias;
        if risk < best.0 {
            best = (risk, j);
        }
    }
    let (risk, at) = best;
    (at != usize::MAX).then(|| Choice {
        seed: probe.seed,
        level: level_of(at),
        model: model_of(at),
        error: risk.sqrt(),
        noise: noise.sqrt(),
        frame: probe.frame,
    })
}

fn level_of(candidate: usize) -> usize {
    candidate / MODELS
}

fn model_of(candidate: usize) -> usize {
    candidate % MODELS
}

fn is_polynomial(candidate: usize) -> bool {
    model_of(candidate) < POLYNOMIALS
}

/// The mean of what is a finite number.
fn mean(probes: &[&Probe], of: impl Fn(&Probe) -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in probes.iter().map(|p| of(p)).filter(|v| v.is_finite()) {
        sum += value;
        count += 1.0;
    }
    sum / count
}

/// The squared Frobenius norm of the difference of two symmetric matrices.
fn distance_squared(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    const TIMES: [f64; 6] = [1.0, 2.0, 2.0, 1.0, 2.0, 1.0];
    a.iter().zip(b).zip(TIMES).map(|((a, b), t)| t * (a - b) * (a - b)).sum()
}
