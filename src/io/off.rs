//! Object File Format (Geomview's OFF), ASCII and binary.
//!
//! The keyword tells what each vertex has besides its position: `ST` a texture coordinate, `C` a
//! colour, `N` a normal, `4` a fourth coordinate. None of that is needed but the fourth coordinate,
//! by which the others are divided.

use super::polygons::Polygons;
use super::text::{self, Lines};
use crate::error::ParseError;
use crate::soup::{Positions, Soup};

/// What the keyword in front of the counts says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Kind {
    texture: bool,
    color: bool,
    normal: bool,
    homogeneous: bool,
    dimension_follows: bool,
}

impl Kind {
    fn of(keyword: &[u8]) -> Option<Self> {
        // The specification has them in this order, MeshLab writes NCOFF.
        let mut kind = Kind::default();
        let mut rest = keyword;
        while rest != b"OFF" {
            let (flag, tail) = match rest {
                [b'S', b'T', tail @ ..] => (&mut kind.texture, tail),
                [b'C', tail @ ..] => (&mut kind.color, tail),
                [b'N', tail @ ..] => (&mut kind.normal, tail),
                [b'4', tail @ ..] => (&mut kind.homogeneous, tail),
                [b'n', tail @ ..] => (&mut kind.dimension_follows, tail),
                _ => return None,
            };
            *flag = true;
            rest = tail;
        }
        Some(kind)
    }

    /// The kind that a word begins with, and what of it is behind: thousands of files of ModelNet have the
    /// first count there, without a space.
    fn at_start_of(word: &[u8]) -> Option<(Self, &[u8])> {
        let end = word.windows(3).position(|three| three == b"OFF")? + 3;
        let (keyword, count) = word.split_at(end);
        Kind::of(keyword).filter(|_| count.iter().all(u8::is_ascii_digit)).map(|kind| (kind, count))
    }

    /// Numbers of a position.
    fn coordinates(self) -> usize {
        if self.homogeneous { 4 } else { 3 }
    }

    /// Numbers of a vertex in a binary file.
    fn numbers(self) -> usize {
        self.coordinates() + 3 * usize::from(self.normal) + 4 * usize::from(self.color) + 2 * usize::from(self.texture)
    }

    fn position(self, numbers: [f64; 4]) -> [f64; 3] {
        let [x, y, z, w] = numbers;
        if self.homogeneous { [x / w, y / w, z / w] } else { [x, y, z] }
    }
}

/// True when the first word is one of OFF's keywords.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let mut lines = Lines::new(bytes).take(1000).map(|(_, line)| text::without_comment(line));
    lines.find_map(|line| text::words(line).next()).is_some_and(|word| Kind::at_start_of(word).is_some())
}

pub(super) fn read(bytes: &[u8]) -> Result<Soup, ParseError> {
    let mut lines = Lines::new(bytes);
    let mut kind = Kind::default();
    let mut words: Vec<(u64, &[u8])> = Vec::new();
    // The keyword, which old files leave out, and the three counts, on one line or several.
    let mut needed = 3;
    while words.len() < needed {
        let Some((line, content)) = lines.next() else {
            return Err(ParseError::file("the file ends before its counts of vertices, faces and edges"));
        };
        let mut rest = text::words(text::without_comment(content)).peekable();
        let before = words.len();
        if let Some((found, count)) = rest.peek().and_then(|word| Kind::at_start_of(word)).filter(|_| before == 0) {
            kind = found;
            rest.next();
            words.extend((!count.is_empty()).then_some((line, count)));
            if rest.peek().is_some_and(|word| *word == b"BINARY") {
                return Binary { bytes, at: bytes.len() - lines.rest().len() }.read(kind);
            }
            needed = if kind.dimension_follows { 4 } else { 3 };
        }
        words.extend(rest.map(|word| (line, word)));
        // Some writers leave out the number of edges, which nobody needs.
        if words.len() + 1 == needed && words.len() - before >= 2 {
            break;
        }
    }
    let count = |at: usize| -> Result<usize, ParseError> {
        let &(line, word) = words.get(at).ok_or_else(|| ParseError::file("the file has no counts"))?;
        text::count(word)
            .map(|count| count as usize)
            .ok_or_else(|| ParseError::line(line, format!("{} is no count of vertices or faces", text::quoted(word))))
    };
    let first = usize::from(kind.dimension_follows);
    if kind.dimension_follows && count(0)? != 3 {
        return Err(ParseError::line(words[0].0, "only meshes in three dimensions can be read"));
    }
    let (vertices, faces) = (count(first)?, count(first + 1)?);
    let header = words.last().map_or(0, |(line, _)| *line);
    read_ascii(kind, vertices, faces, header, lines)
}

