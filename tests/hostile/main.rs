//! Files made to hurt: none may panic, run for more than a second or take more than 200 MB, and each
//! ends in a result or in one sentence.

mod table;

use osculate::{AnnotateOptions, Destination, NoProgress, OutputFormat, annotate};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

const LONGEST: Duration = Duration::from_secs(1);
const MOST_MEGABYTES: u64 = 200;

/// The most memory that the process has had since the last call, in MB; `None` where the system
/// does not tell.
fn peak_megabytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    // Five resets the peak.
    std::fs::write("/proc/self/clear_refs", "5").ok()?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kilobytes| kilobytes / 1024)
}

#[test]
fn hostile_files_do_no_harm() {
    let folder = tempfile::tempdir().expect("a folder");
    let files = table::files();
    assert!(files.len() >= 120, "the table has {} files", files.len());
    let mut read = 0;
    for (name, bytes) in &files {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("writable");
        let output = Destination::File(folder.path().join("out.csv"));
        let options = AnnotateOptions::default();
        let run = || annotate(&path, &output, OutputFormat::Csv, &options, &NoProgress);
        peak_megabytes();
        // Others may be using the machine: the best of three counts.
        let mut shortest = Duration::MAX;
        for _ in 0..3 {
            let start = Instant::now();
            let result = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| panic!("{name} panics"));
            shortest = shortest.min(start.elapsed());
            match result {
                Ok(_) => read += 1,
                Err(error) => {
                    let text = error.to_string();
                    assert!(text.len() < 1000 && text.lines().count() == 1, "{name}: no sentence: {text}");
                    assert!(text.contains(name.as_str()), "{name}: {text}");
                }
            }
            if shortest < LONGEST {
                break;
            }
        }
        assert!(shortest < LONGEST, "{name} takes {shortest:?}");
        if let Some(peak) = peak_megabytes() {
            assert!(peak < MOST_MEGABYTES, "{name} takes {peak} MB");
        }
        std::fs::remove_file(&path).expect("there");
    }
    assert!(read > 10 && read < files.len(), "{read} of {} files give a mesh", files.len());
}
