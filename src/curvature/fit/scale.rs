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
const SPARSE: usize = 2;
/// The same where windows of no more than level [`DENSE_UP_TO`] are chosen: what they say changes from place to place.
const DENSE: usize = 4;
const DENSE_UP_TO: usize = 5;

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
    probe_all(fans, probes.iter_mut().collect(), 0..SPARSE, &seed_of, 0.1);
    // Larger windows overlap more: fewer of them say the same.
    let tiers = tiers(ground, seeds, |i| &probes[i].neighbours, &[1; LEVELS.len() - SPARSE]);
    probe_more(fans, &mut probes, &seed_of, |i| SPARSE + tiers[i]);
    let mut choices = vec![None; seeds.len()];
    choose_all(fans, &probes, kind, &mut choices);
    let is_dense: Vec<bool> = choices.iter().map(|c| c.as_ref().is_some_and(|c| c.level <= DENSE_UP_TO)).collect();
    probe_more(fans, &mut probes, &seed_of, |i| if is_dense[i] { DENSE + tiers[i] } else { 0 });
    choose_all(fans, &probes, kind, &mut choices);
    // Patches lie about as close as windows of their size.
    let stays = |i: usize, choice: &Choice| choice.level <= tiers[i] + if is_dense[i] { DENSE - 1 } else { SPARSE };
    let chosen: Vec<Choice> =
        choices.into_iter().enumerate().filter_map(|(i, choice)| choice.filter(|choice| stays(i, choice))).collect();
    drop(probes);
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

/// Adds levels to probes until each has as many as are wanted, or more would be in vain.
fn probe_more(fans: &Fans<'_>, probes: &mut [Probe], seed_of: &[u32], wanted: impl Fn(usize) -> usize) {
    let mut behind: Vec<(Range<usize>, &mut Probe)> = probes
        .iter_mut()
        .enumerate()
        .map(|(i, probe)| (probe.levels()..wanted(i).min(LEVELS.len()), probe))
        .filter(|(levels, probe)| probe.may_go_on() && !levels.is_empty())
        .collect();
    behind.sort_by_key(|(levels, _)| (levels.start, levels.end));
    for alike in behind.chunk_by_mut(|a, b| a.0 == b.0) {
        let levels = alike[0].0.clone();
        probe_all(fans, alike.iter_mut().map(|(_, probe)| &mut **probe).collect(), levels, seed_of, 0.05);
    }
}

/// Chooses for all seeds.
fn choose_all(fans: &Fans<'_>, probes: &[Probe], kind: Noise, choices: &mut [Option<Choice>]) {
    choices.par_chunks_mut(CHUNK).zip(probes.par_chunks(CHUNK)).for_each(|(choices, some)| {
        fans.ground.work.advance(0);
        choices.iter_mut().zip(some).for_each(|(choice, probe)| *choice = choose(probe, probes, kind));
    });
}

/// The choice for a seed, or none where the surface is smooth.
fn choose(probe: &Probe, probes: &[Probe], kind: Noise) -> Option<Choice> {
    let around: Vec<&Probe> = probe.neighbours.iter().map(|&i| &probes[i as usize]).collect();
    let quartic = |p: &Probe, level: usize| p.at(level).misfits[1];
    if mean(&around, |p| (quartic(p, 1) / quartic(p, 0)).ln()).exp() > SMOOTH {
        return None;
    }
    // Those that have been looked at with windows of a level.
    let looked: [Vec<&Probe>; LEVELS.len()] =
        std::array::from_fn(|level| around.iter().copied().filter(|p| p.levels() > level).collect());
    let (level_of, model_of) = (|j: usize| j / MODELS, |j: usize| j % MODELS);
    let tensor = |p: &Probe, j: usize| p.at(level_of(j)).tensors[model_of(j)];
    let between = |i: usize, j: usize| {
        mean(&looked[level_of(i).max(level_of(j))], |p| distance_squared(&tensor(p, i), &tensor(p, j)))
    };
    let is_alike = kind == Noise::Alike;
    let is_polynomial = |j: usize| model_of(j) < POLYNOMIALS;
    let unit: [f64; CANDIDATES] =
        std::array::from_fn(|j| mean(&looked[level_of(j)], |p| p.at(level_of(j)).variances[model_of(j)]));
    let there = |j: usize| unit[j].is_finite() && probe.may_have(level_of(j), model_of(j));
    let least = mean(&around, |p| p.noise);
    let noise = if is_alike {
        let polynomials: [f64; CANDIDATES] =
            std::array::from_fn(|j| if is_polynomial(j) && there(j) { unit[j] } else { f64::INFINITY });
        rough::alike(&polynomials, between).map_or(least, |alike| alike.max(least))
    } else {
        least
    };
    let variance = unit.map(|unit| noise * unit);
    let misfit: [f64; CANDIDATES] =
        std::array::from_fn(|j| mean(&looked[level_of(j)], |p| p.at(level_of(j)).misfits[model_of(j)]));
    // Alike noise is left in part by large windows only, as detail is: misfits tell nothing.
    let detail = |j: usize| if is_alike { 0.0 } else { unexplained(misfit[j], noise, level_of(j)) };
    // Only polynomials that explain their window bear witness to the bias of others.
    let witness: [bool; CANDIDATES] =
        std::array::from_fn(|i| is_polynomial(i) && there(i) && (level_of(i) < 2 || detail(i) == 0.0));
    // A cyclide is believed where it explains its window better than a polynomial does.
    let believed = |j: usize| is_polynomial(j) || misfit[j] < misfit[j - 1];

    // Of large windows all are alike off where none follows the surface: only small ones can tell, if for their own
    // variance they can tell anything.
    const FAR: f64 = 5.0;
    let mut best = (f64::INFINITY, usize::MAX);
    for j in (0..CANDIDATES).filter(|&j| there(j) && believed(j)) {
        let mut bias = 0.0_f64;
        for i in (0..CANDIDATES).filter(|&i| witness[i] && variance[i] >= 1.15 * variance[j]) {
            let is_near = variance[i] <= kind.reach() * variance[j];
            if is_near || !is_alike {
                let chance = if is_near { variance[i] - variance[j] } else { FAR * variance[i] };
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
