//! The indexed mesh: welded vertices, half-edge neighbours and the kind of every edge.

mod arrays;
mod clusters;
mod connect;
mod edges;
mod ids;
mod order;
mod orientation;
mod report;
pub(crate) mod stages;
mod topology;
mod validate;
mod vertex_table;
mod weld;
mod weld_distance;

pub use arrays::{PositionsRef, SameVertex};
pub use edges::EdgeKind;
pub use ids::{Face, HalfEdge, Vertex};
pub(crate) use order::{FileOrder, inverse};
pub use report::{Bounds, EdgeCounts, FaceState, FirstDefects, MeshReport};
pub use topology::{Across, Topology};

use crate::error::Error;
use crate::place::Place;
use crate::soup::{Group, Positions, Scene, Soup};
use edges::Dihedral;
use glam::DVec3;
use rayon::prelude::*;
use report::Built;
use weld::Welded;

/// Settings for [`Mesh::from_soup`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// Vertices at most this far apart (in file units) become one; 0, the default, welds equal
    /// positions only. Merging is transitive: keep it well under the shortest edge.
    pub weld: f64,
    /// Two faces whose normals differ by more than this many degrees (0 to 180) meet in a feature
    /// edge, where disks end. Default 40; 180 for none.
    pub feature_angle: f64,
}

impl Default for MeshOptions {
    fn default() -> Self {
        MeshOptions { weld: 0.0, feature_angle: 40.0 }
    }
}

impl MeshOptions {
    /// Checks every range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        if !(self.weld >= 0.0 && self.weld.is_finite()) {
            return Err(Error::Usage(format!("the weld distance must be 0 or more, not {}", self.weld)));
        }
        if !(0.0..=180.0).contains(&self.feature_angle) {
            return Err(Error::Usage(format!(
                "the feature angle must be 0 to 180 degrees, not {}",
                self.feature_angle
            )));
        }
        Ok(())
    }
}

/// A triangle mesh, ready to be walked over.
///
/// Faces keep the numbers they have in the [`Soup`]. Positions are 64-bit and relative to
/// [`Mesh::origin`], so that neither georeferenced nor 64-bit files lose anything.
#[derive(Clone, Debug)]
pub struct Mesh {
    origin: DVec3,
    positions: Vec<DVec3>,
    topology: Topology,
    kinds: Vec<EdgeKind>,
    states: Vec<FaceState>,
    flipped: Vec<bool>,
    duplicates: Vec<(Face, Face)>,
    bodies: Vec<Group>,
    scene: Option<Scene>,
    report: MeshReport,
}

impl Mesh {
    /// Welds, connects and classifies.
    ///
    /// # Errors
    /// [`Error::Usage`] for options out of range, a face that names a vertex which is not there or bodies that do not
    /// follow one another over all faces, [`Error::TooLarge`] for more than [`MAX_FACES`](crate::MAX_FACES),
    /// [`Error::EmptyMesh`] when there are no faces or none of them has both an area and finite coordinates.
    pub fn from_soup(soup: &Soup, options: &MeshOptions) -> Result<Mesh, Error> {
        let welded = Self::weld(soup.triangles.clone(), &soup.positions, &soup.bodies, options)?;
        Self::from_welded(welded, soup.bodies.clone(), soup.scene.clone(), options)
    }

    /// The same for a soup that nobody needs any more: its faces become those of the mesh, and its positions go as soon
    /// as they are welded, 36 bytes a face of a binary STL.
    ///
    /// # Errors
    /// Those of [`Mesh::from_soup`].
    pub fn from_owned_soup(soup: Soup, options: &MeshOptions) -> Result<Mesh, Error> {
        let Soup { positions, triangles, bodies, scene, .. } = soup;
        let welded = Self::weld(triangles, &positions, &bodies, options)?;
        drop(positions);
        Self::from_welded(welded, bodies, scene, options)
    }

    fn weld(
        triangles: Vec<[u32; 3]>,
        positions: &Positions,
        bodies: &[Group],
        options: &MeshOptions,
    ) -> Result<Welded, Error> {
        options.check()?;
        arrays::check(&triangles, positions.len())?;
        check_bodies(bodies, triangles.len())?;
        let welded = weld::weld_exact(weld::Faces { triangles, bodies }, positions);
        Ok(Self::weld_further(welded, bodies, options))
    }

