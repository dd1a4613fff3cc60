//! Gives one number to all corners that share a position.

use super::report::Bounds;
use crate::soup::{Group, Positions, Soup};
use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasher, RandomState};

/// Welded vertices and the faces over them.
pub(super) struct Welded {
    /// One position per vertex, numbered by first use in face order; -0.0 has become 0.0.
    pub(super) positions: Vec<DVec3>,
    /// Vertex numbers per face.
    pub(super) faces: Vec<[u32; 3]>,
    /// Vertices that another vertex at most the weld distance away has absorbed.
    pub(super) merged_by_distance: usize,
}

const NONE: u32 = u32::MAX;

/// Welds corners whose coordinates are equal, body by body.
pub(super) fn weld_exact(soup: &Soup) -> Welded {
    // A closed mesh has half as many vertices as faces: sized by that, a soup whose corners are
    // all apart grows its table three times, which is cheaper than clearing a table for the worst.
    let mut table = VertexTable::new(soup.face_count() / 2);
    let mut vertex_of: Vec<u32> = vec![NONE; soup.positions.len()];
    let mut faces = Vec::with_capacity(soup.face_count());
    for body in &soup.bodies {
        let first = table.begin_body();
        for triangle in body_triangles(soup, body) {
            faces.push(triangle.map(|corner| {
                let known = &mut vertex_of[corner as usize];
                // A number from before this body belongs to another coordinate space.
                if *known == NONE || *known < first {
                    *known = table.vertex_at(canonical(&soup.positions, corner));
                }
                *known
            }));
        }
    }
    Welded { positions: table.positions, faces, merged_by_distance: 0 }
}

fn body_triangles<'s>(soup: &'s Soup, body: &Group) -> &'s [[u32; 3]] {
    &soup.triangles[body.faces.start as usize..body.faces.end as usize]
}

/// Adding 0.0 turns -0.0 into 0.0 and leaves every other number as it is.
fn canonical(positions: &Positions, index: u32) -> DVec3 {
    positions.get(index as usize) + DVec3::ZERO
}

/// A hash table with linear probing that holds vertex numbers only; keys are their positions.
struct VertexTable {
    slots: Vec<u32>,
    positions: Vec<DVec3>,
    /// The first vertex of each body; part of the seed of the body's hashes.
    bodies: Vec<u32>,
    /// Different in every run, so that no file can be made to collide. The numbering does not
    /// depend on it.
    secret: u64,
}

impl VertexTable {
    fn new(expected: usize) -> Self {
        let capacity = (2 * expected.max(8)).next_power_of_two();
        VertexTable {
            slots: vec![NONE; capacity],
            positions: Vec::with_capacity(expected),
            bodies: vec![0],
            secret: RandomState::new().hash_one(0),
        }
    }

    /// Vertices made from here on are not found by positions of before. Returns the next number.
    fn begin_body(&mut self) -> u32 {
        let first = self.positions.len() as u32;
        self.bodies.push(first);
        first
    }

    /// The vertex of this body at `position`, made if there is none yet.
    fn vertex_at(&mut self, position: DVec3) -> u32 {
        if 2 * (self.positions.len() + 1) > self.slots.len() {
            self.grow();
        }
        let first = self.bodies[self.bodies.len() - 1];
        let bits = bits_of(position);
        let mask = self.slots.len() - 1;
        let mut slot = hash(bits, self.secret ^ u64::from(first)) as usize & mask;
        loop {
            let vertex = self.slots[slot];
            if vertex == NONE {
                let new = self.positions.len() as u32;
                self.slots[slot] = new;
                self.positions.push(position);
                return new;
            }
            if vertex >= first && bits_of(self.positions[vertex as usize]) == bits {
                return vertex;
            }
            slot = (slot + 1) & mask;
        }
    }

    fn grow(&mut self) {
        let mask = 2 * self.slots.len() - 1;
        let mut slots = vec![NONE; mask + 1];
        let mut bodies = self.bodies.iter().peekable();
        let mut first = 0;
        for (vertex, &position) in self.positions.iter().enumerate() {
            while let Some(&next) = bodies.next_if(|&&next| next as usize <= vertex) {
                first = next;
            }
            let mut slot = hash(bits_of(position), self.secret ^ u64::from(first)) as usize & mask;
            while slots[slot] != NONE {
                slot = (slot + 1) & mask;
            }
            slots[slot] = vertex as u32;
        }
        self.slots = slots;
    }
}

fn bits_of(p: DVec3) -> [u64; 3] {
    p.to_array().map(f64::to_bits)
}

/// Multiply and fold, once per coordinate. The seed keeps equal positions of different bodies
/// (ten thousand copies of a screw) from queueing up behind one another.
fn hash(bits: [u64; 3], seed: u64) -> u64 {
    bits.iter().fold(seed, |h, &b| {
        let product = u128::from((h ^ b).wrapping_add(0x9e37_79b9_7f4a_7c15)) * 0xd6e8_feb8_6659_fd93;
        (product as u64) ^ ((product >> 64) as u64)
    })
}

