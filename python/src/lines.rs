//! Disks, traces and sections as dictionaries of arrays; points are in the input's coordinates.

use crate::arrays::{points, triples, vector};
use crate::work;
use glam::DVec3;
use numpy::IntoPyArray;
use osculate::cli::settings::Walk;
use osculate::{FaceCurvature, Frame, Mesh, Place, Plane, Polyline, Trace, TraceEnd};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

/// The disk at a place: its frame, its values, and per leg angle, length, end, path and why it ended. One disk is done
/// before anybody could cancel it.
pub(crate) fn disk<'py>(py: Python<'py>, mesh: &Mesh, call: &Walk) -> PyResult<Bound<'py, PyDict>> {
    let (place, disk, frame, value) = work::run(py, call.threads, None, |_| {
        let place = call.places(mesh)?.remove(0);
        let (disk, frame, value) = osculate::disk_at(mesh, place, &call.curvature)?;
        Ok((place, disk, frame, value))
    })?;
    let dict = PyDict::new(py);
    set_place(py, &dict, mesh, place, &frame)?;
    dict.set_item("value", value_of(py, &value)?)?;
    let count = disk.legs().len();
    let angle = |i: usize| std::f64::consts::TAU * i as f64 / count as f64;
    let angles: Vec<f64> = (0..count).map(angle).collect();
    dict.set_item("angle", angles.into_pyarray(py))?;
    dict.set_item("length", disk.legs().iter().map(|leg| leg.length).collect::<Vec<_>>().into_pyarray(py))?;
    dict.set_item("stop", disk.legs().iter().map(|leg| leg.stop.name()).collect::<Vec<_>>())?;
    let legs = disk.paths(mesh, place.face, &frame).map(|path| points(py, &path, mesh.origin()));
    dict.set_item("legs", legs.collect::<PyResult<Vec<_>>>()?)?;
    let curvature = disk.diameters().map(|d| osculate::normal_curvature(&d, call.curvature.estimator));
    let curvature: Vec<f64> = curvature.map(|k| k.unwrap_or(f64::NAN)).collect();
    dict.set_item("curvature", curvature.into_pyarray(py))?;
    Ok(dict)
}

fn set_place(py: Python<'_>, dict: &Bound<'_, PyDict>, mesh: &Mesh, place: Place, frame: &Frame) -> PyResult<()> {
    dict.set_item("face", place.face.0)?;
    let [a, b, c] = place.weights;
    dict.set_item("weights", (a, b, c))?;
    dict.set_item("centre", vector(py, frame.centre + mesh.origin()))?;
    dict.set_item("normal", vector(py, frame.normal))?;
    dict.set_item("x", vector(py, frame.x))?;
    dict.set_item("y", vector(py, frame.y))
}

/// The values of one place.
fn value_of<'py>(py: Python<'py>, value: &FaceCurvature) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("k_max", value.k_max)?;
    dict.set_item("k_min", value.k_min)?;
    dict.set_item("mean", value.mean())?;
    dict.set_item("gauss", value.gauss())?;
    dict.set_item("gauss_perimeter", value.gauss_perimeter)?;
    dict.set_item("radius", value.radius)?;
    dict.set_item("coverage", value.coverage)?;
    dict.set_item("face_class", value.class.code())?;
    dict.set_item("dir_max", vector(py, value.dir_max.as_dvec3()))?;
    dict.set_item("dir_min", vector(py, value.dir_min.as_dvec3()))?;
    Ok(dict)
}

/// Traces from all seeds.
pub(crate) fn traces<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    call: &Walk,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let traces = work::run(py, call.threads, progress, |progress| {
        let seeds = call.places(mesh)?;
        osculate::trace(mesh, &seeds, &call.curvature, &call.trace, progress)
    })?;
    let list = PyList::empty(py);
    for trace in &traces {
        list.append(trace_of(py, mesh, trace)?)?;
    }
    Ok(list)
}

fn trace_of<'py>(py: Python<'py>, mesh: &Mesh, trace: &Trace) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let centres: Vec<DVec3> = trace.points.iter().map(|p| p.point).collect();
    let number = |of: fn(&FaceCurvature) -> f32| {
        trace.points.iter().map(|p| of(&p.curvature)).collect::<Vec<f32>>().into_pyarray(py)
    };
    dict.set_item("centres", points(py, &centres, mesh.origin())?)?;
    dict.set_item("faces", trace.points.iter().map(|p| p.place.face.0).collect::<Vec<u32>>().into_pyarray(py))?;
    let directions: Vec<[f64; 3]> = trace.points.iter().map(|p| p.direction.to_array()).collect();
    dict.set_item("directions", triples(py, directions)?)?;
    dict.set_item("k_max", number(|value| value.k_max))?;
    dict.set_item("k_min", number(|value| value.k_min))?;
    dict.set_item("radius", number(|value| value.radius))?;
    dict.set_item("path", points(py, &trace.path.points, mesh.origin())?)?;
    dict.set_item("end", trace.end.name())?;
    dict.set_item("backward_end", trace.backward_end.map(TraceEnd::name))?;
    Ok(dict)
}

/// The polylines of a plane section.
pub(crate) fn section<'py>(
    py: Python<'py>,
    mesh: &Mesh,
    plane: &Plane,
    progress: Option<&Py<PyAny>>,
) -> PyResult<Bound<'py, PyList>> {
    let lines = work::run(py, None, progress, |progress| Ok(osculate::cut(mesh, plane, progress)))?;
    let list = PyList::empty(py);
    for line in &lines {
        list.append((points(py, &line.points, mesh.origin())?, line.closed, Polyline::length(line)))?;
    }
    Ok(list)
}
