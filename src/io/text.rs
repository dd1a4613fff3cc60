//! Lines and numbers of text formats, as bytes: names in old files are in any encoding.

use crate::soup::short_name;
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
        let end = memchr::memchr2(b'\n', b'\r', self.rest).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => &[],
        };
        Some((self.number, line))
    }
}

/// A line without what stands behind a `#`, which is no comment in `1.#INF`.
pub(super) fn without_comment(line: &[u8]) -> &[u8] {
    let is_comment =
        |&at: &usize| !(line[..at].ends_with(b".") && line[at + 1..].first().is_some_and(u8::is_ascii_uppercase));
    &line[..memchr::memchr_iter(b'#', line).find(is_comment).unwrap_or(line.len())]
}

/// The words of a line.
pub(super) fn words(line: &[u8]) -> Words<'_> {
    Words { rest: line }
}

/// Words with white space between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'b> {
    rest: &'b [u8],
}

impl<'b> Words<'b> {
    /// Bytes not yet looked at.
    pub(super) fn rest(&self) -> &'b [u8] {
        self.rest
    }

    #[inline]
    fn skip_space(&mut self) {
        while let [first, rest @ ..] = self.rest
            && first.is_ascii_whitespace()
        {
            self.rest = rest;
        }
    }

    /// The next word as a decimal number, as [`number`] reads it, in one go.
    #[inline]
    pub(super) fn number(&mut self) -> Option<f64> {
        self.skip_space();
        let word = self.rest.strip_prefix(b"+").unwrap_or(self.rest);
        let (value, length) = fast_float2::parse_partial(word).ok()?;
        self.rest = &word[length..];
        match self.rest.first() {
            Some(b'#' | b'(') => self.not_a_number(value),
            next => next.is_none_or(u8::is_ascii_whitespace).then_some(value),
        }
    }

    /// What Microsoft's libraries write for numbers that are none: `1.#QNAN`, `-1.#IND`, `1.#INF`, `-nan(ind)`.
    #[cold]
    fn not_a_number(&mut self, before: f64) -> Option<f64> {
        match self.next()? {
            [b'(', ..] => before.is_nan().then_some(before),
            [b'#', b'I', b'N', b'F', ..] => Some(before * f64::INFINITY),
            [b'#', b'I' | b'Q' | b'S', ..] => Some(f64::NAN),
            _ => None,
        }
    }
}

impl<'b> Iterator for Words<'b> {
    type Item = &'b [u8];

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.skip_space();
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }
}

/// A whole number with or without a sign.
#[inline]
pub(super) fn integer(word: &[u8]) -> Option<i64> {
    let (digits, sign) = match word {
        [b'-', digits @ ..] => (digits, -1),
        [b'+', digits @ ..] | digits => (digits, 1),
    };
    let add = |sum: i64, &digit: &u8| {
        let digit = digit.wrapping_sub(b'0');
        (digit < 10).then(|| 10 * sum + i64::from(digit))
    };
    // Eighteen digits cannot overflow, and no file has as many vertices.
    (1..=18).contains(&digits.len()).then(|| digits.iter().try_fold(0, add)).flatten().map(|sum| sign * sum)
}

/// A decimal number; also `nan` and `inf`, which files do contain.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    fast_float2::parse(word.strip_prefix(b"+").unwrap_or(word)).ok()
}

/// A whole number from 0, as vertices and counts are numbered.
pub(super) fn count(word: &[u8]) -> Option<u32> {
    u32::try_from(integer(word)?).ok()
}

/// Says that a vertex lacks its three numbers.
pub(super) fn no_vertex(line: &[u8]) -> String {
    let why = if line.contains(&b',') { "; decimals stand behind a point, not a comma" } else { "" };
    format!("a vertex has three numbers, not {}{why}", quoted(line.trim_ascii()))
}

