//! What a scheduler of many files needs of `osculate batch`.

use crate::settings::Settings;
use crate::values::json;
use crate::{errors, work};
use osculate::InputFormat;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};

/// What all files of a batch have in common.
#[pyclass(frozen, module = "osculate._native")]
pub(crate) struct Batch {
    batch: osculate::cli::settings::Batch,
    threads: Option<usize>,
}

#[pymethods]
impl Batch {
    #[new]
    fn new(py: Python<'_>, settings: Settings) -> PyResult<Self> {
        let parsed = osculate::cli::settings::parse_batch(&settings);
        let (batch, threads) = parsed.map_err(|e| errors::raise(py, &e))?;
        Ok(Batch { batch, threads })
    }

    /// Stands for all settings and the version.
    #[getter]
    fn fingerprint(&self) -> &str {
        self.batch.fingerprint()
    }

    /// Of all outputs, without the dot.
    #[getter]
    fn extension(&self) -> &str {
        self.batch.extension()
    }

    /// The output and what is written beside it.
    fn files_of(&self, output: &str) -> Vec<String> {
        let files = self.batch.files_of(Path::new(output));
        files.iter().map(|path| path.to_string_lossy().into_owned()).collect()
    }

    /// Annotates a file, whatever is in it: what became of it, as JSON.
    fn annotate(&self, py: Python<'_>, input: PathBuf, output: PathBuf) -> PyResult<String> {
        let done = work::run(py, self.threads, None, |progress| Ok(self.batch.annotate(&input, &output, progress)))?;
        json(&done)
    }
}

/// Whether a folder's file counts as a mesh, by its extension.
#[pyfunction]
pub(crate) fn is_mesh_name(path: PathBuf) -> bool {
    InputFormat::of_extension(&path).is_some()
}

/// Removes what killed programs have left in a folder.
#[pyfunction]
pub(crate) fn remove_abandoned_outputs(py: Python<'_>, folder: PathBuf) {
    py.detach(|| osculate::remove_abandoned_outputs(&folder));
}
