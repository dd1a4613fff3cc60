//! Large windows of a given radius: one serves the faces near its middle.
//!
//! What is seen over a radius changes little over a small share of it. A fit around every face would take time as the
//! square of the radius. Fits around places a share of the radius apart are blended over the faces there. The more
//! vertices a window has, the fewer windows there are, so the time does not grow with the radius.

use super::patches::{self, Blended, Patch, Surface, by_chunk};
use super::steady::{Fitted, Steady};
use crate::curvature::fit::around::samples::Sampler;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::cells::Cells;
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::ground::quantum::Quantum;
use crate::curvature::fit::ground::seeds::drawn;
use crate::curvature::vectors::four::LANES;
use crate::mesh::Face;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Radii from a face to the nearest place with a window, at most. Twice as many windows as for 0.25, and on a torus two
/// thirds of its error at the 95th percentile.
const SPACING: f64 = 0.18;
/// Radii from its middle up to which a window is blended: some nine windows at every face.
const REACH: f64 = 2.0 * SPACING;
/// Places that are fitted by one thread at a time.
const CHUNK: usize = 64;

/// Vertices in windows of given radii around some faces, about, from the least to the most.
fn vertices(ground: &Ground<'_>, radius: impl Fn(Face) -> Option<f64>) -> Vec<f64> {
    const LOOKS: usize = 1000;
    let mesh = ground.mesh;
    let faces = (0..mesh.face_count()).step_by(mesh.face_count().div_ceil(LOOKS)).map(|f| Face(f as u32));
    let vertices = |face: Face| {
        // A single face may be a sliver.
        let around = mesh.topology().corners(face).into_iter().flat_map(|v| ground.stars.of(v.0));
        let (count, area) = around.fold((0, 0.0), |(count, area), &f| (count + 1, area + mesh.area(Face(f))));
        // A vertex has two faces.
        let vertices = PI * radius(face)?.powi(2) * f64::from(count) / (2.0 * area);
        vertices.is_finite().then(|| vertices.min(mesh.positions().len() as f64))
    };
    let mut all: Vec<f64> = faces.filter(|&face| mesh.is_sound(face)).filter_map(vertices).collect();
    all.sort_unstable_by(f64::total_cmp);
    all
}

/// True where windows of given radii hold so many vertices, in the mean, that it pays to share them. Up to some 110 a
/// window around every face is faster, and on clean surfaces nearer to the truth further on too.
pub(in crate::curvature::fit) fn pays(ground: &Ground<'_>, radius: impl Fn(Face) -> Option<f64>) -> bool {
    const LEAST: f64 = 200.0;
    let all = vertices(ground, radius);
    all.iter().sum::<f64>() >= LEAST * all.len() as f64 && !all.is_empty()
}

/// What windows of given radii say about each face, with their coverage; `None` where none of them reaches it, and
/// where that of the place which covers it says nothing.
pub(in crate::curvature::fit) fn estimate(
    fans: &Fans<'_>,
    quantum: &Quantum,
    radius: impl Fn(Face) -> Option<f64> + Sync,
) -> Vec<Option<(Blended, f64)>> {
    /// A place also covers faces on the other side of a thin wall, but its window does not face them: they get places
    /// in the next pass. A few that face aside of all around are left after that.
    const PASSES: usize = 3;
    /// Cells in a window, at least. On a clean torus windows of 2,700 vertices are as near to the truth in 614 cells as
    /// without; in 140 the median error is 0.0029 of the curvature instead of 0.0017.
    const ENOUGH: f64 = 150.0;
    let ground = fans.ground;
    let count = ground.mesh.face_count();
    let vertices = vertices(ground, &radius);
    let median = vertices.get(vertices.len() / 2).copied().unwrap_or(0.0);
    let cells = Cells::new(fans, median / ENOUGH);
    let mut values = vec![None; count];
    let is_sound = |f: u32| ground.mesh.is_sound(Face(f));
    let mut is_left: Vec<bool> = (0..count as u32).map(is_sound).collect();
    for _ in 0..PASSES {
        let (places, covered_by) = places(fans, &is_left, &radius);
        if places.is_empty() {
            break;
        }
        let windows: Vec<Option<(Patch, f64)>> = places
            .par_chunks(CHUNK)
            .map_init(
                || WindowFitter::new(fans, cells.as_ref(), quantum),
                |surveyor, some| {
                    ground.work.advance_by(0.8, some.len(), places.len());
                    let fours = some.chunks(LANES);
                    fours.flat_map(|four| surveyor.windows(four, &is_left, &radius)).collect::<Vec<_>>()
                },
            )
            .flatten_iter()
            .collect();
        let coverages: Vec<Option<f64>> = windows.iter().map(|w| w.as_ref().map(|(_, coverage)| *coverage)).collect();
        let patches: Vec<Patch> = windows.into_iter().flatten().map(|(patch, _)| patch).collect();
        let blended = patches::blend(ground, &patches, count);
        for (f, blended) in blended.into_iter().enumerate() {
            if is_left[f] {
                values[f] = blended.zip(coverages[covered_by[f] as usize]);
                is_left[f] = values[f].is_none();
            }
        }
        // One that its own window does not reach is no place for another.
        places.iter().for_each(|(place, _)| is_left[place.index()] = false);
    }
    values
}

