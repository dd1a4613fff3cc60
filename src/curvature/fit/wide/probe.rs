//! What windows of nested sizes say around a seed on a noisy surface.

use super::patches::{Patch, Surface, by_chunk};
use crate::curvature::fit::around::samples::Sampler;
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::solve::abreast::Abreast;
use crate::curvature::fit::solve::chord_fitter::{ChordFits, ChordFitter};
use crate::curvature::fit::solve::cyclide::{Cyclide, CyclideFitter};
use crate::curvature::fit::surface::bivariate::{CUBIC, HIGHEST};
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::fit::surface::polynomial::CYCLIDE;
use crate::curvature::vectors::four::{F4, LANES};
use crate::mesh::Face;
use glam::{DMat3, DVec3};
use std::ops::{Index, IndexMut, Range};

/// Degrees of the polynomials.
const DEGREES: [usize; 2] = [CUBIC, HIGHEST];
/// Vertices per window, by level.
pub(super) const LEVELS: [usize; 8] = [28, 48, 81, 138, 234, 398, 676, 1150];
/// A patch is blended up to this share of its window's radius.
const REACH: f64 = 0.85;
/// The first level at which a cyclide is believed.
pub(super) const FIRST_CYCLIDE: usize = 2;
/// A larger window is not tried where the variance of samples has grown to this many times its least.
pub(super) const HOPELESS: f64 = 9.0;

/// A seed's fits, level by level.
pub(super) struct Probe {
    pub(super) seed: Face,
    levels: Vec<Level>,
    /// The least variance of samples that can be trusted as noise.
    pub(super) noise: f64,
    /// Mean edge, nearly.
    pub(super) spacing: f64,
    /// Numbers of the seeds around, the nearest first: itself, unless its face is longer than the window, and gets no
    /// choice then.
    pub(super) neighbours: Vec<u32>,
    /// The frame of the largest window so far.
    pub(super) frame: Option<LocalFrame>,
    /// False where a larger window would be in vain.
    goes_on: bool,
    /// As [`HOPELESS`], for this seed.
    hopeless: f64,
}

/// What is fitted to a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Model {
    /// Polynomials in chord coordinates.
    Cubic,
    Quartic,
    Cyclide,
}

/// A model in the window of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Candidate {
    pub(super) level: usize,
    pub(super) model: Model,
}

/// A value for every candidate.
pub(super) struct ByCandidate<T>([T; Candidate::COUNT]);

/// The fit of a model to a window.
#[derive(Clone, Copy)]
pub(super) struct Found {
    /// Upper triangle of the shape tensor; NaN where there is no fit.
    pub(super) tensor: [f64; 6],
    /// Variance of the tensor for samples of unit variance; infinite where there is no fit.
    pub(super) variance: f64,
    /// Variance of the samples about the fit; infinite where there is none.
    pub(super) misfit: f64,
}

/// The fits to a window.
type Level = [Found; Model::ALL.len()];

/// The window and the model for a seed.
#[derive(Clone, Copy)]
pub(super) struct Choice {
    pub(super) seed: Face,
    pub(super) candidate: Candidate,
    /// Expected error of its shape tensor, 1/length.
    pub(super) error: f64,
    /// Standard deviation of the samples around, in file units.
    pub(super) noise: f64,
    /// True where noise is alike at neighbouring samples.
    pub(super) is_alike: bool,
    /// The frame to begin with.
    pub(super) frame: Option<LocalFrame>,
}

/// Fits windows around four seeds at a time; one per thread.
pub(super) struct Prober<'g> {
    samplers: [Sampler<'g, Fans<'g>>; LANES],
    abreast: Abreast,
    chords: ChordFitter,
    cyclides: CyclideFitter,
}

impl Model {
    pub(super) const ALL: [Model; 3] = [Model::Cubic, Model::Quartic, Model::Cyclide];

    /// Of a polynomial.
    fn degree(self) -> Option<usize> {
        match self {
            Model::Cubic => Some(CUBIC),
            Model::Quartic => Some(HIGHEST),
            Model::Cyclide => None,
        }
    }
}

impl Candidate {
    const COUNT: usize = LEVELS.len() * Model::ALL.len();

