//! Which quantities are wanted.

use clap::Args;
use osculate::Selection;

#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct AttributesArgs {
    /// Quantities to write, separated by commas: face, class, k_max, k_min, mean, gauss, gauss_perimeter, shape_index,
    /// curvedness, dir_max, dir_min, radius, coverage, method, confidence; or default, all, none
    #[arg(long, value_name = "LIST", value_parser = Selection::parse, default_value = "default")]
    pub(in crate::cli) attributes: Selection,
}