    /// Welds what lies within the distance asked for.
    fn weld_further(welded: Welded, bodies: &[Group], options: &MeshOptions) -> Welded {
        if options.weld > 0.0 { weld_distance::weld_distance(welded, bodies, options.weld) } else { welded }
    }

    fn from_welded(
        welded: Welded,
        bodies: Vec<Group>,
        scene: Option<Scene>,
        options: &MeshOptions,
    ) -> Result<Mesh, Error> {
        let Welded { mut positions, faces, merged_by_distance } = welded;
        let bounds = Bounds::of(positions.iter().copied());
        let origin = if scene.is_some() {
            DVec3::ZERO
        } else {
            bounds.map_or(DVec3::ZERO, |bounds| origin_for(bounds, &positions))
        };
        if origin != DVec3::ZERO {
            positions.par_iter_mut().for_each(|p| *p -= origin);
        }

        let mut states: Vec<FaceState> = faces.par_iter().map(|&f| state_of(f, &positions)).collect();
        let left_out: Vec<bool> =
            states.par_iter().map(|s| matches!(s, FaceState::RepeatedVertex | FaceState::NotFinite)).collect();
        let (topology, found) = Topology::new(faces, positions.len(), &left_out);
        let mut left_out = left_out;
        for (copy, _) in &found.duplicates {
            left_out[copy.index()] = true;
            states[copy.index()] = FaceState::Duplicate;
        }
        let orientation = orientation::orient(&topology, &left_out, &positions);
        let dihedral = Dihedral { topology: &topology, positions: &positions, states: &states };
        let kinds = edges::classify(&dihedral, options.feature_angle);

        let report = MeshReport::of(&Built {
            topology: &topology,
            left_out: &left_out,
            states: &states,
            kinds: &kinds,
            orientation: &orientation,
            non_manifold_edges: found.non_manifold_edges,
            vertices: positions.len(),
            vertices_merged_by_distance: merged_by_distance,
            bounds,
        });
        if !states.contains(&FaceState::Sound) {
            let remedy = if merged_by_distance > 0 { "; try a smaller weld distance" } else { "" };
            let finite = if report.non_finite_faces > 0 { " and finite coordinates" } else { "" };
            return Err(Error::EmptyMesh(format!("none of the {} faces has an area{finite}{remedy}", report.faces)));
        }
        Ok(Mesh {
            origin,
            positions,
            topology,
            kinds,
            states,
            flipped: orientation.flipped,
            duplicates: found.duplicates,
            bodies,
            scene,
            report,
        })
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.topology.face_count()
    }

    /// The point that positions are relative to, in the input's axes and units: zero unless the
    /// mesh lies far from zero for its size.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Positions of all vertices, relative to [`Mesh::origin`].
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// A vertex's position, relative to [`Mesh::origin`].
    #[inline]
    pub fn position(&self, vertex: Vertex) -> DVec3 {
        self.positions[vertex.index()]
    }

    /// Faces and their neighbours.
    #[inline]
    pub fn topology(&self) -> &Topology {
        &self.topology
    }

    /// The three corners of a face in its own winding, relative to [`Mesh::origin`].
    #[inline]
    pub fn triangle(&self, face: Face) -> [DVec3; 3] {
        self.topology.corners(face).map(|v| self.position(v))
    }

    /// The mean of a face's corners.
    pub fn barycentre(&self, face: Face) -> DVec3 {
        let [a, b, c] = self.triangle(face);
        a + ((b - a) + (c - a)) / 3.0
    }

    /// The point at a place of the surface, relative to [`Mesh::origin`].
    pub fn point(&self, place: Place) -> DVec3 {
        let [a, b, c] = self.triangle(place.face);
        // Differences first: exact in the first corner and for coordinates far from zero.
        a + place.weights[1] * (b - a) + place.weights[2] * (c - a)
    }

    /// The unit normal by the winding of the component's majority; zero for a face without area.
    pub fn normal(&self, face: Face) -> DVec3 {
        let [a, b, c] = self.triangle(face);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if self.is_flipped(face) { -normal } else { normal }
    }

    /// Half the length of the cross product of two sides, in file units squared.
    pub fn area(&self, face: Face) -> f64 {
        let [a, b, c] = self.triangle(face);
        0.5 * (b - a).cross(c - a).length()
    }

