//! The values of all faces, as arrays that NumPy owns.

use crate::arrays::triples;
use crate::settings::Settings;
use crate::{errors, work};
use glam::Vec3;
use numpy::{IntoPyArray, PyArray1};
use osculate::cli::settings::parse_colors;
use osculate::{Colormap, Condition, CurvatureSummary, Face, FaceClass, FaceCurvature, Method, Quantity, Selection};
use pyo3::exceptions::{PyKeyError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;

/// Curvature of all faces of a mesh, in face order.
#[pyclass(frozen, module = "osculate._native")]
pub(crate) struct Values {
    values: Vec<FaceCurvature>,
    selection: Selection,
    /// Threads for making arrays of them; `None` for one per core.
    threads: Option<usize>,
}

impl Values {
    pub(crate) fn new(values: Vec<FaceCurvature>, selection: Selection, threads: Option<usize>) -> Self {
        Values { values, selection, threads }
    }

    pub(crate) fn values(&self) -> &[FaceCurvature] {
        &self.values
    }

    /// The quantities asked for.
    pub(crate) fn selection(&self) -> &Selection {
        &self.selection
    }
}

#[pymethods]
impl Values {
    fn __len__(&self) -> usize {
        self.values.len()
    }

    /// Names of the quantities asked for, in the order of CSV columns.
    fn selected(&self) -> Vec<&'static str> {
        self.selection.for_csv().into_iter().map(Quantity::token).collect()
    }

    /// One number per face: uint32 for `face`, int8 codes for `class` and `method`, (n, 3) float32 for directions,
    /// float32 for others. NaN where there is none.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let quantity = Quantity::from_token(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))?;
        let of = |value: &FaceCurvature, component| quantity.value(Face(0), value, component);
        Ok(match quantity {
            Quantity::Face => PyArray1::from_iter(py, 0..self.values.len() as u32).into_any(),
            Quantity::Class => self.each(py, |value| value.class.code())?.into_pyarray(py).into_any(),
            Quantity::Method => self.each(py, |value| code_of(value.method))?.into_pyarray(py).into_any(),
            Quantity::DirMax | Quantity::DirMin => {
                triples(py, self.each(py, |value| [0, 1, 2].map(|i| of(value, i)))?)?.into_any()
            }
            _ => self.each(py, |value| of(value, 0))?.into_pyarray(py).into_any(),
        })
    }

    /// All values as bytes, for pickle.
    fn pack<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let mut bytes = Vec::with_capacity(self.values.len() * PACKED);
        for value in &self.values {
            let FaceCurvature { k_max, k_min, dir_max, dir_min, gauss_perimeter, radius, coverage, confidence, .. } =
                *value;
            let ([a, b, c], [d, e, f]) = (dir_max.to_array(), dir_min.to_array());
            for number in [k_max, k_min, a, b, c, d, e, f, gauss_perimeter, radius, coverage, confidence] {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend([code_of(value.method) as u8, value.class.code() as u8]);
        }
        PyBytes::new(py, &bytes)
    }

    /// What `pack` gave, and the quantities asked for.
    #[staticmethod]
    fn unpack(py: Python<'_>, bytes: &[u8], selected: Vec<String>) -> PyResult<Self> {
        let (rows, rest) = bytes.as_chunks::<PACKED>();
        if !rest.is_empty() {
            return Err(PyValueError::new_err("packed values are cut off"));
        }
        let list = if selected.is_empty() { "none".into() } else { selected.join(",") };
        let selection = Selection::parse(&list).map_err(|e| errors::raise(py, &e))?;
        Ok(Values::new(rows.iter().map(unpacked).collect(), selection, None))
    }

    /// Which faces fulfil a condition of `--select`.
    fn select<'py>(&self, py: Python<'py>, condition: &str) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let condition: Condition = condition.parse().map_err(|e: osculate::Error| errors::raise(py, &e))?;
        let holds = |(f, value): (usize, &FaceCurvature)| condition.holds(Face(f as u32), value);
        let holds =
            work::run(py, None, None, |_| Ok(self.values.par_iter().enumerate().map(holds).collect::<Vec<bool>>()))?;
        Ok(holds.into_pyarray(py))
    }

    /// Counts of classes and percentiles of quantities, as JSON.
    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        let summary = work::run(py, None, None, |_| Ok(CurvatureSummary::of(&self.values)))?;
        json(&summary)
    }

    /// A colour scale for `color_by`, `colormap` and `range`: quantity, map, lowest and highest value, number of faces
    /// beyond them, and the index of each face's colour in the map's palette.
    #[allow(clippy::type_complexity, reason = "a tuple is what Python gets; the stub names its parts")]
    fn colors<'py>(
        &self,
        py: Python<'py>,
        settings: Settings,
    ) -> PyResult<(&'static str, &'static str, f64, f64, usize, Bound<'py, PyArray1<u8>>)> {
        let scale = work::run(py, None, None, |_| parse_colors(&self.values, &settings))?;
        let indices: Vec<u8> = self.values.iter().map(|value| scale.color_index(value) as u8).collect();
        let (quantity, map) = (scale.quantity.token(), scale.map.name());
        Ok((quantity, map, scale.low, scale.high, scale.clipped, indices.into_pyarray(py)))
    }
}

