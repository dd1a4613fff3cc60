//! One progress bar over all files, on a terminal only.

use crate::cli::messages::Messages;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Draws how many files are left on standard error.
pub(super) struct FilesBar {
    bar: ProgressBar,
}

impl FilesBar {
    pub(super) fn new(files: usize, messages: &Messages) -> Self {
        let bar = if messages.wants_progress() && std::io::stderr().is_terminal() {
            ProgressBar::with_draw_target(Some(files as u64), ProgressDrawTarget::stderr_with_hz(10))
        } else {
            ProgressBar::hidden()
        };
        let template = "[{bar:40}] {pos} of {len} files, {msg} left, {eta}";
        bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(files.to_string());
        if !bar.is_hidden() {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        FilesBar { bar }
    }

    /// One more file is done.
    pub(super) fn advance(&self) {
        self.bar.inc(1);
        let left = self.bar.length().unwrap_or(0).saturating_sub(self.bar.position());
        self.bar.set_message(left.to_string());
    }

    /// Says something without the bar in the way.
    pub(super) fn aside(&self, say: impl FnOnce()) {
        self.bar.suspend(say);
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
