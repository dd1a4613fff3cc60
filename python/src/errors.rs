//! The crate's errors as the package's exceptions.

use osculate::{Error, FilePlace};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io::ErrorKind;
use std::path::PathBuf;

/// The exception for an error, made by the package itself.
pub(crate) fn raise(py: Python<'_>, error: &Error) -> PyErr {
    made(py, error).unwrap_or_else(|failure| failure)
}

fn made(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let facts = PyDict::new(py);
    let mut path: Option<&PathBuf> = None;
    let kind = match error {
        Error::Io { path: file, source, .. } => {
            path = Some(file);
            facts.set_item("errno", source.raw_os_error())?;
            facts.set_item("reason", reason(source.kind()))?;
            "file"
        }
        Error::Parse { path: file, source } => {
            path = Some(file);
            match &source.place {
                FilePlace::File => {}
                FilePlace::Line(line) => facts.set_item("line", line)?,
                FilePlace::Byte(byte) => facts.set_item("byte", byte)?,
                FilePlace::Json(json) => facts.set_item("json_path", json)?,
            }
            "parse"
        }
        Error::EmptyMesh(_) => "empty",
        Error::TooLarge(_) => "too_large",
        Error::Exists(file) => {
            path = Some(file);
            "exists"
        }
        Error::Usage(_) => "usage",
        _ => "other",
    };
    facts.set_item("path", path)?;
    exception(py, kind, &error.to_string(), &facts)
}

/// The name of the system's error number, where the error itself does not have it.
fn reason(kind: ErrorKind) -> Option<&'static str> {
    match kind {
        ErrorKind::NotFound => Some("ENOENT"),
        ErrorKind::PermissionDenied => Some("EACCES"),
        ErrorKind::IsADirectory => Some("EISDIR"),
        ErrorKind::StorageFull => Some("ENOSPC"),
        ErrorKind::BrokenPipe => Some("EPIPE"),
        _ => None,
    }
}

/// A panic is a bug of ours, and says so.
pub(crate) fn bug(py: Python<'_>, what: &str) -> PyErr {
    exception(py, "bug", what, &PyDict::new(py)).unwrap_or_else(|failure| failure)
}

fn exception(py: Python<'_>, kind: &str, message: &str, facts: &Bound<'_, PyDict>) -> PyResult<PyErr> {
    let make = py.import("osculate.errors")?.getattr("_make")?;
    Ok(PyErr::from_value(make.call((kind, message), Some(facts))?))
}
