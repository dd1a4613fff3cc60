//! The window for a noisy place: as large as the surface lets it be.
//!
//! Around each seed, surfaces are fitted to nested windows. Their variances follow from the noise and
//! the fit; their bias is bounded by Lepski's rule, by how far they are from less biased fits beyond what
//! the variances explain. The least sum of both wins. All statistics are means over neighbouring
//! seeds.

use super::abreast::Abreast;
use super::chord::{ChordFits, ChordFitter};
use super::cyclide::{Cyclide, CyclideFitter, TERMS as CYCLIDE_TERMS};
use super::fans::Fans;
use super::frame::Frame;
use super::lanes::{F4, LANES};
use super::patches::{self, Blended, Patch, REACH, Surface};
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
pub(super) fn is_rough(fans: &Fans<'_>, seeds: &[Face]) -> bool {
    /// Windows that a surface must hold: on a coarse model they would be half of it.
    const LEAST_WINDOWS: usize = 20;
    /// Noise in edges below which a surface is no scan's.
    const LEAST_NOISE: f64 = 0.013;
    /// Least growth of the deviation from the first level to the fourth.
    const LEAST_GROWTH: f64 = 1.15;
    /// Growth of what the noise does not explain from the third level to the fourth, from which it is
    /// the detail of a smooth surface.
    const SMOOTH_GROWTH: f64 = 2.6;
    let mesh = fans.ground.mesh;
    if mesh.positions().len() < LEAST_WINDOWS * ROUGH_WINDOW {
        return false;
    }
    let step = seeds.len().div_ceil(JUDGES).max(1);
    let judges: Vec<Face> = seeds.iter().copied().step_by(step).collect();
    let none = vec![u32::MAX; mesh.face_count()];
    let probes = probe_all(fans, &judges, &none, JUDGED);
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
pub(super) fn estimate(fans: &Fans<'_>, seeds: &[Face], wanted: &[bool]) -> Vec<Option<Blended>> {
    let ground = fans.ground;
    let mut seed_of = vec![u32::MAX; ground.mesh.face_count()];
    for (i, seed) in seeds.iter().enumerate() {
        seed_of[seed.index()] = i as u32;
    }
    let probes = probe_all(fans, seeds, &seed_of, LEVELS.len());
    let chosen: Vec<Vec<Choice>> = probes
        .par_chunks(CHUNK)
        .map(|chunk| {
            ground.progress.advance(0);
            chunk.iter().filter_map(|probe| choose(probe, &probes)).collect()
        })
        .collect();
    drop(probes);
    let chosen: Vec<Choice> = chosen.into_iter().flatten().collect();
    let patches: Vec<Vec<Patch>> = chosen
        .par_chunks(CHUNK)
        .map_init(
            || Prober::new(fans),
            |prober, chosen| {
                ground.progress.advance(0);
                prober.patches(chosen, wanted)
            },
        )
        .collect();
    let patches: Vec<Patch> = patches.into_iter().flatten().collect();
    patches::blend(ground, &patches, wanted)
}

fn probe_all(fans: &Fans<'_>, seeds: &[Face], seed_of: &[u32], levels: usize) -> Vec<Probe> {
    let probes: Vec<Vec<Probe>> = seeds
        .par_chunks(CHUNK)
        .map_init(
            || Prober::new(fans),
            |prober, chunk| {
                fans.ground.progress.advance(0);
                chunk.chunks(LANES).flat_map(|seeds| prober.probe(seeds, seed_of, levels)).collect()
            },
        )
        .collect();
    probes.into_iter().flatten().collect()
}

/// Fits windows around four seeds at a time; one per thread.
struct Prober<'g> {
    samplers: [Sampler<'g>; LANES],
    abreast: Abreast,
    chords: ChordFitter,
    cyclides: CyclideFitter,
}

impl<'g> Prober<'g> {
    fn new(fans: &'g Fans<'g>) -> Self {
        Prober {
            samplers: std::array::from_fn(|_| Sampler::new(fans)),
            abreast: Abreast::new(),
            chords: ChordFitter::new(),
            cyclides: CyclideFitter::new(),
        }
    }

    /// Loads the nearest vertices of a seed that its sampler has started at, in a frame known from a smaller window if
    /// there is one. False where there are too few.
    fn load(&mut self, lane: usize, centre: DVec3, count: usize, known: Option<Frame>) -> bool {
        let sampler = &mut self.samplers[lane];
        let Some(frame) = sampler.take_nearest(centre, count) else { return false };
        let frame = known.map_or(frame, |known| Frame { unit: frame.unit, ..known });
        self.abreast.load(lane, frame, sampler.points.iter().map(|&p| (p, 1.0)));
        true
    }

    fn probe(&mut self, seeds: &[Face], seed_of: &[u32], levels: usize) -> Vec<Probe> {
        let fans = self.samplers[0].fans;
        let mut probes: Vec<Probe> = seeds.iter().map(|&seed| Probe::new(seed)).collect();
        let centres: Vec<DVec3> = seeds.iter().map(|&seed| fans.ground.mesh.barycentre(seed)).collect();
        let mut known: [Option<Frame>; LANES] = [None; LANES];
        let mut is_left: [bool; LANES] = std::array::from_fn(|lane| lane < seeds.len());
        self.samplers.iter_mut().zip(seeds).for_each(|(sampler, &seed)| sampler.start(seed));
        for (level, &count) in LEVELS[..levels].iter().enumerate() {
            self.abreast.clear();
            for lane in 0..seeds.len() {
                is_left[lane] = is_left[lane] && self.load(lane, centres[lane], count, known[lane]);
            }
            if !is_left.contains(&true) {
                break;
            }
            let fits = self.chords.fit(&mut self.abreast, [4; LANES], if level == 0 { 2 } else { 1 });
            let mut deviations = [0.0; LANES];
            for lane in 0..seeds.len() {
                let Some(frame) = self.abreast.frame(lane).filter(|_| is_left[lane] && fits.is_carried(lane)) else {
                    is_left[lane] = false;
                    continue;
                };
                known[lane] = Some(frame);
                deviations[lane] = probes[lane].note_chords(level, &fits, lane, frame, centres[lane]);
                if level == 0 {
                    // So many points fill a disk of the window's radius as the vertices of equilateral faces.
                    probes[lane].spacing = frame.unit * (3.63 / self.samplers[lane].points.len() as f64).sqrt();
                }
            }
            if level >= FIRST_CYCLIDE {
                let cyclides = self.cyclides.fit(&self.abreast, F4(deviations.map(f64::sqrt)));
                for lane in 0..seeds.len() {
                    let Some(frame) = known[lane].filter(|_| is_left[lane]) else { continue };
                    if let Some(c) = cyclides.of(lane, frame) {
                        let is_noted = probes[lane].note_cyclide(level, &c, centres[lane]);
                        // In small windows its residual is less than the noise.
                        if is_noted && level > FIRST_CYCLIDE {
                            deviations[lane] = deviations[lane].min(c.misfit);
                            probes[lane].noise = probes[lane].noise.min(c.misfit);
                        }
                    }
                }
            }
            for lane in 0..seeds.len() {
                if !is_left[lane] {
                    continue;
                }
                let (sampler, probe) = (&self.samplers[lane], &mut probes[lane]);
                if level < 2 {
                    let unit = known[lane].map_or(0.0, |frame| frame.unit);
                    let reach = unit.powi(2) * if level == 0 { 4.0 } else { 2.0 };
                    probe.neighbours = seeds_within(sampler, seed_of, centres[lane], reach);
                }
                is_left[lane] = sampler.points.len() >= count && deviations[lane] <= HOPELESS * probe.noise;
            }
        }
        probes
    }

    /// The patches that are chosen, and which of the `wanted` faces they reach.
    fn patches(&mut self, chosen: &[Choice], wanted: &[bool]) -> Vec<Patch> {
        let mesh = self.samplers[0].fans.ground.mesh;
        let mut order: Vec<usize> = (0..chosen.len()).collect();
        // Windows of one size side by side.
        order.sort_by_key(|&i| (chosen[i].level, chosen[i].model));
        let mut patches: Vec<Option<Patch>> = chosen.iter().map(|_| None).collect();
        for four in order.chunks(LANES) {
            self.abreast.clear();
            for (lane, choice) in four.iter().map(|&i| &chosen[i]).enumerate() {
                self.samplers[lane].start(choice.seed);
                self.load(lane, mesh.barycentre(choice.seed), LEVELS[choice.level], None);
            }
            let fits = self.chords.fit(&mut self.abreast, [4; LANES], 2);
            let noise = |lane: usize| four.get(lane).map_or(0.0, |&i| chosen[i].noise);
            let has_cyclide = four.iter().any(|&i| chosen[i].model == DEGREES.len());
            let cyclides = has_cyclide.then(|| self.cyclides.fit(&self.abreast, F4(std::array::from_fn(noise))));
            for (lane, &i) in four.iter().enumerate() {
                let Choice { seed, model, error, .. } = chosen[i];
                let Some(frame) = self.abreast.frame(lane).filter(|_| fits.is_carried(lane)) else { continue };
                let (surface, variance) = match DEGREES.get(model) {
                    Some(&degree) => {
                        let degree = degree.min(fits.highest(lane));
                        let variance = fits.deviation_squared(lane, degree, &frame);
                        (Surface::Chord(fits.surface(lane, degree, frame)), variance)
                    }
                    None => {
                        let Some(c) = cyclides.as_ref().and_then(|c| c.of(lane, frame)) else { continue };
                        (Surface::Implicit(c.surface), c.misfit)
                    }
                };
                let (centre, reach) = (mesh.barycentre(seed), REACH * surface.radius());
                self.samplers[lane].gather_within(centre, reach, 0);
                let reached = self.samplers[lane].faces_within(centre, reach);
                let faces = reached.filter(|&f| wanted[f as usize]).collect();
                patches[i] = Some(Patch { seed, surface, error, noise: variance.sqrt(), faces });
            }
        }
        patches.into_iter().flatten().collect()
    }
}

/// The nearest seeds among the faces a sampler has gathered, at most 16.
fn seeds_within(sampler: &Sampler<'_>, seed_of: &[u32], centre: DVec3, square: f64) -> Vec<u32> {
    let mesh = sampler.fans.ground.mesh;
    let mut near: Vec<(f64, u32)> = sampler
        .faces_within(centre, square.sqrt())
        .filter(|&f| seed_of[f as usize] != u32::MAX)
        .map(|f| (mesh.barycentre(Face(f)).distance_squared(centre), seed_of[f as usize]))
        .collect();
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(16).map(|n| n.1).collect()
}

impl Probe {
    fn new(seed: Face) -> Self {
        Probe {
            seed,
            tensors: [[f64::NAN; 6]; CANDIDATES],
            variances: [f64::INFINITY; CANDIDATES],
            misfits: [f64::INFINITY; CANDIDATES],
            noise: f64::INFINITY,
            spacing: 0.0,
            neighbours: Vec::new(),
        }
    }

    /// Notes polynomials, and returns the variance of the samples about the one of the highest degree.
    fn note_chords(&mut self, level: usize, fits: &ChordFits, lane: usize, frame: Frame, centre: DVec3) -> f64 {
        let highest = fits.highest(lane);
        for (model, &degree) in DEGREES.iter().enumerate().filter(|(_, d)| **d <= highest) {
            if let Some((_, shape)) = fits.surface(lane, degree, frame).shape_at(centre) {
                let variance = fits.tensor_variance(lane, degree, &frame);
                let deviation = fits.deviation_squared(lane, degree, &frame);
                self.note(level * MODELS + model, shape.tensor, variance, deviation);
            }
        }
        let deviation = fits.deviation_squared(lane, highest, &frame);
        self.noise = self.noise.min(deviation);
        deviation
    }

    /// Notes a cyclide; false where it has no shape at the centre.
    fn note_cyclide(&mut self, level: usize, c: &Cyclide, centre: DVec3) -> bool {
        let shape = c.surface.shape_at(centre);
        if let Some(shape) = &shape {
            self.note(level * MODELS + DEGREES.len(), shape.tensor, c.tensor_variance, c.misfit);
        }
        shape.is_some()
    }

    fn note(&mut self, candidate: usize, tensor: DMat3, variance: f64, misfit: f64) {
        let [x, y, z] = [tensor.x_axis, tensor.y_axis, tensor.z_axis];
        self.tensors[candidate] = [x.x, y.x, z.x, y.y, z.y, z.z];
        self.variances[candidate] = variance;
        self.misfits[candidate] = misfit;
    }
}

/// The window and the model for a seed.
struct Choice {
    seed: Face,
    level: usize,
    model: usize,
    /// Expected error of its shape tensor, 1/length.
    error: f64,
    /// Standard deviation of the samples around, in file units.
    noise: f64,
}

/// The choice for a seed, or none where the surface is smooth.
fn choose(probe: &Probe, probes: &[Probe]) -> Option<Choice> {
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
    (at != usize::MAX).then(|| Choice { seed: probe.seed, level, model, error: risk.sqrt(), noise: noise.sqrt() })
}

/// The squared Frobenius norm of the difference of two symmetric matrices.
fn distance_squared(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    const TIMES: [f64; 6] = [1.0, 2.0, 2.0, 1.0, 2.0, 1.0];
    a.iter().zip(b).zip(TIMES).map(|((a, b), t)| t * (a - b) * (a - b)).sum()
}
