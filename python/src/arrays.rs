//! Between NumPy's arrays and the crate's slices and vectors. What comes in is contiguous: the package sees to it.

use glam::DVec3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use osculate::PositionsRef;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// Vertices (n, 3) of either width, borrowed from NumPy.
pub(crate) enum Vertices<'py> {
    F32(PyReadonlyArray2<'py, f32>),
    F64(PyReadonlyArray2<'py, f64>),
}

impl<'py> Vertices<'py> {
    pub(crate) fn of(array: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(narrow) = array.cast::<PyArray2<f32>>() {
            return Ok(Vertices::F32(narrow.readonly()));
        }
        match array.cast::<PyArray2<f64>>() {
            Ok(wide) => Ok(Vertices::F64(wide.readonly())),
            Err(_) => Err(PyTypeError::new_err("vertices must be float32 or float64")),
        }
    }

    pub(crate) fn positions(&self) -> PyResult<PositionsRef<'_>> {
        Ok(match self {
            Vertices::F32(array) => PositionsRef::F32(array.as_slice()?.as_chunks().0),
            Vertices::F64(array) => PositionsRef::F64(array.as_slice()?.as_chunks().0),
        })
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
