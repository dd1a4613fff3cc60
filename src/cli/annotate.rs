//! `osculate annotate`.

use super::Outcome;
use super::args::AnnotateArgs;
use super::messages::Messages;
use super::progress::Bars;
use osculate::{Destination, Error, Output, OutputFormat, Summary};
use std::io::Write;
use std::path::Path;

pub(super) fn run(args: &AnnotateArgs, messages: &Messages) -> Result<Outcome, Error> {
    let options = args.options()?;
    let to_stdout = args.output == Path::new("-");
    let format = match args.format {
        Some(format) => format.into(),
        None if to_stdout => return Err(Error::Usage("-o - needs --format glb, gltf, ply, csv or npz".into())),
        None => OutputFormat::of(&args.output)?,
    };
    let destination = if to_stdout { Destination::Stdout } else { Destination::File(args.output.clone()) };
    let besides = [&args.edges, &args.legend].into_iter().flatten().find(|path| path.exists()).cloned();
    if let Some(existing) = destination.existing(format).or(besides).filter(|_| args.no_clobber) {
        return Err(Error::Exists(existing));
    }
    let stats = args.stats.as_deref().map(|path| open_stats(path, args)).transpose()?;

    let bars = Bars::new(messages.wants_progress());
    let summary = osculate::annotate(&args.input.path, &destination, format, &options, &bars)?;
    if let Some(stats) = stats {
        write_stats(&summary, stats)?;
    }

    summary.notes.iter().for_each(|note| messages.note(note));
    summary.report.defects().iter().for_each(|defect| messages.warning(defect));
    if messages.verbose {
        tell(&summary, messages);
    }
    let seconds = summary.seconds.total;
    messages.info(&format!("{}: {} faces in {seconds:.2} s", args.output.display(), summary.report.faces));
    Ok(Outcome::of(summary.has_defects()))
}

/// Opens the statistics before any work, so that a wrong folder is known at once.
fn open_stats(path: &Path, args: &AnnotateArgs) -> Result<Output, Error> {
    if args.no_clobber && path.exists() {
        return Err(Error::Exists(path.to_path_buf()));
    }
    Output::create(path)
}

fn write_stats(summary: &Summary, mut out: Output) -> Result<(), Error> {
    let json = serde_json::to_string_pretty(summary).unwrap_or_default();
    writeln!(out, "{json}").map_err(|e| out.error(e))?;
    out.finish()
}

fn tell(summary: &Summary, messages: &Messages) {
    let s = summary.seconds;
    messages.info(&format!("settings: {}", summary.settings));
    messages.info(&format!(
        "seconds: read {:.3}, weld {:.3}, estimate {:.3}, write {:.3}",
        s.read, s.weld, s.estimate, s.write
    ));
    let Some(curvature) = &summary.curvature else { return };
    let classes: Vec<String> =
        curvature.classes.iter().filter(|(_, n)| **n > 0).map(|(class, n)| format!("{n} {}", class.name())).collect();
    messages.info(&format!("classes: {}", classes.join(", ")));
}
