//! The walk along a plane section of a mesh, from edge to edge.
//!
//! A vertex whose distance to the plane is exactly zero counts as above it. With that one rule a
//! section enters and leaves every face through an edge with one end below and one above the plane:
//! it has no special case at vertices or along edges, needs no tolerance, and its divisor is never
//! zero. Flipped neighbours do not stop it, since an edge's ends are told apart by their side of
//! the plane and not by the winding.

use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh, Vertex};
use glam::DVec3;

/// Why a walk does not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// It has reached the length asked for.
    Length,
    /// The edge has no other face.
    Boundary,
    /// The edge is a feature.
    Feature,
    /// The edge has three or more faces.
    NonManifold,
    /// A disk's leg has turned by a right angle: further on it says nothing of its centre.
    Turned,
    /// The section is a closed loop and is back at the face it started from.
    Closed,
    /// The plane misses the face, to the precision of its coordinates.
    Missed,
}

impl Stop {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Stop::Length => "length",
            Stop::Boundary => "boundary",
            Stop::Feature => "feature",
            Stop::NonManifold => "non_manifold",
            Stop::Turned => "turned",
            Stop::Closed => "closed",
            Stop::Missed => "missed",
        }
    }
}

/// Whether a walk ends at feature edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Features {
    /// A feature edge ends the walk.
    Stop,
    /// A feature edge is crossed like any other.
    Cross,
}

/// A plane through a point, given by its unit normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// A point on the plane, relative to the mesh's origin.
    pub point: DVec3,
    /// Unit normal, towards the side called above.
    pub normal: DVec3,
}

impl Plane {
    /// The plane a x + b y + c z + d = 0 in the input's coordinates; a, b and c must not all be 0.
    pub fn of_equation(mesh: &Mesh, [a, b, c, d]: [f64; 4]) -> Plane {
        let normal = DVec3::new(a, b, c);
        // The point of the plane nearest to the mesh's origin: the plane's own numbers may be far from it.
        let height = (normal.dot(mesh.origin()) + d) / normal.length_squared();
        Plane { point: -height * normal, normal: normal.normalize() }
    }

    /// Signed distance of a point, positive above the plane.
    #[inline]
    pub fn distance(&self, p: DVec3) -> f64 {
        (p - self.point).dot(self.normal)
    }
}

/// A place where a section crosses an edge.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    /// The edge, as a side of the face that the walk is leaving.
    pub half_edge: HalfEdge,
    /// The point on the edge, relative to the mesh's origin.
    pub point: DVec3,
    below: End,
    above: End,
    share: f64,
    /// True where `above` is the end that the edge before does not have.
    newer_is_above: bool,
}

/// An end of the crossed edge: the vertex, its position and its distance to the plane.
#[derive(Clone, Copy, Debug)]
struct End {
    vertex: Vertex,
    position: DVec3,
    distance: f64,
}

impl Crossing {
    fn new(half_edge: HalfEdge, below: End, above: End, newer_is_above: bool) -> Self {
        let share = below.distance / (below.distance - above.distance);
        let point = below.position + share * (above.position - below.position);
        Crossing { half_edge, point, below, above, share, newer_is_above }
    }

    /// How far along the edge the point is, from the end below (0) to that above (1).
    #[inline]
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// The edge's ends, below and above the plane.
    #[inline]
    pub(crate) fn ends(&self) -> [DVec3; 2] {
        [self.below.position, self.above.position]
    }

    /// The end that the edge crossed before does not have: the apex of the face between the two. Of a
    /// walk's first crossing, the end below.
    #[inline]
    pub(crate) fn newer(&self) -> DVec3 {
        if self.newer_is_above { self.above.position } else { self.below.position }
    }

    /// True where [`Crossing::newer`] is the end above the plane.
    #[inline]
    pub(crate) fn newer_is_above(&self) -> bool {
        self.newer_is_above
    }

    /// Leaves `face` by the edge that has the plane's upper side on its left, seen against the
    /// face's oriented normal: the walk goes in the direction plane normal x face normal.
    ///
    /// `None` when the plane misses the face.
    #[inline]
    pub fn leaving(mesh: &Mesh, plane: &Plane, face: Face) -> Option<Self> {
        Crossing::where_crossed(mesh, plane, face, mesh.is_flipped(face))
    }

    /// Leaves `face` by its other crossed edge, the one that [`Crossing::leaving`] does not take.
    pub fn leaving_backwards(mesh: &Mesh, plane: &Plane, face: Face) -> Option<Self> {
        Crossing::where_crossed(mesh, plane, face, !mesh.is_flipped(face))
    }

