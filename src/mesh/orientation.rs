//! Components, the winding of their majority, and boundary loops.

use super::clusters::Clusters;
use super::ids::{Face, HalfEdge};
use super::topology::{Across, Topology};
use glam::DVec3;
use rayon::prelude::*;

/// What joining the faces of a topology found.
pub(super) struct Orientation {
    /// Per face, true when it winds against its component's majority.
    pub(super) flipped: Vec<bool>,
    /// Number of components: faces connected over edges that have two faces.
    pub(super) components: usize,
    /// Components on which no consistent winding exists, such as a Moebius strip.
    pub(super) non_orientable: usize,
    /// Closed components whose normals point inwards.
    pub(super) inside_out: usize,
}

/// Faces that are joined among themselves first, on one thread.
const BLOCK: usize = 1 << 16;
/// Components at most of which each block of faces has sums of its own.
const FEW_COMPONENTS: usize = 64;

/// Joins faces to components and decides each one's winding by the majority of its faces; where both
/// windings have as many, by the larger area, then by the component's first face.
pub(super) fn orient(topology: &Topology, left_out: &[bool], positions: &[DVec3]) -> Orientation {
    let (mut windings, twisted) = Windings::of(topology);
    let first_faces = windings.number_components(left_out);
    let mut components = Component::sum(topology, &windings, left_out, positions, &first_faces);
    for face in twisted {
        components[windings.component(face).0].is_twisted = true;
    }
    if components.iter().any(Component::is_undecided) {
        // Rare, and costs a root for each face.
        for f in (0..topology.face_count()).filter(|&f| !left_out[f]) {
            let (component, is_against) = windings.component(f as u32);
            let [a, b, c] = topology.corners(Face(f as u32)).map(|v| positions[v.index()] - components[component].base);
            let area = (b - a).cross(c - a).length();
            components[component].balance += if is_against { area } else { -area };
        }
    }
    let is_turned: Vec<bool> = components.iter().map(Component::is_turned).collect();
    let flipped = (0..topology.face_count())
        .into_par_iter()
        .map(|f| {
            let (component, is_against) = windings.component(f as u32);
            !left_out[f] && !components[component].is_twisted && is_against != is_turned[component]
        })
        .collect();
    Orientation {
        flipped,
        components: components.len(),
        non_orientable: components.iter().filter(|c| c.is_twisted).count(),
        inside_out: components.iter().filter(|c| c.is_inside_out()).count(),
    }
}

/// Faces that hang together, and whether each winds as the first of its component does: a forest in
/// which every face knows whether it winds against its parent.
struct Windings {
    /// Twice the parent, which is no larger than the face, plus one where the face winds against it. There
    /// are fewer than 2^31 faces, since half-edges are numbered in 32 bits. In the end the component in the parent's
    /// place.
    links: Vec<u32>,
}

/// The forest of a run of faces.
struct Forest<'w> {
    first: u32,
    /// As in [`Windings`], counted from the first face.
    links: &'w mut [u32],
}

impl Windings {
    /// Joins all faces of a topology; with it, faces at which that fails for there is no consistent winding.
    fn of(topology: &Topology) -> (Self, Vec<u32>) {
        let count = topology.face_count();
        let mut links = vec![0_u32; count];
        // Most neighbours are in the same block; what goes from one to another is joined afterwards.
        let joins: Vec<[Vec<u32>; 2]> = links
            .par_chunks_mut(BLOCK)
            .enumerate()
            .map(|(block, links)| {
                let first = (block * BLOCK) as u32;
                links.iter_mut().zip(0..).for_each(|(link, face)| *link = face << 1);
                let mut forest = Forest { first, links };
                let (mut outward, mut twisted) = (Vec::new(), Vec::new());
                for face in (first..first + forest.links.len() as u32).map(Face) {
                    let mut root = Root { face: face.0 - first, is_against: 0 };
                    for h in face.half_edges() {
                        match topology.twin(h).filter(|twin| *twin < h) {
                            Some(twin) if twin.face().0 < first => outward.push(h.0),
                            Some(twin) if !forest.join(&mut root, topology, h, twin) => twisted.push(face.0),
                            _ => {}
                        }
                    }
                }
                forest.links.iter_mut().for_each(|link| *link += first << 1);
                [outward, twisted]
            })
            .collect();
        let mut forest = Forest { first: 0, links: &mut links };
        let mut twisted = Vec::new();
        for [outward, within] in joins {
            twisted.extend(within);
            for h in outward.into_iter().map(HalfEdge) {
                let mut root = forest.root(h.face().0);
                if topology.twin(h).is_some_and(|twin| !forest.join(&mut root, topology, h, twin)) {
                    twisted.push(h.face().0);
                }
            }
        }
        (Windings { links }, twisted)
    }

