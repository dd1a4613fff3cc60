//! Between NumPy's arrays and the crate's slices and vectors. What comes in is contiguous: the package sees to it.

use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use osculate::{Error, MeshOptions, PositionsRef, SameVertex};
use pyo3::prelude::*;

/// Vertices (n, 3) of either width, borrowed from NumPy.
#[derive(FromPyObject)]
enum Vertices<'py> {
    F32(PyReadonlyArray2<'py, f32>),
    F64(PyReadonlyArray2<'py, f64>),
}

/// A mesh in NumPy's arrays, as the package hands it over: vertices, faces (m, 3), and whether vertices are told apart
/// by their numbers alone.
#[derive(FromPyObject)]
pub(crate) struct Arrays<'py>(Vertices<'py>, PyReadonlyArray2<'py, u32>, bool);

impl Arrays<'_> {
    /// The arrays as they lie in memory, which any thread may read.
    pub(crate) fn borrowed(&self) -> PyResult<BorrowedArrays<'_>> {
        let Arrays(vertices, faces, by_number) = self;
        let vertices = match vertices {
            Vertices::F32(array) => PositionsRef::F32(array.as_slice()?.as_chunks().0),
            Vertices::F64(array) => PositionsRef::F64(array.as_slice()?.as_chunks().0),
        };
        let same = if *by_number { SameVertex::Number } else { SameVertex::Position };
        Ok(BorrowedArrays { vertices, faces: faces.as_slice()?.as_chunks().0, same })
    }
}

/// A mesh in slices.
#[derive(Clone, Copy)]
pub(crate) struct BorrowedArrays<'a> {
    vertices: PositionsRef<'a>,
    faces: &'a [[u32; 3]],
    same: SameVertex,
}

impl BorrowedArrays<'_> {
    pub(crate) fn mesh(self, options: &MeshOptions) -> Result<osculate::Mesh, Error> {
        osculate::Mesh::from_arrays(self.vertices, self.faces, self.same, options)
    }
}

/// Triples (n, 3) that NumPy owns from here on.
pub(crate) fn triples<T: numpy::Element>(py: Python<'_>, rows: Vec<[T; 3]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])
}

/// Points in the input's coordinates.
pub(crate) fn points<'py>(py: Python<'py>, points: &[DVec3], origin: DVec3) -> PyResult<Bound<'py, PyArray2<f64>>> {
    triples(py, points.iter().map(|&p| (p + origin).to_array()).collect())
}

/// A vector of three numbers.
pub(crate) fn vector(py: Python<'_>, v: DVec3) -> Bound<'_, PyArray1<f64>> {
    v.to_array().to_pyarray(py)
}
