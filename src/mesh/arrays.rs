//! A mesh from arrays that somebody else goes on holding.

use super::weld::{self, Faces};
use super::{Mesh, MeshOptions};
use crate::error::Error;
use crate::soup::{Group, MAX_FACES};

/// Vertex positions that somebody else holds.
#[derive(Clone, Copy, Debug)]
pub enum PositionsRef<'a> {
    /// Of 32-bit floats.
    F32(&'a [[f32; 3]]),
    /// Of 64-bit floats.
    F64(&'a [[f64; 3]]),
}

impl PositionsRef<'_> {
    fn len(self) -> usize {
        match self {
            PositionsRef::F32(positions) => positions.len(),
            PositionsRef::F64(positions) => positions.len(),
        }
    }
}

/// What makes corners of faces one vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SameVertex {
    /// Equal positions, as in files: vertices that were split for texture coordinates or normals, or never shared,
    /// are joined.
    #[default]
    Position,
    /// The number that the faces give; vertices at equal positions stay apart.
    Number,
}

impl Mesh {
    /// Connects and classifies faces over vertices, of which it copies only what the mesh itself keeps. A
    /// coordinate may be anything, NaN included.
    ///
    /// # Errors
    /// [`Error::Usage`] for options out of range or a face that names a vertex which is not there,
    /// [`Error::TooLarge`] for more than [`MAX_FACES`], [`Error::EmptyMesh`] when there are no faces or none of
    /// them has both an area and finite coordinates.
    pub fn from_arrays(
        positions: PositionsRef<'_>,
        triangles: &[[u32; 3]],
        same: SameVertex,
        options: &MeshOptions,
    ) -> Result<Mesh, Error> {
        options.check()?;
        check(triangles, positions.len())?;
        let body = [Group { name: String::new(), faces: 0..triangles.len() as u32 }];
        let triangles = triangles.to_vec();
        let faces = |triangles| Faces { triangles, bodies: &body };
        let welded = match (same, positions) {
            (SameVertex::Position, PositionsRef::F32(positions)) => weld::weld_faces(faces(triangles), positions),
            (SameVertex::Position, PositionsRef::F64(positions)) => weld::weld_faces(faces(triangles), positions),
            (SameVertex::Number, PositionsRef::F32(positions)) => weld::keep_numbers(triangles, positions),
            (SameVertex::Number, PositionsRef::F64(positions)) => weld::keep_numbers(triangles, positions),
        };
        let welded = Self::weld_further(welded, &body, options);
        Self::from_welded(welded, body.into(), None, options)
    }
}

/// Refuses faces that are too many, or that name a vertex which is not there.
pub(super) fn check(triangles: &[[u32; 3]], vertices: usize) -> Result<(), Error> {
    if triangles.is_empty() {
        return Err(Error::EmptyMesh("there are no faces".into()));
    }
    if triangles.len() > MAX_FACES {
        return Err(Error::TooLarge(format!("a mesh may have at most {MAX_FACES} faces, not {}", triangles.len())));
    }
    // The largest of all is found faster than the first that is too large.
    let largest = triangles.as_flattened().iter().fold(0, |largest, &i| largest.max(i));
    if (largest as usize) < vertices {
        return Ok(());
    }
    let face = triangles.iter().position(|face| face.contains(&largest)).unwrap_or(0);
    let there = if vertices == 0 { "no vertices".into() } else { format!("{vertices} vertices, numbered from 0") };
    Err(Error::Usage(format!("face {face} names vertex {largest}, but there are {there}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soup::{Positions, Soup};
    use crate::synth::{Grid, Surface};

    fn arrays() -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 24, 12).build().soup;
        ((0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect(), soup.triangles)
    }

    fn build(positions: PositionsRef<'_>, faces: &[[u32; 3]], same: SameVertex) -> Result<Mesh, Error> {
        Mesh::from_arrays(positions, faces, same, &MeshOptions::default())
    }

    #[test]
    fn arrays_make_the_mesh_that_a_soup_makes() {
        let (points, faces) = arrays();
        let soup = Soup::new(Positions::F64(points.clone()), faces.clone());
        let expected = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        for same in [SameVertex::Position, SameVertex::Number] {
            let mesh = build(PositionsRef::F64(&points), &faces, same).expect("a mesh");
            assert_eq!((mesh.positions(), mesh.report()), (expected.positions(), expected.report()));
        }
        let narrow: Vec<[f32; 3]> = points.iter().map(|p| p.map(|c| c as f32)).collect();
        let mesh = build(PositionsRef::F32(&narrow), &faces, SameVertex::Number).expect("a mesh");
        assert_eq!(mesh.report().edges, expected.report().edges);
    }

    #[test]
    fn vertices_at_equal_positions_are_one_unless_numbers_count() {
        let (points, faces) = arrays();
        let apart: Vec<[f64; 3]> = faces.iter().flatten().map(|&v| points[v as usize]).collect();
        let own: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        let edges = |same| build(PositionsRef::F64(&apart), &own, same).expect("a mesh").report().edges;
        assert_eq!(edges(SameVertex::Position).boundary, 0);
        assert_eq!(edges(SameVertex::Number).boundary, apart.len());
    }

    #[test]
    fn a_soup_put_together_by_hand_is_checked() {
        let (points, mut faces) = arrays();
        let count = faces.len() as u32;
        let sound = Soup::new(Positions::F64(points), faces.clone());
        let soup = |bodies: &[(u32, u32)], faces: &[[u32; 3]]| {
            let body = |&(start, end): &(u32, u32)| Group { name: String::new(), faces: start..end };
            let bodies = bodies.iter().map(body).collect();
            let soup = Soup { bodies, triangles: faces.to_vec(), ..sound.clone() };
            Mesh::from_soup(&soup, &MeshOptions::default())
        };
        assert!(soup(&[(0, 9), (9, 9), (9, count)], &faces).is_ok());
        let wrong: [&[(u32, u32)]; 6] =
            [&[(0, 9)], &[(9, count)], &[(0, 9), (10, count)], &[(0, 9), (8, count)], &[(0, count + 1)], &[]];
        for bodies in wrong {
            let error = soup(bodies, &faces).expect_err("wrong bodies").to_string();
            assert_eq!(error, format!("the bodies must follow one another over all {count} faces"), "{bodies:?}");
        }
        faces[3][2] = u32::MAX;
        let error = soup(&[(0, count)], &faces).expect_err("out of range").to_string();
        assert!(error.starts_with("face 3 names vertex 4294967295"), "{error}");
    }

    #[test]
    fn a_vertex_that_is_not_there_is_named() {
        let (points, mut faces) = arrays();
        faces[7][1] = points.len() as u32;
        let error = build(PositionsRef::F64(&points), &faces, SameVertex::Position).expect_err("out of range");
        let there = format!("face 7 names vertex {0}, but there are {0} vertices, numbered from 0", points.len());
        assert_eq!(error.to_string(), there);
        let empty = build(PositionsRef::F64(&points), &[], SameVertex::Position);
        assert!(matches!(empty, Err(Error::EmptyMesh(_))));
        let unused = build(PositionsRef::F32(&[]), &[[0; 3]], SameVertex::Number);
        assert!(unused.is_err_and(|e| e.to_string().ends_with("there are no vertices")));
    }
}
