//! What keeps small windows from being explained: independent noise, noise that is alike at neighbouring
//! vertices as that of scanners is, or a surface that is rough at every scale.

use super::kind::{Noise, SMOOTH};
use super::probe::{Candidate, HOPELESS, Model, Probe};
use super::scale::probe_all;
use super::steady::Steady;
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::ground::seeds::scattered;
use crate::curvature::vectors::four::LANES;
use crate::mesh::{Face, Mesh};
use rayon::prelude::*;

/// Seeds that stand for all when the kind of surface is judged, and levels that are looked at.
const JUDGES: usize = 400;
const JUDGED: usize = 4;

/// What the median of some seeds says. Only where all faces are wanted can noise be alike: elsewhere the detail of
/// clean parts looks the same.
pub(in crate::curvature::fit) fn judge(fans: &Fans<'_>, seeds: &[Face], is_widespread: bool) -> Noise {
    /// Noise in edges below which a surface is not rough.
    const LEAST_NOISE: f64 = 0.013;
    /// Least growth of the deviation from the first level to the fourth.
    const LEAST_GROWTH: f64 = 1.15;
    /// Growth of what the noise does not explain from the third level to the fourth, from which it is
    /// the detail of a smooth surface.
    const SMOOTH_GROWTH: f64 = 2.6;
    /// Least growth of the deviation from the first level to the fourth by noise that is alike: it has 1.9 and more,
    /// independent noise up to 1.2.
    const ALIKE_GROWTH: f64 = 1.5;
    let other = if is_widespread { Noise::Independent } else { Noise::Local };
    if !is_fine(fans.ground.mesh) {
        return other;
    }
    let step = seeds.len().div_ceil(JUDGES).max(1);
    let none = vec![u32::MAX; fans.ground.mesh.face_count()];
    let mut probes: Vec<Probe> = seeds.iter().step_by(step).map(|&seed| Probe::new(seed, HOPELESS)).collect();
    probe_all(fans, probes.iter_mut().collect(), 0..JUDGED, &none, 0.0);
    let of_all = |of: &dyn Fn(&Probe) -> f64| median(probes.iter().map(of)).unwrap_or(0.0);
    let deviation = |level, model| of_all(&|p| p.at(Candidate { level, model }).misfit.sqrt() / p.spacing);
    let [noise, second, third, fourth]: [f64; JUDGED] = std::array::from_fn(|level| deviation(level, Model::Quartic));
    let cyclide = deviation(JUDGED - 1, Model::Cyclide);
    // Detail that a cyclide explains is the surface's.
    let second = second.min(cyclide);
    let beyond = |deviation: f64| (deviation * deviation - noise * noise).max(0.0).sqrt();
    if noise >= LEAST_NOISE
        && fourth.min(cyclide) >= LEAST_GROWTH * noise
        && beyond(fourth) < SMOOTH_GROWTH * beyond(third)
    {
        return Noise::Rough;
    }
    let is_smooth = (second / noise).powi(2) >= SMOOTH;
    let is_alike = is_widespread && !is_smooth && fourth.min(cyclide) >= ALIKE_GROWTH * noise;
    if is_alike { Noise::Alike } else { other }
}

/// Vertices in the window of a rough surface that turns by [`TURN`] over it: about six edges around.
pub(super) const WINDOW: usize = 120;
/// Radians from the middle of such a window to its rim, in the median.
const TURN: f64 = 0.8;

/// True for meshes with enough vertices to tell noise from shape. On a coarse model a window would be half of it, and
/// sharp edges are meant.
pub(in crate::curvature::fit) fn is_fine(mesh: &Mesh) -> bool {
    /// Windows that a surface must hold.
    const LEAST_WINDOWS: usize = 20;
    mesh.positions().len() >= LEAST_WINDOWS * WINDOW
}

/// Vertices in every window of the `wanted` faces, which are rough. No scale stands out on it, but the more closely it
/// was sampled, the less it turns over a window of so many vertices. So windows are the wider the less it turns, and a
/// scan of half as many faces gets windows of nearly the same width.
pub(in crate::curvature::fit) fn window(fans: &Fans<'_>, wanted: &[bool]) -> usize {
    /// Smaller windows show the noise.
    const LEAST: f64 = 48.0;
    /// Where nothing turns, windows would have no end.
    const MOST: f64 = 10_000.0;
    /// Places that are looked at.
    const LOOKS: usize = 5000;
    let turns: Vec<f64> = scattered(fans.ground, wanted, LOOKS)
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
pub(super) fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
