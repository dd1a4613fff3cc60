//! What the program says besides its results: on standard error, for people or for machines.

use super::args::CommonArgs;
use super::choices::LogFormat;
use osculate::{Error, Note};
use serde_json::json;
use std::io::Write;

/// Says things, or keeps quiet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Messages {
    format: LogFormat,
    quiet: bool,
    pub(super) verbose: bool,
}

impl Messages {
    pub(super) fn new(common: Option<&CommonArgs>) -> Self {
        Messages {
            format: common.map_or(LogFormat::Text, |c| c.log),
            quiet: common.is_some_and(|c| c.quiet),
            verbose: common.is_some_and(|c| c.verbose),
        }
    }

    /// True when progress bars have a place.
    pub(super) fn wants_progress(&self) -> bool {
        !self.quiet && self.format == LogFormat::Text
    }

    /// Why the run failed; said also when quiet.
    pub(super) fn error(&self, error: &Error) {
        self.failure(&error.to_string());
    }

    /// Why a file failed; said also when quiet.
    pub(super) fn failure(&self, message: &str) {
        self.say("error", message);
    }

    /// Something in the input that was repaired or is wrong.
    pub(super) fn warning(&self, message: &str) {
        if !self.quiet {
            self.say("warning", message);
        }
    }

    /// What the reader noted.
    pub(super) fn note(&self, note: &Note) {
        if note.repaired {
            self.warning(&note.message);
        } else if !self.quiet {
            self.say("note", &note.message);
        }
    }

    /// What was done.
    pub(super) fn info(&self, message: &str) {
        if !self.quiet {
            self.say("info", message);
        }
    }

    fn say(&self, level: &str, message: &str) {
        let line = match self.format {
            LogFormat::Json => json!({ "level": level, "message": message }).to_string(),
            LogFormat::Text if level == "info" => message.to_owned(),
            LogFormat::Text => format!("osculate: {level}: {message}"),
        };
        // With standard error gone there is no one left to tell.
        let _ = writeln!(std::io::stderr(), "{line}");
    }
}
