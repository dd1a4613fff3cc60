//! The native half of the Python package `osculate`: thin calls into the crate. Arguments come checked and
//! settings as text; what users see is in `package/osculate`.

mod arrays;
mod batch;
mod errors;
mod files;
mod lines;
mod mesh;
mod settings;
mod values;
mod work;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command line with these arguments, of which the first is the program's name; gives its exit code.
#[pyfunction]
fn run(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| osculate::cli::run(arguments))
}

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::batch::{Batch, is_mesh_name, remove_abandoned_outputs};
    #[pymodule_export]
    use super::files::{convert, inspect};
    #[pymodule_export]
    use super::mesh::Mesh;
    #[pymodule_export]
    use super::run;
    #[pymodule_export]
    use super::settings::facts;
    #[pymodule_export]
    use super::values::{Values, class_names, colormaps, method_names, palette, quantities};

    /// Of the crate.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
