//! PLY: ASCII and both binary orders, polygons and triangle strips.
//!
//! Values are read one by one by their declared type, so that elements and properties of any kind
//! can be stepped over. Nothing is allocated on the word of a header: what an element claims to
//! hold is checked against the bytes that are there.

use super::values::{Element, Property, Scalar, Values, header};
use crate::error::ParseError;
use crate::soup::{MAX_FACES, Note, Positions, Soup};
use crate::triangulate::{Outcome, triangulate};
use glam::DVec3;

/// True when the file begins as every PLY does.
pub(in crate::io) fn looks_like(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\r' | b'\n' | b' ', ..])
}

pub(in crate::io) fn read(bytes: &[u8]) -> Result<Soup, ParseError> {
    let (encoding, elements, mut values) = header(bytes)?;
    let mut positions = None;
    let mut faces = Faces::default();
    for element in &elements {
        values.check(element, encoding)?;
        match element.name.as_slice() {
            b"vertex" => positions = Some(vertices(element, &mut values)?),
            b"face" => faces.read(element, b"vertex_ind", &mut values)?,
            b"tristrips" => faces.read(element, b"vertex_ind", &mut values)?,
            _ => {
                for _ in 0..element.count {
                    for property in &element.properties {
                        values.skip(property)?;
                    }
                }
            }
        }
    }
    let positions = positions.ok_or_else(|| ParseError::file("the header has no vertex element"))?;
    if faces.ends.is_empty() {
        return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
    }
    faces.build(positions)
}

fn vertices(element: &Element, values: &mut Values<'_>) -> Result<Positions, ParseError> {
    let axis = |property: &Property| {
        [b"x", b"y", b"z"].iter().position(|n| n[..] == property.name[..]).filter(|_| property.list.is_none())
    };
    let axes: Vec<Option<usize>> = element.properties.iter().map(axis).collect();
    if (0..3).any(|a| !axes.contains(&Some(a))) {
        return Err(ParseError::file("the vertex element lacks one of the properties x, y, z"));
    }
    let in_f32 = element.properties.iter().zip(&axes).all(|(p, a)| a.is_none() || p.scalar == Scalar::F32);
    let mut points = Vec::with_capacity(element.count as usize);
    for _ in 0..element.count {
        let mut point = [0.0; 3];
        for (property, axis) in element.properties.iter().zip(&axes) {
            match axis {
                Some(axis) => point[*axis] = values.next(property.scalar)?,
                None => values.skip(property)?,
            }
        }
        points.push(point);
    }
    // ASCII values of a property called float are 32-bit numbers written out.
    Ok(if in_f32 {
        Positions::F32(points.into_iter().map(|p| p.map(|c| c as f32)).collect())
    } else {
        Positions::F64(points)
    })
}

/// Polygons as read: indices are checked once the number of vertices is known.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    ends: Vec<usize>,
    too_few: usize,
}

impl Faces {
    fn read(&mut self, element: &Element, list_name: &[u8], values: &mut Values<'_>) -> Result<(), ParseError> {
        let strips = element.name == b"tristrips";
        // vertex_indices or vertex_index, whichever the writer preferred.
        let at = element.properties.iter().position(|p| p.list.is_some() && p.name.starts_with(list_name));
        let at = at.ok_or_else(|| ParseError::file("the face element lacks the list property vertex_indices"))?;
        for _ in 0..element.count {
            for (i, property) in element.properties.iter().enumerate() {
                let Some(list) = property.list.filter(|_| i == at) else {
                    values.skip(property)?;
                    continue;
                };
                let count = values.next_count(list)?;
                let start = self.corners.len();
                for _ in 0..count {
                    let index = values.next(property.scalar)?;
                    // In a strip, -1 ends one run of triangles and begins the next.
                    if strips && index == -1.0 {
                        self.strip(start);
                        continue;
                    }
                    if !(0.0..f64::from(u32::MAX)).contains(&index) || index.fract() != 0.0 {
                        return Err(values.error(format!("{index} is no vertex number")));
                    }
                    self.corners.push(index as u32);
                }
                if strips {
                    self.strip(start);
                } else if count < 3 {
                    self.corners.truncate(start);
                    self.too_few += 1;
                } else {
                    self.ends.push(self.corners.len());
                }
            }
        }
        Ok(())
    }

