//! `osculate annotate`.

use super::args::{AnnotateArgs, OutputsArgs};
use super::messages::Messages;
use super::progress::Bars;
use super::{Outcome, open};
use crate::wording::counted;
use osculate::{AnnotateOptions, Destination, Error, Output, OutputFormat, Progress, Summary};
use std::io::Write;
use std::path::{Path, PathBuf};

pub(super) fn run(args: &AnnotateArgs, messages: &Messages) -> Result<Outcome, Error> {
    let options = args.options()?;
    let target = Target::of(&args.outputs, args.stats.clone())?;
    let bars = Bars::new(messages.wants_progress());
    let summary = target.annotate(&args.input.path, &options, &bars)?;

    summary.written.notes.iter().for_each(|note| messages.note(note));
    summary.report.defects().iter().for_each(|defect| messages.warning(defect));
    if messages.verbose {
        tell(&summary, messages);
    }
    let seconds = summary.seconds.total;
    let faces = match summary.written.selected_faces {
        Some(selected) => format!("{selected} of {}", counted(summary.report.faces, "face")),
        None => counted(summary.report.faces, "face"),
    };
    messages.info(&format!("{}: {faces} in {seconds:.2} s", args.outputs.output.display()));
    Ok(Outcome::of(summary.has_defects()))
}

/// Where a file's results go.
pub(super) struct Target {
    pub(super) destination: Destination,
    pub(super) format: OutputFormat,
    pub(super) stats: Option<PathBuf>,
    /// Whether what is there already is kept.
    pub(super) no_clobber: bool,
}

impl Target {
    /// Where the command line says that they go.
    pub(super) fn of(args: &OutputsArgs, stats: Option<PathBuf>) -> Result<Self, Error> {
        let to_stdout = args.output == Path::new("-");
        let format = match (args.format.map(OutputFormat::from), OutputFormat::of(&args.output)) {
            (Some(format), Ok(other)) if format != other => {
                let [path, named, other] = [&args.output.display().to_string(), format.extension(), other.extension()];
                let what = format!("{path}: --format {named} does not go with the extension .{other}; leave one out");
                return Err(Error::Usage(what));
            }
            (Some(format), _) => format,
            (None, _) if to_stdout => {
                return Err(Error::Usage("-o - needs --format glb, gltf, ply, csv or npz".into()));
            }
            (None, format) => format?,
        };
        if to_stdout && stats.as_deref() == Some(Path::new("-")) {
            return Err(Error::Usage("standard output is named for two outputs".into()));
        }
        let destination = if to_stdout { Destination::Stdout } else { Destination::File(args.output.clone()) };
        Ok(Target { destination, format, stats, no_clobber: args.no_clobber })
    }

    /// Annotates a file and writes its statistics.
    pub(super) fn annotate(
        &self,
        input: &Path,
        options: &AnnotateOptions,
        progress: &dyn Progress,
    ) -> Result<Summary, Error> {
        self.check_existing(options)?;
        // Opened before any work, so that a wrong folder is known at once.
        let stats = self.stats.as_deref().map(open).transpose()?;
        let summary = osculate::annotate(input, &self.destination, self.format, options, progress)?;
        if let Some(stats) = stats {
            write_stats(&summary, stats).map_err(|e| match e {
                Error::Io { path, action, source } => {
                    let what = format!("{source}; the output itself is written");
                    Error::Io { path, action, source: std::io::Error::new(source.kind(), what) }
                }
                other => other,
            })?;
        }
        Ok(summary)
    }

    /// Refuses to replace what is there, where that is not wanted.
    pub(super) fn check_existing(&self, options: &AnnotateOptions) -> Result<(), Error> {
        let existing = || options.files(&self.destination, self.format).into_iter().find(|path| path.exists());
        self.no_clobber.then(existing).flatten().map_or(Ok(()), |existing| Err(Error::Exists(existing)))
    }
}

fn write_stats(summary: &Summary, mut out: Output) -> Result<(), Error> {
    let json = serde_json::to_string_pretty(summary).unwrap_or_default();
    writeln!(out, "{json}").map_err(|e| out.error(e))?;
    out.finish()
}

fn tell(summary: &Summary, messages: &Messages) {
    let s = summary.seconds;
    messages.info(&format!("settings: {}", summary.written.settings));
    messages.info(&format!(
        "seconds: read {:.3}, weld {:.3}, estimate {:.3}, write {:.3}",
        s.read, s.weld, s.estimate, s.write
    ));
    let Some(curvature) = &summary.curvature else { return };
    let classes: Vec<String> =
        curvature.classes.iter().filter(|(_, n)| **n > 0).map(|(class, n)| format!("{n} {}", class.name())).collect();
    messages.info(&format!("classes: {}", classes.join(", ")));
}
