//! What a batch does with each of its files.

use super::journal::{Counts, Status};
use crate::cli::annotate::Target;
use crate::cli::args::BatchArgs;
use crate::cli::choices::PictureFormat;
use osculate::{AnnotateOptions, Destination, Error, Note, OutputFormat, Progress, Summary};
use serde::Serialize;
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What all files of a batch have in common: `osculate batch` without its finding, sharing and logging, for
/// schedulers that bring their own.
#[derive(Clone, Debug)]
pub struct Batch {
    options: AnnotateOptions,
    format: OutputFormat,
    legend: Option<&'static str>,
    edges: bool,
    stats: bool,
    no_clobber: bool,
    settings: String,
}

/// What became of a file.
#[derive(Clone, Debug, Serialize)]
pub struct Done {
    /// Written, written with defects, or not written.
    pub status: Status,
    /// Why it failed, or what was repaired or is wrong, in one sentence.
    pub message: Option<String>,
    /// What was repaired or is wrong, one by one.
    pub defects: Vec<String>,
    /// Counts of the mesh; `None` for one that failed.
    pub counts: Option<Counts>,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Whether the reason to fail may be gone by itself: a file system that did not answer, and the like.
    pub transient: bool,
}

impl Batch {
    pub(in crate::cli) fn new(args: &BatchArgs) -> Result<Self, Error> {
        let mut batch = Batch {
            options: args.options()?,
            format: args.format.into(),
            legend: args.legend.map(|format| match format {
                PictureFormat::Png => "legend.png",
                PictureFormat::Svg => "legend.svg",
            }),
            edges: args.edges,
            stats: args.stats,
            no_clobber: args.no_clobber,
            settings: String::new(),
        };
        let sample = batch.options_of(Path::new("sample.glb"));
        sample.check_for(batch.format)?;
        batch.settings = fingerprint(&format!("{} {:?} {sample:?}", env!("CARGO_PKG_VERSION"), batch.format));
        Ok(batch)
    }

    /// 16 digits that stand for all settings and the program's version: equal where those are.
    pub fn fingerprint(&self) -> &str {
        &self.settings
    }

    /// What the names of all outputs end in, without the dot.
    pub fn extension(&self) -> &'static str {
        self.format.extension()
    }

    /// All files that stand for an input when it is done: its output, and what is written beside it.
    pub fn files_of(&self, output: &Path) -> Vec<PathBuf> {
        self.options_of(output).files(&Destination::File(output.to_path_buf()), self.format)
    }

    /// The options of a file, with what is written beside its output.
    fn options_of(&self, output: &Path) -> AnnotateOptions {
        let beside = |ending: &str| output.with_extension(ending);
        AnnotateOptions {
            legend: self.legend.map(beside),
            edges: self.edges.then(|| beside("edges.glb")),
            reserved: self.stats.then(|| beside("stats.json")).into_iter().collect(),
            ..self.options.clone()
        }
    }

    /// Annotates a file, whatever is in it, and tells what became of it. Threads are those of the caller's pool. Only
    /// an unwinding of `progress` comes through.
    pub fn annotate(&self, input: &Path, output: &Path, progress: &dyn Progress) -> Done {
        let start = Instant::now();
        // A panic is a mistake of ours, but not one that the other files should suffer from.
        let result = catch_unwind(AssertUnwindSafe(|| self.try_annotate(input, output, progress)));
        let seconds = start.elapsed().as_secs_f64();
        let failed = |message: String, transient: bool| Done {
            status: Status::Failed,
            message: Some(message),
            defects: Vec::new(),
            counts: None,
            seconds,
            transient,
        };
        match result {
            Ok(Ok(summary)) => {
                let defects = defects(&summary);
                Done {
                    status: if summary.has_defects() { Status::Defects } else { Status::Done },
                    message: (!defects.is_empty()).then(|| defects.join("; ")),
                    defects,
                    counts: Some(Counts::of(&summary.report)),
                    seconds,
                    transient: false,
                }
            }
            Ok(Err(error)) => failed(error.to_string(), is_transient(&error)),
            Err(panic) if panic.is::<String>() || panic.is::<&str>() => {
                failed(format!("{}: {PANIC}", input.display()), false)
            }
            Err(cancel) => resume_unwind(cancel),
        }
    }

    fn try_annotate(&self, input: &Path, output: &Path, progress: &dyn Progress) -> Result<Summary, Error> {
        if let Some(folder) = output.parent() {
            std::fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create", e))?;
        }
        let options = self.options_of(output);
        let target = Target {
            destination: Destination::File(output.to_path_buf()),
            format: self.format,
            stats: options.reserved.first().cloned(),
            no_clobber: self.no_clobber,
        };
        target.annotate(input, &options, progress)
    }
}

const PANIC: &str = "the program has a mistake that this file brings out; please report it with the file";

/// What was repaired or is wrong.
fn defects(summary: &Summary) -> Vec<String> {
    let repaired = summary.written.notes.iter().filter(|note| note.repaired).map(|note: &Note| note.message.clone());
    repaired.chain(summary.report.defects()).collect()
}

/// Whether trying again may help. What a file holds, and where it is not, stay as they are.
fn is_transient(error: &Error) -> bool {
    use ErrorKind::{
        AlreadyExists, InvalidData, InvalidFilename, InvalidInput, IsADirectory, NotADirectory, NotFound,
        PermissionDenied, ReadOnlyFilesystem, UnexpectedEof, Unsupported,
    };
    let Error::Io { source, .. } = error else { return false };
    let lasting = [
        AlreadyExists,
        InvalidData,
        InvalidFilename,
        InvalidInput,
        IsADirectory,
        NotADirectory,
        NotFound,
        PermissionDenied,
        ReadOnlyFilesystem,
        UnexpectedEof,
        Unsupported,
    ];
    !lasting.contains(&source.kind())
}

/// A short text that differs where `settings` do (FNV-1a, 64 bits).
fn fingerprint(settings: &str) -> String {
    let hash = settings
        .bytes()
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{hash:016x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_may_pass_is_tried_again() {
        let io = |kind: ErrorKind| Error::io(Path::new("a.stl"), "read", kind.into());
        assert!(
            [ErrorKind::TimedOut, ErrorKind::StaleNetworkFileHandle, ErrorKind::Other].map(io).iter().all(is_transient)
        );
        assert!(![ErrorKind::NotFound, ErrorKind::PermissionDenied].map(io).iter().any(is_transient));
        assert!(!is_transient(&Error::Usage("no".into())));
    }
}
