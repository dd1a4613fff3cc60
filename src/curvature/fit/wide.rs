//! Windows of a given radius that hold many vertices: shared by the faces about their middles.
//!
//! What is seen over a radius changes little over a small share of it. A fit around every face would take time as the
//! square of the radius. Fits around places a share of the radius apart, blended over the faces there, take the same time
//! at any radius: as many more vertices as each of them has, as many fewer are they.

use super::fans::Fans;
use super::lanes::LANES;
use super::patches::{self, Blended, Patch, Surface, by_chunk};
use super::quantum::Quantum;
use super::samples::Sampler;
use super::seeds::drawn;
use super::steady::{Fitted, Steady};
use crate::mesh::{Face, FaceState, Mesh};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Radii from a face to the nearest place around which a window lies, at most, and between two such places, at least.
const SPACING: f64 = 0.18;
/// Radii from its middle up to which a window is blended.
const REACH: f64 = 0.36;
/// Places that are fitted by one thread at a time.
const CHUNK: usize = 64;

/// True where windows of given radii hold so many vertices that it pays to share them.
pub(super) fn pays(mesh: &Mesh, radius: impl Fn(Face) -> Option<f64>) -> bool {
    /// Vertices in a window, in the median over some faces.
    const LEAST: f64 = 200.0;
    const LOOKS: usize = 1000;
    let faces = (0..mesh.face_count()).step_by(mesh.face_count().div_ceil(LOOKS)).map(|f| Face(f as u32));
    let sound = faces.filter(|&face| mesh.face_state(face) == FaceState::Sound);
    // A vertex has two faces.
    let vertices = |face: Face| Some(PI * radius(face)?.powi(2) / (2.0 * mesh.area(face)));
    let mut counts: Vec<f64> = sound.filter_map(vertices).collect();
    counts.sort_unstable_by(f64::total_cmp);
    let typical = counts.get(counts.len() / 2).copied().unwrap_or(0.0);
    typical.min(mesh.positions().len() as f64) >= LEAST
}

/// What windows of given radii say about each face, with their coverage; `None` where none of them reaches it.
pub(super) fn estimate(
    fans: &Fans<'_>,
    quantum: &Quantum,
    radius: impl Fn(Face) -> Option<f64> + Sync,
) -> Vec<Option<(Blended, f64)>> {
    /// The other side of a thin wall is nearer than the way around its rim is short: it needs windows of its own.
    const PASSES: usize = 4;
    let ground = fans.ground;
    let count = ground.mesh.face_count();
    let mut values = vec![None; count];
    let is_sound = |f: u32| ground.mesh.face_state(Face(f)) == FaceState::Sound;
    let mut is_left: Vec<bool> = (0..count as u32).map(is_sound).collect();
    for _ in 0..PASSES {
        let (places, nearest) = spread(fans, &is_left, &radius);
        if places.is_empty() {
            break;
        }
        let fitted: Vec<Option<(Fitted, Patch)>> = places
            .par_chunks(CHUNK)
            .map_init(
                || Steady::new(fans),
                |steady, some| {
                    ground.work.advance_by(0.8, some.len(), places.len());
                    some.chunks(LANES).flat_map(|four| shared(steady, four, quantum, &is_left)).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect();
        let coverages: Vec<f64> =
            fitted.iter().map(|f| f.as_ref().map_or(0.0, |(fitted, _)| fitted.coverage)).collect();
        let patches: Vec<Patch> = fitted.into_iter().flatten().map(|(_, patch)| patch).collect();
        let blended = patches::blend(ground, &patches, count);
        for (f, blended) in blended.into_iter().enumerate().filter(|(f, _)| is_left[*f]) {
            values[f] = blended.map(|blended| (blended, coverages[nearest[f] as usize]));
        }
        is_left.iter_mut().zip(&values).for_each(|(is_left, value)| *is_left &= value.is_none());
    }
    values
}

/// Windows around up to four places, and what they reach of the faces that are left.
fn shared<'a>(
    steady: &mut Steady<'_>,
    places: &'a [(Face, f64)],
    quantum: &Quantum,
    is_left: &[bool],
) -> impl Iterator<Item = Option<(Fitted, Patch)>> + use<'a> {
    let fitted = steady.within(places, quantum);
    let patches: Vec<Option<(Fitted, Patch)>> = places
        .iter()
        .enumerate()
        .map(|(lane, &(_, radius))| {
            let Fitted { surface, centre, noise, error, .. } = fitted[lane]?;
            let reach = REACH * radius;
            let faces = steady.gathered_within(lane, centre, reach).filter(|&f| is_left[f as usize]);
            let faces = by_chunk(faces.collect());
            // All windows measure alike: the nearer one says more, whatever is left unexplained.
            let patch = Patch { centre, surface: Surface::Chord(surface), reach, error, doubt: 1.0, noise, faces };
            Some((fitted[lane]?, patch))
        })
        .collect();
    patches.into_iter()
}

