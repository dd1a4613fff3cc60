//! Wavefront OBJ: positions, polygons and groups.
//!
//! Read here and not by `tobj`, which fails on whole files for a continued line, a comment behind a
//! face, a coloured vertex or one byte that is not UTF-8, and cannot say where (docs/decisions.md).
//! Tests compare the two on files that both read.

use super::folders::Folders;
use super::polygons::{Examples, Polygons};
use super::text::{self, Lines, Words};
use crate::error::ParseError;
use crate::soup::{Note, Positions, Soup, short_name};

/// True when one of the first lines is a vertex or face statement.
pub(super) fn looks_like(bytes: &[u8]) -> bool {
    text::is_text(bytes)
        && Lines::new(bytes).take(1000).any(|(_, line)| {
            let mut words = text::words(line);
            matches!(words.next(), Some(b"v")) && words.take(3).filter(|word| text::number(word).is_some()).count() == 3
        })
}

/// Statements of material files, and names in one of them, that are looked for.
const MOST_LIBRARIES: usize = 100;

/// Reads an OBJ. `folders` are where its materials are looked for, which is only told about.
pub(super) fn read<'a>(bytes: &[u8], folders: impl Into<Folders<'a>>) -> Result<Soup, ParseError> {
    let folders = folders.into();
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut polygons = Polygons::default();
    // Per group: its name and the number of polygons before it.
    let mut groups: Vec<(String, usize)> = Vec::new();
    let (mut object, mut group, mut material) = (String::new(), String::new(), String::new());
    // The largest vertex number, from 0, as it is written, and its line.
    let mut largest: Option<(u32, i64, u64)> = None;
    // The line of the first face with too few corners.
    let mut too_few: Option<u64> = None;
    let mut libraries: Vec<(u64, String)> = Vec::new();

    let mut lines = Lines::new(bytes);
    while let Some((line, first)) = lines.next() {
        let joined;
        let content = if goes_on(first) {
            joined = join_continued(first, &mut lines);
            joined.as_slice()
        } else {
            first
        };
        let content = text::without_comment(content);
        let mut words = text::words(content);
        match words.next() {
            Some(b"v") => positions.push(position(words, line, content)?),
            // The old name of faces.
            Some(b"f" | b"fo") => {
                let mut largest_here = None;
                for word in words {
                    let index = vertex_index(word, line)?;
                    let corner = corner(index, positions.len());
                    largest_here = largest_here.max(Some((corner, index, line)));
                    polygons.corner(corner);
                }
                if polygons.open_corners() < 3 {
                    too_few.get_or_insert(line);
                } else if largest_here.map(|(corner, ..)| corner) > largest.map(|(corner, ..)| corner) {
                    largest = largest_here;
                }
                polygons.end_face();
            }
            Some(keyword @ (b"o" | b"g" | b"usemtl")) => {
                let name = text::name(&content.trim_ascii()[keyword.len()..]);
                match keyword {
                    b"o" => object = name,
                    b"g" => group = name,
                    _ => material = name,
                }
                // A material divides only what has no other name.
                let full = match (object.as_str(), group.as_str()) {
                    ("", "") => material.clone(),
                    (name, "") | ("", name) => name.to_owned(),
                    (object, group) => short_name(&format!("{object}/{group}")).to_owned(),
                };
                // Of names without a face between them only the last counts.
                groups.pop_if(|(_, before)| *before == polygons.count());
                groups.push((full, polygons.count()));
            }
            Some(b"mtllib") if libraries.len() < MOST_LIBRARIES => {
                let names = String::from_utf8_lossy(content.trim_ascii()[b"mtllib".len()..].trim_ascii());
                libraries.push((line, names.into_owned()));
            }
            // Everything else concerns looks, curves or points.
            _ => {}
        }
    }
    let examples = Examples { largest: largest.map(|(_, index, line)| (index, line)), too_few };
    let mut soup = polygons.into_grouped(Positions::F64(positions), &groups, &examples)?;
    look_for(&libraries, folders, &mut soup);
    Ok(soup)
}

/// Tells of material files that are not there: nothing of them is needed, but a user may want to know.
fn look_for(libraries: &[(u64, String)], folders: Folders<'_>, soup: &mut Soup) {
    if folders.base().is_none() {
        return;
    }
    for (line, names) in libraries {
        // Names may hold spaces, and a line may hold several names.
        let found = match folders.find(names) {
            Ok(file) => vec![Ok(file)],
            Err(why) => {
                let each = names.split_whitespace().take(MOST_LIBRARIES);
                let each: Vec<_> = each.map(|name| folders.find(name).map_err(|why| (name, why))).collect();
                // Where none is there, it may as well be one name with spaces.
                if each.iter().any(Result::is_ok) { each } else { vec![Err((names.as_str(), why))] }
            }
        };
        for file in found {
            match file {
                Ok(file) if soup.files.contains(&file) => {}
                Ok(file) => soup.files.push(file),
                Err((name, why)) => soup.notes.push(Note::info(format!(
                    "line {line}: the materials {} {why}; curvature needs none",
                    text::quoted(name.as_bytes())
                ))),
            }
            // Thousands of missing files are told as well by the first few.
            if soup.notes.len() >= 5 {
                return;
            }
        }
    }
}

