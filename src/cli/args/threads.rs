//! How many threads work.

use crate::cli::parse::threads;
use clap::Args;

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(in crate::cli) struct ThreadsArgs {
    /// Threads to use, 1 or more; default: one per core. The output does not depend on it
    #[arg(short = 'j', long, value_name = "N", value_parser = threads)]
    pub(in crate::cli) threads: Option<usize>,
}
