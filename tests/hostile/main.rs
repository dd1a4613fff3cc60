//! Files made to hurt: reading and building the mesh takes no more than a second and 200 MB, nothing
//! panics up to the last value, and each file ends in a result or in one sentence.

mod shared;
mod table;

use osculate::{AnnotateOptions, Destination, Error, MeshOptions, NoProgress, OutputFormat, annotate, inspect};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Of work. Tests are hardly optimised, which takes two to three times as long.
const LONGEST: Duration = Duration::from_secs(if cfg!(debug_assertions) { 3 } else { 1 });
const MOST_MEGABYTES: u64 = 200;
/// By the clock on the wall, since waiting takes no work.
const LONGEST_WAIT: Duration = Duration::from_secs(30);

/// What the process has worked so far, on all threads: others may be using the machine. `None` where
/// the system does not tell.
fn worked() -> Option<Duration> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // Behind the name, which may hold anything: user and system time are the 12th and 13th, in ticks.
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(Duration::from_millis(10 * ticks))
}

/// The most memory that the process has had since the last call, in MB; `None` where the system
/// does not tell.
fn peak_megabytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    // Five resets the peak.
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes / 1024)
}

/// What the file ends in: a mesh, or an error that names it in one line.
fn ends_well<T>(name: &str, run: impl FnOnce() -> Result<T, Error>) -> bool {
    match catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| panic!("{name} panics")) {
        Ok(_) => true,
        Err(error) => {
            let text = error.to_string();
            assert!(text.len() < 1000 && text.lines().count() == 1, "{name}: no sentence: {text}");
            assert!(text.contains(name), "{name}: {text}");
            false
        }
    }
}

#[test]
fn hostile_files_do_no_harm() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = [table::files(), shared::files()].concat();
    assert!(files.len() >= 120, "the table has {} files", files.len());
    let output = Destination::File(folder.path().join("out.csv"));
    let mut read = 0;
    for (name, bytes) in &files {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("writable");
        peak_megabytes();
        let (before, start) = (worked(), Instant::now());
        ends_well(name, || inspect(&path, &MeshOptions::default(), None, &NoProgress));
        let waited = start.elapsed();
        let took = worked().zip(before).map_or(waited, |(after, before)| after - before);
        assert!(took < LONGEST && waited < LONGEST_WAIT, "{name} takes {took:?} of work in {waited:?}");
        if let Some(peak) = peak_megabytes() {
            assert!(peak < MOST_MEGABYTES, "{name} takes {peak} MB");
        }
        let all = || annotate(&path, &output, OutputFormat::Csv, &AnnotateOptions::default(), &NoProgress);
        read += usize::from(ends_well(name, all));
        std::fs::remove_file(&path).expect("there");
    }
    assert!(read > 10 && read < files.len(), "{read} of {} files give a mesh", files.len());
}