    /// The mean length of a face's three edges.
    pub fn mean_edge(&self, face: Face) -> f64 {
        let [a, b, c] = self.triangle(face);
        (a.distance(b) + b.distance(c) + c.distance(a)) / 3.0
    }

    /// True for a face all of whose sides are borders.
    pub(crate) fn is_lone(&self, face: Face) -> bool {
        face.half_edges().into_iter().all(|h| self.edge_kind(h) == EdgeKind::Boundary)
    }

    /// The height of a half-edge's face over it.
    pub(crate) fn height(&self, h: HalfEdge) -> f64 {
        let [a, b] = [self.topology.origin(h), self.topology.target(h)].map(|v| self.position(v));
        2.0 * self.area(h.face()) / a.distance(b)
    }

    /// The least of a face's three heights.
    pub fn least_height(&self, face: Face) -> f64 {
        let [a, b, c] = self.triangle(face);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)).sqrt();
        2.0 * self.area(face) / longest
    }

    /// The mean of [`Mesh::mean_edge`] over all faces whose coordinates are finite.
    pub fn mean_edge_of_mesh(&self) -> f64 {
        // Summed in chunks of fixed size, so that the sum does not depend on the threads.
        let chunks: Vec<(f64, usize)> = self
            .states
            .par_chunks(1 << 14)
            .enumerate()
            .map(|(chunk, states)| {
                let first = (chunk << 14) as u32;
                let finite = (first..).zip(states).filter(|(_, s)| **s != FaceState::NotFinite);
                finite.fold((0.0, 0), |(sum, n), (f, _)| (sum + self.mean_edge(Face(f)), n + 1))
            })
            .collect();
        let (sum, count) = chunks.into_iter().fold((0.0, 0), |(s, n), (t, m)| (s + t, n + m));
        sum / count as f64
    }

    /// The kind of a half-edge's edge. For a face left out of the topology: boundary.
    #[inline]
    pub fn edge_kind(&self, h: HalfEdge) -> EdgeKind {
        self.kinds[h.index()]
    }

    /// The angle between the normals of the two faces at an edge, in radians (0 to pi), or `None`
    /// where the edge does not have two faces with a normal.
    pub fn dihedral_angle(&self, h: HalfEdge) -> Option<f64> {
        let twin = self.topology.twin(h)?;
        let (cos, sin) = self.dihedral().cos_sin(h, twin);
        (cos != 0.0 || sin != 0.0).then(|| sin.atan2(cos))
    }

    fn dihedral(&self) -> Dihedral<'_> {
        Dihedral { topology: &self.topology, positions: &self.positions, states: &self.states }
    }

    /// True when one face at the edge looks towards the viewer and the other away from it.
    ///
    /// `view` points from the viewer to the mesh, in any length. A face seen exactly edge-on counts as
    /// looking towards the viewer. An edge with one face is a boundary, not a silhouette.
    pub fn is_silhouette(&self, h: HalfEdge, view: DVec3) -> bool {
        let towards = |f: Face| self.normal(f).dot(view) <= 0.0;
        self.topology.twin(h).is_some_and(|twin| towards(h.face()) != towards(twin.face()))
    }

    /// What is wrong with a face, if anything.
    #[inline]
    pub fn face_state(&self, face: Face) -> FaceState {
        self.states[face.index()]
    }

    /// True when nothing is wrong with a face, so that it gets an estimate.
    #[inline]
    pub(crate) fn is_sound(&self, face: Face) -> bool {
        self.face_state(face) == FaceState::Sound
    }

    /// True for faces that are part of the surface, with an area or without.
    #[inline]
    pub(crate) fn is_in_surface(&self, face: Face) -> bool {
        matches!(self.face_state(face), FaceState::Sound | FaceState::NoArea)
    }

    /// True when the face winds against the majority of its component.
    #[inline]
    pub fn is_flipped(&self, face: Face) -> bool {
        self.flipped[face.index()]
    }

    /// The earlier face with the same three vertices.
    pub fn duplicate_of(&self, face: Face) -> Option<Face> {
        let at = self.duplicates.binary_search_by_key(&face, |&(copy, _)| copy).ok()?;
        Some(self.duplicates[at].1)
    }

    /// Faces over the vertices of an earlier one, and that one.
    pub(crate) fn duplicates(&self) -> &[(Face, Face)] {
        &self.duplicates
    }

    /// Runs of faces that share a coordinate space, in face order (see [`Soup::bodies`]).
    pub fn bodies(&self) -> &[Group] {
        &self.bodies
    }

    /// The placement of the bodies, for inputs that have one.
    pub fn scene(&self) -> Option<&Scene> {
        self.scene.as_ref()
    }

    /// What the construction found.
    pub fn report(&self) -> &MeshReport {
        &self.report
    }
}

