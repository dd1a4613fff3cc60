//! Which file is read, and how.

use crate::cli::choices::InputFormatArg;
use clap::Args;
use osculate::ReadOptions;
use std::path::PathBuf;

/// One mesh file.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(in crate::cli) struct InputArgs {
    /// Mesh to read: STL, OBJ, PLY, OFF, 3MF, glTF or GLB, told by its content; gzip is undone
    /// first. - for standard input
    #[arg(value_name = "INPUT", help_heading = None)]
    pub(in crate::cli) path: PathBuf,

    #[command(flatten)]
    pub(in crate::cli) reading: ReadingArgs,
}

/// How a mesh file is read, of commands with one input or many.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(in crate::cli) struct ReadingArgs {
    /// Input format, where the content does not tell
    #[arg(long, value_enum, value_name = "FORMAT")]
    input_format: Option<InputFormatArg>,

    /// Also read files in this folder that the input names, such as a glTF's buffers; may be given
    /// several times. Default: only those beside the input and below
    #[arg(long, value_name = "DIR")]
    allow_folder: Vec<PathBuf>,
}

impl ReadingArgs {
    pub(in crate::cli) fn options(&self) -> Result<ReadOptions, osculate::Error> {
        if let Some(folder) = self.allow_folder.iter().find(|folder| !folder.is_dir()) {
            return Err(osculate::Error::Usage(format!("--allow-folder {}: is no folder", folder.display())));
        }
        Ok(ReadOptions { format: self.input_format.map(Into::into), allowed_folders: self.allow_folder.clone() })
    }
}