/// Faces, each with its radius, of which one lies within [`SPACING`] of every face that is left; and for each face the
/// number of the one it was nearest to when that was chosen.
fn spread(fans: &Fans<'_>, is_left: &[bool], radius: impl Fn(Face) -> Option<f64>) -> (Vec<(Face, f64)>, Vec<u32>) {
    const NONE: u32 = u32::MAX;
    /// Windows may be shared by faces whose own ones would be smaller or larger by this.
    const ALIKE: f64 = 1.25;
    let ground = fans.ground;
    let mut nearest = vec![NONE; is_left.len()];
    let mut places = Vec::new();
    let mut sampler = Sampler::new(fans);
    for face in drawn(ground, is_left) {
        let Some(own) = radius(face).filter(|_| nearest[face.index()] == NONE) else { continue };
        let number = places.len() as u32;
        places.push((face, own));
        if number.is_multiple_of(CHUNK as u32) {
            ground.work.advance(0);
        }
        let (centre, reach) = (ground.mesh.barycentre(face), SPACING * own);
        sampler.start(face);
        sampler.gather_within(centre, reach, 0);
        for f in sampler.faces_within(centre, reach) {
            let is_alike = |other: f64| other < ALIKE * own && own < ALIKE * other;
            if nearest[f as usize] == NONE && radius(Face(f)).is_some_and(is_alike) {
                nearest[f as usize] = number;
            }
        }
        nearest[face.index()] = number;
    }
    (places, nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::ground::Ground;
    use crate::curvature::fit::quantum::quantum;
    use crate::curvature::fit::work::Work;
    use crate::progress::NoProgress;
    use crate::synth::{Grid, Surface};
    use crate::{MeshOptions, Soup};

    /// Windows of a radius around places, and how far their curvatures are from those of every face's own window, in
    /// units of one over the radius, at most.
    fn compared(soup: &Soup, radius: f64) -> (usize, f64) {
        let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        let quantum = quantum(&mesh, ground.width);
        assert!(pays(&mesh, |_| Some(radius)));
        let (places, _) = spread(&fans, &vec![true; mesh.face_count()], |_| Some(radius));
        let mut steady = Steady::new(&fans);
        let mut most = 0.0_f64;
        for (f, shared) in estimate(&fans, &quantum, |_| Some(radius)).into_iter().enumerate().step_by(7) {
            let (shared, coverage) = shared.expect("a value for every face");
            let [own, ..] = steady.within(&[(Face(f as u32), radius)], &quantum);
            let own = own.expect("a window");
            let (a, b) = (shared.shape.principal(), own.value().expect("a value").shape.principal());
            most = most.max(radius * (a.k_max - b.k_max).abs()).max(radius * (a.k_min - b.k_min).abs());
            assert!((shared.radius - radius).abs() < 0.1 * radius && (coverage - own.coverage).abs() < 0.1, "{f}");
        }
        (places.len(), most)
    }

    #[test]
    fn shared_windows_say_what_own_ones_do() {
        let torus = Surface::Torus { major: 3.0, minor: 1.0 };
        let soup = Grid { jitter: 0.3, ..Grid::with_faces(torus, 20_000, 1.0) }.build().soup;
        for radius in [0.9, 1.3] {
            let (places, most) = compared(&soup, radius);
            assert!(most < 0.04, "{radius}: {most}");
            // As many as fit onto the torus.
            assert!((places as f64) < 12.0 * PI * PI / (0.18 * radius).powi(2), "{radius}: {places}");
        }
    }

    #[test]
    fn both_sides_of_a_thin_wall_get_values() {
        // A flattened torus: the way around its rims is longer than that through the wall.
        let torus = Surface::Torus { major: 3.0, minor: 1.0 };
        let round = Grid::with_faces(torus, 20_000, 1.0).build().soup;
        let flattened =
            (0..round.positions.len()).map(|v| (round.positions.get(v) * glam::DVec3::new(1.0, 1.0, 0.02)).to_array());
        let soup = Soup::new(crate::Positions::F64(flattened.collect()), round.triangles);
        let mesh =
            Mesh::from_soup(&soup, &MeshOptions { feature_angle: 180.0, ..MeshOptions::default() }).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        let values = estimate(&fans, &quantum(&mesh, ground.width), |_| Some(1.0));
        let missing = values.iter().filter(|value| value.is_none()).count();
        assert!(100 * missing < values.len(), "{missing}");
    }
}
