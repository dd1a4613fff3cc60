//! `osculate report`.

use super::Outcome;
use super::args::ReportArgs;
use super::messages::Messages;
use super::place::extension;
use super::progress::Bars;
use osculate::{Error, Output};
use std::path::Path;

pub(super) fn run(args: &ReportArgs, messages: &Messages) -> Result<Outcome, Error> {
    let options = args.options()?;
    if args.png.is_some() && args.inputs.len() > 1 {
        return Err(Error::Usage("--png draws one mesh; give one input, or leave it out".into()));
    }
    let to_stdout = args.output.as_deref() == Some(Path::new("-"));
    let page = args.output.as_deref().filter(|_| !to_stdout);
    let outputs = [(page, ["html", "htm"].as_slice()), (args.png.as_deref(), &["png"])];
    for (path, known) in outputs.into_iter().filter_map(|(path, known)| Some((path?, known))) {
        extension(path, known)?;
        if args.no_clobber && path.exists() {
            return Err(Error::Exists(path.to_path_buf()));
        }
    }
    // Opened before any work, so that a wrong folder is known at once.
    let page = if to_stdout { Some(Output::stdout()) } else { page.map(Output::create).transpose()? };
    let picture = args.png.as_deref().map(Output::create).transpose()?;
    let bars = Bars::new(messages.wants_progress());
    let done = osculate::report(&args.inputs, page, picture, &options, &bars)?;
    for (notes, report) in done.notes.iter().zip(&done.reports) {
        notes.iter().for_each(|note| messages.note(note));
        report.defects().iter().for_each(|defect| messages.warning(defect));
    }
    let faces: Vec<String> = done.reports.iter().map(|report| report.faces.to_string()).collect();
    let named = args.output.iter().chain(&args.png).map(|path| path.display().to_string()).collect::<Vec<_>>();
    messages.info(&format!("{}: {} faces in {:.2} s", named.join(", "), faces.join(" and "), done.seconds));
    Ok(Outcome::of(done.has_defects))
}
