//! Long facets side by side, as CAD programs cover cylinders, cones and fillets.
//!
//! Rings around a long facet hold mostly what lies beyond its short sides: on a part with fine corners, the corners.
//! What lies beside it, over its long sides, tells how the surface bends there. So here windows are runs of facets
//! that share long edges. Near a jump of curvature, where a fillet runs out into a flat, the run that lies
//! on one side of it explains itself best, as in [`super::one_sided`].
//!
//! Where facets lie in one plane with their neighbours along a fold, as those of a fillet do that is meshed evenly, all of
//! them together are like one long facet, and rows go across the folds.

use super::first::{Quality, Reading, Surveyor};
use crate::curvature::fit::around::rulings::{Folds, NO_FOLD, rulings};
use crate::curvature::fit::around::window::StripWindow;
use crate::curvature::fit::ground::normals::scaled_normal;
use crate::curvature::fit::surface::polynomial::PLANE;
use crate::curvature::vectors::four::LANES;
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::DVec3;
use std::ops::Range;

/// A facet is long where its shortest side is less than this share of its longest, and slender with less than that.
const LONG: f64 = 0.5;
const SLENDER: f64 = 0.25;
/// Facets of one surface are alike: a strip ends before a facet so many times as wide as the one before it, or the
/// reverse.
const ALIKE: f64 = 3.0;
/// Facets looked at on either side, as triangles.
const REACH: usize = 12;
/// Least numbers of triangles in the windows that are tried, one after the other. Six in cells of two have four
/// straight folds, and nine that alternate have eleven corners: fewer would be explained by any cylinder.
const PAIRED: [usize; 2] = [12, 6];
const ALTERNATING: [usize; 2] = [12, 9];
/// A strip must promise an error this much less than the window around the face does.
const BETTER: f64 = 0.1;
/// A window around the face that promises an error below this share of the curvature is good enough.
const GOOD: f64 = 1e-5;
/// Curvature along a strip, in shares of that across, from which it is more than a strip.
const BENT: f64 = 0.1;

/// Facets in a row, each beside the next over a long edge.
struct Strip {
    faces: Vec<Face>,
    /// The edge from each facet to the next.
    between: Vec<HalfEdge>,
    /// Where cells of coplanar facets begin, and the end of the last.
    bounds: Vec<usize>,
    /// The cell of the facet the strip was laid around.
    middle: usize,
}

/// What a run says, and how it compares with others.
struct Scored {
    /// Least first: whether it jumps, the power of ten of its error, how far aside it lies, its error.
    key: [f64; 4],
    reading: Reading,
}

impl Scored {
    /// False where the run reaches over a jump.
    fn is_on_one_side(&self) -> bool {
        self.key[0] == 0.0
    }
}

/// The two long edges of a sound facet whose shortest side is less than a share of its longest.
fn long_edges(mesh: &Mesh, face: Face, share: f64) -> Option<[HalfEdge; 2]> {
    if !mesh.is_sound(face) {
        return None;
    }
    let topology = mesh.topology();
    let length = |h: HalfEdge| mesh.position(topology.origin(h)).distance_squared(mesh.position(topology.target(h)));
    let mut sides = face.half_edges().map(|h| (length(h), h));
    sides.sort_by(|a, b| a.0.total_cmp(&b.0));
    (sides[0].0 < share * share * sides[2].0).then_some([sides[1].1, sides[2].1])
}

/// The edges over which a row goes on from a facet that lies in one plane with those over two of its sides: the side
/// where the surface folds, and that of the two by which the row came, or the longer. All the facets in the plane are
/// like one that is long: the surface does not bend along the fold.
fn ruled_edges(mesh: &Mesh, face: Face, entered: Option<HalfEdge>) -> Option<[HalfEdge; 2]> {
    if !mesh.is_sound(face) {
        return None;
    }
    let normal = mesh.normal(face);
    let mut sides = [(0.0, HalfEdge(0)); 3];
    for (side, h) in sides.iter_mut().zip(face.half_edges()) {
        let twin = mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner)?;
        *side = (normal.cross(mesh.normal(twin.face())).length(), h);
    }
    sides.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(_, a), (most, b), (sine, fold)] = sides;
    let longer = || if mesh.height(a) < mesh.height(b) { a } else { b };
    let over = entered.filter(|h| [a, b].contains(h)).unwrap_or_else(longer);
    (most < NO_FOLD * sine).then_some([over, fold])
}

