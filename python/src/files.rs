//! From file to file.

use crate::settings::Settings;
use crate::values::json;
use crate::{errors, work};
use osculate::cli::settings::{Convert, Read};
use pyo3::prelude::*;
use std::path::PathBuf;

/// `osculate annotate`: the object that `--stats` writes, as JSON, and all notes.
#[pyfunction]
#[pyo3(signature = (input, output, settings, summarise, progress=None))]
pub(crate) fn convert(
    py: Python<'_>,
    input: PathBuf,
    output: PathBuf,
    settings: Settings,
    summarise: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let call = Convert::parse(&input, &output, &settings);
    let mut call = call.map_err(|e| errors::raise(py, &e))?;
    if summarise {
        call.summarise();
    }
    let summary = work::run(py, call.threads(), progress.as_ref(), |progress| call.run(progress))?;
    let repaired = summary.written.notes.iter().filter(|note| note.repaired).map(|note| note.message.clone());
    Ok((json(&summary)?, repaired.chain(summary.report.defects()).collect()))
}

/// `osculate inspect`: what `--format json` prints.
#[pyfunction]
#[pyo3(signature = (input, settings, progress=None))]
pub(crate) fn inspect(
    py: Python<'_>,
    input: PathBuf,
    settings: Settings,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let call = Read::parse_inspect(&settings).map_err(|e| errors::raise(py, &e))?;
    let inspection = work::run(py, call.threads, progress.as_ref(), |progress| {
        osculate::inspect_with(&input, &call.read, &call.mesh, call.view, progress)
    })?;
    json(&inspection)
}
