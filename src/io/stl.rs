//! STL, binary and ASCII.
//!
//! Binary files whose header tells their length are read in windows, so that a file of gigabytes is never in memory
//! besides its triangles. Others are read whole, and judged by what they hold.

use super::corners::Corners;
use super::foreign;
use super::text::{self, Lines, Words};
use crate::error::ParseError;
use crate::soup::{Group, MAX_FACES, Note, Soup};
use std::array::from_fn;
use std::io::{self, BufRead};

const HEADER: usize = 84;
const RECORD: usize = 50;

/// True when the file's size is just what the count in its header asks for.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    binary_count(bytes, bytes.len() as u64).is_some()
}

/// The number of triangles of a binary file that is as long as its header says, by its first bytes
/// and its length.
pub(super) fn binary_count(start: &[u8], length: u64) -> Option<u64> {
    declared(start).filter(|count| HEADER as u64 + RECORD as u64 * count == length)
}

/// True when the file begins as an ASCII STL and goes on as one.
pub(super) fn is_ascii(bytes: &[u8]) -> bool {
    let start = Lines::new(&bytes[..bytes.len().min(4096)]).filter(|(_, line)| !is_comment(line));
    let mut words = start.flat_map(|(_, line)| text::words(line)).map(<[u8]>::to_ascii_lowercase);
    text::is_text(bytes)
        && words.next().is_some_and(|word| word == b"solid")
        && words.any(|word| word == b"facet" || word == b"endsolid")
}

/// Some programs write them, though the format has none.
fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start(), [b';' | b'#', ..])
}

/// The number of triangles in a binary file's header.
fn declared(bytes: &[u8]) -> Option<u64> {
    let count: [u8; 4] = bytes.get(80..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count).into())
}

/// Reads a file. Where it only may be an STL, `is_judged`, it must look like one.
pub(super) fn read(bytes: &[u8], is_judged: bool) -> Result<Soup, ParseError> {
    if is_binary(bytes) {
        read_binary(bytes, is_judged)
    } else if is_ascii(bytes) {
        read_ascii(bytes)
    } else if text::is_text(bytes) {
        Err(ParseError::line(1, "this is text, but not an ASCII STL, which begins with the word solid and has facets"))
    } else {
        read_binary(bytes, is_judged)
    }
}

fn read_binary(bytes: &[u8], is_judged: bool) -> Result<Soup, ParseError> {
    let Some(declared) = declared(bytes) else {
        return Err(ParseError::file(format!(
            "a binary STL begins with 84 bytes, but the file ends after {}",
            bytes.len()
        )));
    };
    let body = &bytes[HEADER..];
    let held = (body.len() / RECORD) as u64;
    let left_over = body.len() % RECORD;
    // What is behind the promised triangles is more of them if it has just their size.
    let more = declared == 0 || left_over == 0;
    let count = held.min(if more { held } else { declared });
    if count == 0 {
        return Err(ParseError::byte(HEADER as u64, "the file ends before the first triangle"));
    }
    if count > MAX_FACES as u64 {
        return Err(ParseError::byte(
            80,
            format!("{count} triangles are more than the {MAX_FACES} that can be handled"),
        ));
    }
    let records = &mut &body[..RECORD * count as usize];
    let is_as_declared = declared == held && left_over == 0;
    let foreign = foreign::sentence(bytes);
    if is_judged && !is_as_declared && !looks_like_triangles(records, foreign.is_some()) {
        return Err(ParseError::file(foreign.unwrap_or_else(|| {
            format!(
                "this is no STL: {} bytes that hold no numbers of triangles, under a header that promises {declared}",
                bytes.len()
            )
        })));
    }
    let mut notes = Vec::new();
    if declared > held {
        notes.push(Note::repaired(format!(
            "the header promises {declared} triangles, but the file ends after {held}; those are used"
        )));
    } else if declared < held || left_over > 0 {
        let extra = body.len() as u64 - RECORD as u64 * count;
        if more {
            notes.push(Note::repaired(format!(
                "the header says {declared} triangles, but the file holds {held}; those are used"
            )));
        } else {
            notes.push(Note::repaired(format!("{extra} bytes after the last of {count} triangles are ignored")));
        }
    }
    let mut soup = read_records(records, count as usize).map_err(|e| ParseError::byte(HEADER as u64, e.to_string()))?;
    soup.notes = notes;
    Ok(soup)
}

