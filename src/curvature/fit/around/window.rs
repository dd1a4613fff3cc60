//! The vertices and faces around a face, as far as nothing lies between that ends windows.

use super::marks::Marks;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::normals::scaled_normal;
use crate::curvature::fit::ground::stars::CROWDED;
use crate::mesh::{Face, Mesh, Vertex};
use glam::DVec3;

/// Vertices and faces around a seed face, ring by ring. Reused from face to face.
pub(in crate::curvature::fit) struct Window {
    pub(in crate::curvature::fit) vertices: Vec<u32>,
    pub(in crate::curvature::fit) faces: Vec<u32>,
    /// True when the last ring added nothing: the window holds its whole patch.
    exhausted: bool,
    vertex_marks: Marks,
    face_marks: Marks,
    /// Vertices whose stars are still to be added.
    front: usize,
}

/// The part of a strip that a surface is fitted to.
pub(in crate::curvature::fit) struct StripWindow {
    pub(in crate::curvature::fit) vertices: Vec<u32>,
    /// Where they are; behind them the middles of straight folds.
    pub(in crate::curvature::fit) points: Vec<DVec3>,
    /// Normals there, as long as the roots of areas.
    pub(in crate::curvature::fit) normals: Vec<DVec3>,
    /// Places and directions in which the surface is straight.
    pub(in crate::curvature::fit) rulings: Vec<(DVec3, DVec3)>,
}

impl Window {
    pub(in crate::curvature::fit) fn new() -> Self {
        Window {
            vertices: Vec::new(),
            faces: Vec::new(),
            exhausted: false,
            vertex_marks: Marks::new(),
            face_marks: Marks::new(),
            front: 0,
        }
    }

    /// Begins with a face alone.
    pub(in crate::curvature::fit) fn start(&mut self, mesh: &Mesh, seed: Face) {
        self.vertices.clear();
        self.faces.clear();
        self.vertex_marks.clear();
        self.face_marks.clear();
        (self.front, self.exhausted) = (0, false);
        self.add(mesh, seed);
    }

    /// Lays whole rings until there are `count` vertices or no more.
    pub(in crate::curvature::fit) fn grow_to(&mut self, ground: &Ground<'_>, count: usize) {
        while self.vertices.len() < count && !self.exhausted {
            self.add_ring(ground);
        }
    }

    /// Adds all faces that share a vertex with what is there, over edges that windows reach over.
    pub(in crate::curvature::fit) fn add_ring(&mut self, ground: &Ground<'_>) {
        let (vertices, faces) = (self.front..self.vertices.len(), self.faces.len());
        self.front = self.vertices.len();
        for at in vertices {
            let vertex = self.vertices[at];
            if ground.stars.is_divided(vertex) {
                self.add_fan(ground, Vertex(vertex), faces);
            } else {
                for &face in ground.stars.of(vertex) {
                    self.add(ground.mesh, Face(face));
                }
            }
        }
        self.exhausted = self.faces.len() == faces;
    }

    /// Adds the faces at a vertex that hang together with one of the first `known` faces.
    fn add_fan(&mut self, ground: &Ground<'_>, vertex: Vertex, known: usize) {
        let topology = ground.mesh.topology();
        let star = ground.stars.of(vertex.0);
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
                    let Some(twin) = topology.twin(h).filter(|t| ground.is_open(h) && t.face() != start) else { break };
                    self.add(ground.mesh, twin.face());
                    h = topology.other_side_at(twin, vertex);
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

    /// For every vertex, a normal of those of its faces that are in the window. As long as lengths, not areas: that
    /// the squares of small areas do not vanish.
    pub(super) fn add_normals(&self, mesh: &Mesh, normals: &mut Vec<DVec3>) {
        normals.clear();
        normals.resize(self.vertices.len(), DVec3::ZERO);
        for f in self.faces.iter().map(|&f| Face(f)) {
            let normal = scaled_normal(mesh, f);
            for place in mesh.topology().corners(f).into_iter().filter_map(|v| self.vertex_marks.place(v.0)) {
                normals[place] += normal;
            }
        }
    }
}