/// How a row goes on from facet to facet.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Across the folds between flat cells, and over long edges where there are none.
    Ruled,
    /// Over long edges.
    Long,
}

impl Way {
    /// The edges over which a row goes on from a facet; `entered` is that by which it came.
    fn edges(self, mesh: &Mesh, face: Face, entered: Option<HalfEdge>) -> Option<[HalfEdge; 2]> {
        let ruled = if self == Way::Ruled { ruled_edges(mesh, face, entered) } else { None };
        ruled.or_else(|| long_edges(mesh, face, LONG))
    }
}

fn is_long(mesh: &Mesh, face: Face) -> bool {
    long_edges(mesh, face, LONG).is_some()
}

/// True where a face's window is explained by many terms, but says little: where facets lie in one plane along the folds,
/// it holds only some six lines, and as many terms explain any six. (Long ones have windows of many lines.)
pub(in crate::curvature::fit) fn is_explained_by_chance(mesh: &Mesh, face: Face, quality: &Quality) -> bool {
    quality.has_many_terms && !is_long(mesh, face) && ruled_edges(mesh, face, None).is_some()
}

/// True for a facet that lies in a row.
pub(in crate::curvature::fit) fn is_in_row(mesh: &Mesh, face: Face) -> bool {
    Way::Ruled.edges(mesh, face, None).is_some()
}

/// True for a facet so long that the rings around it consist of two parts that lie far apart.
pub(in crate::curvature::fit) fn is_slender(mesh: &Mesh, face: Face) -> bool {
    long_edges(mesh, face, SLENDER).is_some()
}

/// Nearly the curvature along a strip, from how the surface folds at the short side of a facet.
fn curvature_along(mesh: &Mesh, face: Face, exits: [HalfEdge; 2]) -> f64 {
    let Some(short) = face.half_edges().into_iter().find(|h| !exits.contains(h)) else { return 0.0 };
    let Some(twin) = mesh.topology().twin(short).filter(|_| mesh.edge_kind(short) == EdgeKind::Inner) else {
        return 0.0;
    };
    let (own, other) = (mesh.height(short), mesh.height(twin));
    let turn = mesh.normal(face).cross(mesh.normal(twin.face())).length();
    // Where facets are not alike another surface begins, and the one of smaller facets turns.
    if other < own / ALIKE {
        0.0
    } else if other > own * ALIKE {
        2.0 * turn / own
    } else {
        2.0 * turn / (own + other)
    }
}

/// The signed curvature of the arc that the facets on both sides of an edge are chords of: it turns by half of what either
/// chord spans. `None` where they fold by more than any arc.
fn arc_curvature(mesh: &Mesh, edge: HalfEdge) -> Option<f64> {
    let topology = mesh.topology();
    let twin = topology.twin(edge)?;
    let [a, b] = [edge, twin].map(|h| mesh.height(h));
    let (n, m) = (mesh.normal(edge.face()), mesh.normal(twin.face()));
    let fold = n.cross(m).length().atan2(n.dot(m));
    if fold == 0.0 {
        return Some(0.0);
    }
    let mut k = 2.0 * fold / (a + b);
    // What the half angles of chords exceed their sines by is little where they fold by no sharp edge.
    for _ in 0..4 {
        let half = [a, b].map(|chord| (0.5 * k * chord).asin());
        k *= fold / (half[0] + half[1]);
    }
    let beyond = mesh.position(topology.apex(twin)) - mesh.position(topology.origin(edge));
    k.is_finite().then_some(if beyond.dot(n) < 0.0 { k } else { -k })
}

impl Strip {
    /// The strip around a facet of a row.
    fn around(mesh: &Mesh, seed: Face, way: Way, exits: [HalfEdge; 2]) -> Self {
        let mut strip = Strip { faces: vec![seed], between: Vec::new(), bounds: Vec::new(), middle: 0 };
        strip.walk(mesh, way, exits[0]);
        strip.faces.reverse();
        strip.between.reverse();
        let at = strip.faces.len() - 1;
        strip.walk(mesh, way, exits[1]);
        let folds = Folds::of(mesh, strip.between.iter().copied());
        strip.bounds = (0..=strip.faces.len())
            .filter(|&i| i == 0 || i == strip.faces.len() || !folds.has_diagonals || !folds.is_diagonal(i - 1))
            .collect();
        strip.middle = strip.bounds.partition_point(|&b| b <= at) - 1;
        strip
    }

