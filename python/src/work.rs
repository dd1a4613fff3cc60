//! Long work: without the interpreter's lock, on threads of its own, with progress, interrupts and cancelling.
//!
//! The work runs in a pool that is made for it: a pool that outlived the call would have no threads left in a forked
//! process. The calling thread waits and looks up every now and then: there, and nowhere else, signals are handled
//! and the callback is called. A cancel travels as an unwinding from wherever the work next tells its progress; the
//! pool carries it to the caller, and outputs that are being written vanish on the way.

use crate::errors;
use osculate::{Error, Progress, Stage};
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How often the calling thread looks up.
const TICK: Duration = Duration::from_millis(50);

/// Does `work` on so many threads, or one per core. `progress` is called with the name of the stage, how much of it
/// is done and how much there is; an exception it raises ends the work and is what the caller gets.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    progress: Option<&Py<PyAny>>,
    work: impl FnOnce(&dyn Progress) -> Result<T, Error> + Send,
) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    let pool = pool.map_err(|e| errors::raise(py, &Error::Usage(format!("cannot start the threads: {e}"))))?;
    let watch = Watch::default();
    let outcome = py.detach(|| {
        pool.in_place_scope(|scope| {
            let (sender, receiver) = sync_channel(1);
            let watch = &watch;
            scope.spawn(move |_| {
                // The receiver waits until this has come.
                let _ = sender.send(catch_unwind(AssertUnwindSafe(|| work(watch))));
            });
            let mut told = Told::default();
            let mut stop: Option<PyErr> = None;
            loop {
                let result = match receiver.recv_timeout(TICK) {
                    Ok(result) => Some(result),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => {
                        Some(Err(Box::new("the work is lost") as Box<dyn Any + Send>))
                    }
                };
                if stop.is_none() {
                    let looked = Python::attach(|py| {
                        py.check_signals()?;
                        // Of work that has failed, the error is what is told.
                        let goes_well = matches!(result, None | Some(Ok(Ok(_))));
                        progress.filter(|_| goes_well).map_or(Ok(()), |callback| told.tell(py, watch, callback))
                    });
                    if let Err(error) = looked {
                        stop = Some(error);
                        watch.cancelled.store(true, Ordering::Relaxed);
                    }
                }
                if let Some(result) = result {
                    return stop.map_or(Ok(result), Err);
                }
            }
        })
    })?;
    match outcome {
        Ok(result) => result.map_err(|error| errors::raise(py, &error)),
        Err(panic) => Err(errors::bug(py, words_of(panic.as_ref()))),
    }
}

fn words_of(panic: &(dyn Any + Send)) -> &str {
    panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied()).unwrap_or_default()
}

/// What unwinds when work is cancelled.
struct Cancelled;

/// How far a stage is.
#[derive(Clone, Copy)]
struct Reached {
    stage: Stage,
    done: u64,
    total: u64,
    over: bool,
}

/// Progress as the work tells it.
#[derive(Default)]
struct Watch {
    stages: Mutex<Vec<Reached>>,
    /// How much of the last stage is done.
    done: AtomicU64,
    cancelled: AtomicBool,
}

impl Watch {
    fn stages(&self) -> MutexGuard<'_, Vec<Reached>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn stop_if_cancelled(&self) {
        if self.cancelled.load(Ordering::Relaxed) {
            resume_unwind(Box::new(Cancelled));
        }
    }
}

impl Progress for Watch {
    fn begin(&self, stage: Stage, total: u64) {
        self.stop_if_cancelled();
        let mut stages = self.stages();
        self.done.store(0, Ordering::Relaxed);
        stages.push(Reached { stage, done: 0, total, over: false });
    }

    fn advance(&self, amount: u64) {
        self.done.fetch_add(amount, Ordering::Relaxed);
        self.stop_if_cancelled();
    }

    fn end(&self) {
        if let Some(last) = self.stages().last_mut() {
            last.total = last.total.max(self.done.load(Ordering::Relaxed));
            last.done = last.total;
            last.over = true;
        }
    }
}

/// What the callback has been told.
#[derive(Default)]
struct Told {
    /// Stages it has been told the end of.
    stages: usize,
    /// What it has been told of the stage after those.
    done: Option<u64>,
}

impl Told {
    /// Calls the callback with all news.
    fn tell(&mut self, py: Python<'_>, watch: &Watch, callback: &Py<PyAny>) -> PyResult<()> {
        let news: Vec<Reached> = watch.stages().iter().skip(self.stages).copied().collect();
        for mut reached in news {
            if !reached.over {
                // The writing of files may come to more than was expected.
                reached.done = watch.done.load(Ordering::Relaxed).min(reached.total);
            }
            if self.done != Some(reached.done) {
                self.done = Some(reached.done);
                callback.call1(py, (reached.stage.name(), reached.done, reached.total))?;
            }
            if reached.over {
                self.stages += 1;
                self.done = None;
            }
        }
        Ok(())
    }
}
