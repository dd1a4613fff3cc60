//! The kind of every edge: inner, boundary, feature or non-manifold.

use super::ids::{Face, HalfEdge};
use super::report::FaceState;
use super::topology::{Across, Topology};
use glam::DVec3;
use rayon::prelude::*;
use std::array::from_fn;

/// What an edge is to a walk over the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EdgeKind {
    /// Two faces meet smoothly.
    Inner,
    /// One face only.
    Boundary,
    /// Two faces meet at an angle above the feature angle.
    Feature,
    /// Three or more faces meet.
    NonManifold,
}

/// The normals that decide whether an edge is sharp, from positions alone.
pub(super) struct Dihedral<'m> {
    pub(super) topology: &'m Topology,
    pub(super) positions: &'m [DVec3],
    pub(super) states: &'m [FaceState],
}

/// How many faces without area may lie between an edge and the face that gives it a normal.
const LONGEST_CHAIN: usize = 16;

impl Dihedral<'_> {
    /// Twice the face's area as a vector along the normal of its winding.
    #[inline]
    pub(super) fn area_vector(&self, face: Face) -> DVec3 {
        let [a, b, c] = self.topology.corners(face).map(|v| self.positions[v.index()]);
        (b - a).cross(c - a)
    }

    /// The area vector of the face, or for one without area that of the neighbour over its longest
    /// edge, with the face's winding: a sliver that closes the seam between two flat sides of a
    /// part belongs to the side it lies along, and must not hide the edge between them.
    #[inline]
    fn normal(&self, face: Face) -> DVec3 {
        if self.states[face.index()] == FaceState::NoArea { self.borrowed_normal(face) } else { self.area_vector(face) }
    }

    #[cold]
    fn borrowed_normal(&self, face: Face) -> DVec3 {
        let (mut face, mut sign) = (face, 1.0);
        for _ in 0..LONGEST_CHAIN {
            if self.states[face.index()] != FaceState::NoArea {
                return sign * self.area_vector(face);
            }
            let longest = face.half_edges().into_iter().max_by(|&a, &b| self.length(a).total_cmp(&self.length(b)));
            let Some((h, twin)) = longest.and_then(|h| Some((h, self.topology.twin(h)?))) else { break };
            if self.topology.is_flipped(h, twin) {
                sign = -sign;
            }
            face = twin.face();
        }
        DVec3::ZERO
    }

    fn length(&self, h: HalfEdge) -> f64 {
        let [a, b] = [self.topology.origin(h), self.topology.target(h)].map(|v| self.positions[v.index()]);
        a.distance_squared(b)
    }

    /// Cosine and sine of the angle between the normals of the two faces, times a common positive
    /// factor; (0, 0) where one of them has no normal.
    pub(super) fn cos_sin(&self, h: HalfEdge, twin: HalfEdge) -> (f64, f64) {
        let a = self.normal(h.face());
        let mut b = self.normal(twin.face());
        if self.topology.is_flipped(h, twin) {
            b = -b;
        }
        cos_sin(a, b)
    }

    /// The kinds of a face's edges, each as its lesser side sees it.
    #[inline]
    fn kinds(&self, face: Face, limit: &Limit) -> [EdgeKind; 3] {
        let corners = self.topology.corners(face).map(|v| self.positions[v.index()]);
        let own = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let has_area = |face: Face| self.states[face.index()] != FaceState::NoArea;
        from_fn(|i| {
            let h = HalfEdge(3 * face.0 + i as u32);
            let twin = match self.topology.across(h) {
                Across::Boundary => return EdgeKind::Boundary,
                Across::NonManifold => return EdgeKind::NonManifold,
                // Each edge is judged once, so that both sides agree.
                Across::Twin(twin) if twin < h => return EdgeKind::Inner,
                Across::Twin(twin) => twin,
            };
            let is_sharp = if has_area(face) && has_area(twin.face()) {
                // Two of the neighbour's corners are at hand. From them its normal has this face's winding,
                // whatever its own is.
                let [start, end] = [corners[i], corners[(i + 1) % 3]];
                let apex = self.positions[self.topology.apex(twin).index()];
                let other = (start - end).cross(apex - end);
                !limit.is_far_above(own, other) && limit.is_below(cos_sin(own, other))
            } else {
                limit.is_below(self.cos_sin(h, twin))
            };
            if is_sharp { EdgeKind::Feature } else { EdgeKind::Inner }
        })
    }
}

fn cos_sin(a: DVec3, b: DVec3) -> (f64, f64) {
    (a.dot(b), a.cross(b).length())
}

/// The feature angle.
struct Limit {
    sin: f64,
    cos: f64,
    /// Of the cosine, and more than rounding may add to it; infinite for a large angle, whose cosine has few digits.
    square: f64,
}

impl Limit {
    /// `angle` in degrees, 0 to 180; at 180 there are no features.
    fn new(angle: f64) -> Self {
        let (sin, cos) = if angle < 180.0 { angle.to_radians().sin_cos() } else { (0.0, -1.0) };
        let square = if angle < 80.0 { cos * cos * (1.0 + 1e-9) } else { f64::INFINITY };
        Limit { sin, cos, square }
    }

    /// True for an angle, by its cosine and sine, above this one: both are within 0 and 180 degrees, so that the sine
    /// of their difference decides.
    #[inline]
    fn is_below(&self, (cos, sin): (f64, f64)) -> bool {
        sin * self.cos - cos * self.sin > 0.0
    }

    /// True for an angle between two vectors that is so far below this one that no root is needed to see it.
    #[inline]
    fn is_far_above(&self, a: DVec3, b: DVec3) -> bool {
        /// Products below it have lost digits.
        const SMALL: f64 = 1e-280;
        let (cos, squares) = (a.dot(b), a.length_squared() * b.length_squared());
        cos > 0.0 && cos * cos > squares * self.square && squares > SMALL
    }
}

/// Classifies every half-edge. `feature_angle` in degrees, 0 to 180; at 180 there are no features.
pub(super) fn classify(dihedral: &Dihedral<'_>, feature_angle: f64) -> Vec<EdgeKind> {
    let limit = Limit::new(feature_angle);
    let topology = dihedral.topology;
    let faces = (0..topology.face_count() as u32).into_par_iter().map(Face);
    let mut kinds: Vec<EdgeKind> = faces.map(|face| dihedral.kinds(face, &limit)).collect::<Vec<_>>().into_flattened();
    for h in (0..kinds.len() as u32).map(HalfEdge) {
        if kinds[h.index()] == EdgeKind::Feature
            && let Some(twin) = topology.twin(h)
        {
            kinds[twin.index()] = EdgeKind::Feature;
        }
    }
    kinds
}
