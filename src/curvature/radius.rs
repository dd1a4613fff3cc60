//! The length of a disk's legs, also where it is to be found automatically.
//!
//! A disk says something about bending only if its sections leave the face and pass some edges, and
//! something about one place only if the surface does not turn far over it. The automatic radius
//! starts from the width of the faces around, and then
//! - shrinks while the surface turns by more than 0.8 radians over it, but not below a quarter of the
//!   first;
//! - grows by a half while the surface turns by little and the radius is below three mean edges of
//!   the face, unless the surface does not turn at all: a flat disk stays as it is.
//!
//! The width of a face is its least height. Long thin faces between others of the kind, as CAD
//! programs make them, get a disk that passes several of them across and stays within the face along,
//! where it does not matter; a needle among well-shaped faces gets the disk of its neighbours.

use super::options::{CurvatureOptions, Radius};
use crate::mesh::{EdgeKind, Face, Mesh};

/// First radius in widths: 3.4 mean edges of a right-angled triangle of equal legs.
const WIDTHS: f64 = 5.4;
/// Turn in radians up to which a radius is kept.
const LARGEST_TURN: f64 = 0.8;
/// Turn up to which it may still grow.
const SMALL_TURN: f64 = LARGEST_TURN / GROWTH;
const GROWTH: f64 = 1.5;
/// No growth beyond this many mean edges of the face.
const MOST_EDGES: f64 = 3.0;
/// A turn below this many radians is none: a flat of 32-bit coordinates.
const NO_TURN: f64 = 1e-4;
/// Most disks laid for one face: at most eleven times the first radius, so that the time for a face
/// does not grow with the number of long facets around a cylinder.
const MOST_ROUNDS: usize = 7;

/// Chooses the radius of one face, disk by disk.
#[derive(Clone, Copy, Debug)]
pub(super) struct RadiusSearch {
    automatic: bool,
    first: f64,
    most: f64,
    rounds: usize,
}

impl CurvatureOptions {
    /// The radius of a face where the user has chosen one; `fixed` is [`CurvatureOptions::fixed_radius`].
    pub(super) fn radius_of(&self, mesh: &Mesh, face: Face, fixed: Option<f64>) -> Option<f64> {
        match self.radius {
            Radius::FaceFactor(factor) => Some(factor * mesh.mean_edge(face)),
            _ => fixed,
        }
    }

    /// The radius where it is the same for all faces.
    pub(crate) fn fixed_radius(&self, mesh: &Mesh) -> Option<f64> {
        match self.radius {
            Radius::FaceFactor(_) | Radius::Auto => None,
            Radius::MeshFactor(factor) => Some(factor * mesh.mean_edge_of_mesh()),
            Radius::Length(length) => Some(length),
        }
    }
}

impl RadiusSearch {
    /// `fixed` is [`CurvatureOptions::fixed_radius`], computed once for a mesh. Returns the search
    /// and the radius to begin with.
    pub(super) fn new(mesh: &Mesh, face: Face, options: &CurvatureOptions, fixed: Option<f64>) -> (Self, f64) {
        let edge = mesh.mean_edge(face);
        let first = match (fixed, options.radius) {
            (Some(fixed), _) => fixed,
            (None, Radius::FaceFactor(factor)) => factor * edge,
            (None, _) => WIDTHS * width_around(mesh, face),
        };
        let most = MOST_EDGES * edge;
        (RadiusSearch { automatic: options.radius == Radius::Auto, first, most, rounds: 0 }, first)
    }

    /// The next radius to try after one and the turn that a disk of it shows, radius times curvature; `None`
    /// to keep it. `is_blind` says whether no section of the disk passes an edge.
    pub(super) fn next(&mut self, radius: f64, turn: f64, is_blind: impl FnOnce() -> bool) -> Option<f64> {
        self.rounds += 1;
        if !self.automatic || self.rounds == MOST_ROUNDS {
            return None;
        }
        if radius <= self.first {
            let wanted = (radius * LARGEST_TURN / turn).max(0.25 * self.first);
            // Little slack: where rounding decides, it must not change much.
            if turn.is_finite() && wanted < 0.97 * radius {
                return Some(wanted);
            }
        }
        let grown = GROWTH * radius;
        let may_grow = radius >= self.first && turn < SMALL_TURN && grown <= self.most;
        (may_grow && (turn > NO_TURN || is_blind())).then_some(grown)
    }
}

/// The second largest width among the face and its neighbours across inner edges; its own where it
/// has none.
fn width_around(mesh: &Mesh, face: Face) -> f64 {
    let (mut largest, mut second) = (mesh.least_height(face), 0.0_f64);
    for h in face.half_edges() {
        let neighbour = mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner);
        if let Some(neighbour) = neighbour {
            let width = mesh.least_height(neighbour.face());
            second = second.max(width.min(largest));
            largest = largest.max(width);
        }
    }
    if second > 0.0 { second } else { largest }
}
