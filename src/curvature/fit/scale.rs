//! The window for a noisy place: as large as the surface lets it be.
//!
//! Around each seed, surfaces are fitted to nested windows. Their variances follow from the noise and
//! the fit; their bias is bounded by Lepski's rule, by how far they are from less biased fits beyond what
//! the variances explain. The least sum of both wins. All statistics are means over neighbouring
//! seeds.

use super::fans::Fans;
use super::lanes::LANES;
use super::patches::{self, Blended, Patch};
use super::probe::{Choice, LEVELS, MODELS, POLYNOMIALS, Probe, Prober, unexplained};
use super::rough::{self, Noise, WINDOW};
use super::seeds::tiers;
use crate::mesh::{Face, Mesh};
use rayon::prelude::*;
use std::ops::Range;

const CANDIDATES: usize = LEVELS.len() * MODELS;
/// Growth of the variance of samples from the first to the second level that says that the surface is
/// smooth and its fits too coarse, not that it is noisy.
pub(super) const SMOOTH: f64 = 6.8;
const CHUNK: usize = 64;
/// Levels at which all seeds are looked at; each one further up, about half of those before.
const DENSE: usize = 4;

/// True for meshes with enough vertices to tell noise from shape. On a coarse model a window would be half of it, and
/// sharp edges are meant.
pub(super) fn is_fine(mesh: &Mesh) -> bool {
    /// Windows that a surface must hold.
    const LEAST_WINDOWS: usize = 20;
    mesh.positions().len() >= LEAST_WINDOWS * WINDOW
}

/// Values for the faces that are `wanted`, from patches around `seeds`; `None` where the surface turns
/// out smooth or no patch reaches.
pub(super) fn estimate(fans: &Fans<'_>, seeds: &[Face], wanted: &[bool], kind: Noise) -> Vec<Option<Blended>> {
    let ground = fans.ground;
    let mut seed_of = vec![u32::MAX; ground.mesh.face_count()];
    for (i, seed) in seeds.iter().enumerate() {
        seed_of[seed.index()] = i as u32;
    }
    let mut probes: Vec<Probe> = seeds.iter().map(|&seed| Probe::new(seed, kind.hopeless())).collect();
    probe_all(fans, probes.iter_mut().collect(), 0..DENSE, &seed_of, 0.45);
    // Larger windows overlap more: fewer of them say the same.
    let tiers = tiers(ground, seeds, |i| &probes[i].neighbours, &[1; LEVELS.len() - DENSE]);
    let mut fewer: Vec<(usize, &mut Probe)> =
        tiers.iter().copied().zip(&mut probes).filter(|(tier, _)| *tier > 0).collect();
    fewer.sort_by_key(|(tier, _)| *tier);
    for tier in 1..=LEVELS.len() - DENSE {
        let of_tier = fewer.iter_mut().filter(|(t, _)| *t == tier).map(|(_, probe)| &mut **probe).collect();
        probe_all(fans, of_tier, DENSE..DENSE + tier, &seed_of, 0.05);
    }
    let chosen: Vec<Vec<Choice>> = probes
        .par_chunks(CHUNK)
        .map(|chunk| {
            ground.work.advance(0);
            chunk.iter().filter_map(|probe| choose(probe, &probes, kind)).collect()
        })
        .collect();
    drop(probes);
    let chosen: Vec<Choice> = chosen.into_iter().flatten().collect();
    let patches: Vec<Vec<Patch>> = chosen
        .par_chunks(CHUNK)
        .map_init(
            || Prober::new(fans),
            |prober, some| {
                ground.work.advance_by(0.2, some.len(), chosen.len());
                prober.patches(some, wanted)
            },
        )
        .collect();
    let patches: Vec<Patch> = patches.into_iter().flatten().collect();
    patches::blend(ground, patches, wanted)
}

