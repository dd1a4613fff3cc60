//! What every command takes.

use crate::cli::choices::LogFormat;
use crate::cli::parse::threads;
use clap::Args;

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(in crate::cli) struct CommonArgs {
    /// Threads to use, 1 or more; default: one per core. The output does not depend on it
    #[arg(short = 'j', long, value_name = "N", value_parser = threads)]
    pub(in crate::cli) threads: Option<usize>,

    /// Say more
    #[arg(short, long, conflicts_with = "quiet")]
    pub(in crate::cli) verbose: bool,

    /// Say nothing but errors
    #[arg(short, long)]
    pub(in crate::cli) quiet: bool,

    /// Messages for people, or one JSON object per line
    #[arg(long, value_enum, default_value_t = LogFormat::Text)]
    pub(in crate::cli) log: LogFormat,
}
