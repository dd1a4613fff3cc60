//! What keeps small windows from being explained: independent noise, noise that is alike at neighbouring
//! vertices as that of scanners is, or a surface that is rough at every scale.

use super::fans::Fans;
use super::probe::{HOPELESS, MODELS, POLYNOMIALS, Probe};
use super::scale::{SMOOTH, is_fine, probe_all};
use crate::mesh::Face;

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
    let median = |of: &dyn Fn(&Probe) -> f64| {
        let mut values: Vec<f64> = probes.iter().map(of).filter(|v| v.is_finite()).collect();
        values.sort_unstable_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let quartic = |level: usize| median(&|p| (p.at(level).misfits[1]).sqrt() / p.spacing);
    let cyclide = median(&|p| p.at(3).misfits[POLYNOMIALS].sqrt() / p.spacing);
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

impl Noise {
    /// Growth of the variance of samples from its least at which larger windows are not tried. Alike noise itself makes it
    /// grow.
    pub(super) fn hopeless(self) -> f64 {
        if self == Noise::Alike { 20.0 } else { HOPELESS }
    }

    /// How many times the variance of a fit those have at most that bear witness to its bias. Small windows
    /// average less of alike noise than their variances say, and would pass it off as bias of far larger ones.
    pub(super) fn reach(self) -> f64 {
        if self == Noise::Alike { 6.0 } else { 16.0 }
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
    /// The smallest window averages alike noise less than others do: it moves as one there.
    const SMALL: f64 = 6.0;
    debug_assert!(FIRST < MODELS && units.len() % MODELS == 0);
    let others = (0..units.len()).filter(|&j| LESS * units[j] <= units[FIRST]);
    let apart = others.map(|j| between(FIRST, j) / (units[FIRST] - units[j])).filter(|v| v.is_finite());
    apart.min_by(f64::total_cmp).map(|least| SMALL * least)
}
