//! What keeps small windows from being explained: independent noise, noise that is alike at neighbouring
//! vertices as that of scanners is, or a surface that is rough at every scale.

use super::fans::Fans;
use super::lanes::LANES;
use super::lepski::SMOOTH;
use super::probe::{HOPELESS, POLYNOMIALS, Probe};
use super::scale::{is_fine, probe_all};
use super::steady::Steady;
use crate::mesh::Face;
use rayon::prelude::*;

/// Seeds that stand for all when the kind of surface is judged, and levels that are looked at.
const JUDGES: usize = 400;
const JUDGED: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Noise {
    /// What the samples are off by at one vertex says nothing of the next.
    Independent,
    /// Samples are off by the same over an edge or two, as in range images. Small windows follow it, so that what they
    /// leave is far less than the noise.
    Alike,
    /// Noise and detail at every scale from the edges up, as real scans have it. No window is then better than another by
    /// what the data say.
    Rough,
}

/// What the median of some seeds says. Only where all faces are wanted can noise be alike: elsewhere the detail of
/// clean parts looks the same.
pub(super) fn judge(fans: &Fans<'_>, seeds: &[Face], is_everywhere: bool) -> Noise {
    /// Noise in edges below which a surface is not rough.
    const LEAST_NOISE: f64 = 0.013;
    /// Least growth of the deviation from the first level to the fourth.
    const LEAST_GROWTH: f64 = 1.15;
    /// Growth of what the noise does not explain from the third level to the fourth, from which it is
    /// the detail of a smooth surface.
    const SMOOTH_GROWTH: f64 = 2.6;
    /// Least growth of the variance from the first level to the second by noise that is alike. Independent noise has up to
    /// 1.15 on small meshes, whose shape adds to it.
    const ALIKE_GROWTH: f64 = 1.2;
    if !is_fine(fans.ground.mesh) {
        return Noise::Independent;
    }
    let step = seeds.len().div_ceil(JUDGES).max(1);
    let none = vec![u32::MAX; fans.ground.mesh.face_count()];
    let mut probes: Vec<Probe> = seeds.iter().step_by(step).map(|&seed| Probe::new(seed, HOPELESS)).collect();
    probe_all(fans, probes.iter_mut().collect(), 0..JUDGED, &none, 0.0);
    let of_all = |of: &dyn Fn(&Probe) -> f64| median(probes.iter().map(of)).unwrap_or(0.0);
    let quartic = |level: usize| of_all(&|p| (p.at(level).misfits[1]).sqrt() / p.spacing);
    let cyclide = of_all(&|p| p.at(3).misfits[POLYNOMIALS].sqrt() / p.spacing);
    let (noise, second, third, fourth) = (quartic(0), quartic(1), quartic(2), quartic(3));
    let beyond = |deviation: f64| (deviation * deviation - noise * noise).max(0.0).sqrt();
    if noise >= LEAST_NOISE
        && fourth.min(cyclide) >= LEAST_GROWTH * noise
        && beyond(fourth) < SMOOTH_GROWTH * beyond(third)
    {
        return Noise::Rough;
    }
    let growth = (second / noise).powi(2);
    if is_everywhere && (ALIKE_GROWTH..SMOOTH).contains(&growth) { Noise::Alike } else { Noise::Independent }
}

/// Vertices in the window of a rough surface that turns by [`TURN`] over it: about six edges around.
pub(super) const WINDOW: usize = 120;
/// Radians from the middle of such a window to its rim, in the median.
const TURN: f64 = 0.8;

/// Vertices in every window of a rough surface. No scale stands out on it, but the more closely it was sampled, the less it
/// turns over a window of so many vertices. So windows are the wider the less it turns, and a scan of half as many faces
/// gets windows of nearly the same width.
pub(super) fn window(fans: &Fans<'_>, seeds: &[Face]) -> usize {
    /// Smaller windows show the noise, larger ones cost more than they tell.
    const LEAST: f64 = 48.0;
    const MOST: f64 = 400.0;
    // All seeds: some of them would depend on the order of faces, and all values on them.
    let turns: Vec<f64> = seeds
        .par_chunks(LANES)
        .map_init(|| Steady::new(fans), |steady, four| steady.around_faces(four, WINDOW))
        .flatten_iter()
        .flatten()
        .map(|value| {
            let k = value.shape.principal();
            value.radius * k.k_max.hypot(k.k_min)
        })
        .collect();
    let wider = median(turns).map_or(1.0, |turn| TURN / turn);
    (WINDOW as f64 * wider * wider).clamp(LEAST, MOST).round() as usize
}

/// The median of what is a finite number.
fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

impl Noise {
    /// Growth of the variance of samples from its least at which larger windows are not tried. Alike noise itself makes it
    /// grow.
    pub(super) fn hopeless(self) -> f64 {
        if self == Noise::Alike { 20.0 } else { HOPELESS }
    }

    /// How far a fit is by chance from one of more variance, squared: what is beyond is bias. `None` for one that has little
    /// more or cannot tell.
    pub(super) fn chance(self, witness: f64, variance: f64) -> Option<f64> {
        const LEAST: f64 = 1.15;
        // Small windows average less of alike noise than their variances say, and would pass it off as bias of far larger
        // ones.
        let reach = if self == Noise::Alike { 6.0 } else { 16.0 };
        // Large windows that all miss the surface are alike off. Far smaller ones can tell, if for their own variance they
        // can tell anything.
        const FAR: f64 = 5.0;
        match (self, witness <= reach * variance) {
            _ if witness < LEAST * variance => None,
            (_, true) => Some(witness - variance),
            (Noise::Alike, false) => None,
            (_, false) => Some(FAR * witness),
        }
    }
}

/// The variance of independent samples that would make fits differ as alike noise does. A quartic in the smallest
/// window has next to no bias: what separates it from others is its noise and their bias, so the least of it, in units of
/// what independent samples do, tells of the noise alone. `units` are the variances of the candidates for samples of
/// unit variance, infinite for those that are not asked; `between` tells how far two are apart, squared.
pub(super) fn alike(units: &[f64], between: impl Fn(usize, usize) -> f64) -> Option<f64> {
    /// The quartic in the smallest window.
    const FIRST: usize = 1;
    /// So much less variance others must have.
    const LESS: f64 = 3.0;
    /// How much more counts as noise than that shows: the smallest window moves with alike noise as one, and so differs
    /// less from others than they are off.
    const SMALL: f64 = 6.0;
    let others = (0..units.len()).filter(|&j| LESS * units[j] <= units[FIRST]);
    let apart = others.map(|j| between(FIRST, j) / (units[FIRST] - units[j])).filter(|v| v.is_finite());
    apart.min_by(f64::total_cmp).map(|least| SMALL * least)
}