/// Fits windows to places; one per thread.
struct WindowFitter<'g> {
    quantum: &'g Quantum,
    of_cells: Option<Steady<'g, Cells<'g>>>,
    of_fans: Steady<'g, Fans<'g>>,
    sampler: Sampler<'g, Fans<'g>>,
}

impl<'g> WindowFitter<'g> {
    fn new(fans: &'g Fans<'g>, cells: Option<&'g Cells<'g>>, quantum: &'g Quantum) -> Self {
        let (of_cells, of_fans) = (cells.map(Steady::new), Steady::new(fans));
        WindowFitter { quantum, of_cells, of_fans, sampler: Sampler::new(fans) }
    }

    /// What windows around up to four places say, with their coverages.
    fn fitted(&mut self, places: &[(Face, f64)]) -> [Option<(Fitted, f64)>; LANES] {
        let WindowFitter { quantum, of_cells, of_fans, .. } = self;
        let Some(of_cells) = of_cells else { return of_fans.within(places, quantum) };
        let mut fitted = of_cells.within(places, quantum);
        // Where faces are large against the radius, cells are too few.
        for (fitted, place) in fitted.iter_mut().zip(places).filter(|(fitted, _)| fitted.is_none()) {
            [*fitted, ..] = of_fans.within(std::slice::from_ref(place), quantum);
        }
        fitted
    }

    /// The windows with the faces that they serve, and their coverages.
    fn windows(
        &mut self,
        places: &[(Face, f64)],
        is_left: &[bool],
        radius: impl Fn(Face) -> Option<f64>,
    ) -> Vec<Option<(Patch, f64)>> {
        let fitted = self.fitted(places);
        let window = |(&(place, own), fitted): (&(Face, f64), Option<(Fitted, f64)>)| {
            let (Fitted { surface, centre, noise, error, .. }, coverage) = fitted?;
            let reach = REACH * own;
            let serves = |f: &u32| is_left[*f as usize] && radius(Face(*f)).is_some_and(|other| are_alike(own, other));
            self.sampler.start(place);
            self.sampler.gather_within(centre, reach, 0);
            let faces = by_chunk(self.sampler.faces_within(centre, reach).filter(serves).collect());
            // All windows measure alike: the nearer one says more, whatever is left unexplained.
            Some((Patch { centre, surface: Surface::Chord(surface), reach, error, doubt: 1.0, noise, faces }, coverage))
        };
        places.iter().zip(fitted).map(window).collect()
    }
}

/// True for radii of faces that may share a window: what they would see apart differs by little more than what the
/// window itself leaves open.
fn are_alike(a: f64, b: f64) -> bool {
    const MOST: f64 = 1.25;
    a < MOST * b && b < MOST * a
}