    /// Puts the component in the place of each face's parent, and gives the first face of each component. Faces that
    /// are left out are in the first, for want of one.
    fn number_components(&mut self, left_out: &[bool]) -> Vec<Face> {
        let mut first_faces = Vec::new();
        for (face, &left_out) in left_out.iter().enumerate() {
            let link = self.links[face];
            let parent = (link >> 1) as usize;
            // A parent comes first, and so has its component already.
            self.links[face] = if parent < face {
                self.links[parent] ^ (link & 1)
            } else if left_out {
                0
            } else {
                first_faces.push(Face(face as u32));
                (first_faces.len() as u32 - 1) << 1
            };
        }
        first_faces
    }

    /// A face's component, and whether it winds against the first face of it.
    #[inline]
    fn component(&self, face: u32) -> (usize, bool) {
        let link = self.links[face as usize];
        ((link >> 1) as usize, link & 1 == 1)
    }
}

/// The first face of a component as far as it is joined.
struct Root {
    /// Counted from the first face of the forest.
    face: u32,
    /// 1 where the face whose root it is winds against it.
    is_against: u32,
}

impl Forest<'_> {
    /// The root of a face.
    #[inline]
    fn root(&mut self, mut face: u32) -> Root {
        let mut is_against = 0;
        loop {
            let link = self.links[face as usize];
            let parent = link >> 1;
            if parent == face {
                return Root { face, is_against };
            }
            // Every second face on the way skips its parent from now on.
            let skipping = self.links[parent as usize] ^ (link & 1);
            self.links[face as usize] = skipping;
            is_against ^= skipping & 1;
            face = skipping >> 1;
        }
    }

    /// Joins the face of a half-edge, whose root is known, and that of its twin; false where they are joined already
    /// and this contradicts it.
    #[inline]
    fn join(&mut self, root: &mut Root, topology: &Topology, h: HalfEdge, twin: HalfEdge) -> bool {
        let other = self.root(twin.face().0 - self.first);
        let is_against = u32::from(topology.is_flipped(h, twin)) ^ root.is_against ^ other.is_against;
        if root.face == other.face {
            return is_against == 0;
        }
        self.links[root.face.max(other.face) as usize] = root.face.min(other.face) << 1 | is_against;
        if other.face < root.face {
            *root = Root { face: other.face, is_against: root.is_against ^ is_against };
        }
        true
    }
}

/// What the faces of a component add up to.
#[derive(Clone)]
struct Component {
    /// Any of its vertices.
    base: DVec3,
    faces: usize,
    /// Faces that wind against the first one.
    against: usize,
    /// Area of the faces that wind against the first one, less that of the others, times two; only where numbers do not
    /// decide.
    balance: f64,
    /// Six times the volume inside, with the winding of the first face.
    volume: f64,
    is_closed: bool,
    /// No consistent winding exists.
    is_twisted: bool,
}

impl Component {
    fn new(base: DVec3) -> Self {
        Component { base, faces: 0, against: 0, balance: 0.0, volume: 0.0, is_closed: true, is_twisted: false }
    }

    /// Adds up the faces of each component, in blocks whose number does not depend on that of the threads.
    fn sum(
        topology: &Topology,
        windings: &Windings,
        left_out: &[bool],
        positions: &[DVec3],
        first_faces: &[Face],
    ) -> Vec<Component> {
        let first_vertex = |face: &Face| positions[topology.corners(*face)[0].index()];
        let empty: Vec<Component> = first_faces.iter().map(|face| Component::new(first_vertex(face))).collect();
        // Of many components every block would have to hold all.
        let block = if empty.len() > FEW_COMPONENTS { left_out.len().max(1) } else { BLOCK };
        let sums: Vec<Vec<Component>> = left_out
            .par_chunks(block)
            .enumerate()
            .map(|(n, left_out)| {
                let mut components = empty.clone();
                for f in (0..left_out.len()).filter(|&f| !left_out[f]) {
                    let face = Face((n * block + f) as u32);
                    let (component, is_against) = windings.component(face.0);
                    components[component].add(topology, positions, face, is_against);
                }
                components
            })
            .collect();
        sums.into_iter().fold(empty, |mut all, block| {
            all.iter_mut().zip(block).for_each(|(sum, part)| {
                sum.faces += part.faces;
                sum.against += part.against;
                sum.volume += part.volume;
                sum.is_closed &= part.is_closed;
            });
            all
        })
    }

