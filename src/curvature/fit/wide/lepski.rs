//! The choice among windows of nested sizes, by Lepski's rule.
//!
//! Variances follow from the noise and the fits. The bias of a fit is bounded by how far it is from less biased ones
//! beyond what the variances and the bias of those explain. The least sum of both wins. Where variances are not known,
//! since noise is alike at neighbouring samples, the fit wins that is nearest to one in a smaller window. All
//! statistics are means over neighbouring seeds.

use super::kind::{Noise, SMOOTH};
use super::probe::{ByCandidate, Candidate, Choice, FIRST_CYCLIDE, Found, LEVELS, Model, Probe, spread, unexplained};

/// Vertices that the windows of the seeds around hold beyond those of one.
const AROUND: f64 = 100.0;

/// What the seeds around one found.
struct Around<'p> {
    probe: &'p Probe,
    /// Itself among them.
    probes: Vec<&'p Probe>,
    /// Those that have been looked at with windows of a level.
    looked: [Vec<&'p Probe>; LEVELS.len()],
    /// Variances of the tensors for samples of unit variance.
    unit: ByCandidate<f64>,
    /// Variances of the samples.
    misfit: ByCandidate<f64>,
}

/// The choice for a seed, or none where the surface is smooth.
pub(super) fn choose(probe: &Probe, probes: &[Probe], kind: Noise) -> Option<Choice> {
    let around = Around::new(probe, probes);
    let quartic = |p: &Probe, level: usize| p.at(Candidate { level, model: Model::Quartic }).misfit;
    if mean(&around.probes, |p| (quartic(p, 1) / quartic(p, 0)).ln()).exp() > SMOOTH {
        return None;
    }
    if kind == Noise::Alike { around.nearest_to_witness() } else { around.least_risk(kind) }
}

impl<'p> Around<'p> {
    fn new(probe: &'p Probe, probes: &'p [Probe]) -> Self {
        let around: Vec<&Probe> = probe.neighbours.iter().map(|&i| &probes[i as usize]).collect();
        let looked: [Vec<&Probe>; LEVELS.len()] =
            std::array::from_fn(|level| around.iter().copied().filter(|p| p.levels() > level).collect());
        let of_all = |of: &dyn Fn(&Found) -> f64| ByCandidate::of(|j| mean(&looked[j.level], |p| of(p.at(j))));
        let unit = of_all(&|found| found.variance);
        let misfit = of_all(&|found| found.misfit);
        Around { probe, probes: around, looked, unit, misfit }
    }

    fn is_there(&self, j: Candidate) -> bool {
        self.unit[j].is_finite() && self.probe.may_have(j)
    }

    /// A cyclide is believed where it explains its window better than a polynomial does.
    fn is_believed(&self, j: Candidate) -> bool {
        j.is_polynomial() || self.misfit[j] < self.misfit[j.quartic()]
    }

    /// The mean of a function of the squared distance of two candidates.
    fn between(&self, i: Candidate, j: Candidate, of: impl Fn(f64) -> f64) -> f64 {
        let looked = &self.looked[i.level.max(j.level)];
        mean(looked, |p| of(distance_squared(&p.at(i).tensor, &p.at(j).tensor)))
    }

    fn choice(&self, candidate: Candidate, risk: f64, noise: f64, is_alike: bool) -> Choice {
        let Probe { seed, frame, .. } = *self.probe;
        Choice { seed, candidate, error: risk.sqrt(), noise: noise.sqrt(), is_alike, frame }
    }

    /// Where noise is alike at neighbouring samples, neither misfits nor covariances tell how much a fit is off by. But
    /// while noise prevails fits come nearer to each other from window to window, and where windows miss the surface
    /// they part again. So the choice is the candidate that is nearest to its witness.
    fn nearest_to_witness(&self) -> Option<Choice> {
        let apart = |j: Candidate| {
            // Not of squares: some seeds lie where fits are far off.
            let apart = self.between(j.witness()?, j, f64::sqrt);
            apart.is_finite().then_some((apart, j))
        };
        let candidates = Candidate::all().filter(|&j| self.is_there(j) && self.is_believed(j));
        let (apart, at) = candidates.filter_map(apart).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.choice(at, apart * apart, self.misfit[at], true))
    }

    /// The least sum of variance and bias, where noise is independent from sample to sample.
    fn least_risk(&self, kind: Noise) -> Option<Choice> {
        let Around { unit, misfit, .. } = self;
        // Samples of neighbouring seeds tell of one noise where all are noisy.
        let is_pooled = kind == Noise::Independent;
        // The least variance of samples about any fit, as large as it may be but for chance. The least one around each
        // seed is less than the noise: chance picks it. Cyclides in small windows leave less than the noise, too.
        let pooled = Candidate::all()
            .filter(|&j| self.is_there(j) && (j.is_polynomial() || j.level > FIRST_CYCLIDE))
            .map(|j| misfit[j] * (1.0 + spread(j.level, AROUND)))
            .fold(f64::INFINITY, f64::min);
        let noise = if is_pooled { pooled } else { mean(&self.probes, |p| p.noise) };
        let variance = ByCandidate::of(|j| noise * unit[j]);
        let detail = |j: Candidate| {
            let chance = if is_pooled { spread(j.level, AROUND) } else { 2.0 * spread(j.level, 0.0) };
            unexplained(misfit[j], noise, j.level, chance)
        };
        // Only polynomials that explain their window bear witness to the bias of others.
        let is_witness =
            ByCandidate::of(|i| i.is_polynomial() && self.is_there(i) && (i.level < 2 || detail(i) == 0.0));

        // From the largest variance to the least, so that the bias of witnesses is known before they are asked.
        let is_asked = |j: Candidate| self.is_there(j) && (self.is_believed(j) || is_witness[j]);
        let mut order: Vec<Candidate> = Candidate::all().filter(|&j| is_asked(j)).collect();
        order.sort_by(|&i, &j| variance[j].total_cmp(&variance[i]));
        let mut biases = ByCandidate::of(|_| 0.0_f64);
        let mut best: Option<(f64, Candidate)> = None;
        for &j in &order {
            for &i in order.iter().filter(|&&i| is_witness[i]) {
                if let Some(chance) = kind.chance(variance[i], variance[j]) {
                    // What a witness itself is off by is not the other's fault. But detail passes for bias, and would
                    // silence all witnesses.
                    let own = if is_pooled { biases[i] } else { 0.0 };
                    biases[j] = biases[j].max(self.between(i, j, |square| square) - chance - own);
                }
            }
            let risk = variance[j] * (1.0 + detail(j)) + biases[j];
            if self.is_believed(j) && risk < best.map_or(f64::INFINITY, |best| best.0) {
                best = Some((risk, j));
            }
        }
        best.map(|(risk, at)| self.choice(at, risk, noise, false))
    }
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