    /// Level by level.
    pub(super) fn all() -> impl Iterator<Item = Candidate> {
        (0..Candidate::COUNT).map(Candidate::numbered)
    }

    pub(super) fn is_polynomial(self) -> bool {
        self.model != Model::Cyclide
    }

    /// The quartic in the same window.
    pub(super) fn quartic(self) -> Candidate {
        Candidate { model: Model::Quartic, ..self }
    }

    /// The quartic that has some four to twenty times its variance: that in the next smaller window, for cubics that in
    /// their own.
    pub(super) fn witness(self) -> Option<Candidate> {
        let level = if self.model == Model::Cubic { self.level } else { self.level.checked_sub(1)? };
        Some(Candidate { level, model: Model::Quartic })
    }

    fn numbered(number: usize) -> Self {
        Candidate { level: number / Model::ALL.len(), model: Model::ALL[number % Model::ALL.len()] }
    }

    fn number(self) -> usize {
        self.level * Model::ALL.len() + self.model as usize
    }
}

impl<T> ByCandidate<T> {
    pub(super) fn of(value: impl Fn(Candidate) -> T) -> Self {
        ByCandidate(std::array::from_fn(|number| value(Candidate::numbered(number))))
    }
}

impl<T> Index<Candidate> for ByCandidate<T> {
    type Output = T;

    #[inline]
    fn index(&self, candidate: Candidate) -> &T {
        &self.0[candidate.number()]
    }
}

impl<T> IndexMut<Candidate> for ByCandidate<T> {
    #[inline]
    fn index_mut(&mut self, candidate: Candidate) -> &mut T {
        &mut self.0[candidate.number()]
    }
}

impl<'g> Prober<'g> {
    pub(super) fn new(fans: &'g Fans<'g>) -> Self {
        Prober {
            samplers: std::array::from_fn(|_| Sampler::new(fans)),
            abreast: Abreast::new(),
            chords: ChordFitter::new(),
            cyclides: CyclideFitter::new(),
        }
    }

    /// Loads the nearest vertices of a seed that its sampler has started at, in a frame known from a smaller window if
    /// there is one. False where there are too few.
    fn load(&mut self, lane: usize, centre: DVec3, count: usize, known: Option<LocalFrame>) -> bool {
        let sampler = &mut self.samplers[lane];
        let Some(frame) = sampler.take_nearest(centre, count) else { return false };
        let frame = known.map_or(frame, |known| LocalFrame { unit: frame.unit, ..known });
        self.abreast.load(lane, frame, sampler.points.iter().map(|&p| (p, 1.0)));
        true
    }

    /// Adds levels to up to four probes; `seed_of` has the numbers of the faces that are seeds.
    pub(super) fn probe(&mut self, probes: &mut [&mut Probe], levels: Range<usize>, seed_of: &[u32]) {
        let mesh = self.samplers[0].ground().mesh;
        let centres: Vec<DVec3> = probes.iter().map(|probe| mesh.barycentre(probe.seed)).collect();
        self.samplers.iter_mut().zip(&*probes).for_each(|(sampler, probe)| sampler.start(probe.seed));
        for level in levels {
            self.abreast.clear();
            for (lane, probe) in probes.iter_mut().enumerate() {
                probe.goes_on = probe.goes_on && self.load(lane, centres[lane], LEVELS[level], probe.frame);
            }
            if !probes.iter().any(|probe| probe.goes_on) {
                break;
            }
            let fits = self.chords.fit(&mut self.abreast, &DEGREES, [HIGHEST; LANES], if level == 0 { 2 } else { 0 });
            let (mut deviations, mut frames) = ([0.0; LANES], [None; LANES]);
            for (lane, probe) in probes.iter_mut().enumerate().filter(|(_, probe)| probe.goes_on) {
                frames[lane] = self.abreast.frame(lane).filter(|_| fits.is_carried(lane));
                let settled = frames[lane].and_then(|frame| fits.settled(lane, &frame));
                let (Some(frame), Some(settled)) = (frames[lane], settled) else {
                    probe.goes_on = false;
                    continue;
                };
                probe.frame = Some(settled);
                deviations[lane] = probe.add(&fits, lane, frame, centres[lane]);
                if level == 0 {
                    // So many points fill a disk of the window's radius as the vertices of equilateral faces.
                    probe.spacing = frame.unit * (3.63 / self.samplers[lane].points.len() as f64).sqrt();
                }
            }
            if level >= FIRST_CYCLIDE {
                let cyclides = self.cyclides.fit(&self.abreast, F4(deviations.map(f64::sqrt)));
                for (lane, probe) in probes.iter_mut().enumerate().filter(|(_, probe)| probe.goes_on) {
                    let Some(c) = frames[lane].and_then(|frame| cyclides.of(lane, frame)) else { continue };
                    // In small windows its residual is less than the noise.
                    if probe.add_cyclide(&c, centres[lane]) && level > FIRST_CYCLIDE {
                        deviations[lane] = deviations[lane].min(c.misfit);
                        probe.noise = probe.noise.min(c.misfit);
                    }
                }
            }
            for (lane, probe) in probes.iter_mut().enumerate().filter(|(_, probe)| probe.goes_on) {
                let sampler = &self.samplers[lane];
                if level < 2 {
                    let unit = probe.frame.map_or(0.0, |frame| frame.unit);
                    let reach = unit * if level == 0 { 2.0 } else { 2.0_f64.sqrt() };
                    probe.neighbours = seeds_within(sampler, seed_of, centres[lane], reach);
                }
                probe.goes_on =
                    sampler.points.len() >= LEVELS[level] && deviations[lane] <= probe.hopeless * probe.noise;
            }
        }
    }

