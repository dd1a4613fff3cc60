//! In which axes and unit glTF is written.

use crate::cli::choices::{UnitArg, UpArg};
use clap::Args;
use osculate::{InputFormat, Space};

/// Axes and units of a glTF output.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(in crate::cli) struct SpaceArgs {
    /// The input's up axis; what is written as glTF or drawn is turned so that it becomes +Y. glTF is y always.
    /// Default: z for STL and 3MF, y for others
    #[arg(long, value_enum)]
    pub(super) up: Option<UpArg>,

    /// The input's unit; what is written as glTF is scaled to metres, and a report shows numbers with it. glTF is in
    /// metres always. Default: lengths stay as they are
    #[arg(long, value_enum)]
    pub(super) unit: Option<UnitArg>,
}

impl SpaceArgs {
    pub(in crate::cli) fn space(&self, input: InputFormat) -> Result<Space, osculate::Error> {
        Space::to_gltf(input, self.up.map(Into::into), self.unit.map(Into::into))
    }
}