    /// Replaces the run of strip corners behind the last whole triangle by its triangles.
    fn strip(&mut self, start: usize) {
        let from = self.ends.last().copied().unwrap_or(0).max(start);
        let run = self.corners.split_off(from);
        for (i, t) in run.windows(3).enumerate() {
            let [a, b, c] = [t[0], t[1], t[2]];
            // Every other triangle of a strip runs backwards; a repeated corner only moves the strip on.
            if a != b && b != c && c != a {
                self.corners.extend(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                self.ends.push(self.corners.len());
            }
        }
    }

    fn build(&self, positions: Positions) -> Result<Soup, ParseError> {
        let count = positions.len();
        let mut triangles = Vec::with_capacity(self.corners.len() - 2 * self.ends.len());
        let (mut start, mut rough, mut out_of_range, mut first_out) = (0, 0, 0, 0);
        for (face, &end) in self.ends.iter().enumerate() {
            let corners = &self.corners[start..end];
            start = end;
            if corners.iter().any(|&c| c as usize >= count) {
                if out_of_range == 0 {
                    first_out = face;
                }
                out_of_range += 1;
            } else if triangulate(corners, |c| position(&positions, c), &mut triangles) == Outcome::Rough {
                rough += 1;
            }
        }
        if triangles.len() > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        if triangles.is_empty() {
            return Err(ParseError::file(format!(
                "all faces name vertices out of range: the file has {count} vertices"
            )));
        }
        let mut soup = Soup::new(positions, triangles);
        if out_of_range > 0 {
            soup.notes.push(Note::repaired(format!(
                "{out_of_range} faces name vertices out of range ({count} vertices) and are left out, the first is face {first_out}"
            )));
        }
        if self.too_few > 0 {
            soup.notes
                .push(Note::repaired(format!("{} faces with fewer than three corners are left out", self.too_few)));
        }
        if rough > 0 {
            soup.notes.push(Note::info(format!(
                "{rough} polygons cross themselves or have no area; their triangles may overlap"
            )));
        }
        Ok(soup)
    }
}

fn position(positions: &Positions, index: u32) -> DVec3 {
    positions.get(index as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float other\nend_header\n";

    fn ascii() -> String {
        format!(
            "ply\nformat ascii 1.0\ncomment x\n{HEADER}0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3 0\n3 0 1 2 2 7 8\n"
        )
    }

    fn binary(name: &str, big: bool) -> Vec<u8> {
        let mut bytes = format!("ply\r\nformat {name} 1.0\r\n{}", HEADER.replace('\n', "\r\n")).into_bytes();
        let mut put = |raw: &[u8]| {
            let mut raw = raw.to_vec();
            if big {
                raw.reverse();
            }
            bytes.extend(raw);
        };
        for [x, y, z] in [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]] {
            for c in [x, y, z] {
                put(&c.to_le_bytes());
            }
            put(&[9]);
        }
        for (corners, others) in [(&[0_i32, 1, 2, 3][..], &[][..]), (&[0, 1, 2], &[7.0_f32, 8.0])] {
            put(&[corners.len() as u8]);
            for c in corners {
                put(&c.to_le_bytes());
            }
            put(&[others.len() as u8]);
            for o in others {
                put(&o.to_le_bytes());
            }
        }
        bytes
    }

    #[test]
    fn all_three_encodings_say_the_same() {
        let soup = read(ascii().as_bytes()).expect("ascii");
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
        assert!(matches!(soup.positions, Positions::F32(_)));
        assert_eq!(read(&binary("binary_little_endian", false)).expect("little"), soup);
        assert_eq!(read(&binary("binary_big_endian", true)).expect("big"), soup);
    }

    #[test]
    fn a_file_cut_anywhere_is_an_error_and_never_more() {
        let whole = binary("binary_little_endian", false);
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "cut at {end}");
        }
        let text = ascii();
        for end in 0..text.trim_end().len() {
            assert!(read(&text.as_bytes()[..end]).is_err(), "cut at {end}");
        }
    }

    #[test]
    fn a_count_beyond_the_file_allocates_nothing() {
        let text = ascii().replace("vertex 4", "vertex 4000000000000");
        assert!(read(text.as_bytes()).expect_err("too many").to_string().contains("truncated"));
        let text = ascii().replace("4 0 1 2 3 0", "4000000000 0 1 2 3 0");
        assert!(read(text.as_bytes()).is_err());
    }

    #[test]
    fn strips_alternate_their_winding() {
        let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n8 0 1 2 3 -1 0 1 3\n";
        assert_eq!(read(text.as_bytes()).expect("strips").triangles, [[0, 1, 2], [2, 1, 3], [0, 1, 3]]);
    }

    #[test]
    fn faces_out_of_range_are_left_out_and_told() {
        let soup = read(ascii().replace("4 0 1 2 3 0", "4 0 1 2 4 0").as_bytes()).expect("one face is good");
        assert_eq!(soup.triangles, [[0, 1, 2]]);
        assert!(soup.notes[0].repaired);
    }

    #[test]
    fn a_point_cloud_is_told_so() {
        let text = ascii().replace("face 2", "face 0");
        assert!(read(text.as_bytes()).expect_err("no faces").to_string().contains("point cloud"));
    }
}