/// Per axis zero, unless the mesh lies so far from zero that 32-bit coordinates would lose more than
/// about a millionth of its size; then the middle of its box. Coordinates there are within a factor
/// of two of the origin, so that subtracting it is exact (Sterbenz' lemma).
///
/// A few vertices far from all others, such as those a program left at zero, do not count.
fn origin_for(bounds: Bounds, positions: &[DVec3]) -> DVec3 {
    let nearer = lie_on_one_side(positions);
    let axis = |i: usize| {
        let without_strays = || nearer[i].then(|| middle_if_far(range_of_most(positions, i)?)).flatten();
        middle_if_far((bounds.min[i], bounds.max[i])).or_else(without_strays).unwrap_or(0.0)
    };
    let origin = DVec3::new(axis(0), axis(1), axis(2));
    if origin.is_finite() { origin } else { DVec3::ZERO }
}

fn middle_if_far((low, high): (f64, f64)) -> Option<f64> {
    const FAR: f64 = 16.0;
    let size = high - low;
    (low.abs().max(high.abs()) > FAR * size && size > 0.0).then_some(0.5 * (low + high))
}

/// For each axis, whether the mean of the coordinates is more than two standard deviations from zero: where it is not,
/// most vertices do not lie far from zero, whatever a few do.
fn lie_on_one_side(positions: &[DVec3]) -> [bool; 3] {
    let sums = |chunk: &[DVec3]| {
        let finite = chunk.iter().filter(|p| p.is_finite());
        finite.fold((DVec3::ZERO, DVec3::ZERO, 0), |(sum, squares, n), &p| (sum + p, squares + p * p, n + 1))
    };
    let sums: Vec<(DVec3, DVec3, usize)> = positions.par_chunks(1 << 14).map(sums).collect();
    let (sum, squares, count) =
        sums.into_iter().fold((DVec3::ZERO, DVec3::ZERO, 0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
    let (mean, squares) = (sum / count as f64, squares / count as f64);
    [0, 1, 2].map(|i| mean[i] * mean[i] > 4.0 * (squares[i] - mean[i] * mean[i]))
}

/// The range along an axis of all but a twentieth of the vertices on either side.
fn range_of_most(positions: &[DVec3], axis: usize) -> Option<(f64, f64)> {
    let mut along: Vec<f64> = positions.iter().map(|p| p[axis]).filter(|c| c.is_finite()).collect();
    let aside = along.len() / 20;
    let last = along.len().checked_sub(1 + aside)?;
    let low = *along.select_nth_unstable_by(aside, f64::total_cmp).1;
    let high = *along.select_nth_unstable_by(last, f64::total_cmp).1;
    Some((low, high))
}

fn state_of(face: [u32; 3], positions: &[DVec3]) -> FaceState {
    let [a, b, c] = face.map(|v| positions[v as usize]);
    if !(a.is_finite() && b.is_finite() && c.is_finite()) {
        return FaceState::NotFinite;
    }
    if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
        return FaceState::RepeatedVertex;
    }
    // The area vector's own rounding error, from the corners' and from the products': below it the
    // sign of the area says nothing. No tolerance beyond that.
    let (u, v) = (b - a, c - a);
    let size = a.abs().max(b.abs()).max(c.abs()).max_element();
    let rounding = 4.0 * f64::EPSILON * (u.length() * v.length() + size * u.length().max(v.length()));
    if u.cross(v).length() > rounding { FaceState::Sound } else { FaceState::NoArea }
}

/// Refuses bodies that leave faces out or share some.
fn check_bodies(bodies: &[Group], faces: usize) -> Result<(), Error> {
    let follow = |end, body: &Group| (body.faces.start == end && body.faces.end >= end).then_some(body.faces.end);
    if bodies.iter().try_fold(0, follow).is_some_and(|end| end as usize == faces) {
        return Ok(());
    }
    Err(Error::Usage(format!("the bodies must follow one another over all {faces} faces")))
}
