//! The `osculate` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(osculate::cli::run(std::env::args_os()))
}
