//! `osculate batch`: many files, a mirrored tree, a log.

mod bar;
mod files;
mod inputs;
mod journal;
mod share;

use super::Outcome;
use super::args::BatchArgs;
use super::messages::Messages;
use bar::FilesBar;
use inputs::{Found, Job};
use journal::{Journal, Record};
use osculate::{Error, NoProgress};
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

pub use files::{Batch, Done};
pub use journal::{Counts, Status};

pub(super) fn run(args: &BatchArgs, messages: &Messages) -> Result<Outcome, Error> {
    let start = Instant::now();
    let batch = Batch::new(args)?;
    let Found { jobs, failures } = inputs::find(&args.inputs, &args.output, &batch, args.keep_extension)?;
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    let (journal, records) = Journal::open(&args.output, args.resume)?;
    // What a killed run has left behind.
    let folders: BTreeSet<&Path> = jobs.iter().filter_map(|job| job.output.parent()).collect();
    folders.into_iter().for_each(|folder| osculate::remove_abandoned_outputs(&args.output.join(folder)));

    let mut tally = Tally::default();
    for failure in &failures {
        let record = Record::of_failure(failure, batch.fingerprint());
        tell(&record, messages);
        journal.write(&record)?;
        tally.add(&record);
    }
    let mut left = Vec::new();
    for job in jobs {
        match records
            .get(&job.output.display().to_string())
            .filter(|record| is_done(&batch, &args.output, &job, record))
        {
            Some(record) => tally.skip(record),
            None => left.push(job),
        }
    }

    let bar = FilesBar::new(left.len(), messages);
    let shared = Mutex::new((tally, Ok(())));
    share::over(&left, |job| {
        let done = batch.annotate(&job.input, &args.output.join(&job.output), &NoProgress);
        let record = Record::of(job, batch.fingerprint()).with(done);
        let written = journal.write(&record);
        let goes_on = written.is_ok();
        if record.message.is_some() {
            bar.aside(|| tell(&record, messages));
        }
        bar.advance();
        let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
        shared.0.add(&record);
        if written.is_err() {
            shared.1 = written;
        }
        goes_on
    })?;
    bar.finish();
    let (tally, written) = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    // Without its log a batch cannot tell what it has done.
    written?;
    messages.info(&tally.summary(start.elapsed().as_secs_f64(), &args.output.join(journal::NAME)));
    Ok(tally.outcome())
}

/// True when all that the job would write is there, newer than the input and made with the same settings, as
/// its record says.
fn is_done(batch: &Batch, folder: &Path, job: &Job, record: &Record) -> bool {
    let is_newer =
        |path: &Path| path.metadata().and_then(|m| m.modified()).is_ok_and(|modified| modified >= job.modified);
    let files = || batch.files_of(&folder.join(&job.output));
    record.is_of(job, batch.fingerprint()) && files().iter().all(|path| is_newer(path))
}

fn tell(record: &Record, messages: &Messages) {
    let Some(message) = &record.message else { return };
    match record.status {
        Status::Failed => messages.failure(message),
        // With many files that is much to read; the log has it.
        _ if messages.verbose => messages.warning(&format!("{}: {message}", record.input)),
        _ => {}
    }
}

/// How many files came out how.
#[derive(Debug, Default)]
struct Tally {
    done: usize,
    skipped: usize,
    failed: usize,
    /// Of those done or skipped.
    with_defects: usize,
}

impl Tally {
    fn add(&mut self, record: &Record) {
        match record.status {
            Status::Failed => self.failed += 1,
            _ => self.done += 1,
        }
        self.with_defects += usize::from(record.status == Status::Defects);
    }

    /// A file that an earlier run has done: the outcome is that of both runs together.
    fn skip(&mut self, record: &Record) {
        self.skipped += 1;
        self.with_defects += usize::from(record.status == Status::Defects);
    }

    fn outcome(&self) -> Outcome {
        if self.failed > 0 { Outcome::Failed } else { Outcome::of(self.with_defects > 0) }
    }

    fn summary(&self, seconds: f64, log: &Path) -> String {
        let part = |count: usize, what: &str| if count > 0 { format!(", {count} {what}") } else { String::new() };
        format!(
            "{} files annotated in {seconds:.1} s{}{}{}; {}",
            self.done,
            part(self.skipped, "skipped"),
            part(self.failed, "failed"),
            part(self.with_defects, "with defects"),
            log.display()
        )
    }
}
