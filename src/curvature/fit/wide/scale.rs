//! The window for a noisy place: as large as the surface lets it be.
//!
//! Around each seed, surfaces are fitted to nested windows ([`probe`](super::probe)), the larger ones around some of
//! the seeds only; [`lepski`](super::lepski) chooses among them, and patches are laid where they are chosen.

use super::kind::Noise;
use super::lepski::choose;
use super::patches::{self, Blended, Patch};
use super::probe::{Choice, LEVELS, Probe, Prober};
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::ground::seeds::tiers;
use crate::curvature::vectors::four::LANES;
use crate::mesh::Face;
use rayon::prelude::*;
use std::ops::Range;

const CHUNK: usize = 64;
/// Levels at which all seeds are looked at; each one further up, six of ten of those before.
const SPARSE: usize = 2;
/// The same where windows of no more than level [`DENSE_UP_TO`] are chosen: what they say changes from place to place.
const DENSE: usize = 4;
const DENSE_UP_TO: usize = 5;

/// Values for the faces that are `wanted`, from patches around `seeds`; `None` where the surface turns
/// out smooth or no patch reaches.
pub(in crate::curvature::fit) fn estimate(
    fans: &Fans<'_>,
    seeds: &[Face],
    wanted: &[bool],
    kind: Noise,
) -> Vec<Option<Blended>> {
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
    let is_dense: Vec<bool> =
        choices.iter().map(|c| c.as_ref().is_some_and(|c| c.candidate.level <= DENSE_UP_TO)).collect();
    probe_more(fans, &mut probes, &seed_of, |i| if is_dense[i] { DENSE + tiers[i] } else { 0 });
    choose_all(fans, &probes, kind, &mut choices);
    // Patches lie about as close as windows of their size.
    let stays =
        |i: usize, choice: &Choice| choice.candidate.level <= tiers[i] + if is_dense[i] { DENSE - 1 } else { SPARSE };
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
    patches::blend(ground, &patches, wanted.len())
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
