//! Components, the winding of their majority, and boundary loops.

use super::ids::{Face, HalfEdge};
use super::topology::{Across, Topology};
use glam::DVec3;

/// What a flood over the faces of a topology found.
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

/// Floods the components and decides each one's winding by the majority of its faces; where both
/// windings have as many, by the larger area, then by the component's first face.
pub(super) fn orient(topology: &Topology, left_out: &[bool], positions: &[DVec3]) -> Orientation {
    let count = topology.face_count();
    let mut found = Orientation { flipped: vec![false; count], components: 0, non_orientable: 0, inside_out: 0 };
    let mut seen = left_out.to_vec();
    let mut component: Vec<Face> = Vec::new();
    for seed in (0..count as u32).map(Face) {
        if seen[seed.index()] {
            continue;
        }
        found.components += 1;
        seen[seed.index()] = true;
        component.clear();
        component.push(seed);
        let mut next = 0;
        let (mut consistent, mut closed) = (true, true);
        while next < component.len() {
            let face = component[next];
            next += 1;
            for h in face.half_edges() {
                let Some(twin) = topology.twin(h) else {
                    closed = false;
                    continue;
                };
                let other = twin.face().index();
                let winding = found.flipped[face.index()] ^ topology.is_flipped(h, twin);
                if seen[other] {
                    consistent &= found.flipped[other] == winding;
                } else {
                    seen[other] = true;
                    found.flipped[other] = winding;
                    component.push(twin.face());
                }
            }
        }
        if !consistent {
            found.non_orientable += 1;
            for face in &component {
                found.flipped[face.index()] = false;
            }
            continue;
        }
        let against = component.iter().filter(|f| found.flipped[f.index()]).count();
        let turn = match (2 * against).cmp(&component.len()) {
            std::cmp::Ordering::Less => false,
            std::cmp::Ordering::Greater => true,
            std::cmp::Ordering::Equal => flipped_area_is_larger(topology, positions, &component, &found.flipped),
        };
        if turn {
            for face in &component {
                found.flipped[face.index()] ^= true;
            }
        }
        if closed && signed_volume(topology, positions, &component, &found.flipped) < 0.0 {
            found.inside_out += 1;
        }
    }
    found
}

fn flipped_area_is_larger(topology: &Topology, positions: &[DVec3], component: &[Face], flipped: &[bool]) -> bool {
    let balance: f64 = component
        .iter()
        .map(|&f| {
            let [a, b, c] = topology.corners(f).map(|v| positions[v.index()]);
            let area = (b - a).cross(c - a).length();
            if flipped[f.index()] { area } else { -area }
        })
        .sum();
    balance > 0.0
}

/// Six times the volume that a closed component encloses, measured from one of its own vertices.
fn signed_volume(topology: &Topology, positions: &[DVec3], component: &[Face], flipped: &[bool]) -> f64 {
    let base = positions[topology.corners(component[0])[0].index()];
    component
        .iter()
        .map(|&f| {
            let [a, b, c] = topology.corners(f).map(|v| positions[v.index()] - base);
            let six_volumes = a.cross(b).dot(c);
            if flipped[f.index()] { -six_volumes } else { six_volumes }
        })
        .sum()
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
    fn two_fans_that_touch_in_a_vertex_have_two_loops() {
        let (t, out) = topology(&[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(boundary_loops(&t, &out), 2);
    }
}
