//! Lines and numbers of text formats, as bytes: names in old files are in any encoding.

use std::borrow::Cow;

/// Lines with their numbers, counted from 1; ends of line are LF, CR LF or CR.
#[derive(Clone, Debug)]
pub(super) struct Lines<'b> {
    rest: &'b [u8],
    number: u64,
}

impl<'b> Lines<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Lines { rest: bytes, number: 0 }
    }

    /// What follows the lines read so far.
    pub(super) fn rest(&self) -> &'b [u8] {
        self.rest
    }
}

impl<'b> Iterator for Lines<'b> {
    type Item = (u64, &'b [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => &[],
        };
        Some((self.number, line))
    }
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A decimal number; also `nan` and `inf`, which files do contain.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    fast_float2::parse(word.strip_prefix(b"+").unwrap_or(word)).ok()
}

/// A word or line for use in a message: readable, and short whatever the file holds.
pub(super) fn quoted(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let text: String = text.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    format!("\"{text}{}\"", if bytes.len() > MOST { "..." } else { "" })
}

/// A name as text, whatever its encoding.
pub(super) fn name(bytes: &[u8]) -> String {
    let name: Cow<'_, str> = String::from_utf8_lossy(bytes.trim_ascii());
    name.into_owned()
}

/// True when the first bytes look like text: no control characters but white space.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(1024)];
    !start.iter().any(|&b| b < 0x20 && !b.is_ascii_whitespace() && b != 0x0b && b != 0x1a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_any_of_three_ways() {
        let lines: Vec<_> = Lines::new(b"a\nb\r\nc\rd\n\ne").collect();
        let expected: [(u64, &[u8]); 6] = [(1, b"a"), (2, b"b"), (3, b"c"), (4, b"d"), (5, b""), (6, b"e")];
        assert_eq!(lines, expected);
    }

    #[test]
    fn numbers_come_in_many_spellings() {
        for (word, value) in [("1e+5", 1e5), (".5", 0.5), ("-.5E-3", -5e-4), ("+2", 2.0), ("3.", 3.0)] {
            assert_eq!(number(word.as_bytes()), Some(value), "{word}");
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
        assert_eq!(number(b"1,5"), None);
        assert_eq!(number(b"0x1"), None);
    }
}