/// A word or line for use in a message: readable, and short whatever the file holds.
pub(super) fn quoted(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let text: String = text.chars().map(|c| if c.is_control() { '?' } else { c }).collect();
    format!("\"{text}{}\"", if bytes.len() > MOST { "..." } else { "" })
}

/// A name as text, whatever its encoding, as far as names are kept.
pub(super) fn name(bytes: &[u8]) -> String {
    let bytes = bytes.trim_ascii();
    // Decoding is left with enough to find the end of a character.
    let name: Cow<'_, str> = String::from_utf8_lossy(&bytes[..bytes.len().min(260)]);
    short_name(&name).to_owned()
}

/// The text of a file in UTF-16 with a byte order mark.
///
/// Its first characters must be ASCII: two bytes alone may begin any binary file.
pub(super) fn from_utf16(bytes: &[u8]) -> Option<String> {
    let (mark, rest) = bytes.split_first_chunk()?;
    let unit: fn([u8; 2]) -> u16 = match mark {
        [0xff, 0xfe] => u16::from_le_bytes,
        [0xfe, 0xff] => u16::from_be_bytes,
        _ => return None,
    };
    let (pairs, _) = rest.as_chunks();
    if pairs.is_empty() || pairs.iter().take(4).any(|&pair| !(1..0x80).contains(&unit(pair))) {
        return None;
    }
    let decoded = char::decode_utf16(pairs.iter().map(|&pair| unit(pair)));
    Some(decoded.map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect())
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
    fn comments_begin_with_a_hash_that_is_no_number() {
        for (line, without) in [("a # b", "a "), ("1.# b", "1."), ("-1.#IND 2 # 1.#INF", "-1.#IND 2 "), ("#", "")] {
            assert_eq!(without_comment(line.as_bytes()), without.as_bytes(), "{line}");
        }
    }

    #[test]
    fn utf_16_is_told_by_its_mark_and_its_first_letters() {
        let text = "v 1 2 3 # größe \u{1f600}\n";
        let little: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect();
        assert_eq!(from_utf16(&little).as_deref(), Some(text));
        assert_eq!(from_utf16(&big).as_deref(), Some(text));
        for other in [&b"\xff\xfe"[..], b"\xff\xfe\x00\x01v", b"\xff", text.as_bytes()] {
            assert_eq!(from_utf16(other), None);
        }
    }

    #[test]
    fn numbers_come_in_many_spellings() {
        for (word, value) in [("1e+5", 1e5), (".5", 0.5), ("-.5E-3", -5e-4), ("+2", 2.0), ("3.", 3.0)] {
            assert_eq!(number(word.as_bytes()), Some(value), "{word}");
            let mut words = words(word.as_bytes());
            assert_eq!((words.number(), words.number()), (Some(value), None), "{word}");
        }
        assert!(number(b"nan").is_some_and(f64::is_nan));
        for word in ["nan(ind)", "-nan(snan)", "1.#QNAN", "-1.#IND00", "1.#SNAN"] {
            let mut words = words(word.as_bytes());
            assert!(words.number().is_some_and(f64::is_nan) && words.rest().is_empty(), "{word}");
        }
        assert_eq!(words(b"-1.#INF 2").number(), Some(f64::NEG_INFINITY));
        assert!(words(b"1(2)").number().is_none() && words(b"1.#x").number().is_none());
        assert_eq!(number(b"1,5"), None);
        assert_eq!(number(b"0x1"), None);
        assert_eq!(words(b" 1.5 2,5").by_ref().number(), Some(1.5));
        assert!(words(b"2,5 1").number().is_none() && words(b" ").number().is_none());
        for (word, value) in
            [("12", Some(12)), ("-3", Some(-3)), ("+4", Some(4)), ("", None), ("-", None), ("1a", None)]
        {
            assert_eq!(integer(word.as_bytes()), value, "{word}");
        }
        assert_eq!((integer(b"9999999999999999999"), count(b"-1"), count(b"4294967296")), (None, None, None));
    }
}
