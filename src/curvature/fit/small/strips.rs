//! Long facets side by side, as CAD programs cover cylinders, cones and fillets.
//!
//! Rings around a long facet hold mostly what lies beyond its short sides: on a part with fine corners, the corners.
//! What lies beside it, over its long sides, tells how the surface bends there. So here windows are runs of facets
//! that share long edges. Near a jump of curvature, where a fillet runs out into a flat, the run that lies
//! on one side of it explains itself best, as in [`super::one_sided`].

use super::first::{Quality, Reading, Surveyor};
use crate::curvature::fit::around::rulings::{Folds, rulings};
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

pub(in crate::curvature::fit) fn is_long(mesh: &Mesh, face: Face) -> bool {
    long_edges(mesh, face, LONG).is_some()
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

impl Strip {
    /// The strip around a long facet.
    fn around(mesh: &Mesh, seed: Face) -> Option<Self> {
        let exits = long_edges(mesh, seed, LONG)?;
        let mut strip = Strip { faces: vec![seed], between: Vec::new(), bounds: Vec::new(), middle: 0 };
        strip.walk(mesh, exits[0]);
        strip.faces.reverse();
        strip.between.reverse();
        let at = strip.faces.len() - 1;
        strip.walk(mesh, exits[1]);
        let folds = Folds::of(mesh, strip.between.iter().copied());
        strip.bounds = (0..=strip.faces.len())
            .filter(|&i| i == 0 || i == strip.faces.len() || !folds.has_diagonals || !folds.is_diagonal(i - 1))
            .collect();
        strip.middle = strip.bounds.partition_point(|&b| b <= at) - 1;
        Some(strip)
    }

    /// Goes over long edges until the facets are long no more.
    fn walk(&mut self, mesh: &Mesh, mut exit: HalfEdge) {
        for _ in 0..REACH {
            let inner = |h: HalfEdge| mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner);
            let Some(twin) = inner(exit) else { return };
            let face = twin.face();
            let ratio = mesh.area(face) / mesh.area(exit.face());
            if !(ratio < ALIKE && ratio > 1.0 / ALIKE) {
                return;
            }
            // Round a closed strip, facets come again.
            let Some(exits) = long_edges(mesh, face, LONG).filter(|e| e.contains(&twin) && !self.faces.contains(&face))
            else {
                return;
            };
            self.faces.push(face);
            self.between.push(exit);
            exit = if exits[0] == twin { exits[1] } else { exits[0] };
        }
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
    let strip = Strip::around(mesh, face)?;
    let seed = Some(quality.seed).filter(|_| quality.misfit.is_finite());
    let fit = seed.and_then(|seed| surveyor.fit(seed));
    // A plane that does not explain its window says nothing of its error.
    let own = fit.filter(|f| f.surface.f.size > PLANE || !quality.is_uneven).map_or(f64::INFINITY, |fit| fit.error);
    let is_uneven = quality.is_uneven || own.is_infinite();
    let along = curvature_along(mesh, face, long_edges(mesh, face, LONG)?);
    let middle = strip.bounds[strip.middle]..strip.bounds[strip.middle + 1];
    let sizes = if strip.is_paired(&middle) { PAIRED } else { ALTERNATING };
    let score = |run: &Range<usize>, reading: Reading| {
        let across = reading.principal.size();
        let is_even = !reading.quality.is_uneven;
        let is_promising = reading.error < BETTER * own && !reading.quality.is_vague;
        let is_better = is_even && is_uneven || is_promising;
        let is_straight = across == 0.0 || along <= BENT * across;
        // In powers of ten: among equals the one about the face.
        let power = if is_even { f64::NEG_INFINITY } else { reading.error.log10().floor() };
        let aside = (run.start + run.end).abs_diff(middle.start + middle.end);
        (own > GOOD * across && is_straight && is_better).then_some(([power, aside as f64, reading.error], reading))
    };
    sizes.iter().find_map(|&triangles| {
        let mut best: Option<([f64; 3], Reading)> = None;
        for runs in strip.runs(triangles).chunks(LANES) {
            let windows = runs.iter().map(|run| strip.window(mesh, run.clone())).collect();
            let readings = surveyor.read_strips(face, windows);
            for found in runs.iter().zip(readings).filter_map(|(run, reading)| score(run, reading?)) {
                if best.as_ref().is_none_or(|best| found.0 < best.0) {
                    best = Some(found);
                }
            }
            if best.as_ref().is_some_and(|best| best.0[0].is_infinite()) {
                break;
            }
        }
        best.map(|best| best.1)
    })
}
