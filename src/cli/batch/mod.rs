//! `osculate batch`: many files, a mirrored tree, a log.

mod bar;
mod inputs;
mod journal;
mod share;

use super::Outcome;
use super::annotate::Target;
use super::args::BatchArgs;
use super::choices::PictureFormat;
use super::messages::Messages;
use bar::FilesBar;
use inputs::{Failure, Found, Job};
use journal::{Counts, Journal, Record, Status};
use osculate::{AnnotateOptions, Destination, Error, NoProgress, Note, OutputFormat, Summary};
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Instant, UNIX_EPOCH};

pub(super) fn run(args: &BatchArgs, messages: &Messages) -> Result<Outcome, Error> {
    let start = Instant::now();
    let batch = Batch::new(args)?;
    std::fs::create_dir_all(&args.output).map_err(|e| Error::io(&args.output, "create", e))?;
    let Found { jobs, failures } =
        inputs::find(&args.inputs, &args.output, batch.format.extension(), args.keep_extension)?;
    let (journal, records) = Journal::open(&args.output, args.resume)?;
    // What a killed run has left behind.
    let folders: BTreeSet<&Path> = jobs.iter().filter_map(|job| job.output.parent()).collect();
    folders.into_iter().for_each(|folder| osculate::remove_abandoned_outputs(&args.output.join(folder)));

    let mut tally = Tally::default();
    for failure in &failures {
        let record = batch.record_of(failure);
        tell(&record, messages);
        journal.write(&record)?;
        tally.add(&record);
    }
    let mut left = Vec::new();
    for job in jobs {
        match records.get(&job.output.display().to_string()).filter(|record| batch.is_done(&job, record)) {
            Some(record) => tally.skip(record),
            None => left.push(job),
        }
    }

    let bar = FilesBar::new(left.len(), messages);
    let shared = Mutex::new((tally, Ok(())));
    share::over(&left, |job| {
        let record = batch.annotate(job);
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

/// What all files have in common.
struct Batch<'a> {
    args: &'a BatchArgs,
    options: AnnotateOptions,
    format: OutputFormat,
    /// Stands for all settings and the version.
    settings: String,
}

impl<'a> Batch<'a> {
    fn new(args: &'a BatchArgs) -> Result<Self, Error> {
        let options = args.options()?;
        let format: OutputFormat = args.format.into();
        let mut batch = Batch { args, options, format, settings: String::new() };
        let sample = batch.options_of(Path::new("sample.glb"));
        sample.check()?;
        batch.settings = fingerprint(&format!("{} {format:?} {sample:?}", env!("CARGO_PKG_VERSION")));
        Ok(batch)
    }

    /// The options of a file, with what is written beside its output.
    fn options_of(&self, output: &Path) -> AnnotateOptions {
        let beside = |ending: &str| output.with_extension(ending);
        AnnotateOptions {
            legend: self.args.legend.map(|format| match format {
                PictureFormat::Png => beside("legend.png"),
                PictureFormat::Svg => beside("legend.svg"),
            }),
            edges: self.args.edges.then(|| beside("edges.glb")),
            reserved: self.args.stats.then(|| beside("stats.json")).into_iter().collect(),
            ..self.options.clone()
        }
    }

    /// True when all that the job would write is there, newer than the input and made with the same
    /// settings, as its record says.
    fn is_done(&self, job: &Job, record: &Record) -> bool {
        let output = self.args.output.join(&job.output);
        let options = self.options_of(&output);
        let is_newer =
            |path: &Path| path.metadata().and_then(|m| m.modified()).is_ok_and(|modified| modified >= job.modified);
        let mut besides = options.legend.iter().chain(&options.edges).chain(&options.reserved);
        record.is_of(job, &self.settings) && is_newer(&output) && besides.all(|path| is_newer(path))
    }

    /// Annotates a file, whatever is in it, and tells what became of it.
    fn annotate(&self, job: &Job) -> Record {
        let start = Instant::now();
        // A panic is a mistake of ours, but not one that the other files should suffer from.
        let result = catch_unwind(AssertUnwindSafe(|| self.try_annotate(job)));
        let mut record = Record::of(job, &self.settings);
        record.seconds = start.elapsed().as_secs_f64();
        match result {
            Ok(Ok(summary)) => {
                record.status = if summary.has_defects() { Status::Defects } else { Status::Done };
                record.message = defects(&summary);
                record.counts = Some(Counts::of(&summary.report));
            }
            Ok(Err(error)) => record.message = Some(error.to_string()),
            Err(_) => record.message = Some(format!("{}: {PANIC}", job.input.display())),
        }
        record
    }

    fn try_annotate(&self, job: &Job) -> Result<Summary, Error> {
        let output = self.args.output.join(&job.output);
        if let Some(folder) = output.parent() {
            std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
        }
        let options = self.options_of(&output);
        let target = Target {
            destination: Destination::File(output),
            format: self.format,
            stats: options.reserved.first().cloned(),
            no_clobber: self.args.no_clobber,
        };
        target.annotate(&job.input, &options, &NoProgress)
    }

    fn record_of(&self, failure: &Failure) -> Record {
        let message = format!("{}: {}", failure.input.display(), failure.message);
        let job = Job { input: failure.input.clone(), output: PathBuf::new(), bytes: 0, modified: UNIX_EPOCH };
        Record { output: None, message: Some(message), ..Record::of(&job, &self.settings) }
    }
}

const PANIC: &str = "the program has a mistake that this file brings out; please report it with the file";

/// What was repaired or is wrong, in one line.
fn defects(summary: &Summary) -> Option<String> {
    let repaired = summary.notes.iter().filter(|note| note.repaired).map(|note: &Note| note.message.clone());
    let all: Vec<String> = repaired.chain(summary.report.defects()).collect();
    (!all.is_empty()).then(|| all.join("; "))
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

/// A short text that differs where `settings` do (FNV-1a, 64 bits).
fn fingerprint(settings: &str) -> String {
    let hash = settings
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
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