    /// Goes over edges until the facets are in a row no more.
    fn walk(&mut self, mesh: &Mesh, way: Way, mut exit: HalfEdge) {
        for _ in 0..REACH {
            let inner = |h: HalfEdge| mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner);
            let Some(twin) = inner(exit) else { return };
            let face = twin.face();
            let ratio = mesh.area(face) / mesh.area(exit.face());
            if !(ratio < ALIKE && ratio > 1.0 / ALIKE) {
                return;
            }
            // Round a closed strip, facets come again.
            let exits = way.edges(mesh, face, Some(twin)).filter(|exits| exits.contains(&twin));
            let Some(exits) = exits.filter(|_| !self.faces.contains(&face)) else { return };
            self.faces.push(face);
            self.between.push(exit);
            exit = if exits[0] == twin { exits[1] } else { exits[0] };
        }
    }

    /// The run that tells most of the middle, of those that `counts` holds for, if it tells more than another strip.
    fn best(
        &self,
        surveyor: &mut Surveyor<'_>,
        face: Face,
        other: Option<Scored>,
        counts: impl Fn(&Reading) -> bool,
    ) -> Option<Scored> {
        let mesh = surveyor.mesh();
        let middle = self.bounds[self.middle]..self.bounds[self.middle + 1];
        let sizes = if self.is_paired(&middle) { PAIRED } else { ALTERNATING };
        let mut best = other;
        for triangles in sizes {
            for runs in self.runs(triangles).chunks(LANES) {
                let windows = runs.iter().map(|run| self.window(mesh, run.clone())).collect();
                for (run, reading) in runs.iter().zip(surveyor.read_strips(face, windows)) {
                    let reading = reading.and_then(|reading| self.by_arcs(mesh, run, reading));
                    let Some(reading) = reading.filter(&counts) else { continue };
                    // In powers of ten: among equals the one about the face.
                    let power =
                        if reading.quality.is_uneven { reading.error.log10().floor() } else { f64::NEG_INFINITY };
                    let aside = (run.start + run.end).abs_diff(middle.start + middle.end);
                    let key = [f64::from(self.is_jumping(mesh, run)), power, aside as f64, reading.error];
                    if best.as_ref().is_none_or(|best| key < best.key) {
                        best = Some(Scored { key, reading });
                    }
                }
                if best.as_ref().is_some_and(|best| best.key[..2] == [0.0, f64::NEG_INFINITY]) {
                    break;
                }
            }
            // Smaller ones only where the larger reach over a jump.
            if best.as_ref().is_some_and(Scored::is_on_one_side) {
                break;
            }
        }
        best
    }

    /// Runs of whole cells, of no more than needed for so many triangles, that hold the middle; those about it first.
    fn runs(&self, triangles: usize) -> Vec<Range<usize>> {
        let end_of = |&start: &usize| self.bounds.iter().find(|&&end| end >= start + triangles);
        let middle = self.bounds[self.middle]..self.bounds[self.middle + 1];
        let runs = self.bounds.iter().filter_map(|start| Some(*start..*end_of(start)?));
        let mut runs: Vec<_> = runs.filter(|run| run.start <= middle.start && middle.end <= run.end).collect();
        runs.sort_by_key(|run| (run.start + run.end).abs_diff(middle.start + middle.end));
        runs
    }

    /// Whether all facets between two places belong to flat cells of several.
    fn is_paired(&self, run: &Range<usize>) -> bool {
        self.bounds.windows(2).filter(|b| run.contains(&b[0])).all(|b| b[1] - b[0] > 1)
    }

    /// The curvature of the arcs that cells side by side in a run are chords of.
    fn arcs(&self, mesh: &Mesh, run: &Range<usize>) -> Vec<Option<f64>> {
        let within = self.bounds.iter().filter(|&&bound| run.start < bound && bound < run.end);
        within.map(|&bound| arc_curvature(mesh, self.between[bound - 1])).collect()
    }

    /// Whether the folds between flat cells tell of a jump of curvature, or there are too few to tell.
    fn is_jumping(&self, mesh: &Mesh, run: &Range<usize>) -> bool {
        /// Least share of the largest curvature in a run.
        const LEAST: f64 = 0.8;
        if !self.is_paired(run) {
            // Where there are cells, a part of one tells nothing of how they fold.
            return self.bounds.len() <= self.faces.len();
        }
        let arcs: Option<Vec<f64>> = self.arcs(mesh, run).into_iter().collect();
        let Some([first, others @ ..]) = arcs.as_deref() else { return true };
        let (low, high) = others.iter().fold((*first, *first), |(low, high), k| (k.min(low), k.max(high)));
        let is_one = low >= LEAST * high && low >= 0.0 || high <= LEAST * low && high <= 0.0;
        others.is_empty() || !is_one
    }

    /// A reading of a run, whose curvature is that of the arcs beside the middle where the run is of three cells: many
    /// surfaces pass through their four folds. `None` where it bends the other way than they do.
    fn by_arcs(&self, mesh: &Mesh, run: &Range<usize>, mut reading: Reading) -> Option<Reading> {
        if !self.is_paired(run) {
            return Some(reading);
        }
        let [Some(a), Some(b)] = self.arcs(mesh, run)[..] else { return Some(reading) };
        let k = if self.bounds[self.middle] == run.start {
            a
        } else if self.bounds[self.middle + 1] == run.end {
            b
        } else {
            0.5 * (a + b)
        };
        reading.principal = reading.principal.with_larger(k)?;
        reading.error = reading.error.max(0.5 * (a - b).abs());
        Some(reading)
    }

    fn window(&self, mesh: &Mesh, run: Range<usize>) -> StripWindow {
        let mut vertices: Vec<u32> = Vec::with_capacity(run.len() + 2);
        let mut normals: Vec<DVec3> = Vec::with_capacity(run.len() + 2);
        let faces: Vec<u32> = self.faces[run.clone()].iter().map(|f| f.0).collect();
        for face in faces.iter().map(|&f| Face(f)) {
            let normal = scaled_normal(mesh, face);
            for v in mesh.topology().corners(face) {
                let at = vertices.iter().position(|&w| w == v.0).unwrap_or_else(|| {
                    vertices.push(v.0);
                    normals.push(DVec3::ZERO);
                    vertices.len() - 1
                });
                normals[at] += normal;
            }
        }
        let mut points: Vec<DVec3> = vertices.iter().map(|&v| mesh.positions()[v as usize]).collect();
        let folds = Folds::of(mesh, self.between[run.start..run.end - 1].iter().copied());
        if self.is_paired(&run) {
            for fold in folds.sharp() {
                points.push(fold.ends[0].midpoint(fold.ends[1]));
                normals.push(fold.normal);
            }
        }
        StripWindow {
            vertices,
            points,
            normals,
            rulings: rulings(mesh, &faces, self.is_paired(&run).then_some(&folds)),
        }
    }
}