    /// The patches that are chosen, and which of the `wanted` faces they reach.
    pub(super) fn patches(&mut self, chosen: &[Choice], wanted: &[bool]) -> Vec<Patch> {
        let mesh = self.samplers[0].ground().mesh;
        let mut order: Vec<usize> = (0..chosen.len()).collect();
        // Windows of one size side by side.
        order.sort_by_key(|&i| chosen[i].candidate);
        let mut patches: Vec<Option<Patch>> = chosen.iter().map(|_| None).collect();
        for four in order.chunks(LANES) {
            self.abreast.clear();
            for (lane, choice) in four.iter().map(|&i| &chosen[i]).enumerate() {
                self.samplers[lane].start(choice.seed);
                self.load(lane, mesh.barycentre(choice.seed), LEVELS[choice.candidate.level], choice.frame);
            }
            let fits = self.chords.fit(&mut self.abreast, &DEGREES, [HIGHEST; LANES], 1);
            let noise = |lane: usize| four.get(lane).map_or(0.0, |&i| chosen[i].noise);
            let has_cyclide = four.iter().any(|&i| !chosen[i].candidate.is_polynomial());
            let cyclides = has_cyclide.then(|| self.cyclides.fit(&self.abreast, F4(std::array::from_fn(noise))));
            for (lane, &i) in four.iter().enumerate() {
                let Choice { seed, candidate: Candidate { level, model }, error, is_alike, .. } = chosen[i];
                let Some(frame) = self.abreast.frame(lane).filter(|_| fits.is_carried(lane)) else { continue };
                let (surface, variance, unit_variance) = match model.degree() {
                    Some(degree) => {
                        let degree = degree.min(fits.highest(lane));
                        let variance = fits.deviation_squared(lane, degree, &frame);
                        (
                            Surface::Chord(fits.surface(lane, degree, frame)),
                            variance,
                            fits.tensor_variance(lane, degree, &frame),
                        )
                    }
                    None => {
                        let Some(c) = cyclides.as_ref().and_then(|c| c.of(lane, frame)) else { continue };
                        (Surface::Implicit(c.surface), c.misfit, c.tensor_variance)
                    }
                };
                let around = chosen[i].noise.powi(2);
                let detail = unexplained(variance, around, level, 2.0 * spread(level, 0.0));
                let scatter = (unit_variance * around * (1.0 + detail)).sqrt();
                let error = error.max(scatter);
                let (centre, reach) = (mesh.barycentre(seed), REACH * surface.radius());
                self.samplers[lane].gather_within(centre, reach, 0);
                let reached = self.samplers[lane].faces_within(centre, reach);
                let faces = by_chunk(reached.filter(|&f| wanted[f as usize]).collect());
                let doubt = if is_alike { scatter } else { error };
                patches[i] = Some(Patch { centre, surface, reach, error, doubt, noise: variance.sqrt(), faces });
            }
        }
        patches.into_iter().flatten().collect()
    }
}

