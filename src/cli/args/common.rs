//! What every command takes.

use super::ThreadsArgs;
use crate::cli::choices::LogFormat;
use clap::Args;

#[derive(Debug, Args)]
#[command(next_help_heading = "General")]
pub(in crate::cli) struct CommonArgs {
    #[command(flatten)]
    pub(in crate::cli) threads: ThreadsArgs,

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