/// A line that ends in a backslash goes on in the next, but not the path of a folder in a comment.
fn goes_on(line: &[u8]) -> bool {
    line.trim_ascii_end().ends_with(b"\\") && text::without_comment(line).len() == line.len()
}

fn join_continued(first: &[u8], lines: &mut Lines<'_>) -> Vec<u8> {
    let mut joined = Vec::new();
    let mut line = first;
    while goes_on(line) {
        joined.extend_from_slice(line.trim_ascii_end());
        joined.pop();
        joined.push(b' ');
        line = lines.next().map_or(&[], |(_, next)| next);
    }
    joined.extend_from_slice(line);
    joined
}

/// The first three numbers; a weight or a colour may follow.
fn position(mut words: Words<'_>, line: u64, content: &[u8]) -> Result<[f64; 3], ParseError> {
    let mut point = [0.0; 3];
    for coordinate in &mut point {
        *coordinate = words.number().ok_or_else(|| ParseError::line(line, text::no_vertex(content)))?;
    }
    Ok(point)
}

/// What a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` names its vertex by.
fn vertex_index(word: &[u8], line: u64) -> Result<i64, ParseError> {
    let index = word.split(|&b| b == b'/').next().unwrap_or_default();
    match text::integer(index) {
        Some(0) => Err(ParseError::line(line, "vertex number 0: they start at 1")),
        Some(index) => Ok(index),
        None => Err(ParseError::line(line, format!("{} is no vertex number", text::quoted(word)))),
    }
}