/// The standard error of a variance of samples, as a share of it, from a window and so many vertices around.
pub(super) fn spread(level: usize, around: f64) -> f64 {
    (2.0 / (LEVELS[level] as f64 + around)).sqrt()
}

/// What a fit to a window leaves of detail, in units of its variance from the noise alone: what is not explained bends
/// the fit as a whole, not sample by sample. A misfit that is greater than the noise by a share of `chance` tells
/// nothing.
pub(super) fn unexplained(misfit: f64, noise: f64, level: usize, chance: f64) -> f64 {
    (misfit / noise - (1.0 + chance)).max(0.0) * LEVELS[level] as f64 / CYCLIDE as f64
}

/// The nearest seeds among the faces a sampler has gathered, at most 16.
fn seeds_within(sampler: &Sampler<'_, Fans<'_>>, seed_of: &[u32], centre: DVec3, reach: f64) -> Vec<u32> {
    let mesh = sampler.ground().mesh;
    let mut near: Vec<(f64, u32)> = sampler
        .faces_within(centre, reach)
        .filter(|&f| seed_of[f as usize] != u32::MAX)
        .map(|f| (mesh.barycentre(Face(f)).distance_squared(centre), seed_of[f as usize]))
        .collect();
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(16).map(|n| n.1).collect()
}

impl Probe {
    pub(super) fn new(seed: Face, hopeless: f64) -> Self {
        let (levels, neighbours) = (Vec::new(), Vec::new());
        Probe { seed, levels, noise: f64::INFINITY, spacing: 0.0, neighbours, frame: None, goes_on: true, hopeless }
    }

    /// What it found.
    pub(super) fn at(&self, candidate: Candidate) -> &Found {
        self.levels.get(candidate.level).map_or(&Found::NONE, |level| &level[candidate.model as usize])
    }

    /// Levels that have been looked at.
    pub(super) fn levels(&self) -> usize {
        self.levels.len()
    }

    /// False where a larger window would be in vain.
    pub(super) fn may_go_on(&self) -> bool {
        self.goes_on
    }

    /// False where a fit was tried in vain, or is too large to be tried.
    pub(super) fn may_have(&self, candidate: Candidate) -> bool {
        if candidate.level < self.levels.len() { self.at(candidate).variance.is_finite() } else { self.goes_on }
    }

    /// Adds a level with its polynomials, and returns the variance of the samples about the one of the highest degree.
    fn add(&mut self, fits: &ChordFits, lane: usize, frame: LocalFrame, centre: DVec3) -> f64 {
        let mut level = [Found::NONE; Model::ALL.len()];
        let highest = fits.highest(lane);
        for (model, found) in Model::ALL.into_iter().zip(&mut level) {
            let Some(degree) = model.degree().filter(|&degree| degree <= highest) else { continue };
            if let Some((_, shape)) = fits.surface(lane, degree, frame).shape_at(centre) {
                let variance = fits.tensor_variance(lane, degree, &frame);
                *found = Found::of(shape.tensor, variance, fits.deviation_squared(lane, degree, &frame));
            }
        }
        self.levels.push(level);
        let deviation = fits.deviation_squared(lane, highest, &frame);
        self.noise = self.noise.min(deviation);
        deviation
    }

    /// Adds a cyclide to the last level; false where it has no shape at the centre.
    fn add_cyclide(&mut self, c: &Cyclide, centre: DVec3) -> bool {
        let (Some((_, shape)), Some(level)) = (c.surface.shape_at(centre), self.levels.last_mut()) else {
            return false;
        };
        level[Model::Cyclide as usize] = Found::of(shape.tensor, c.tensor_variance, c.misfit);
        true
    }
}

impl Found {
    const NONE: Found = Found { tensor: [f64::NAN; 6], variance: f64::INFINITY, misfit: f64::INFINITY };

    fn of(tensor: DMat3, variance: f64, misfit: f64) -> Self {
        let [x, y, z] = [tensor.x_axis, tensor.y_axis, tensor.z_axis];
        Found { tensor: [x.x, y.x, z.x, y.y, z.y, z.z], variance, misfit }
    }
}
