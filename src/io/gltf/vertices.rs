//! Vertices of primitives, split only where faces with different values meet.

use crate::mesh::{Face, HalfEdge};
use crate::numbers::Numbers;
use std::sync::Arc;

/// Marks a vertex that no face uses.
const NONE: u32 = u32::MAX;

/// Copies of a vertex that a face may be compared with: a fan of a million faces around one vertex
/// would otherwise take quadratic time. Beyond them a vertex is split without need.
const COMPARED: usize = 32;

/// The vertices of one set of accessors after splitting. The given ones keep their numbers; copies
/// follow.
#[derive(Debug, PartialEq)]
pub(super) struct Vertices {
    given: u32,
    /// The given vertex that each copy repeats.
    copies: Vec<u32>,
    /// The half-edge whose face's value each vertex carries, and at whose origin it is.
    owners: Vec<u32>,
}

impl Vertices {
    /// Gives every face vertices that no face with other values uses, and renumbers the corners.
    ///
    /// `primitives` has the faces of each primitive and their corners, all below
    /// `given`. `same` tells whether two faces have the same values; `None`: no two have.
    pub(super) fn split(
        given: u32,
        primitives: &mut [(Numbers, Vec<[u32; 3]>)],
        same: Option<&dyn Fn(Face, Face) -> bool>,
    ) -> Self {
        let mut owners = vec![NONE; given as usize];
        let mut copies: Vec<u32> = Vec::new();
        // The newest copy of each given vertex and, for each copy, the one before it.
        let mut newest: Vec<u32> = Vec::new();
        let mut before: Vec<u32> = Vec::new();
        if same.is_some() {
            newest = (0..given).collect();
        }
        for (faces, corners) in primitives {
            for (face, triangle) in faces.iter().zip(corners) {
                for (i, corner) in triangle.iter_mut().enumerate() {
                    let vertex = *corner as usize;
                    let half_edge = 3 * face + i as u32;
                    if owners[vertex] == NONE {
                        owners[vertex] = half_edge;
                    }
                    if owners[vertex] / 3 == face {
                        continue;
                    }
                    if let Some(same) = same {
                        let mut candidate = newest[vertex];
                        let mut found = None;
                        for _ in 0..COMPARED {
                            if same(Face(owners[candidate as usize] / 3), Face(face)) {
                                found = Some(candidate);
                                break;
                            }
                            match candidate.checked_sub(given) {
                                Some(copy) => candidate = before[copy as usize],
                                None => break,
                            }
                        }
                        if let Some(found) = found {
                            *corner = found;
                            continue;
                        }
                    }
                    let copy = owners.len() as u32;
                    if same.is_some() {
                        before.push(std::mem::replace(&mut newest[vertex], copy));
                    }
                    owners.push(half_edge);
                    copies.push(*corner);
                    *corner = copy;
                }
            }
        }
        Vertices { given, copies, owners }
    }

    /// Vertices that stay as they are.
    pub(super) fn kept<'c>(given: u32, primitives: impl IntoIterator<Item = (&'c Numbers, &'c [[u32; 3]])>) -> Self {
        let mut owners = vec![NONE; given as usize];
        for (faces, corners) in primitives {
            for (face, triangle) in faces.iter().zip(corners) {
                for (half_edge, &corner) in (3 * face..).zip(triangle) {
                    if owners[corner as usize] == NONE {
                        owners[corner as usize] = half_edge;
                    }
                }
            }
        }
        Vertices { given, copies: Vec::new(), owners }
    }

    /// Number of vertices, copies included.
    pub(super) fn len(&self) -> usize {
        self.owners.len()
    }

    /// True when there is no copy: everything may stay as it is.
    pub(super) fn is_unchanged(&self) -> bool {
        self.copies.is_empty()
    }

    /// The given vertex that a vertex is or repeats.
    #[inline]
    pub(super) fn source(&self, vertex: u32) -> u32 {
        match vertex.checked_sub(self.given) {
            Some(copy) => self.copies[copy as usize],
            None => vertex,
        }
    }

    /// The face whose value a vertex carries, if any uses it.
    #[inline]
    pub(super) fn owner(&self, vertex: u32) -> Option<Face> {
        self.corner(vertex).map(HalfEdge::face)
    }

    /// A half-edge that begins at a vertex, if a face uses it.
    #[inline]
    pub(super) fn corner(&self, vertex: u32) -> Option<HalfEdge> {
        let half_edge = self.owners[vertex as usize];
        (half_edge != NONE).then_some(HalfEdge(half_edge))
    }
}

/// Which face the elements of an accessor belong to.
#[derive(Clone)]
pub(super) enum Owners {
    /// Three vertices of its own for each face.
    Corners(Numbers),
    /// One element for each face.
    Faces(Numbers),
    /// The vertices of an original.
    Vertices(Arc<Vertices>),
}

impl Owners {
    /// Number of elements.
    pub(super) fn len(&self) -> usize {
        match self {
            Owners::Corners(faces) => 3 * faces.len(),
            Owners::Faces(faces) => faces.len(),
            Owners::Vertices(vertices) => vertices.len(),
        }
    }

    /// A half-edge at whose origin a vertex is; none for an element of a face.
    pub(super) fn corner(&self, element: u32) -> Option<HalfEdge> {
        match self {
            Owners::Corners(faces) => Some(HalfEdge(3 * faces.at(element / 3) + element % 3)),
            Owners::Faces(_) => None,
            Owners::Vertices(vertices) => vertices.corner(element),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fan of four faces around vertex 0, and a vertex that no face uses.
    fn fan() -> [(Numbers, Vec<[u32; 3]>); 1] {
        [(Numbers::Run(10..14), vec![[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])]
    }

    #[test]
    fn every_face_gets_vertices_of_its_own_and_the_given_ones_keep_their_numbers() {
        let mut primitives = fan();
        let vertices = Vertices::split(6, &mut primitives, None);
        let used: Vec<u32> = primitives[0].1.as_flattened().to_vec();
        let mut sorted = used.clone();
        sorted.sort_unstable();
        sorted.dedup();
        assert_eq!((sorted.len(), vertices.len()), (12, 13), "12 corners and the unused vertex");
        let sources: Vec<u32> = used.iter().map(|&v| vertices.source(v)).collect();
        assert_eq!(sources, *fan()[0].1.as_flattened());
        for (f, triangle) in primitives[0].1.iter().enumerate() {
            assert!(triangle.iter().all(|&v| vertices.owner(v) == Some(Face(10 + f as u32))));
        }
        assert_eq!(vertices.owner(5), None);
        // Split vertices need no more splitting.
        let again = Vertices::split(13, &mut primitives, None);
        assert!(again.is_unchanged());
        assert_eq!(primitives[0].1.as_flattened(), used);
    }

    #[test]
    fn faces_of_equal_values_share_their_vertices() {
        let mut primitives = fan();
        let parity = |a: Face, b: Face| a.0 % 2 == b.0 % 2;
        let vertices = Vertices::split(6, &mut primitives, Some(&parity));
        assert_eq!(vertices.len(), 6 + 5, "the middle once more, each other vertex once more");
        for (f, triangle) in primitives[0].1.iter().enumerate() {
            assert!(triangle.iter().all(|&v| vertices.owner(v).is_some_and(|o| o.0 as usize % 2 == f % 2)));
        }
        let mut primitives = fan();
        assert!(Vertices::split(6, &mut primitives, Some(&|_, _| true)).is_unchanged());
    }
}