/// Merges vertices that a chain of steps of at most `distance` connects, body by body.
///
/// The merged vertex keeps the position that is least in (x, y, z) order, so that the result does
/// not depend on the order of the faces.
pub(super) fn weld_distance(mut welded: Welded, bodies: &[Group], distance: f64) -> Welded {
    let before = welded.positions.len();
    let mut clusters = Clusters::new(before);
    let mut first = 0;
    for body in bodies {
        let faces = &welded.faces[body.faces.start as usize..body.faces.end as usize];
        let end = faces.iter().flatten().map(|&v| v + 1).max().unwrap_or(first).max(first);
        clusters.join_close(&welded.positions, first..end, distance);
        first = end;
    }
    let representative = clusters.representatives(&welded.positions);
    let mut number = vec![NONE; before];
    let mut positions = Vec::new();
    for corner in welded.faces.iter_mut().flatten() {
        let kept = representative[*corner as usize];
        if number[kept as usize] == NONE {
            number[kept as usize] = positions.len() as u32;
            positions.push(welded.positions[kept as usize]);
        }
        *corner = number[kept as usize];
    }
    Welded { merged_by_distance: before - positions.len(), positions, faces: welded.faces }
}

/// Union-find over vertices.
struct Clusters {
    parent: Vec<u32>,
}

impl Clusters {
    fn new(count: usize) -> Self {
        Clusters { parent: (0..count as u32).collect() }
    }

    fn root(&mut self, mut v: u32) -> u32 {
        while self.parent[v as usize] != v {
            self.parent[v as usize] = self.parent[self.parent[v as usize] as usize];
            v = self.parent[v as usize];
        }
        v
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// Sorts the vertices into cubes whose diagonal is the distance: all of one cube belong
    /// together, and only cubes at most two apart can hold another close vertex.
    fn join_close(&mut self, positions: &[DVec3], vertices: std::ops::Range<u32>, distance: f64) {
        let side = distance / 3.0_f64.sqrt();
        let inside = positions[vertices.start as usize..vertices.end as usize].iter().copied();
        let Some(bounds) = Bounds::of(inside) else { return };
        // Below the rounding of the coordinates nothing is close but what is equal, and equal is one.
        if bounds.size().max_element() / side > 2.0_f64.powi(53) {
            return;
        }
        let mut cubes: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for v in vertices {
            let p = positions[v as usize];
            if p.is_finite() {
                let cube = ((p - bounds.min) / side).floor().to_array().map(|c| c as i64);
                cubes.entry(cube).or_default().push(v);
            }
        }
        for members in cubes.values() {
            for pair in members.windows(2) {
                self.join(pair[0], pair[1]);
            }
        }
        for (cube, members) in &cubes {
            for step in half_of_the_neighbours() {
                let near = [0, 1, 2].map(|i| cube[i].saturating_add(step[i]));
                let Some(others) = cubes.get(&near) else { continue };
                if self.root(members[0]) == self.root(others[0]) {
                    continue;
                }
                let close = members.iter().any(|&a| {
                    others
                        .iter()
                        .any(|&b| positions[a as usize].distance_squared(positions[b as usize]) <= distance * distance)
                });
                if close {
                    self.join(members[0], others[0]);
                }
            }
        }
    }

    /// Per vertex, the member of its cluster whose position is least.
    fn representatives(&mut self, positions: &[DVec3]) -> Vec<u32> {
        let count = positions.len() as u32;
        let mut least: Vec<u32> = (0..count).collect();
        for v in 0..count {
            let root = self.root(v) as usize;
            let (p, q) = (positions[v as usize].to_array(), positions[least[root] as usize].to_array());
            if p < q {
                least[root] = v;
            }
        }
        (0..count).map(|v| least[self.root(v) as usize]).collect()
    }
}

/// One of each pair of opposite steps between cubes at most two apart.
fn half_of_the_neighbours() -> impl Iterator<Item = [i64; 3]> {
    (-2..=2).flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| [x, y, z]))).filter(|step| *step > [0, 0, 0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn soup_of(points: &[[f64; 3]]) -> Soup {
        let triangles = (0..points.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        Soup::new(Positions::F64(points.to_vec()), triangles)
    }

    #[test]
    fn negative_zero_is_zero() {
        let welded = weld_exact(&soup_of(&[
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-0.0, 0.0, -0.0],
            [1.0, -0.0, 0.0],
            [0.0, 0.0, 1.0],
        ]));
        assert_eq!(welded.faces, [[0, 1, 2], [0, 1, 3]]);
    }

    #[test]
    fn bodies_stay_apart_however_often_the_table_grows() {
        let mut soup = soup_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].repeat(500));
        soup.bodies = (0..500).map(|f| Group { name: String::new(), faces: f..f + 1 }).collect();
        assert_eq!(weld_exact(&soup).positions.len(), 1500);
        soup.bodies = vec![Group { name: String::new(), faces: 0..500 }];
        assert_eq!(weld_exact(&soup).positions.len(), 3);
    }

    #[test]
    fn weld_distance_merges_chains_and_nothing_else() {
        let soup = soup_of(&[
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 0.009],
            [1.0, 0.0, 0.018],
            [1.0, 0.0, 0.009],
        ]);
        let welded = weld_distance(weld_exact(&soup), &soup.bodies, 0.01);
        assert_eq!(welded.faces, [[0, 1, 2], [0, 1, 1]]);
        assert_eq!(welded.merged_by_distance, 3);
        let apart = weld_distance(weld_exact(&soup), &soup.bodies, 0.008);
        assert_eq!(apart.merged_by_distance, 0);
    }
}