/// True when most of some records have coordinates that a mesh may have: nearly all where the file begins as another kind
/// does. Of numbers made of other bytes one in four is beyond the size of everything: of nine of them hardly ever none
/// is. Records of zeros and of NaN tell nothing.
fn looks_like_triangles(records: &[u8], is_suspect: bool) -> bool {
    /// Records that are looked at, from all of the file.
    const LOOKS: usize = 4000;
    let (records, _) = records.as_chunks::<RECORD>();
    let some = records.iter().step_by(records.len().div_ceil(LOOKS).max(1)).map(corners_of);
    let tells = |corners: &[[f32; 3]; 3]| {
        let mut values = corners.as_flattened().iter();
        values.clone().any(|value| value.abs() > 1e-30) && !values.any(|value| value.is_nan())
    };
    let (mut usual, mut all) = (0, 0);
    for corners in some.filter(tells) {
        all += 1;
        usual += usize::from(corners.as_flattened().iter().all(|value| value.abs() < 1e20));
    }
    let least = if is_suspect { 0.95 } else { 0.5 };
    usual > 0 && usual as f64 >= least * f64::from(all)
}

/// Reads a binary file from its first byte on, as far as [`binary_count`] says; `None` where there
/// are no triangles, or more than can be handled.
pub(super) fn read_stream(stream: &mut impl BufRead, count: u64) -> Option<io::Result<Soup>> {
    let count = usize::try_from(count).ok().filter(|count| (1..=MAX_FACES).contains(count))?;
    Some(stream.read_exact(&mut [0; HEADER]).and_then(|()| read_records(stream, count)))
}

/// Reads triangles of 50 bytes each: a normal, three corners and two bytes that are nobody's.
fn read_records(stream: &mut impl BufRead, count: usize) -> io::Result<Soup> {
    let mut corners = Corners::new();
    corners.try_reserve(count)?;
    while corners.face_count() < count {
        let (whole, _) = stream.fill_buf()?.as_chunks::<RECORD>();
        let whole = &whole[..whole.len().min(count - corners.face_count())];
        corners.extend(whole.iter().map(corners_of));
        let used = RECORD * whole.len();
        if used > 0 {
            stream.consume(used);
        } else {
            // It begins in one window and ends in the next.
            let mut record = [0; RECORD];
            stream.read_exact(&mut record)?;
            corners.extend(std::iter::once(corners_of(&record)));
        }
    }
    Ok(corners.into_soup())
}

#[inline]
fn corners_of(record: &[u8; RECORD]) -> [[f32; 3]; 3] {
    let (values, _) = record.as_chunks::<4>();
    from_fn(|corner| from_fn(|axis| f32::from_le_bytes(values[3 + 3 * corner + axis])))
}

fn read_ascii(bytes: &[u8]) -> Result<Soup, ParseError> {
    let mut ascii = Ascii::new();
    let mut lines = Lines::new(bytes);
    let mut cut = None;
    let mut last = 0;
    while let Some((line, content)) = lines.next() {
        last = line;
        if let Err(error) = ascii.line(line, content) {
            // A file that was cut short ends in the middle of a line: what is before it counts.
            if lines.rest().is_empty() && ascii.corners.face_count() > 0 {
                cut = Some(line);
                break;
            }
            return Err(error);
        }
    }
    if cut.is_none() && ascii.in_facet > 0 {
        cut = Some(last);
    }
    ascii.into_soup(cut)
}