/// More values than this are looked at on several threads; starting those takes as long as so many.
const FEW: usize = 1 << 16;

impl Values {
    /// Something of each value.
    fn each<T: Send>(&self, py: Python<'_>, of: impl Fn(&FaceCurvature) -> T + Send + Sync) -> PyResult<Vec<T>> {
        if self.values.len() <= FEW {
            return Ok(self.values.iter().map(of).collect());
        }
        work::run(py, self.threads, None, |_| Ok(self.values.par_iter().map(of).collect()))
    }
}

/// Bytes of a packed value.
const PACKED: usize = 12 * 4 + 2;

fn unpacked(row: &[u8; PACKED]) -> FaceCurvature {
    let (numbers, codes) = row.split_at(PACKED - 2);
    let at = |i: usize| f32::from_le_bytes(numbers.as_chunks().0[i]);
    let class = FaceClass::ALL.into_iter().find(|class| class.code() == codes[1] as i8);
    FaceCurvature {
        k_max: at(0),
        k_min: at(1),
        dir_max: Vec3::new(at(2), at(3), at(4)),
        dir_min: Vec3::new(at(5), at(6), at(7)),
        gauss_perimeter: at(8),
        radius: at(9),
        coverage: at(10),
        confidence: at(11),
        method: Method::ALL.get(usize::from(codes[0])).copied().unwrap_or(Method::None),
        class: class.unwrap_or(FaceClass::NotEstimated),
    }
}

/// The code of a method: its place among all.
fn code_of(method: Method) -> i8 {
    method as i8
}

/// Words of `method`, by code.
#[pyfunction]
pub(crate) fn method_names() -> Vec<&'static str> {
    Method::ALL.iter().map(|method| method.name()).collect()
}

/// Words of `class`, with their codes.
#[pyfunction]
pub(crate) fn class_names() -> Vec<(i8, &'static str)> {
    FaceClass::ALL.iter().map(|class| (class.code(), class.name())).collect()
}

/// All quantities, in the order of CSV columns: name, names of CSV columns and of glTF attributes, and the power of
/// length.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "a tuple is what Python gets; the stub names its parts")]
pub(crate) fn quantities() -> Vec<(&'static str, Vec<&'static str>, Vec<&'static str>, i32)> {
    let row = |q: Quantity| (q.token(), q.columns().to_vec(), q.attributes().to_vec(), q.dimension());
    Quantity::ALL.into_iter().map(row).collect()
}

/// Names of all colour maps.
#[pyfunction]
pub(crate) fn colormaps() -> Vec<&'static str> {
    Colormap::names().collect()
}

/// The 256 colours of a map, three bytes each; the last is for faces without estimate. `classes` is that of classes.
#[pyfunction]
pub(crate) fn palette<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
    let classes = Colormap::default_for(Quantity::Class);
    let map = if name == classes.name() { Ok(classes) } else { Colormap::named(name) };
    let palette = map.map_err(|e| errors::raise(py, &e))?.palette();
    Ok(PyBytes::new(py, palette.as_flattened()))
}

/// Facts as JSON, which the package makes a dictionary of.
pub(crate) fn json(facts: &impl serde::Serialize) -> PyResult<String> {
    serde_json::to_string(facts).map_err(|e| PyValueError::new_err(e.to_string()))
}
