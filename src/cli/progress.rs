//! Progress bars, one per long stage, on a terminal only.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use osculate::{Progress, Stage};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::Duration;

/// Draws the current stage on standard error.
pub(super) struct Bars {
    visible: bool,
    current: Mutex<ProgressBar>,
}

impl Bars {
    /// Bars that show where `wanted` and standard error is a terminal.
    pub(super) fn new(wanted: bool) -> Self {
        Bars { visible: wanted && std::io::stderr().is_terminal(), current: Mutex::new(ProgressBar::hidden()) }
    }

    fn with(&self, action: impl FnOnce(&mut ProgressBar)) {
        if self.visible
            && let Ok(mut bar) = self.current.lock()
        {
            action(&mut bar);
        }
    }
}

impl Progress for Bars {
    fn begin(&self, stage: Stage, total: u64) {
        let (verb, counter) = match stage {
            Stage::Read => ("reading", "{bytes}/{total_bytes}"),
            Stage::Estimate => ("estimating", "{human_pos}/{human_len} faces"),
            Stage::Write => ("writing", "{bytes}/{total_bytes}"),
            Stage::Trace => ("tracing", "{human_pos}/{human_len} traces"),
            Stage::Cut => ("cutting", "{human_pos}/{human_len} faces"),
        };
        let template = format!("{{msg:>10}} [{{bar:40}}] {counter} {{eta}}");
        self.with(|bar| {
            *bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr_with_hz(10));
            bar.set_style(ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar.set_message(verb);
            bar.enable_steady_tick(Duration::from_millis(100));
        });
    }

    fn advance(&self, amount: u64) {
        self.with(|bar| bar.inc(amount));
    }

    fn end(&self) {
        self.with(|bar| bar.finish_and_clear());
    }
}