fn read_ascii(kind: Kind, vertices: usize, faces: usize, header: u64, lines: Lines<'_>) -> Result<Soup, ParseError> {
    // A vertex takes three digits, two spaces and an end of line; no more is believed of the count.
    let mut positions = Vec::with_capacity(vertices.min(lines.rest().len() / 6 + 1));
    let mut polygons = Polygons::default();
    let (mut left, mut last) = (faces, header);
    for (line, content) in lines {
        last = line;
        let content = text::without_comment(content);
        let mut words = text::words(content);
        if content.trim_ascii().is_empty() {
            continue;
        }
        if positions.len() < vertices {
            let mut numbers = [1.0; 4];
            for number in &mut numbers[..kind.coordinates()] {
                *number = words.number().ok_or_else(|| ParseError::line(line, text::no_vertex(content)))?;
            }
            positions.push(kind.position(numbers));
        } else if left > 0 {
            let corners = words.next().and_then(text::count).ok_or_else(|| {
                ParseError::line(line, format!("{} does not begin with a number of corners", text::quoted(content)))
            })?;
            for _ in 0..corners {
                let word = words.next().ok_or_else(|| {
                    ParseError::line(
                        line,
                        format!("a face of {corners} corners has fewer in {}", text::quoted(content)),
                    )
                })?;
                polygons
                    .corner(text::count(word).ok_or_else(|| {
                        ParseError::line(line, format!("{} is no vertex number", text::quoted(word)))
                    })?);
            }
            polygons.end_face();
            left -= 1;
        } else {
            // What stands behind the last face is nobody's business: edges, or a program's remarks.
            break;
        }
    }
    if positions.len() < vertices || left > 0 {
        return Err(ParseError::line(
            last,
            format!(
                "the file ends after {} of {vertices} vertices and {} of {faces} faces; it is truncated or its counts are wrong",
                positions.len(),
                faces - left
            ),
        ));
    }
    polygons.into_soup(Positions::F64(positions))
}

