//! How a long run tells how far it is.

/// The long stages of a run, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stage {
    /// Reading the input, counted in bytes.
    Read,
    /// Estimating curvature, counted in faces.
    Estimate,
    /// Writing the output, counted in bytes.
    Write,
    /// Stepping along principal directions, counted in traces.
    Trace,
    /// Cutting with a plane, counted in faces.
    Cut,
}

impl Stage {
    /// One word.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Read => "read",
            Stage::Estimate => "estimate",
            Stage::Write => "write",
            Stage::Trace => "trace",
            Stage::Cut => "cut",
        }
    }
}

/// Receives progress. Calls may come from any thread, one stage at a time.
pub trait Progress: Sync {
    /// A stage begins; `total` is its amount of work, 0 where it is not known.
    fn begin(&self, stage: Stage, total: u64);
    /// So much more of the stage's work is done; 0 where work goes on that is not counted. Who wants the run to end may
    /// unwind from here, with a payload that is no text, as a panic's would be: no output is then left half written.
    fn advance(&self, amount: u64);
    /// The stage is over.
    fn end(&self);
}

/// Ignores all progress.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn begin(&self, _: Stage, _: u64) {}
    fn advance(&self, _: u64) {}
    fn end(&self) {}
}

/// Passes on that work goes on, so that it can be cancelled, but counts nothing: for work that is part of another
/// stage.
pub(crate) struct Uncounted<'p>(pub(crate) &'p dyn Progress);

impl Progress for Uncounted<'_> {
    fn begin(&self, _: Stage, _: u64) {}
    fn advance(&self, _: u64) {
        self.0.advance(0);
    }
    fn end(&self) {}
}
