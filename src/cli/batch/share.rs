//! Threads shared between files and faces.

use super::inputs::Job;
use osculate::Error;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Inputs above this many bytes get all threads, one after another: a few million faces at a time are
/// then in memory, however many threads there are. Below it a thread for each file is faster, since
/// some stages of a file are not parallel.
const LARGE: u64 = 16 << 20;

/// Calls `work` once for each job until it gives false: first for the large files, each with all the
/// threads of the current rayon pool, then for the others, each with one thread; also the others get all
/// threads where there are fewer of them than threads.
///
/// # Errors
/// [`Error::Usage`] where the system gives no threads.
pub(super) fn over(jobs: &[Job], work: impl Fn(&Job) -> bool + Sync) -> Result<(), Error> {
    let threads = rayon::current_num_threads();
    let (mut large, mut small): (Vec<&Job>, Vec<&Job>) = jobs.iter().partition(|job| job.bytes > LARGE);
    if small.len() < threads {
        large.append(&mut small);
    }
    if !large.into_iter().all(&work) {
        return Ok(());
    }
    // The largest first, so that no thread begins a long one when the others are done.
    small.sort_by_key(|job| std::cmp::Reverse(job.bytes));
    let pools = (0..threads.min(small.len()))
        .map(|_| rayon::ThreadPoolBuilder::new().num_threads(1).build())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|e| Error::Usage(format!("cannot start the threads: {e}; try a smaller -j")))?;
    let next = AtomicUsize::new(0);
    let take = || small.get(next.fetch_add(1, Ordering::Relaxed));
    std::thread::scope(|scope| {
        for pool in &pools {
            scope.spawn(|| {
                pool.install(|| {
                    while let Some(job) = take() {
                        if !work(job) {
                            next.store(small.len(), Ordering::Relaxed);
                        }
                    }
                });
            });
        }
    });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::sync::Mutex;
    use std::time::UNIX_EPOCH;

    fn jobs(sizes: &[u64]) -> Vec<Job> {
        let job = |(i, &bytes): (usize, &u64)| {
            let name = i.to_string();
            Job { input: name.clone().into(), output: name.into(), bytes, modified: UNIX_EPOCH }
        };
        sizes.iter().enumerate().map(job).collect()
    }

    #[test]
    fn large_files_get_all_threads_and_small_ones_one_each() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().expect("threads");
        let seen = |sizes: &[u64]| {
            let seen = Mutex::new(BTreeMap::new());
            let note = |job: &Job| {
                let before = seen.lock().expect("unpoisoned").insert(job.output.clone(), rayon::current_num_threads());
                assert!(before.is_none(), "once each");
                true
            };
            pool.install(|| over(&jobs(sizes), note)).expect("threads");
            seen.into_inner().expect("unpoisoned").into_values().collect::<Vec<_>>()
        };
        assert_eq!(seen(&[1, LARGE + 1, 2, 3, LARGE]), [1, 3, 1, 1, 1]);
        assert_eq!(seen(&[1, LARGE + 1, 2]), [3, 3, 3]);
        assert_eq!(seen(&[]), [0; 0]);
    }

    #[test]
    fn work_that_gives_up_stops_the_rest() {
        let done = AtomicUsize::new(0);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
        let work = |_: &Job| done.fetch_add(1, Ordering::Relaxed) < 4;
        pool.install(|| over(&jobs(&[1; 100]), work)).expect("threads");
        assert_eq!(done.into_inner(), 5);
    }
}
