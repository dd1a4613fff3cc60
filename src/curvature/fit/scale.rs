//! The window for a noisy place: as large as the surface lets it be.
//!
//! Around each seed, surfaces are fitted to nested windows. Their variances follow from the noise and
//! the fit; their bias is bounded by Lepski's rule, by how far they are from less biased fits beyond what
//! the variances explain. The least sum of both wins. All statistics are means over neighbouring
//! seeds.

use super::chord::ChordFit;
use super::cyclide::{Cyclide, TERMS as CYCLIDE_TERMS};
use super::frame::Frame;
use super::ground::Ground;
use super::patches::{self, Blended, Patch, Surface};
use super::samples::Sampler;
use super::steady::ROUGH_WINDOW;
use crate::mesh::Face;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Vertices per window, by level.
const LEVELS: [usize; 6] = [28, 48, 81, 138, 234, 398];
const DEGREES: [usize; 2] = [3, 4];
/// Two chord polynomials and a cyclide per level.
const MODELS: usize = DEGREES.len() + 1;
const CANDIDATES: usize = LEVELS.len() * MODELS;
/// The first level at which a cyclide is believed.
const FIRST_CYCLIDE: usize = 2;
/// Growth of the variance of samples from the first to the second level that says that the surface is
/// smooth and its fits too coarse, not that it is noisy.
const SMOOTH: f64 = 6.8;
/// A larger window is not tried where the variance of samples has grown to this many times its least.
const HOPELESS: f64 = 9.0;
const CHUNK: usize = 64;
/// Seeds that stand for all when the kind of surface is judged, and levels that are looked at.
const JUDGES: usize = 400;
const JUDGED: usize = 4;

/// A seed's fits at every level.
struct Probe {
    seed: Face,
    /// Upper triangles of shape tensors; NaN where there is no fit.
    tensors: [[f64; 6]; CANDIDATES],
    /// Variances of the tensors for samples of unit variance; infinite where there is no fit.
    variances: [f64; CANDIDATES],
    /// Variances of the samples about each fit; infinite where there is none.
    misfits: [f64; CANDIDATES],
    /// The least of them that can be trusted as noise.
    noise: f64,
    /// Mean edge, nearly.
    spacing: f64,
    /// Numbers of the seeds around, itself among them.
    neighbours: Vec<u32>,
}