/// The number of a vertex, from 0: positive ones count from the file's first vertex, negative ones back from the last
/// of so many. One that no vertex has stands for all that are out of range.
fn corner(index: i64, vertices: usize) -> u32 {
    let from_first = if index > 0 { Some(index - 1) } else { index.checked_add(vertices as i64) };
    from_first.and_then(|corner| u32::try_from(corner).ok()).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(text: &str) -> Vec<[u32; 3]> {
        read(text.as_bytes(), None).unwrap_or_else(|e| panic!("{text}: {e}")).triangles
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn faces_are_written_in_many_ways() {
        let two = [[0, 1, 2], [0, 2, 3]];
        for face in [
            "f 1 2 3 4",
            "f 1/1 2/2 3/3 4/4",
            "f 1//1 2//2 3//3 4//4",
            "f -4 -3 -2 -1",
            "f 1 2 \\\n 3 4 # four",
            "f  1/1/1\t2/2/2 3/3/3 4/4/4\r",
            "fo 1 2 3 4",
            "# C:\\meshes\\\nf 1 2 3 4",
            "f 1 2 3 4 # C:\\meshes\\\nv 9 9 9",
            "f 1 2 \\\n3 4 # C:\\meshes\\\nv 9 9 9",
        ] {
            assert_eq!(faces(&format!("{SQUARE}{face}\n")), two, "{face}");
        }
        assert_eq!(faces(&format!("f 1 2 3 4\n{SQUARE}")), two, "a face before its vertices");
    }

    #[test]
    fn vertices_may_carry_weights_and_colours() {
        let soup = read(b"v 1 2 3 1.0\nv 4 5 6 0.1 0.2 0.3\nv 7 8 9 1 0.1 0.2 0.3\nf 1 2 3", None).expect("readable");
        assert_eq!(soup.positions, Positions::F64(vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]));
    }

    #[test]
    fn vertices_without_numbers_are_kept_as_such() {
        let soup =
            read(format!("{SQUARE}v -1.#IND 1.#INF -nan(ind)\nf 1 2 3 # four").as_bytes(), None).expect("readable");
        assert_eq!((soup.face_count(), soup.positions.len()), (1, 5));
        assert!(soup.positions.get(4).is_nan());
    }

    #[test]
    fn groups_and_objects_are_remembered() {
        let text = format!("{SQUARE}o body\ng left\nf 1 2 3\ng right\ng left\nusemtl gr?n\nf 1 3 4\no tail\nf 2 3 4\n");
        // A name in Latin-1, as old exporters write it.
        let bytes: Vec<u8> = text.bytes().map(|b| if b == b'?' { 0xfc } else { b }).collect();
        let soup = read(&bytes, None).expect("readable");
        let groups: Vec<_> = soup.groups.iter().map(|g| (g.name.as_str(), g.faces.clone())).collect();
        assert_eq!(groups, [("body/left", 0..2), ("tail/left", 2..3)]);
    }

    /// What is left out moves groups, in triangles and in polygons.
    #[test]
    fn faces_out_of_range_are_left_out_of_their_groups() {
        let text = format!("{SQUARE}g a\nf 1 2 3\nf 1 2 9\ng b\nf 1 3 4\nf 1 2 3 4\ng c\nf 1 2 3 8\ng d\nf 2 3 4\n");
        let soup = read(text.as_bytes(), None).expect("readable");
        let groups: Vec<_> = soup.groups.iter().map(|g| (g.name.as_str(), g.faces.clone())).collect();
        assert_eq!(groups, [("a", 0..1), ("b", 1..4), ("d", 4..5)]);
        assert!(soup.notes[0].repaired && soup.notes[0].message.starts_with("2 faces left out"), "{:?}", soup.notes);
    }

    #[test]
    fn materials_name_what_has_no_other_name() {
        let text = format!("{SQUARE}usemtl shiny red\nf 1 2 3\nusemtl blue\nf 1 3 4\ng left\nusemtl green\nf 2 3 4\n");
        let soup = read(text.as_bytes(), None).expect("readable");
        let names: Vec<_> = soup.groups.iter().map(|g| g.name.as_str()).collect();
        assert_eq!(names, ["shiny red", "blue", "left"]);
    }

    #[test]
    fn missing_materials_are_only_told() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("my looks.mtl"), "").expect("a file");
        std::fs::write(folder.path().join("a.mtl"), "").expect("a file");
        let read_in = |library: &str| {
            let text = format!("mtllib {library}\n{SQUARE}f 1 2 3\n");
            read(text.as_bytes(), Some(folder.path())).expect("readable")
        };
        for library in ["my looks.mtl", "a.mtl"] {
            let soup = read_in(library);
            assert!(soup.notes.is_empty() && soup.files.len() == 1, "{:?}", soup.notes);
        }
        let soup = read_in("one name with spaces.mtl");
        assert!(soup.notes.len() == 1 && soup.notes[0].message.contains("\"one name with spaces.mtl\""));
        for library in ["a.mtl gone.mtl", "../b.mtl a.mtl", "gone.mtl a.mtl"] {
            let soup = read_in(library);
            assert_eq!((soup.notes.len(), soup.files.len()), (1, 1), "{:?}", soup.notes);
            assert!(!soup.notes[0].repaired && soup.notes[0].message.starts_with("line 1: "));
        }
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (face, line) in [
            ("f 1 2 9", "line 5: vertex 9 is out of range"),
            ("f 0 1 2", "line 5: vertex number 0"),
            ("f -9 1 2", "line 5: vertex -9 is out of range"),
            ("f 1 9999999999 2", "line 5: vertex 9999999999 is out of range"),
            ("f 1 99\nf 1 2 9", "line 6: vertex 9 is out of range"),
            ("f a b c", "line 5: \"a\""),
        ] {
            let error = read(format!("{SQUARE}{face}\n").as_bytes(), None).expect_err(face).to_string();
            assert!(error.contains(line), "{error}");
        }
        assert!(read(b"v 1 2\n", None).expect_err("two numbers").to_string().starts_with("line 1: "));
        let error = read(b"v 1,5 2,5 3\n", None).expect_err("commas").to_string();
        assert!(error.starts_with("line 1: ") && error.ends_with("a point, not a comma"), "{error}");
        assert!(read(b"v 1 2 3\n", None).expect_err("a point").to_string().contains("no faces"));
        let soup = read(format!("{SQUARE}f 1 2\nf 1 2 3\n").as_bytes(), None).expect("one face is good");
        assert!(soup.face_count() == 1 && soup.notes[0].repaired && soup.notes[0].message.contains("line 5"));
    }

    #[test]
    fn agrees_with_tobj_on_what_both_read() {
        let text = format!("{SQUARE}v 2 2 2\no a\nf 1 2 3\nf 1//1 3//1 4//1\nf -1 -2 -3\n").replace("//1", "");
        let ours = read(text.as_bytes(), None).expect("readable");
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &tobj::LoadOptions::default(), |_| {
            tobj::load_mtl_buf(&mut &b""[..])
        })
        .expect("tobj reads it");
        let theirs: Vec<[f64; 3]> = models
            .iter()
            .flat_map(|m| m.mesh.indices.iter().map(|&i| [0, 1, 2].map(|c| m.mesh.positions[3 * i as usize + c])))
            .collect();
        let ours: Vec<[f64; 3]> =
            ours.triangles.as_flattened().iter().map(|&i| ours.positions.get(i as usize).to_array()).collect();
        assert_eq!(ours, theirs);
    }
}
