//! What of a mesh is drawn: its faces where the scene puts them, thinned where there are too many.

use super::subject::Subject;
use super::thin;
use crate::inspect::matrix;
use crate::mesh::{Face, FaceState, Mesh};
use glam::{DMat4, DVec3};

/// The drawn faces of a subject and where they are.
pub(crate) struct Display {
    /// Positions of all vertices, relative to the mesh's origin, placed by the scene; finite.
    pub(crate) positions: Vec<DVec3>,
    /// Corners of the drawn faces. A face that cannot be drawn has one vertex three times.
    pub(crate) corners: Vec<[u32; 3]>,
    /// The number of each drawn face in the input, where not all are drawn.
    pub(crate) numbers: Option<Vec<u32>>,
    /// Where the bodies stand.
    pub(crate) bodies: Vec<Placed>,
    /// Nodes of the scene that show a body a second time and are not drawn.
    pub(crate) instances_left_out: usize,
}

/// A body and its place in the scene.
pub(crate) struct Placed {
    /// Its faces.
    pub(crate) faces: std::ops::Range<u32>,
    /// From its own space to that of the scene.
    pub(crate) matrix: DMat4,
    /// The factor by which lengths grow on the way.
    pub(crate) scale: f64,
}

impl Display {
    /// The drawn faces, at most about so many.
    pub(super) fn new(subject: &Subject, most: usize) -> Self {
        let mesh = &subject.mesh;
        let (bodies, instances_left_out) = place(mesh);
        let mut positions: Vec<DVec3> =
            mesh.positions().iter().map(|&p| if p.is_finite() { p } else { DVec3::ZERO }).collect();
        let corners = corners(mesh);
        if bodies.iter().any(|body| body.matrix != DMat4::IDENTITY) {
            let mut done = vec![false; positions.len()];
            for body in &bodies {
                for &v in corners[body.faces.start as usize..body.faces.end as usize].as_flattened() {
                    if !std::mem::replace(&mut done[v as usize], true) {
                        let placed = body.matrix.transform_point3(positions[v as usize]);
                        positions[v as usize] = if placed.is_finite() { placed } else { DVec3::ZERO };
                    }
                }
            }
        }
        let mut display = Display { positions, corners, numbers: None, bodies, instances_left_out };
        if display.corners.len() > most {
            thin::thin(&mut display, most);
        }
        display
    }

    /// The number in the input of the face drawn at an index.
    pub(crate) fn number(&self, index: usize) -> Face {
        Face(self.numbers.as_ref().map_or(index as u32, |numbers| numbers[index]))
    }

    /// The body that a face of the input belongs to.
    pub(crate) fn body(&self, face: Face) -> Option<&Placed> {
        let after = self.bodies.partition_point(|body| body.faces.start <= face.0);
        self.bodies.get(after.wrapping_sub(1))
    }

    /// The three corners of the face drawn at an index.
    pub(crate) fn triangle(&self, index: usize) -> [DVec3; 3] {
        self.corners[index].map(|v| self.positions[v as usize])
    }
}

fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    let states = (0..mesh.face_count() as u32).map(|f| mesh.face_state(Face(f)));
    let faces = mesh.topology().faces().iter().zip(states);
    faces.map(|(&face, state)| if state == FaceState::NotFinite { [face[0]; 3] } else { face }).collect()
}

/// Each body where the first node that shows it puts it; as it is where none does. Also the number of
/// further nodes.
fn place(mesh: &Mesh) -> (Vec<Placed>, usize) {
    let mut places: Vec<Option<DMat4>> = vec![None; mesh.bodies().len()];
    let mut left_out = 0;
    if let Some(scene) = mesh.scene() {
        let mut open: Vec<(usize, DMat4)> = scene.roots.iter().rev().map(|&root| (root, DMat4::IDENTITY)).collect();
        while let Some((n, parent)) = open.pop() {
            let node = &scene.nodes[n];
            let global = parent * matrix(&node.transform);
            open.extend(node.children.iter().rev().map(|&child| (child, global)));
            match node.body.map(|body| &mut places[body]) {
                Some(Some(_)) => left_out += 1,
                Some(place) => *place = Some(global),
                None => {}
            }
        }
    }
    let usable = |m: &DMat4| m.is_finite() && m.determinant() != 0.0;
    let bodies = mesh.bodies().iter().zip(places).map(|(body, place)| {
        let matrix = place.filter(usable).unwrap_or(DMat4::IDENTITY);
        Placed { faces: body.faces.clone(), matrix, scale: matrix.determinant().abs().cbrt() }
    });
    (bodies.collect(), left_out)
}