/// The words from the first facet on, or none. A name before it may be anything, the word facet
/// included; a facet has a normal or a loop.
fn first_facet(mut words: Words<'_>) -> Words<'_> {
    let is = |word: &[u8], keyword: &[u8]| word.eq_ignore_ascii_case(keyword);
    loop {
        let here = words;
        match words.next() {
            Some(word) if is(word, b"facet") => {
                if { words }.next().is_some_and(|next| is(next, b"normal") || is(next, b"outer")) {
                    return here;
                }
            }
            Some(_) => {}
            None => return words,
        }
    }
}

/// An ASCII file as far as it has been read.
struct Ascii {
    /// The facets with three vertices so far.
    corners: Corners<f64>,
    solids: Vec<Group>,
    /// The vertices of the current facet.
    facet: [[f64; 3]; 3],
    /// How many of them have been read.
    in_facet: usize,
    /// True behind an `endsolid`.
    ended: bool,
}

impl Ascii {
    fn new() -> Self {
        Ascii { corners: Corners::new(), solids: Vec::new(), facet: [[0.0; 3]; 3], in_facet: 0, ended: false }
    }

    /// Reads the words of a line, of which there may be several statements.
    fn line(&mut self, line: u64, content: &[u8]) -> Result<(), ParseError> {
        if is_comment(content) {
            return Ok(());
        }
        let mut words = text::words(content);
        let error = |what: String| Err(ParseError::line(line, what));
        while let Some(word) = words.next() {
            // The longest keyword has eight letters.
            let mut lower = [0; 8];
            let length = word.len().min(lower.len() + 1);
            let lower = lower.get_mut(..length).map(|lower| {
                lower.copy_from_slice(word);
                lower.make_ascii_lowercase();
                &*lower
            });
            match lower.unwrap_or_default() {
                b"vertex" if self.in_facet == 3 => {
                    return error("a facet with more than three vertices; export the file as triangles".into());
                }
                b"vertex" => {
                    for coordinate in &mut self.facet[self.in_facet] {
                        let Some(value) = words.number() else {
                            return error(text::no_vertex(content));
                        };
                        *coordinate = value;
                    }
                    self.in_facet += 1;
                    if self.in_facet == 3 {
                        if self.corners.face_count() == MAX_FACES {
                            return error(format!("the {MAX_FACES} facets before it are all that can be handled"));
                        }
                        self.corners.extend(std::iter::once(self.facet));
                    }
                }
                b"endfacet" | b"facet" if !self.in_facet.is_multiple_of(3) => {
                    return error(format!("a facet ends after {} of three vertices", self.in_facet));
                }
                b"endfacet" | b"facet" => self.in_facet = 0,
                // Nobody needs the normal, and some programs write words where its numbers belong, or colours.
                b"normal" | b"color" => drop(words.by_ref().take(3).count()),
                b"outer" | b"loop" | b"endloop" => {}
                b"solid" => {
                    let start = self.corners.face_count() as u32;
                    let from = words.rest();
                    let facet = first_facet(words);
                    let name = text::name(&from[..from.len() - facet.rest().len()]);
                    self.solids.push(Group { name, faces: start..start });
                    self.ended = false;
                    words = facet;
                }
                b"endsolid" => {
                    self.ended = true;
                    // Its name, and perhaps the next solid.
                    while { words }.next().is_some_and(|word| !word.eq_ignore_ascii_case(b"solid")) {
                        words.next();
                    }
                }
                // What some program leaves behind the last solid is not ours to judge.
                _ if self.ended => return Ok(()),
                _ => return error(format!("{} is no part of an STL file", text::quoted(word))),
            }
        }
        Ok(())
    }

    /// `cut` is the line in which the file ends too early.
    fn into_soup(mut self, cut: Option<u64>) -> Result<Soup, ParseError> {
        let count = self.corners.face_count();
        if count == 0 {
            return Err(ParseError::file("the solid has no whole facet"));
        }
        for i in 0..self.solids.len() {
            self.solids[i].faces.end = self.solids.get(i + 1).map_or(count as u32, |next| next.faces.start);
        }
        let mut soup = self.corners.into_soup();
        soup.groups = self.solids;
        if cut.is_none() && !self.ended {
            soup.notes.push(Note::info("the last solid has no endsolid; the file may be cut short between two facets"));
        }
        soup.notes.extend(cut.map(|line| {
            Note::repaired(format!(
                "the file ends inside a facet, in line {line}; the {count} facets before it are used"
            ))
        }));
        Ok(soup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn binary(header: &[u8], declared: u32, triangles: u32) -> Vec<u8> {
        let mut bytes = vec![0; 80];
        bytes[..header.len()].copy_from_slice(header);
        bytes.extend(declared.to_le_bytes());
        for i in 0..triangles {
            for value in [0.0, 0.0, 1.0, 0.0, 0.0, i as f32, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
                bytes.extend(value.to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }

    const FACET: &str = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

    #[test]
    fn a_binary_file_may_begin_with_solid() {
        let soup = read(&binary(b"solid made by a program", 2, 2), true).expect("readable");
        assert_eq!(soup.face_count(), 2);
        assert_eq!(soup.positions.get(3).z, 1.0);
        assert!(soup.notes.is_empty());
    }

    #[test]
    fn a_wrong_count_is_reported_and_the_triangles_that_are_there_are_used() {
        for (declared, faces) in [(5, 3), (0, 3), (2, 3), (u32::MAX, 3)] {
            let soup = read(&binary(b"", declared, 3), true).expect("readable");
            assert_eq!(soup.face_count(), faces, "{declared}");
            assert!(soup.notes[0].repaired);
        }
        let trailing = [binary(b"", 3, 3), b"left behind".to_vec()].concat();
        let soup = read(&trailing, true).expect("readable");
        assert!(soup.face_count() == 3 && soup.notes[0].message.starts_with("11 bytes after the last of 3 triangles"));
        let mut cut = binary(b"", 3, 3);
        cut.truncate(cut.len() - 1);
        assert_eq!(read(&cut, true).expect("readable").face_count(), 2);
    }

    #[test]
    fn other_bytes_are_not_taken_for_triangles() {
        // A multiplicative generator; its high bytes are as good as drawn by lot.
        let noise = |seed: u64| (1..5000u64).map(move |i| ((i + seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 56) as u8);
        for seed in 0..20 {
            let bytes: Vec<u8> = [0xff].into_iter().chain(noise(seed)).collect();
            let error = read(&bytes, true).expect_err("noise").to_string();
            assert!(error.contains("this is no STL: 5000 bytes"), "{error}");
        }
        let told = read(&[[0xff_u8; 1].as_slice(), &[7; 4999]].concat(), false);
        assert_eq!(told.expect("whoever says so is believed").face_count(), 98);
        // A black picture, and a mesh among records that tell nothing.
        let black = [b"RIFF\x00\x00\x00\x00WAVEfmt ".as_slice(), &[0; 5000]].concat();
        assert!(read(&black, true).is_err());
        let mut among = binary(b"", 0, 30);
        among.splice(84..84, [[0; 500], [0xff; 500]].concat());
        assert_eq!(read(&among, true).expect("readable").face_count(), 50);
        let picture: Vec<u8> = b"\x89PNG\r\n\x1a\n".iter().copied().chain(noise(0)).collect();
        assert!(read(&picture, true).expect_err("a picture").to_string().contains("this is a PNG picture"));
    }

    #[test]
    fn windows_of_any_size_show_the_same() {
        let bytes = binary(b"windows", 7, 7);
        let whole = read(&bytes, true).expect("readable");
        let theirs: Vec<[f32; 3]> = stl_io::create_stl_reader(&mut io::Cursor::new(&bytes))
            .expect("stl_io reads it")
            .flat_map(|triangle| triangle.expect("a triangle").vertices.map(|v| v.0))
            .collect();
        let ours = whole.triangles.as_flattened().iter().map(|&corner| whole.positions.get(corner as usize));
        assert!(ours.eq(theirs.into_iter().map(|[x, y, z]| DVec3::new(x.into(), y.into(), z.into()))));
        for window in [1, 49, 50, 51, 84, 130, 1000] {
            let mut stream = io::BufReader::with_capacity(window, bytes.as_slice());
            let soup = read_stream(&mut stream, 7).expect("some triangles").expect("readable");
            assert_eq!(soup, whole, "{window}");
            let mut cut = io::BufReader::with_capacity(window, &bytes[..bytes.len() - 1]);
            read_stream(&mut cut, 7).expect("some triangles").expect_err("a file that shrinks while it is read");
        }
        assert!(read_stream(&mut &bytes[..], 0).is_none() && read_stream(&mut &bytes[..], u64::MAX).is_none());
    }

    #[test]
    fn ascii_comes_in_many_hands() {
        for text in [
            format!("solid on one line {}endsolid", FACET.replace('\n', " ")),
            format!("solid a {0}endsolid a solid b {0}endsolid b", FACET.replace('\n', " ")),
            format!("solid my facet part\n{FACET}endsolid my facet part\n"),
            format!("solid\n{FACET}{}{FACET}endsolid\n", FACET.replace('\n', " ") + "\n"),
            format!("solid\n{FACET}endsolid\nleft behind\n"),
            format!("; made by a program\n# and another\n  solid x\n{FACET}endsolid x"),
            format!("solid x\ncolor 1 0.5 0\n{}endsolid x", FACET.replace("facet n", "color 1 0 0\nfacet n")),
            format!("solid x\n{}endsolid x", FACET.replace("0 0 1\no", "-nan(ind) 1.#QNAN -1.#IND\no")),
            format!("solid\n{FACET}endsolid\n"),
            format!("  solid  a name\n{FACET}{FACET}"),
            format!("SOLID x\n{}ENDSOLID", FACET.to_uppercase()),
            format!("solid x\n{}endsolid x", FACET.replace('\n', "\r\n")),
            format!("solid x\n{}endsolid x", FACET.replace('\n', "\r")),
            format!(
                "solid a\n{}endsolid a\nsolid b\n{FACET}endsolid b",
                FACET.replace("normal 0 0 1", "normal nan nan nan")
            ),
        ] {
            let soup = read(text.as_bytes(), true).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert_eq!(soup.face_count(), text.to_lowercase().matches("endfacet").count(), "{text}");
            assert!(!soup.notes.iter().any(|n| n.repaired), "{text}");
            assert_eq!(soup.positions.get(1).x, 1.0);
        }
    }

    #[test]
    fn solids_become_groups() {
        let soup = read(format!("solid one\n{FACET}{FACET}endsolid\nsolid the other\n{FACET}").as_bytes(), true)
            .expect("readable");
        assert_eq!(
            soup.groups.iter().map(|g| (g.name.as_str(), g.faces.clone())).collect::<Vec<_>>(),
            [("one", 0..2), ("the other", 2..3)]
        );
    }

    #[test]
    fn a_bad_line_is_named() {
        let error = read(format!("solid x\n{}", FACET.replace("vertex 1 0 0", "vertex 1 O 0")).as_bytes(), true)
            .expect_err("a letter");
        assert!(error.to_string().starts_with("line 5: "), "{error}");
        assert!(
            read(b"A letter to my aunt, renamed to .stl", true)
                .expect_err("text")
                .to_string()
                .contains("not an ASCII STL")
        );
    }

    #[test]
    fn a_cut_ascii_file_gives_its_whole_facets() {
        let text = format!("solid x\n{FACET}{FACET}");
        for end in
            text.len() - FACET.len() + 7..text.find("0 1 0\nendloop\nendfacet\n").map_or(0, |at| at + FACET.len())
        {
            let soup = read(&text.as_bytes()[..end], true).unwrap_or_else(|e| panic!("cut at {end}: {e}"));
            assert_eq!(soup.face_count(), 1, "cut at {end}");
            assert!(soup.notes.len() <= 1);
        }
    }
}