/// True where a surface is rough: noise and detail at every scale from the edges up, as real scans have
/// it. No window is then better than another by what the data say.
pub(super) fn is_rough(ground: &Ground<'_>, seeds: &[Face]) -> bool {
    /// Windows that a surface must hold: on a coarse model they would be half of it.
    const LEAST_WINDOWS: usize = 20;
    /// Noise in edges below which a surface is no scan's.
    const LEAST_NOISE: f64 = 0.013;
    /// Least growth of the deviation from the first level to the fourth.
    const LEAST_GROWTH: f64 = 1.15;
    /// Growth of what the noise does not explain from the third level to the fourth, from which it is
    /// the detail of a smooth surface.
    const SMOOTH_GROWTH: f64 = 2.6;
    if ground.mesh.positions().len() < LEAST_WINDOWS * ROUGH_WINDOW {
        return false;
    }
    let step = seeds.len().div_ceil(JUDGES).max(1);
    let judges: Vec<Face> = seeds.iter().copied().step_by(step).collect();
    let none = vec![u32::MAX; ground.mesh.face_count()];
    let probes = probe_all(ground, &judges, &none, JUDGED);
    let median = |of: &dyn Fn(&Probe) -> f64| {
        let mut values: Vec<f64> = probes.iter().map(of).filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let quartic = |level: usize| median(&|p| (p.misfits[level * MODELS + 1]).sqrt() / p.spacing);
    let cyclide = median(&|p| p.misfits[3 * MODELS + 2].sqrt() / p.spacing);
    let (noise, third, fourth) = (quartic(0), quartic(2), quartic(3));
    let beyond = |deviation: f64| (deviation * deviation - noise * noise).max(0.0).sqrt();
    noise >= LEAST_NOISE
        && fourth.min(cyclide) >= LEAST_GROWTH * noise
        && beyond(fourth) < SMOOTH_GROWTH * beyond(third)
}

/// Values for the faces that are `wanted`, from patches around `seeds`; `None` where the surface turns
/// out smooth or no patch reaches.
pub(super) fn estimate(ground: &Ground<'_>, seeds: &[Face], wanted: &[bool]) -> Vec<Option<Blended>> {
    let mut seed_of = vec![u32::MAX; ground.mesh.face_count()];
    for (i, seed) in seeds.iter().enumerate() {
        seed_of[seed.index()] = i as u32;
    }
    let probes = probe_all(ground, seeds, &seed_of, LEVELS.len());
    let chosen: Vec<Vec<Option<Patch>>> = probes
        .par_chunks(CHUNK)
        .map_init(
            || Sampler::new(ground),
            |sampler, chunk| {
                ground.progress.advance(0);
                chunk.iter().map(|probe| choose(probe, &probes, sampler)).collect()
            },
        )
        .collect();
    drop(probes);
    let chosen: Vec<Option<Patch>> = chosen.into_iter().flatten().collect();
    patches::blend(ground, seeds, &chosen, wanted)
}

fn probe_all(ground: &Ground<'_>, seeds: &[Face], seed_of: &[u32], levels: usize) -> Vec<Probe> {
    let probes: Vec<Vec<Probe>> = seeds
        .par_chunks(CHUNK)
        .map_init(
            || Sampler::new(ground),
            |sampler, chunk| {
                ground.progress.advance(0);
                chunk.iter().map(|&seed| probe(sampler, seed, seed_of, levels)).collect()
            },
        )
        .collect();
    probes.into_iter().flatten().collect()
}

fn probe(sampler: &mut Sampler<'_>, seed: Face, seed_of: &[u32], levels: usize) -> Probe {
    let ground = sampler.ground;
    let mesh = ground.mesh;
    let centre = mesh.barycentre(seed);
    let mut probe = Probe {
        seed,
        tensors: [[f64::NAN; 6]; CANDIDATES],
        variances: [f64::INFINITY; CANDIDATES],
        misfits: [f64::INFINITY; CANDIDATES],
        noise: f64::INFINITY,
        spacing: 0.0,
        neighbours: Vec::new(),
    };
    let mut known: Option<Frame> = None;
    sampler.start(seed);
    for (level, &count) in LEVELS[..levels].iter().enumerate() {
        let Some(fit) = fit(sampler, centre, count, known) else { break };
        known = Some(fit.frame);
        if level == 0 {
            // So many points fill a disk of the window's radius as the vertices of equilateral faces.
            probe.spacing = fit.frame.unit * (3.63 / sampler.points.len() as f64).sqrt();
        }
        for (model, &degree) in DEGREES.iter().enumerate().filter(|(_, d)| **d <= fit.highest()) {
            if let Some((_, shape)) = fit.surface(degree).shape_at(centre) {
                let variance = fit.tensor_variance(degree);
                probe.note(level * MODELS + model, shape.tensor, variance, fit.deviation_squared(degree));
            }
        }
        let mut deviation = fit.deviation_squared(fit.highest());
        probe.noise = probe.noise.min(deviation);
        if level >= FIRST_CYCLIDE
            && let Some(c) = Cyclide::fit(fit.frame, &sampler.points, deviation.sqrt(), &mut sampler.rows)
            && let Some(shape) = c.surface.shape_at(centre)
        {
            probe.note(level * MODELS + DEGREES.len(), shape.tensor, c.tensor_variance(), c.misfit);
            // In small windows its residual is less than the noise.
            if level > FIRST_CYCLIDE {
                deviation = deviation.min(c.misfit);
                probe.noise = probe.noise.min(deviation);
            }
        }
        if level < 2 {
            let reach = fit.frame.unit.powi(2) * if level == 0 { 4.0 } else { 2.0 };
            probe.neighbours = seeds_within(ground, sampler.vertices(), seed_of, centre, reach);
        }
        if sampler.points.len() < count || deviation > HOPELESS * probe.noise {
            break;
        }
    }
    probe
}

/// The nearest seeds among the faces at vertices, at most 16.
fn seeds_within(ground: &Ground<'_>, vertices: &[u32], seed_of: &[u32], centre: DVec3, square: f64) -> Vec<u32> {
    let mut near: Vec<(f64, u32)> = vertices
        .iter()
        .flat_map(|&v| ground.stars.of(v))
        .filter(|&&f| seed_of[f as usize] != u32::MAX)
        .map(|&f| (ground.mesh.barycentre(Face(f)).distance_squared(centre), seed_of[f as usize]))
        .filter(|n| n.0 <= square)
        .collect();
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.dedup();
    near.into_iter().take(16).map(|n| n.1).collect()
}

/// A chord fit to the `count` nearest vertices, from a frame known from a smaller window if there is one.
fn fit(sampler: &mut Sampler<'_>, centre: DVec3, count: usize, known: Option<Frame>) -> Option<ChordFit> {
    let frame = sampler.take_nearest(centre, count)?;
    let (frame, rounds) = known.map_or((frame, 2), |known| (Frame { unit: frame.unit, ..known }, 1));
    ChordFit::new(frame, &sampler.points, rounds, &mut sampler.rows)
}

impl Probe {
    fn note(&mut self, candidate: usize, tensor: DMat3, variance: f64, misfit: f64) {
        let [x, y, z] = [tensor.x_axis, tensor.y_axis, tensor.z_axis];
        self.tensors[candidate] = [x.x, y.x, z.x, y.y, z.y, z.z];
        self.variances[candidate] = variance;
        self.misfits[candidate] = misfit;
    }
}

/// The patch for a seed, or none where the surface is smooth.
fn choose(probe: &Probe, probes: &[Probe], sampler: &mut Sampler<'_>) -> Option<Patch> {
    let mean = |of: &dyn Fn(&Probe) -> f64| {
        let values = probe.neighbours.iter().map(|&i| of(&probes[i as usize])).filter(|v| v.is_finite());
        let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / count
    };
    let quartic = |p: &Probe, level: usize| p.misfits[level * MODELS + 1];
    let growth = mean(&|p| (quartic(p, 1) / quartic(p, 0)).ln()).exp();
    if growth > SMOOTH {
        return None;
    }
    let noise = mean(&|p| p.noise);
    let there = |j: usize| probe.variances[j].is_finite();
    let variance: [f64; CANDIDATES] = std::array::from_fn(|j| noise * mean(&|p| p.variances[j]));
    let misfit: [f64; CANDIDATES] = std::array::from_fn(|j| mean(&|p| p.misfits[j]));
    // What a window does not explain beyond chance.
    let excess = |j: usize| {
        let chance = 2.0 * (2.0 / LEVELS[j / MODELS] as f64).sqrt();
        (misfit[j] - noise * (1.0 + chance)).max(0.0)
    };
    let is_polynomial = |j: usize| j % MODELS < DEGREES.len();
    // Only polynomials that explain their window bear witness to the bias of others.
    let witness: [bool; CANDIDATES] =
        std::array::from_fn(|i| is_polynomial(i) && there(i) && (i < 2 * MODELS || excess(i) == 0.0));
    // A cyclide is believed where it explains its window better than a polynomial does.
    let believed = |j: usize| is_polynomial(j) || misfit[j] < misfit[j - 1];

    let mut best = (f64::INFINITY, usize::MAX);
    for j in (0..CANDIDATES).filter(|&j| there(j) && believed(j)) {
        let mut bias = 0.0_f64;
        let less_biased = |i: usize| variance[i] >= 1.15 * variance[j] && variance[i] <= 16.0 * variance[j];
        for i in (0..CANDIDATES).filter(|&i| witness[i] && less_biased(i)) {
            let between = mean(&|p| distance_squared(&p.tensors[i], &p.tensors[j]));
            bias = bias.max(between - (variance[i] - variance[j]));
        }
        // What is not explained is detail; it bends the fit as a whole, not sample by sample.
        let coherent = excess(j) / noise * LEVELS[j / MODELS] as f64 / CYCLIDE_TERMS as f64;
        let risk = variance[j] * (1.0 + coherent) + bias;
        if risk < best.0 {
            best = (risk, j);
        }
    }
    let (risk, at) = best;
    let (level, model) = (at / MODELS, at % MODELS);
    if at == usize::MAX {
        return None;
    }
    let centre = sampler.ground.mesh.barycentre(probe.seed);
    sampler.start(probe.seed);
    let fit = fit(sampler, centre, LEVELS[level], None)?;
    let error = risk.sqrt();
    if model == DEGREES.len() {
        let c = Cyclide::fit(fit.frame, &sampler.points, noise.sqrt(), &mut sampler.rows)?;
        return Some(Patch { surface: Surface::Implicit(c.surface), error, noise: c.misfit.sqrt() });
    }
    let degree = DEGREES[model].min(fit.highest());
    let noise = fit.deviation_squared(degree).sqrt();
    Some(Patch { surface: Surface::Chord(fit.surface(degree)), error, noise })
}

/// The squared Frobenius norm of the difference of two symmetric matrices.
fn distance_squared(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    const TIMES: [f64; 6] = [1.0, 2.0, 2.0, 1.0, 2.0, 1.0];
    a.iter().zip(b).zip(TIMES).map(|((a, b), t)| t * (a - b) * (a - b)).sum()
}
