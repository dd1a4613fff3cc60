//! The command line: parse, run, report, exit code. And its options by name, for bindings ([`settings`]), so that
//! names, defaults, checks and messages have one source.

mod annotate;
mod args;
mod batch;
mod choices;
mod disk;
mod inspect;
mod messages;
mod parse;
mod place;
mod progress;
mod report;
mod section;
pub mod settings;
mod synth;
mod trace;

use args::{Cli, Command};
use clap::{CommandFactory, Parser};
use messages::Messages;
use osculate::{Error, Output};
use std::ffi::OsString;
use std::io::{self, Write};
use std::path::Path;

/// How a run ended; the numbers are part of the command line's contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    /// Done.
    Done = 0,
    /// Failed; nothing was written.
    Failed = 1,
    /// The command line makes no sense.
    Usage = 2,
    /// Done, but the input was repaired or has defects.
    Defects = 3,
}

/// Exit code after Ctrl-C.
const INTERRUPTED: i32 = 130;

impl Outcome {
    fn of(has_defects: bool) -> Self {
        if has_defects { Outcome::Defects } else { Outcome::Done }
    }
}

/// Runs the program with these arguments, of which the first is its own name, and gives its exit code. Reads
/// and writes the standard streams and takes over the process's handling of interrupts.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = match Cli::try_parse_from(arguments) {
        Ok(cli) => cli,
        Err(error) => {
            // With its stream gone there is no one left to tell.
            let _ = error.print();
            return if error.use_stderr() { Outcome::Usage as u8 } else { Outcome::Done as u8 };
        }
    };
    let common = cli.command.common();
    let messages = Messages::new(common);
    let is_batch = matches!(cli.command, Command::Batch(_));
    // On Ctrl-C and the like; without a handler the temporary files would stay.
    let _ = ctrlc::set_handler(move || {
        osculate::abandon_outputs_at_exit();
        if is_batch {
            messages.info("interrupted; the same command with --resume goes on from here");
        }
        std::process::exit(INTERRUPTED);
    });
    let result = on_threads(common.and_then(|c| c.threads.threads), || match &cli.command {
        Command::Annotate(args) => annotate::run(args, &messages),
        Command::Batch(args) => batch::run(args, &messages),
        Command::Inspect(args) => inspect::run(args, &messages),
        Command::Report(args) => report::run(args, &messages),
        Command::Disk(args) => disk::run(args, &messages),
        Command::Trace(args) => trace::run(args, &messages),
        Command::Section(args) => section::run(args, &messages),
        Command::Synth(args) => synth::run(args, &messages),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut Cli::command(), "osculate", &mut script);
            print(&script)
        }
        Command::Man => {
            let mut page = Vec::new();
            render_man(&mut page).map_err(|e| Error::io(Path::new("standard output"), "write", e))?;
            print(&page)
        }
    });
    let outcome = match result {
        Ok(outcome) => outcome,
        // Whoever read the output has had enough: no failure.
        Err(error) if error.is_broken_pipe() => Outcome::Done,
        Err(error) => {
            messages.error(&error);
            if error.is_usage() { Outcome::Usage } else { Outcome::Failed }
        }
    };
    outcome as u8
}

/// Runs the work on so many threads, or on one per core.
fn on_threads(threads: Option<usize>, work: impl FnOnce() -> Result<Outcome, Error> + Send) -> Result<Outcome, Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    match pool {
        Ok(pool) => pool.install(work),
        Err(e) => Err(Error::Usage(format!("cannot start the threads: {e}; try a smaller -j"))),
    }
}

/// Opens a text that is written besides the main output; `-` is standard output.
fn open(path: &Path) -> Result<Output, Error> {
    if path == Path::new("-") { Ok(Output::stdout()) } else { Output::create(path) }
}

/// Writes results to standard output.
fn print(bytes: &[u8]) -> Result<Outcome, Error> {
    let mut out = io::stdout().lock();
    out.write_all(bytes).and_then(|()| out.flush()).map_err(|e| Error::io(Path::new("standard output"), "write", e))?;
    Ok(Outcome::Done)
}

/// One page: the program, then each command with its options.
fn render_man(page: &mut Vec<u8>) -> io::Result<()> {
    let mut command = Cli::command();
    command.build();
    clap_mangen::Man::new(command.clone()).render(page)?;
    for sub in command.get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help") {
        writeln!(page, ".SH \"OSCULATE {}\"", sub.get_name().to_uppercase())?;
        let man = clap_mangen::Man::new(sub.clone());
        man.render_synopsis_section(page)?;
        man.render_description_section(page)?;
        man.render_options_section(page)?;
    }
    Ok(())
}
