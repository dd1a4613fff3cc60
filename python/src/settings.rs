//! Settings as the package hands them over, and what there are.

use osculate::cli::settings::Setting;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Names and texts: the package has made texts of all values.
pub(crate) type Settings = Vec<Setting>;

/// What is known of the settings of a call, as JSON.
#[pyfunction]
pub(crate) fn facts(call: &str) -> PyResult<String> {
    let facts = osculate::cli::settings::facts(call);
    let facts = facts.ok_or_else(|| PyValueError::new_err(format!("there is no call {call}")))?;
    serde_json::to_string(&facts).map_err(|e| PyValueError::new_err(e.to_string()))
}
