//! The vertices and faces around a face, as far as no sharp edge lies between.

use crate::mesh::{EdgeKind, Face, FaceState, HalfEdge, Mesh, Vertex};
use glam::DVec3;

/// Of more faces at one vertex, as in the middle of a fan, a window takes only the nearest: time for a
/// window is bounded.
const CROWDED: usize = 256;

/// The faces at every vertex, and what is needed to tell which of them hang together.
pub(super) struct Stars {
    ends: Vec<u32>,
    faces: Vec<u32>,
    /// True where the faces at a vertex fall apart: sharp or non-manifold edges, or several borders.
    divided: Vec<bool>,
}

impl Stars {
    pub(super) fn new(mesh: &Mesh, ignore_features: bool) -> Self {
        let topology = mesh.topology();
        let count = mesh.positions().len();
        let takes_part = |f: Face| matches!(mesh.face_state(f), FaceState::Sound | FaceState::NoArea);
        let all = || (0..mesh.face_count() as u32).map(Face).filter(|&f| takes_part(f));
        let mut ends = vec![0_u32; count + 1];
        let (mut borders, mut divided) = (vec![0_u8; count], vec![false; count]);
        for f in all() {
            for h in f.half_edges() {
                let v = topology.origin(h);
                ends[v.index() + 1] += 1;
                let kind = mesh.edge_kind(h);
                let both = [v, topology.target(h)].map(Vertex::index);
                match kind {
                    EdgeKind::Boundary => both.into_iter().for_each(|v| borders[v] = borders[v].saturating_add(1)),
                    EdgeKind::NonManifold => both.into_iter().for_each(|v| divided[v] = true),
                    EdgeKind::Feature if !ignore_features => both.into_iter().for_each(|v| divided[v] = true),
                    EdgeKind::Feature | EdgeKind::Inner => {}
                }
            }
        }
        for (divided, borders) in divided.iter_mut().zip(borders) {
            *divided |= borders > 2;
        }
        for v in 1..=count {
            ends[v] += ends[v - 1];
        }
        let mut faces = vec![0; ends[count] as usize];
        // Filling from the back moves each end to its start, which is where the one before it ends.
        for f in (0..mesh.face_count() as u32).rev().map(Face).filter(|&f| takes_part(f)) {
            for v in topology.corners(f) {
                let at = &mut ends[v.index() + 1];
                *at -= 1;
                faces[*at as usize] = f.0;
            }
        }
        ends.remove(0);
        ends.push(faces.len() as u32);
        Stars { ends, faces, divided }
    }

    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        &self.faces[self.ends[vertex as usize] as usize..self.ends[vertex as usize + 1] as usize]
    }
}

/// A small set of numbers that is emptied without touching its memory.
struct Marks {
    /// Number, age, and place in the order of insertion.
    slots: Vec<(u32, u32, u32)>,
    age: u32,
    count: usize,
}

impl Marks {
    fn new() -> Self {
        Marks { slots: vec![(0, 0, 0); 256], age: 1, count: 0 }
    }

    fn clear(&mut self) {
        self.count = 0;
        self.age = self.age.wrapping_add(1);
        if self.age == 0 {
            self.slots.fill((0, 0, 0));
            self.age = 1;
        }
    }

    /// False when the number was there already.
    #[inline]
    fn insert(&mut self, key: u32) -> bool {
        if 2 * self.count >= self.slots.len() {
            self.grow();
        }
        let at = self.find(key);
        let is_new = self.slots[at].1 != self.age;
        if is_new {
            self.slots[at] = (key, self.age, self.count as u32);
            self.count += 1;
        }
        is_new
    }

    /// The place of a number in the order of insertion.
    fn place(&self, key: u32) -> Option<usize> {
        let (_, age, place) = self.slots[self.find(key)];
        (age == self.age).then_some(place as usize)
    }

    /// The slot that holds a number or would take it.
    #[inline]
    fn find(&self, key: u32) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = (key.wrapping_mul(0x9E37_79B1) >> 8) as usize & mask;
        while self.slots[at].1 == self.age && self.slots[at].0 != key {
            at = (at + 1) & mask;
        }
        at
    }

    fn grow(&mut self) {
        let larger = vec![(0, 0, 0); 2 * self.slots.len()];
        let (held, age) = (std::mem::replace(&mut self.slots, larger), std::mem::replace(&mut self.age, 1));
        for (key, _, place) in held.into_iter().filter(|s| s.1 == age) {
            let at = self.find(key);
            self.slots[at] = (key, self.age, place);
        }
    }
}

/// Vertices and faces around a seed face, ring by ring. Reused from face to face.
pub(super) struct Window {
    pub(super) vertices: Vec<u32>,
    pub(super) faces: Vec<u32>,
    /// Rings laid around the seed.
    pub(super) rings: usize,
    /// True when the last ring added nothing: the window holds its whole patch.
    pub(super) exhausted: bool,
    vertex_marks: Marks,
    face_marks: Marks,
    /// Vertices whose stars are still to be added.
    front: usize,
}

