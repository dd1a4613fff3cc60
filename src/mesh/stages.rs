//! Single stages of building a mesh, for benches.

use super::Topology;
use super::weld::{Faces, weld_exact};
use crate::soup::Soup;
use glam::DVec3;

/// Positions of the vertices, and vertex numbers per face.
pub fn weld(soup: &Soup) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let faces = Faces { triangles: soup.triangles.clone(), bodies: &soup.bodies };
    let welded = weld_exact(faces, &soup.positions);
    (welded.positions, welded.faces)
}

/// Neighbours of all faces.
pub fn connect(faces: Vec<[u32; 3]>, vertex_count: usize) -> Topology {
    let none = vec![false; faces.len()];
    Topology::new(faces, vertex_count, &none).0
}
