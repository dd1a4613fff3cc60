//! A mesh: built from arrays or read from a file, then estimated.

use crate::arrays::{Arrays, points, triples};
use crate::lines;
use crate::settings::Settings;
use crate::values::{Values, json};
use crate::{errors, work};
use numpy::PyArray2;
use osculate::cli::settings::{Build, Estimate, Read, Walk, Write, parse_arrays, parse_plane};
use osculate::{
    AnnotateOptions, Annotated, CurvatureOptions, Error, Face, InputFormat, MeshOptions, Note, Progress, Selection,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A mesh, ready to be walked over.
#[pyclass(frozen, module = "osculate._native")]
pub(crate) struct Mesh {
    mesh: osculate::Mesh,
    options: MeshOptions,
    notes: Vec<Note>,
    stored: Option<Stored>,
    origin: Origin,
}

/// Where a mesh is from.
struct Origin {
    /// The file; of arrays the name that their object gets.
    path: PathBuf,
    /// Files that it names.
    files: Vec<PathBuf>,
    format: Option<InputFormat>,
}

impl Default for Origin {
    fn default() -> Self {
        Origin { path: "mesh".into(), files: Vec::new(), format: None }
    }
}

/// Of a mesh that is gone: its report as JSON, its defects, and the settings that decide values as JSON.
type MeshFacts = (String, Vec<String>, String);

/// Values that a file carries from an earlier run.
struct Stored {
    values: Vec<osculate::FaceCurvature>,
    settings: Value,
}

impl Mesh {
    fn of(mesh: osculate::Mesh, options: MeshOptions) -> Self {
        let notes = mesh.report().remarks().into_iter().map(Note::info).collect();
        Mesh { mesh, options, notes, stored: None, origin: Origin::default() }
    }
}

/// The settings that decide values, as they stand in files, as JSON.
fn settings_of(mesh: MeshOptions, curvature: CurvatureOptions) -> PyResult<String> {
    json(&AnnotateOptions { mesh, curvature, ..AnnotateOptions::default() }.settings_of_estimation())
}

fn read(path: &Path, call: &Read, progress: &dyn Progress) -> Result<Mesh, Error> {
    let (soup, format) = osculate::read_with(path, &call.read, progress)?;
    // Values that are not as an estimate has them are no reason to refuse the mesh.
    let stored = osculate::stored_values(&soup).unwrap_or_default();
    let notes = soup.notes.clone();
    let origin = Origin { path: path.to_owned(), files: soup.files.clone(), format: Some(format) };
    let mesh = osculate::Mesh::from_owned_soup(soup, &call.mesh).map_err(|e| e.in_file(path))?;
    let stored = stored.map(|stored| {
        let values = stored.curvature(&mesh).map_err(|e| e.in_file(path))?;
        Ok(Stored { values, settings: stored.settings })
    });
    let mut read = Mesh { origin, ..Mesh::of(mesh, call.mesh) };
    read.stored = stored.and_then(Result::<_, Error>::ok);
    read.notes.splice(0..0, notes);
    Ok(read)
}

#[pymethods]
impl Mesh {
    /// From float vertices (n, 3) and uint32 faces (m, 3), both contiguous, and whether vertices go by number.
    #[staticmethod]
    fn from_arrays(py: Python<'_>, arrays: Arrays<'_>, settings: Settings) -> PyResult<Self> {
        let call = Build::parse(&settings).map_err(|e| errors::raise(py, &e))?;
        let arrays = arrays.borrowed()?;
        let mesh = work::run(py, call.threads, None, |_| arrays.mesh(&call.mesh))?;
        Ok(Mesh::of(mesh, call.mesh))
    }

    /// From a file of any format; `-` is standard input.
    #[staticmethod]
    #[pyo3(signature = (path, settings, progress=None))]
    fn read(py: Python<'_>, path: PathBuf, settings: Settings, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let call = Read::parse(&settings).map_err(|e| errors::raise(py, &e))?;
        work::run(py, call.threads, progress.as_ref(), |progress| read(&path, &call, progress))
    }

    /// Builds a mesh from arrays and estimates it, in one go. Gives its report, its defects and the settings that decide
    /// values (texts and JSON), and the values; the mesh itself is gone.
    #[staticmethod]
    #[pyo3(signature = (arrays, settings, progress=None))]
    fn annotate_arrays(
        py: Python<'_>,
        arrays: Arrays<'_>,
        settings: Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(MeshFacts, Values)> {
        let (build, call) = parse_arrays(&settings).map_err(|e| errors::raise(py, &e))?;
        let arrays = arrays.borrowed()?;
        let (report, values) = work::run(py, build.threads, progress.as_ref(), |progress| {
            let mesh = arrays.mesh(&build.mesh)?;
            let (mesh, values) = osculate::estimate_owned(mesh, &call.curvature, progress)?;
            Ok((mesh.report().clone(), values))
        })?;
        let facts = (json(&report)?, report.defects(), settings_of(build.mesh, call.curvature)?);
        Ok((facts, Values::new(values, call.selection, call.threads)))
    }

    /// Estimates the curvature of all faces.
    #[pyo3(signature = (settings, progress=None))]
    fn estimate(&self, py: Python<'_>, settings: Settings, progress: Option<Py<PyAny>>) -> PyResult<Values> {
        let call = Estimate::parse(&settings).map_err(|e| errors::raise(py, &e))?;
        let values = work::run(py, call.threads, progress.as_ref(), |progress| {
            osculate::estimate(&self.mesh, &call.curvature, progress)
        })?;
        Ok(Values::new(values, call.selection, call.threads))
    }

    /// Writes the mesh with values that were estimated with `used`, settings as JSON: what is worth knowing of it, as
    /// JSON.
    #[pyo3(signature = (output, values, used, settings, progress=None))]
    fn write(
        &self,
        py: Python<'_>,
        output: PathBuf,
        values: &Values,
        used: &str,
        settings: Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<String> {
        let used: Value = serde_json::from_str(used).map_err(|e| PyValueError::new_err(e.to_string()))?;
        let call = Write::parse(&output, &settings, values.selection()).map_err(|e| errors::raise(py, &e))?;
        let Origin { path, files, format } = &self.origin;
        let annotated = Annotated { mesh: &self.mesh, values: values.values(), source: path, files, format: *format };
        json(&work::run(py, call.threads, progress.as_ref(), |progress| call.run(&annotated, &used, progress))?)
    }

    /// The settings that decide values, with their defaults, as JSON.
    fn settings(&self, py: Python<'_>, settings: Settings) -> PyResult<String> {
        let call = Estimate::parse(&settings).map_err(|e| errors::raise(py, &e))?;
        settings_of(self.options, call.curvature)
    }

    /// The values that the file carries from an earlier run, and the settings of that run as JSON.
    fn stored(&self) -> PyResult<Option<(Values, String)>> {
        let Some(stored) = &self.stored else { return Ok(None) };
        Ok(Some((Values::new(stored.values.clone(), Selection::default(), None), json(&stored.settings)?)))
    }

    /// Positions of the welded vertices, (n, 3) float64.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        points(py, self.mesh.positions(), self.mesh.origin())
    }

    /// Vertex numbers of all faces, (m, 3) uint32.
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let faces = (0..self.mesh.face_count() as u32).map(Face);
        triples(py, faces.map(|face| self.mesh.topology().corners(face).map(|v| v.0)).collect())
    }

    /// Number of faces.
    fn face_count(&self) -> usize {
        self.mesh.face_count()
    }

    /// Counts, extent and defects as JSON.
    fn report(&self) -> PyResult<String> {
        json(self.mesh.report())
    }

    /// One sentence for each defect, and for all that the reader had to repair.
    fn defects(&self) -> Vec<String> {
        let repaired = self.notes.iter().filter(|note| note.repaired).map(|note| note.message.clone());
        repaired.chain(self.mesh.report().defects()).collect()
    }

    /// One sentence for each thing that is no defect but worth knowing.
    fn notes(&self) -> Vec<String> {
        self.notes.iter().filter(|note| !note.repaired).map(|note| note.message.clone()).collect()
    }

    /// The disk of one face.
    fn disk<'py>(&self, py: Python<'py>, settings: Settings) -> PyResult<Bound<'py, PyDict>> {
        let call = Walk::parse_disk(&settings).map_err(|e| errors::raise(py, &e))?;
        lines::disk(py, &self.mesh, &call)
    }

    /// Paths along a principal direction.
    #[pyo3(signature = (settings, progress=None))]
    fn trace<'py>(
        &self,
        py: Python<'py>,
        settings: Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        let call = Walk::parse_trace(&settings).map_err(|e| errors::raise(py, &e))?;
        lines::traces(py, &self.mesh, &call, progress.as_ref())
    }

    /// The polylines in which a plane cuts the mesh.
    #[pyo3(signature = (settings, progress=None))]
    fn section<'py>(
        &self,
        py: Python<'py>,
        settings: Settings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        let plane = parse_plane(&self.mesh, &settings).map_err(|e| errors::raise(py, &e))?;
        lines::section(py, &self.mesh, &plane, progress.as_ref())
    }
}