/// The binary form: 32-bit big-endian numbers behind the line of the keyword.
struct Binary<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl Binary<'_> {
    fn word(&mut self) -> Result<[u8; 4], ParseError> {
        let word = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk());
        let word = *word.ok_or_else(|| ParseError::byte(self.at as u64, "the file ends before its last value"))?;
        self.at += 4;
        Ok(word)
    }

    fn float(&mut self) -> Result<f32, ParseError> {
        self.word().map(f32::from_be_bytes)
    }

    /// A number of things of at least so many bytes each, which must fit into the file.
    fn count(&mut self, least: usize) -> Result<usize, ParseError> {
        let at = self.at as u64;
        let count = u32::from_be_bytes(self.word()?) as usize;
        if count.saturating_mul(least) > self.bytes.len() - self.at {
            let what = format!("the file promises {count} values or more, but ends before; it is truncated");
            return Err(ParseError::byte(at, what));
        }
        Ok(count)
    }

    fn read(mut self, kind: Kind) -> Result<Soup, ParseError> {
        if kind.dimension_follows && self.count(0)? != 3 {
            return Err(ParseError::byte(self.at as u64, "only meshes in three dimensions can be read"));
        }
        let vertices = self.count(4 * kind.numbers())?;
        let faces = self.count(8)?;
        self.word()?;
        let mut positions = Vec::with_capacity(vertices);
        for _ in 0..vertices {
            let mut numbers = [1.0; 4];
            for number in &mut numbers[..kind.coordinates()] {
                *number = self.float()?.into();
            }
            self.at += 4 * (kind.numbers() - kind.coordinates());
            positions.push(kind.position(numbers).map(|c| c as f32));
        }
        let mut polygons = Polygons::default();
        for _ in 0..faces {
            for _ in 0..self.count(4)? {
                polygons.corner(u32::from_be_bytes(self.word()?));
            }
            polygons.end_face();
            self.at += 4 * self.count(4)?;
        }
        polygons.into_soup(Positions::F32(positions))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BODY: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n";

    fn triangles(text: &str) -> Vec<[u32; 3]> {
        read(text.as_bytes()).unwrap_or_else(|e| panic!("{text}: {e}")).triangles
    }

    #[test]
    fn headers_are_written_in_many_ways() {
        for text in [
            format!("OFF\n4 2 0\n{BODY}"),
            format!("OFF 4 2 0\n{BODY}"),
            format!("4 2 0\n{BODY}"),
            format!("OFF4 2 0\n{BODY}"),
            format!("nOFF3\n4 2 0\n{BODY}"),
            format!("OFF\n4 2\n{BODY}"),
            format!("# made by hand\n\nOFF # comment\n\n# more\n4\n2\n0\n{BODY}"),
            format!("nOFF\n3\n4 2 0\n{BODY}"),
            format!("OFF\n4 2 0\n{BODY}\nleft behind"),
            format!("OFF\r\n4 2 0\r\n{}", BODY.replace('\n', "\r\n")),
            format!(
                "OFF\n4 2 0\n{}",
                BODY.replace("0 1 2 3", "0 1 2 3 255 0 0 # red").replace("3 0 1 2\n", "3 0 1 2 0.5 0.5 0.5")
            ),
            format!("COFF\n4 2 0\n{}", BODY.replace(" 0\n1", " 0 255 0 0 255\n1")),
            "STCN4OFF\n4 2 0\n0 0 0 1\n2 0 0 2 9 9\n1 1 0 1\n0 1 0 1\n4 0 1 2 3\n3 0 1 2\n".to_owned(),
        ] {
            assert_eq!(triangles(&text), [[0, 1, 2], [0, 2, 3], [0, 1, 2]], "{text}");
            assert_eq!(read(text.as_bytes()).expect("readable").positions.get(1).to_array(), [1.0, 0.0, 0.0]);
        }
        for (text, is) in [("OFF 1", true), ("#x\nNCOFF\n", true), ("OFFICE", false), ("off", false), ("", false)] {
            assert_eq!(looks_like(text.as_bytes()), is, "{text}");
        }
    }

    fn binary(keyword: &str, extra: usize) -> Vec<u8> {
        let mut bytes = format!("{keyword} BINARY\n").into_bytes();
        let mut put = |values: &[u32]| bytes.extend(values.iter().flat_map(|v| v.to_be_bytes()));
        put(&[4, 2, 0]);
        for [x, y, z] in [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] {
            put(&[x.to_bits(), y.to_bits(), z.to_bits()]);
            put(&vec![7; extra]);
        }
        put(&[4, 0, 1, 2, 3, 0]);
        put(&[3, 0, 1, 2, 4, 0, 0, 0, 0]);
        bytes
    }

    #[test]
    fn binary_says_the_same() {
        for (keyword, extra) in [("OFF", 0), ("COFF", 4), ("STCNOFF", 9)] {
            let whole = binary(keyword, extra);
            let soup = read(&whole).expect("readable");
            assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
            for end in 0..whole.len() {
                assert!(read(&whole[..end]).is_err(), "cut at {end}");
            }
        }
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, message) in [
            ("OFF\n4 2 0\n0 0 0\n1 0\n", "line 4: a vertex has three numbers"),
            ("OFF\n4 x 0\n", "line 2: \"x\" is no count"),
            ("OFF\n1 1 0\n0 0 0\n3 0 a 0\n", "line 4: \"a\" is no vertex number"),
            ("OFF\n1 1 0\n0 0 0\n3 0 0\n", "line 4: a face of 3 corners"),
            ("OFF\n9 1 0\n0 0 0\n", "line 3: the file ends after 1 of 9 vertices and 0 of 1 faces"),
            ("OFF\n99999999999999 99999999999999 0\n", "line 2: "),
            ("5OFF\n4 2 0\n", "line 1: "),
            ("OFF\n", "the file ends before its counts"),
            ("OFF\n3 0 0\n0 0 0\n0 0 0\n0 0 0\n", "there are no faces"),
        ] {
            let error = read(text.as_bytes()).expect_err(text).to_string();
            assert!(error.starts_with(message), "{text}: {error}");
        }
    }
}
