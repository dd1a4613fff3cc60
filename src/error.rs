//! The one error type of the crate: where, what is wrong, and what to do.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// A place inside a file, as exact as its format allows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FilePlace {
    /// The file as a whole.
    File,
    /// A line of a text file, counted from 1.
    Line(u64),
    /// A byte offset from the start of the file.
    Byte(u64),
    /// A path in a JSON document, such as `accessors[3].count`.
    Json(String),
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FilePlace::File => Ok(()),
            FilePlace::Line(n) => write!(f, "line {n}: "),
            FilePlace::Byte(n) => write!(f, "byte {n}: "),
            FilePlace::Json(path) => write!(f, "{path}: "),
        }
    }
}

/// What a reader found wrong in a file's content; [`Error::Parse`] adds the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}{what}")]
pub struct ParseError {
    /// Where in the file.
    pub place: FilePlace,
    /// What is wrong and, where there is a remedy, what to do: one sentence without a full stop.
    pub what: String,
}

impl ParseError {
    /// A parse error about the file as a whole.
    pub fn file(what: impl Into<String>) -> Self {
        ParseError { place: FilePlace::File, what: in_one_line(what.into()) }
    }

    /// A parse error on a line, counted from 1.
    pub fn line(line: u64, what: impl Into<String>) -> Self {
        ParseError { place: FilePlace::Line(line), what: in_one_line(what.into()) }
    }

    /// A parse error at a byte offset.
    pub fn byte(offset: u64, what: impl Into<String>) -> Self {
        ParseError { place: FilePlace::Byte(offset), what: in_one_line(what.into()) }
    }

    /// A parse error at a path of a JSON document.
    pub fn json(path: impl Into<String>, what: impl Into<String>) -> Self {
        ParseError { place: FilePlace::Json(in_one_line(path.into())), what: in_one_line(what.into()) }
    }
}

/// A message that quotes a file may hold anything; it is to be read as a sentence.
pub(crate) fn in_one_line(text: String) -> String {
    const MOST: usize = 600;
    if text.len() <= MOST && !text.contains(char::is_control) {
        return text;
    }
    let cut: String = text.chars().map(|c| if c.is_control() { '?' } else { c }).take(MOST).collect();
    if text.chars().nth(MOST).is_some() { cut + "..." } else { cut }
}

/// Everything that can go wrong between an input file and an output file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read or write a file.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file in question.
        path: PathBuf,
        /// What was being done: "read", "write", "create".
        action: &'static str,
        /// The system's own words.
        source: io::Error,
    },
    /// A file's content is not what its format promises.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file in question.
        path: PathBuf,
        /// Place and reason.
        source: ParseError,
    },
    /// The mesh holds nothing that a curvature could be estimated of.
    #[error("{0}")]
    EmptyMesh(String),
    /// The mesh does not fit what the output format can hold.
    #[error("{0}")]
    TooLarge(String),
    /// An output that exists and is to be kept.
    #[error("{} exists; remove it, or allow it to be replaced", .0.display())]
    Exists(PathBuf),
    /// An option that contradicts the input, the output or another option.
    #[error("{0}")]
    Usage(String),
}

impl Error {
    /// Wraps an I/O error with the file and what was being done to it.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Error::Io { path: path.to_path_buf(), action, source }
    }

    /// Names the file in which `source` was found.
    pub fn parse(path: &Path, source: ParseError) -> Self {
        Error::Parse { path: path.to_path_buf(), source }
    }

    /// Names the file that an error without one is about.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Error::EmptyMesh(what) => Error::EmptyMesh(format!("{}: {what}", path.display())),
            Error::Usage(what) => Error::Usage(format!("{}: {what}", path.display())),
            other => other,
        }
    }

    /// True when the command line is to blame rather than a file (exit code 2).
    pub fn is_usage(&self) -> bool {
        matches!(self, Error::Usage(_))
    }

    /// True when the reader of an output pipe went away, which is no failure.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Error::Io { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_stay_on_one_line_whatever_a_file_holds() {
        for error in [
            ParseError::file("a\nb\r\u{1b}c"),
            ParseError::line(1, "a\nb"),
            ParseError::byte(1, "a\nb"),
            ParseError::json("a\nb", "c\u{85}d"),
            ParseError::file("\u{1f600}".repeat(10_000)),
        ] {
            let text = error.to_string();
            assert!(!text.contains(char::is_control) && text.chars().count() < 700, "{text}");
        }
        assert_eq!(in_one_line("as it is".into()), "as it is");
        assert_eq!(in_one_line("x".repeat(600)).len(), 600);
        assert!(in_one_line("x".repeat(601)).ends_with("x..."));
    }
}