/// Adds levels to probes, which takes about `share` of the work on all faces.
pub(super) fn probe_all(
    fans: &Fans<'_>,
    mut probes: Vec<&mut Probe>,
    levels: Range<usize>,
    seed_of: &[u32],
    share: f64,
) {
    let count = probes.len();
    probes.par_chunks_mut(CHUNK).for_each_init(
        || Prober::new(fans),
        |prober, chunk| {
            fans.ground.work.advance_by(share, chunk.len(), count);
            chunk.chunks_mut(LANES).for_each(|four| prober.probe(four, levels.clone(), seed_of));
        },
    );
}

/// The choice for a seed, or none where the surface is smooth.
fn choose(probe: &Probe, probes: &[Probe], kind: Noise) -> Option<Choice> {
    let mean = |of: &dyn Fn(&Probe) -> f64| {
        let values = probe.neighbours.iter().map(|&i| of(&probes[i as usize])).filter(|v| v.is_finite());
        let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / count
    };
    let quartic = |p: &Probe, level: usize| p.at(level).misfits[1];
    let growth = mean(&|p| (quartic(p, 1) / quartic(p, 0)).ln()).exp();
    if growth > SMOOTH {
        return None;
    }
    fn tensor(p: &Probe, j: usize) -> &[f64; 6] {
        &p.at(j / MODELS).tensors[j % MODELS]
    }
    let between = |i: usize, j: usize| mean(&|p| distance_squared(tensor(p, i), tensor(p, j)));
    let is_alike = kind == Noise::Alike;
    let is_polynomial = |j: usize| j % MODELS < POLYNOMIALS;
    let unit: [f64; CANDIDATES] = std::array::from_fn(|j| mean(&|p| p.at(j / MODELS).variances[j % MODELS]));
    let there = |j: usize| unit[j].is_finite() && probe.may_have(j / MODELS, j % MODELS);
    let least = mean(&|p| p.noise);
    let noise = if is_alike {
        let polynomials: [f64; CANDIDATES] =
            std::array::from_fn(|j| if is_polynomial(j) && there(j) { unit[j] } else { f64::INFINITY });
        rough::alike(&polynomials, between).map_or(least, |alike| alike.max(least))
    } else {
        least
    };
    let variance = unit.map(|unit| noise * unit);
    let misfit: [f64; CANDIDATES] = std::array::from_fn(|j| mean(&|p| p.at(j / MODELS).misfits[j % MODELS]));
    // Alike noise is left in part by large windows only, as detail is: misfits tell nothing.
    let detail = |j: usize| if is_alike { 0.0 } else { unexplained(misfit[j], noise, j / MODELS) };
    // Only polynomials that explain their window bear witness to the bias of others.
    let witness: [bool; CANDIDATES] =
        std::array::from_fn(|i| is_polynomial(i) && there(i) && (i < 2 * MODELS || detail(i) == 0.0));
    // A cyclide is believed where it explains its window better than a polynomial does.
    let believed = |j: usize| is_polynomial(j) || misfit[j] < misfit[j - 1];

    let mut best = (f64::INFINITY, usize::MAX);
    for j in (0..CANDIDATES).filter(|&j| there(j) && believed(j)) {
        let mut bias = 0.0_f64;
        let less_biased = |i: usize| variance[i] >= 1.15 * variance[j] && variance[i] <= kind.reach() * variance[j];
        for i in (0..CANDIDATES).filter(|&i| witness[i] && less_biased(i)) {
            bias = bias.max(between(i, j) - (variance[i] - variance[j]));
        }
        let risk = variance[j] * (1.0 + detail(j)) + bias;
        if risk < best.0 {
            best = (risk, j);
        }
    }
    let (risk, at) = best;
    let (level, model) = (at / MODELS, at % MODELS);
    (at != usize::MAX).then(|| Choice {
        seed: probe.seed,
        level,
        model,
        error: risk.sqrt(),
        noise: noise.sqrt(),
        frame: probe.frame,
    })
}

/// The squared Frobenius norm of the difference of two symmetric matrices.
fn distance_squared(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    const TIMES: [f64; 6] = [1.0, 2.0, 2.0, 1.0, 2.0, 1.0];
    a.iter().zip(b).zip(TIMES).map(|((a, b), t)| t * (a - b) * (a - b)).sum()
}