/// Faces, each with its radius, so that one of them covers each face that is left: lies within [`SPACING`] of it and
/// has a radius alike; and for each face the number of the first one that does.
fn places(fans: &Fans<'_>, is_left: &[bool], radius: impl Fn(Face) -> Option<f64>) -> (Vec<(Face, f64)>, Vec<u32>) {
    const NONE: u32 = u32::MAX;
    let ground = fans.ground;
    let mut covered_by = vec![NONE; is_left.len()];
    let mut places = Vec::new();
    let mut sampler = Sampler::new(fans);
    for face in drawn(ground, is_left) {
        let Some(own) = radius(face).filter(|_| covered_by[face.index()] == NONE) else { continue };
        let number = places.len() as u32;
        places.push((face, own));
        if number.is_multiple_of(CHUNK as u32) {
            ground.work.advance(0);
        }
        let (centre, reach) = (ground.mesh.barycentre(face), SPACING * own);
        sampler.start(face);
        sampler.gather_within(centre, reach, 0);
        for f in sampler.faces_within(centre, reach) {
            if covered_by[f as usize] == NONE && radius(Face(f)).is_some_and(|other| are_alike(own, other)) {
                covered_by[f as usize] = number;
            }
        }
        covered_by[face.index()] = number;
    }
    (places, covered_by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::ground::quantum::quantum;
    use crate::curvature::fit::ground::work::Work;
    use crate::progress::NoProgress;
    use crate::synth::{Grid, Surface};
    use crate::{Mesh, MeshOptions, Soup};

    /// Windows of a radius around places, and how far their curvatures are from those of every face's own window, in
    /// units of one over the radius, at most.
    fn compared(soup: &Soup, radius: f64) -> (usize, f64) {
        let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        let quantum = quantum(&mesh, ground.width);
        assert!(pays(&ground, |_| Some(radius)));
        let (places, _) = places(&fans, &vec![true; mesh.face_count()], |_| Some(radius));
        let mut steady = Steady::new(&fans);
        let mut most = 0.0_f64;
        for (f, shared) in estimate(&fans, &quantum, |_| Some(radius)).into_iter().enumerate().step_by(7) {
            let (shared, coverage) = shared.expect("a value for every face");
            let [own, ..] = steady.within(&[(Face(f as u32), radius)], &quantum);
            let (own, own_coverage) = own.expect("a window");
            let (a, b) = (shared.shape.principal(), own.value().expect("a value").shape.principal());
            most = most.max(radius * (a.k_max - b.k_max).abs()).max(radius * (a.k_min - b.k_min).abs());
            assert!((shared.radius - radius).abs() < 0.1 * radius && (coverage - own_coverage).abs() < 0.1, "{f}");
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

    /// Coarse faces have windows that fine ones lie in, but theirs are far smaller.
    #[test]
    fn faces_of_other_sizes_keep_to_their_own_scale() {
        let soup = Grid { jitter: 0.2, ..Grid::new(Surface::Wave, 80, 80) }.build().soup;
        let crowded: Vec<[f64; 3]> = (0..soup.positions.len())
            .map(|v| {
                let glam::DVec3 { x, y, .. } = soup.positions.get(v);
                let x = if x > 0.0 { x } else { 0.2 * x };
                [x, y, 0.3 * (3.0 * x).sin() * (2.0 * y).cos()]
            })
            .collect();
        let soup = Soup::new(crate::Positions::F64(crowded), soup.triangles);
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        let quantum = quantum(&mesh, ground.width);
        let radius = |face: Face| Some(10.0 * mesh.area(face).sqrt());
        let mut steady = Steady::new(&fans);
        let mut compared = 0;
        for (f, shared) in estimate(&fans, &quantum, radius).into_iter().enumerate() {
            let Some((shared, coverage)) = shared else { continue };
            let own = radius(Face(f as u32)).expect("a radius");
            assert!((0.7..1.4).contains(&(shared.radius / own)), "{f}: {} for {own}", shared.radius);
            let [fitted, ..] = steady.within(&[(Face(f as u32), own)], &quantum);
            // Windows at the border have less than all of it.
            assert!(fitted.is_some_and(|(_, own)| (own - coverage).abs() < 0.25), "{f}: {coverage}");
            compared += 1;
        }
        assert!(2 * compared > mesh.face_count(), "{compared}");
    }

    /// Most faces have few others within the radius, some have very many.
    #[test]
    fn sharing_is_decided_by_the_work_that_it_spares() {
        let graded = |fine: usize| {
            let crowd = |t: f64| if t < 0.0 { t } else { t.powi(6) };
            let soup = Grid::new(Surface::Plane, fine, fine).build().soup;
            let points = (0..soup.positions.len()).map(|v| {
                let glam::DVec3 { x, y, .. } = soup.positions.get(v);
                [crowd(x), crowd(y), 0.0]
            });
            Soup::new(crate::Positions::F64(points.collect()), soup.triangles)
        };
        let pays_on = |soup: &Soup, radius: f64| {
            let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
            let work = Work::new(&NoProgress, 0);
            pays(&Ground::new(&mesh, false, &work), |_| Some(radius))
        };
        assert!(pays_on(&graded(100), 0.1));
        assert!(!pays_on(&Grid::new(Surface::Plane, 100, 100).build().soup, 0.1));
    }

    /// A needle's plane says nothing of what lies around it.
    #[test]
    fn a_needle_makes_nothing_flat() {
        let torus = Surface::Torus { major: 3.0, minor: 1.0 };
        let mut soup = Grid { jitter: 0.3, ..Grid::with_faces(torus, 20_000, 1.0) }.build().soup;
        let mut points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
        // A side of one face in seventy is given a third point, nearly on it.
        for f in (0..soup.triangles.len()).step_by(70) {
            let [a, b, c] = soup.triangles[f];
            let [p, q, r] = [a, b, c].map(|v| glam::DVec3::from(points[v as usize]));
            points.push((0.5 * (p + q) + 1e-13 * (r - p)).to_array());
            let middle = points.len() as u32 - 1;
            soup.triangles[f] = [a, middle, c];
            soup.triangles.extend([[middle, b, c], [a, b, middle]]);
        }
        let soup = Soup::new(crate::Positions::F64(points), soup.triangles);
        let mesh = Mesh::from_soup(&soup, &MeshOptions { feature_angle: 180.0, ..MeshOptions::default() });
        let mesh = mesh.expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        let values = estimate(&fans, &quantum(&mesh, ground.width), |_| Some(1.0));
        let k_max = values.iter().flatten().map(|(value, _)| value.shape.principal().k_max);
        let least = k_max.fold(f64::INFINITY, f64::min);
        assert!(least > 0.9, "{least}");
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
