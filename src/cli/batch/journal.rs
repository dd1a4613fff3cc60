//! The log of a batch: one JSON object per line, one line per file, written when the file is done. It is
//! also what a later run goes by to know what is done already.
//!
//! Lines are only ever added, each with one write: whatever happens to the program, all lines but the
//! last are whole, and a file without a line is done again.

use super::files::Done;
use super::inputs::{Failure, Job};
use osculate::{Error, MeshReport};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// The log's name in the output folder.
pub(super) const NAME: &str = "osculate-batch.jsonl";

/// What became of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Written.
    Done,
    /// Written, but the input was repaired or has defects: exit code 3 of `annotate`.
    Defects,
    /// Not written.
    Failed,
}

/// Counts of a mesh, as in `--stats`.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Counts {
    /// Triangles.
    pub faces: usize,
    /// Welded vertices that a face uses.
    pub vertices: usize,
    /// Faces connected over edges with two faces.
    pub components: usize,
    /// Loops of boundary edges.
    pub boundary_loops: usize,
    /// Faces without area.
    pub degenerate_faces: usize,
    /// Second and later faces over the same vertices.
    pub duplicate_faces: usize,
    /// Faces with a NaN or infinite coordinate.
    pub non_finite_faces: usize,
    /// Faces that wind against the majority of their component.
    pub flipped_faces: usize,
    /// Edges with three or more faces.
    pub non_manifold_edges: usize,
}

impl Counts {
    pub(super) fn of(report: &MeshReport) -> Self {
        Counts {
            faces: report.faces,
            vertices: report.vertices,
            components: report.components,
            boundary_loops: report.boundary_loops,
            degenerate_faces: report.degenerate_faces,
            duplicate_faces: report.duplicate_faces,
            non_finite_faces: report.non_finite_faces,
            flipped_faces: report.flipped_faces,
            non_manifold_edges: report.edges.non_manifold,
        }
    }
}

/// One line.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Record {
    /// The input, as the arguments led to it.
    pub(super) input: String,
    /// The output, relative to the log's folder; nothing for what is no file.
    pub(super) output: Option<String>,
    pub(super) status: Status,
    /// Why it failed, or what was repaired or is wrong.
    pub(super) message: Option<String>,
    /// Wall-clock seconds.
    pub(super) seconds: f64,
    pub(super) counts: Option<Counts>,
    /// Stands for all settings and the program's version: equal where those are.
    pub(super) settings: String,
    /// Size of the input, and seconds from 1970 to its last change.
    pub(super) input_bytes: u64,
    pub(super) input_modified: f64,
}

impl Record {
    /// A record of a job, to be completed.
    pub(super) fn of(job: &Job, settings: &str) -> Self {
        Record {
            input: job.input.display().to_string(),
            output: Some(job.output.display().to_string()),
            status: Status::Failed,
            message: None,
            seconds: 0.0,
            counts: None,
            settings: settings.to_owned(),
            input_bytes: job.bytes,
            input_modified: seconds(job.modified),
        }
    }

    /// A record of what is no file.
    pub(super) fn of_failure(failure: &Failure, settings: &str) -> Self {
        let message = format!("{}: {}", failure.input.display(), failure.message);
        let job = Job { input: failure.input.clone(), output: PathBuf::new(), bytes: 0, modified: UNIX_EPOCH };
        Record { output: None, message: Some(message), ..Record::of(&job, settings) }
    }

    /// The record with what became of the job.
    pub(super) fn with(self, done: Done) -> Self {
        let Done { status, message, counts, seconds, .. } = done;
        Record { status, message, counts, seconds, ..self }
    }

    /// True when what the record tells of is what the job would make: from the same input, with the
    /// same settings.
    pub(super) fn is_of(&self, job: &Job, settings: &str) -> bool {
        self.status != Status::Failed
            && self.settings == settings
            && (self.input_bytes, self.input_modified) == (job.bytes, seconds(job.modified))
    }
}

fn seconds(time: SystemTime) -> f64 {
    match time.duration_since(UNIX_EPOCH) {
        Ok(after) => after.as_secs_f64(),
        Err(before) => -before.duration().as_secs_f64(),
    }
}