    /// The edge that rises through the plane along the face's winding, or falls through it.
    #[inline]
    fn where_crossed(mesh: &Mesh, plane: &Plane, face: Face, falling: bool) -> Option<Self> {
        let ends = mesh.topology().corners(face).map(|vertex| {
            let position = mesh.position(vertex);
            End { vertex, position, distance: plane.distance(position) }
        });
        face.half_edges().into_iter().enumerate().find_map(|(i, h)| {
            let (a, b) = (ends[i], ends[(i + 1) % 3]);
            let (below, above) = if falling { (b, a) } else { (a, b) };
            (below.distance < 0.0 && above.distance >= 0.0).then(|| Crossing::new(h, below, above, false))
        })
    }

    /// Goes through the face across the edge to the edge by which the section leaves it.
    ///
    /// # Errors
    /// The reason why the walk ends here.
    #[inline]
    pub fn advance(&self, mesh: &Mesh, plane: &Plane, features: Features) -> Result<Self, Stop> {
        match mesh.edge_kind(self.half_edge) {
            EdgeKind::Inner => {}
            EdgeKind::Feature if features == Features::Cross => {}
            EdgeKind::Boundary => return Err(Stop::Boundary),
            EdgeKind::Feature => return Err(Stop::Feature),
            EdgeKind::NonManifold => return Err(Stop::NonManifold),
        }
        let topology = mesh.topology();
        let twin = topology.twin(self.half_edge).ok_or(Stop::Boundary)?;
        let vertex = topology.apex(twin);
        let position = mesh.position(vertex);
        let apex = End { vertex, position, distance: plane.distance(position) };
        let newer_is_above = apex.distance >= 0.0;
        let (below, above, kept) =
            if newer_is_above { (self.below, apex, self.below) } else { (apex, self.above, self.above) };
        // The edge between the kept end and the apex.
        let half_edge = topology.other_side_at(twin, kept.vertex);
        Ok(Crossing::new(half_edge, below, above, newer_is_above))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::soup::{Positions, Soup};

    /// An octahedron: its edges lie in the coordinate planes, so that sections run along them.
    fn octahedron() -> Mesh {
        let p = vec![
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        let f = vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let options = MeshOptions { feature_angle: 180.0, ..MeshOptions::default() };
        let mesh = Mesh::from_soup(&Soup::new(Positions::F64(p), f), &options).expect("a sound mesh");
        mesh.sanity_check();
        mesh
    }

    /// Walks until back at the first face; returns the length of the loop and its number of faces.
    fn go_round(mesh: &Mesh, plane: &Plane, start: Face) -> (f64, usize) {
        let first = Crossing::leaving(mesh, plane, start).expect("the plane meets the face");
        let (mut at, mut length) = (first, 0.0);
        for steps in 1..=mesh.face_count() {
            let next = at.advance(mesh, plane, Features::Stop).expect("the mesh is closed");
            length += at.point.distance(next.point);
            at = next;
            if at.half_edge == first.half_edge {
                return (length, steps);
            }
        }
        panic!("the section does not close");
    }

    #[test]
    fn a_section_along_edges_and_through_vertices_closes() {
        let mesh = octahedron();
        let plane = Plane { point: DVec3::ZERO, normal: DVec3::Z };
        let start = (0..8).map(Face).find(|&f| Crossing::leaving(&mesh, &plane, f).is_some()).expect("met");
        let (length, _) = go_round(&mesh, &plane, start);
        assert!((length - 4.0 * 2.0_f64.sqrt()).abs() < 1e-12, "{length}");
        let slanted = Plane { point: DVec3::ZERO, normal: DVec3::new(1.0, -1.0, 0.0).normalize() };
        let start = (0..8).map(Face).find(|&f| Crossing::leaving(&mesh, &slanted, f).is_some()).expect("met");
        let (length, _) = go_round(&mesh, &slanted, start);
        assert!((length - 4.0 * 1.5_f64.sqrt()).abs() < 1e-12, "{length}");
    }

    #[test]
    fn the_walk_leaves_with_the_upper_side_on_its_left() {
        let mesh = octahedron();
        let centre = mesh.barycentre(Face(0));
        let normal = mesh.normal(Face(0));
        let direction = normal.any_orthonormal_vector();
        let plane = Plane { point: centre, normal: normal.cross(direction) };
        let out = Crossing::leaving(&mesh, &plane, Face(0)).expect("through the centre");
        assert!((out.point - centre).dot(direction) > 0.0);
    }
}