    #[inline]
    fn add(&mut self, topology: &Topology, positions: &[DVec3], face: Face, is_against: bool) {
        let [a, b, c] = topology.corners(face).map(|v| positions[v.index()] - self.base);
        let volume = a.cross(b).dot(c);
        self.faces += 1;
        self.against += usize::from(is_against);
        self.volume += if is_against { -volume } else { volume };
        self.is_closed &= face.half_edges().iter().all(|&h| topology.twin(h).is_some());
    }

    /// True where as many faces wind one way as the other.
    fn is_undecided(&self) -> bool {
        2 * self.against == self.faces
    }

    /// True where the majority winds against the first face.
    fn is_turned(&self) -> bool {
        if self.is_undecided() { self.balance > 0.0 } else { 2 * self.against > self.faces }
    }

    fn is_inside_out(&self) -> bool {
        let volume = if self.is_turned() { -self.volume } else { self.volume };
        self.is_closed && !self.is_twisted && volume < 0.0
    }
}

/// Counts the loops of edges that have one face only.
///
/// At a vertex where several loops touch, each loop continues along its own fan of faces.
pub(super) fn boundary_loops(topology: &Topology, left_out: &[bool]) -> usize {
    let boundary: Vec<HalfEdge> = (0..topology.face_count() as u32)
        .map(Face)
        .filter(|f| !left_out[f.index()])
        .flat_map(Face::half_edges)
        .filter(|&h| topology.across(h) == Across::Boundary)
        .collect();
    let mut loops = boundary.len();
    let mut clusters = Clusters::new(boundary.len());
    for (i, &h) in boundary.iter().enumerate() {
        for start in [h.next(), h.prev()] {
            if let Some(j) = end_of_fan(topology, h, start).and_then(|end| boundary.binary_search(&end).ok()) {
                loops -= usize::from(clusters.join(i as u32, j as u32));
            }
        }
    }
    loops
}

/// Turns around the vertex that `h` and `start` (sides of one face) share until an edge without a
/// face across is met; `None` at an edge with several.
fn end_of_fan(topology: &Topology, h: HalfEdge, start: HalfEdge) -> Option<HalfEdge> {
    let hub = if start == h.next() { topology.target(h) } else { topology.origin(h) };
    let mut side = start;
    loop {
        match topology.across(side) {
            Across::Boundary => return Some(side),
            Across::NonManifold => return None,
            Across::Twin(twin) => side = topology.other_side_at(twin, hub),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topology(faces: &[[u32; 3]]) -> (Topology, Vec<bool>) {
        let vertices = faces.iter().flatten().max().map_or(0, |v| *v as usize + 1);
        let left_out = vec![false; faces.len()];
        (Topology::new(faces.to_vec(), vertices, &left_out).0, left_out)
    }

    #[test]
    fn a_strip_with_a_half_twist_is_not_orientable() {
        let (t, out) = topology(&[[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5], [4, 5, 1], [1, 5, 0]]);
        let found = orient(&t, &out, &[DVec3::ZERO; 6]);
        assert_eq!((found.components, found.non_orientable), (1, 1));
        assert_eq!(boundary_loops(&t, &out), 1);
    }

    #[test]
    fn the_majority_decides_and_the_minority_is_flipped() {
        let (t, out) = topology(&[[0, 1, 2], [1, 2, 3], [2, 4, 3]]);
        let found = orient(&t, &out, &[DVec3::ZERO; 5]);
        assert_eq!(found.flipped, [true, false, false]);
    }

    #[test]
    fn a_tie_is_decided_by_area_and_an_inside_out_solid_is_found() {
        let (t, out) = topology(&[[0, 1, 2], [1, 2, 3]]);
        let corners = |size: f64| [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::splat(size)];
        assert_eq!(orient(&t, &out, &corners(9.0)).flipped, [true, false]);
        assert_eq!(orient(&t, &out, &corners(0.6)).flipped, [false, true]);
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let (t, out) = topology(&faces);
        let found = orient(&t, &out, &corners);
        assert_eq!((found.flipped, found.components, found.inside_out), (vec![false; 4], 1, 0));
        let (t, out) = topology(&faces.map(|[a, b, c]| [b, a, c]));
        let found = orient(&t, &out, &corners);
        assert_eq!((found.flipped, found.components, found.inside_out), (vec![false; 4], 1, 1));
    }

    #[test]
    fn two_fans_that_touch_in_a_vertex_have_two_loops() {
        let (t, out) = topology(&[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(boundary_loops(&t, &out), 2);
    }
}
