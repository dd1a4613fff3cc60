//! The `osculate` command.

use std::process::ExitCode;

mod cli;

/// Asks for large pages, which the system fills several times faster than small ones
/// (docs/decisions.md).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    cli::run()
}
