//! Components, the winding of their majority, and boundary loops.

use super::ids::{Face, HalfEdge};
use super::topology::{Across, Topology};
use glam::DVec3;

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

/// Joins faces to components and decides each one's winding by the majority of its faces; where both
/// windings have as many, by the larger area, then by the component's first face.
pub(super) fn orient(topology: &Topology, left_out: &[bool], positions: &[DVec3]) -> Orientation {
    let count = topology.face_count();
    let mut windings = Windings::new(count);
    let mut twisted: Vec<u32> = Vec::new();
    for face in (0..count as u32).map(Face) {
        for h in face.half_edges() {
            if let Some(twin) = topology.twin(h).filter(|twin| *twin < h)
                && !windings.join(face.0, twin.face().0, topology.is_flipped(h, twin))
            {
                twisted.push(face.0);
            }
        }
    }
    // Per face the number of its component, and per component what its faces add up to.
    let mut component_of = vec![0_u32; count];
    let mut components: Vec<Component> = Vec::new();
    let mut flipped = vec![false; count];
    for f in (0..count).filter(|&f| !left_out[f]) {
        let (root, is_against) = windings.root(f as u32);
        // A component is known by its first face, which comes before all others.
        if root as usize == f {
            component_of[f] = components.len() as u32;
            components.push(Component::new(positions[topology.corners(Face(f as u32))[0].index()]));
        }
        component_of[f] = component_of[root as usize];
        flipped[f] = is_against;
        components[component_of[f] as usize].add(topology, positions, Face(f as u32), is_against);
    }
    for face in twisted {
        components[component_of[face as usize] as usize].is_twisted = true;
    }
    for f in (0..count).filter(|&f| !left_out[f]) {
        let component = &components[component_of[f] as usize];
        flipped[f] = !component.is_twisted && flipped[f] != component.is_turned();
    }
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
    /// are fewer than 2^31 faces, since half-edges are numbered in 32 bits.
    parents: Vec<u32>,
}

impl Windings {
    fn new(count: usize) -> Self {
        Windings { parents: (0..count as u32).map(|f| f << 1).collect() }
    }

    /// The first face of the component as far as it is joined, and whether `face` winds against it.
    #[inline]
    fn root(&mut self, mut face: u32) -> (u32, bool) {
        let mut against = 0;
        loop {
            let link = self.parents[face as usize];
            let parent = link >> 1;
            if parent == face {
                return (face, against != 0);
            }
            // Every second face on the way skips its parent from now on.
            let skipping = self.parents[parent as usize] ^ (link & 1);
            self.parents[face as usize] = skipping;
            against ^= skipping & 1;
            face = skipping >> 1;
        }
    }

    /// Joins two faces, one of which winds against the other where `is_flipped`; false where they are
    /// joined already and this contradicts it.
    #[inline]
    fn join(&mut self, a: u32, b: u32, is_flipped: bool) -> bool {
        let ((a, a_against), (b, b_against)) = (self.root(a), self.root(b));
        let is_against = is_flipped ^ a_against ^ b_against;
        if a == b {
            return !is_against;
        }
        self.parents[a.max(b) as usize] = a.min(b) << 1 | u32::from(is_against);
        true
    }
}

/// What the faces of a component add up to.
struct Component {
    /// Any of its vertices.
    base: DVec3,
    faces: usize,
    /// Faces that wind against the first one.
    against: usize,
    /// Area of the faces that wind against the first one, less that of the others, times two.
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

    #[inline]
    fn add(&mut self, topology: &Topology, positions: &[DVec3], face: Face, is_against: bool) {
        let [a, b, c] = topology.corners(face).map(|v| positions[v.index()] - self.base);
        let sign = if is_against { -1.0 } else { 1.0 };
        self.faces += 1;
        self.against += usize::from(is_against);
        self.balance -= sign * (b - a).cross(c - a).length();
        self.volume += sign * a.cross(b).dot(c);
        self.is_closed &= face.half_edges().iter().all(|&h| topology.twin(h).is_some());
    }

    /// True where the majority winds against the first face.
    fn is_turned(&self) -> bool {
        match (2 * self.against).cmp(&self.faces) {
            std::cmp::Ordering::Less => false,
            std::cmp::Ordering::Greater => true,
            std::cmp::Ordering::Equal => self.balance > 0.0,
        }
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
    let mut parent: Vec<usize> = (0..boundary.len()).collect();
    for (i, &h) in boundary.iter().enumerate() {
        for start in [h.next(), h.prev()] {
            if let Some(j) = end_of_fan(topology, h, start).and_then(|end| boundary.binary_search(&end).ok()) {
                let (a, b) = (root(&mut parent, i), root(&mut parent, j));
                if a != b {
                    parent[a.max(b)] = a.min(b);
                    loops -= 1;
                }
            }
        }
    }
    loops
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
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
            Across::Twin(twin) => {
                let next = twin.next();
                side = if topology.origin(next) == hub || topology.target(next) == hub { next } else { twin.prev() };
            }
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