/// The open log.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: Mutex<File>,
}

impl Journal {
    /// Opens the log of an output folder, and locks it until the program ends. Gives the last record of
    /// each output where `resume` is true; otherwise the log begins anew.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Usage`] while another program writes to the log.
    pub(super) fn open(folder: &Path, resume: bool) -> Result<(Self, HashMap<String, Record>), Error> {
        let path = folder.join(NAME);
        let failed = |e| Error::io(&path, "write", e);
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(&path).map_err(failed)?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                return Err(Error::Usage(format!(
                    "{}: another batch is writing to this folder; wait for it to end",
                    folder.display()
                )));
            }
            // Some network file systems know no locks; then it is the user who must take care.
            Ok(()) | Err(TryLockError::Error(_)) => {}
        }
        let mut records = HashMap::new();
        if resume {
            let mut text = Vec::new();
            file.read_to_end(&mut text).map_err(failed)?;
            for line in text.split(|&byte| byte == b'\n') {
                // A line that was cut short is as good as none.
                if let Ok(record) = serde_json::from_slice::<Record>(line)
                    && let Some(output) = record.output.clone()
                {
                    records.insert(output, record);
                }
            }
            if text.last().is_some_and(|&byte| byte != b'\n') {
                file.write_all(b"\n").map_err(failed)?;
            }
        } else {
            file.set_len(0).and_then(|()| file.seek(SeekFrom::Start(0))).map_err(failed)?;
        }
        Ok((Journal { path, file: Mutex::new(file) }, records))
    }

    /// Adds a line.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub(super) fn write(&self, record: &Record) -> Result<(), Error> {
        let mut line = serde_json::to_vec(record).unwrap_or_default();
        line.push(b'\n');
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(&line).map_err(|e| Error::io(&self.path, "write", e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job(output: &str) -> Job {
        Job { input: "in/a.stl".into(), output: output.into(), bytes: 84, modified: SystemTime::now() }
    }

    #[test]
    fn a_torn_line_costs_one_record_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let done = |name: &str| Record { status: Status::Done, ..Record::of(&job(name), "s") };
        let (journal, _) = Journal::open(folder.path(), false).expect("open");
        ["a.glb", "b.glb", "c.glb"].iter().for_each(|name| journal.write(&done(name)).expect("written"));
        drop(journal);
        let path = folder.path().join(NAME);
        let text = std::fs::read(&path).expect("there");
        std::fs::write(&path, &text[..text.len() - 20]).expect("writable");
        let (journal, records) = Journal::open(folder.path(), true).expect("open");
        assert_eq!(records.len(), 2);
        journal.write(&done("c.glb")).expect("written");
        drop(journal);
        let (_, records) = Journal::open(folder.path(), true).expect("open");
        assert_eq!(records.len(), 3);
        let (_, records) = Journal::open(folder.path(), false).expect("open");
        assert!(records.is_empty() && std::fs::read(&path).expect("there").is_empty());
    }

    #[test]
    fn a_record_is_good_for_the_same_input_and_settings_only() {
        let job = job("a.glb");
        let mut record = Record::of(&job, "s");
        assert!(!record.is_of(&job, "s"), "it failed");
        record.status = Status::Defects;
        assert!(record.is_of(&job, "s") && !record.is_of(&job, "t"));
        let json = serde_json::to_vec(&record).expect("JSON");
        assert!(serde_json::from_slice::<Record>(&json).expect("a record").is_of(&job, "s"));
        assert!(!record.is_of(&Job { bytes: 85, ..job.clone() }, "s"));
        assert!(!record.is_of(&Job { modified: UNIX_EPOCH, ..job }, "s"));
    }

    #[test]
    fn a_folder_has_one_batch_at_a_time() {
        let folder = tempfile::tempdir().expect("a folder");
        let first = Journal::open(folder.path(), true).expect("open");
        let second = Journal::open(folder.path(), true).expect_err("locked");
        assert!(second.to_string().contains("another batch"));
        drop(first);
        Journal::open(folder.path(), true).expect("open");
    }
}