/// What the strip around a face says about it, where that promises a far smaller error than the window around the face.
pub(in crate::curvature::fit) fn reading(
    surveyor: &mut Surveyor<'_>,
    face: Face,
    quality: &Quality,
) -> Option<Reading> {
    let mesh = surveyor.mesh();
    let is_trusted = quality.misfit.is_finite() && !is_explained_by_chance(mesh, face, quality);
    let seed = is_trusted.then_some(quality.seed);
    let fit = seed.and_then(|seed| surveyor.fit(seed));
    // A plane that does not explain its window says nothing of its error.
    let own = fit.filter(|f| f.surface.f.size > PLANE || !quality.is_uneven).map_or(f64::INFINITY, |fit| fit.error);
    let is_uneven = quality.is_uneven || own.is_infinite();
    let mut rows: Vec<(Way, [HalfEdge; 2])> =
        [Way::Ruled, Way::Long].into_iter().filter_map(|way| Some((way, way.edges(mesh, face, None)?))).collect();
    rows.dedup_by(|(_, a), (_, b)| a.iter().all(|exit| b.contains(exit)));
    let mut best: Option<Scored> = None;
    for (way, exits) in rows {
        let strip = Strip::around(mesh, face, way, exits);
        let along = curvature_along(mesh, face, exits);
        best = strip.best(surveyor, face, best, |reading| {
            let across = reading.principal.size();
            let is_promising = reading.error < BETTER * own && !reading.quality.is_vague;
            // Nor does a plane that does not explain its run.
            let is_honest = across > 0.0 || !reading.quality.is_uneven;
            let is_better = !reading.quality.is_uneven && is_uneven || is_promising && is_honest;
            let is_straight = across == 0.0 || along <= BENT * across;
            own > GOOD * across && is_straight && is_better
        });
        // Another way only where this one reaches over a jump.
        if best.as_ref().is_some_and(Scored::is_on_one_side) {
            break;
        }
    }
    // A long facet has no better window; another is left to those that hold its neighbours along the fold.
    best.filter(|best| best.is_on_one_side() || is_long(mesh, face)).map(|best| best.reading)
}