impl Window {
    pub(super) fn new() -> Self {
        Window {
            vertices: Vec::new(),
            faces: Vec::new(),
            rings: 0,
            exhausted: false,
            vertex_marks: Marks::new(),
            face_marks: Marks::new(),
            front: 0,
        }
    }

    /// Begins with a face alone.
    pub(super) fn start(&mut self, mesh: &Mesh, seed: Face) {
        self.vertices.clear();
        self.faces.clear();
        self.vertex_marks.clear();
        self.face_marks.clear();
        (self.rings, self.front, self.exhausted) = (0, 0, false);
        self.add(mesh, seed);
    }

    /// Begins with the faces at a vertex.
    pub(super) fn start_at(&mut self, mesh: &Mesh, stars: &Stars, vertex: u32) {
        let Some((&first, others)) = stars.of(vertex).split_first() else { return };
        self.start(mesh, Face(first));
        for &face in others.iter().take(CROWDED) {
            self.add(mesh, Face(face));
        }
    }

    /// Lays whole rings until there are `count` vertices or no more.
    pub(super) fn grow_to(&mut self, mesh: &Mesh, stars: &Stars, ignore_features: bool, count: usize) {
        while self.vertices.len() < count && !self.exhausted {
            self.add_ring(mesh, stars, ignore_features);
        }
    }

    /// Adds all faces that share a vertex with what is there, over edges that are not sharp.
    pub(super) fn add_ring(&mut self, mesh: &Mesh, stars: &Stars, ignore_features: bool) {
        let (vertices, faces) = (self.front..self.vertices.len(), self.faces.len());
        self.front = self.vertices.len();
        for at in vertices {
            let vertex = self.vertices[at];
            if stars.divided[vertex as usize] || stars.of(vertex).len() > CROWDED {
                self.add_fan(mesh, stars, Vertex(vertex), faces, ignore_features);
            } else {
                for &face in stars.of(vertex) {
                    self.add(mesh, Face(face));
                }
            }
        }
        self.rings += 1;
        self.exhausted = self.faces.len() == faces;
    }

    /// Adds the faces at a vertex that hang together with one of the first `known` faces.
    fn add_fan(&mut self, mesh: &Mesh, stars: &Stars, vertex: Vertex, known: usize, ignore_features: bool) {
        let topology = mesh.topology();
        let open = |h: HalfEdge| match mesh.edge_kind(h) {
            EdgeKind::Inner => true,
            EdgeKind::Feature => ignore_features,
            EdgeKind::Boundary | EdgeKind::NonManifold => false,
        };
        let star = stars.of(vertex.0);
        for at in 0..star.len().min(known) {
            // Through the star or through the window, whichever is shorter.
            let start = if star.len() <= known { Face(star[at]) } else { Face(self.faces[at]) };
            let is_start = if star.len() <= known {
                self.face_marks.place(start.0).is_some_and(|place| place < known)
            } else {
                topology.corners(start).contains(&vertex)
            };
            if !is_start {
                continue;
            }
            // Around the vertex both ways; windings may differ from face to face.
            for first in start.half_edges() {
                if topology.apex(first) == vertex {
                    continue;
                }
                let mut h = first;
                for _ in 0..CROWDED / 2 {
                    let Some(twin) = topology.twin(h).filter(|t| open(h) && t.face() != start) else { break };
                    self.add(mesh, twin.face());
                    // Of the other two sides the one that ends at the vertex too.
                    h = if topology.apex(twin.next()) == vertex { twin.prev() } else { twin.next() };
                }
            }
        }
    }

    fn add(&mut self, mesh: &Mesh, face: Face) {
        if self.face_marks.insert(face.0) {
            self.faces.push(face.0);
            for v in mesh.topology().corners(face) {
                if self.vertex_marks.insert(v.0) {
                    self.vertices.push(v.0);
                }
            }
        }
    }

    /// The share of the window's faces that have neither a border nor a sharp edge.
    pub(super) fn coverage(&self, mesh: &Mesh) -> f64 {
        let inside = |f: Face| f.half_edges().iter().all(|&h| mesh.edge_kind(h) == EdgeKind::Inner);
        self.faces.iter().filter(|&&f| inside(Face(f))).count() as f64 / self.faces.len() as f64
    }

    /// The sum of the faces' area vectors: along the mean normal.
    pub(super) fn area_vector(&self, mesh: &Mesh) -> DVec3 {
        self.faces.iter().map(|&f| oriented_area(mesh, Face(f))).sum()
    }
}

/// Twice a face's area as a vector along its oriented normal.
pub(super) fn oriented_area(mesh: &Mesh, face: Face) -> DVec3 {
    let [a, b, c] = mesh.triangle(face);
    let area = (b - a).cross(c - a);
    if mesh.is_flipped(face) { -area } else { area }
}
