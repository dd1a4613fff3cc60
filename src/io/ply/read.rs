//! PLY: ASCII and both binary orders, polygons and triangle strips.
//!
//! Values are read one by one by their declared type, so that elements and properties of any kind
//! can be stepped over. Nothing is allocated on the word of a header: what an element claims to
//! hold is checked against the bytes that are there.

use super::rows;
use super::values::{Element, Property, Scalar, Values, header};
use crate::error::ParseError;
use crate::io::polygons::Polygons;
use crate::soup::{Positions, Soup};

/// True when the file begins as every PLY does.
pub(in crate::io) fn looks_like(bytes: &[u8]) -> bool {
    matches!(bytes, [b'p', b'l', b'y', b'\r' | b'\n' | b' ', ..])
}

pub(in crate::io) fn read(bytes: &[u8]) -> Result<Soup, ParseError> {
    let (encoding, elements, mut values) = header(bytes)?;
    let mut positions = None;
    let mut polygons = Polygons::default();
    for element in &elements {
        values.check(element, encoding)?;
        match element.name.as_slice() {
            b"vertex" => positions = Some(vertices(element, &mut values)?),
            b"face" | b"tristrips" => faces(element, &mut values, &mut polygons)?,
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
    polygons.into_soup(positions)
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
    if let Some((rows, stride, big)) = values.rows(element) {
        let mut offsets = [(0, Scalar::F32); 3];
        let mut offset = 0;
        for (property, axis) in element.properties.iter().zip(&axes) {
            if let Some(axis) = axis {
                offsets[*axis] = (offset, property.scalar);
            }
            offset += property.scalar.size();
        }
        return Ok(if in_f32 {
            Positions::F32(rows::points_f32(rows, stride, big, offsets.map(|(at, _)| at)))
        } else {
            Positions::F64(rows::points(rows, stride, big, offsets))
        });
    }
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

/// Reads the corner lists of faces or strips.
fn faces(element: &Element, values: &mut Values<'_>, polygons: &mut Polygons) -> Result<(), ParseError> {
    if element.count == 0 {
        return Ok(());
    }
    let strips = element.name == b"tristrips";
    // vertex_indices or vertex_index, whichever the writer preferred.
    let at = element.properties.iter().position(|p| p.list.is_some() && p.name.starts_with(b"vertex_ind"));
    let at = at.ok_or_else(|| ParseError::file("the face element lacks the list property vertex_indices"))?;
    if !strips && let Some(result) = rows::faces(element, at, values, polygons) {
        return result;
    }
    for _ in 0..element.count {
        for (i, property) in element.properties.iter().enumerate() {
            let Some(list) = property.list.filter(|_| i == at) else {
                values.skip(property)?;
                continue;
            };
            let count = values.next_count(list)?;
            for _ in 0..count {
                let index = values.next(property.scalar)?;
                // In a strip, -1 ends one run of triangles and begins the next.
                if strips && index == -1.0 {
                    polygons.end_strip();
                    continue;
                }
                if !(0.0..f64::from(u32::MAX)).contains(&index) || index.fract() != 0.0 {
                    return Err(values.error(format!("{index} is no vertex number")));
                }
                polygons.corner(index as u32);
            }
            if strips {
                polygons.end_strip();
            } else {
                polygons.end_face();
            }
        }
    }
    Ok(())
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
    fn rows_of_other_types_say_the_same() {
        let soup = read(ascii().as_bytes()).expect("ascii");
        for (big, order) in [(false, "little"), (true, "big")] {
            for (kind, size) in
                [("uint64", 8), ("int64", 8), ("ushort", 2), ("short", 2), ("uint", 4), ("int", 4), ("uchar", 1)]
            {
                let mut bytes = format!("ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty uchar red\nproperty double x\nproperty float y\nproperty short z\nelement face 2\nproperty uchar a\nproperty list int {kind} vertex_index\nproperty double b\nend_header\n").into_bytes();
                let mut put = |value: &[u8]| {
                    let mut value = value.to_vec();
                    if big {
                        value.reverse();
                    }
                    bytes.extend(value);
                };
                for [x, y] in [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0_f32]] {
                    put(&[9]);
                    put(&f64::from(x).to_le_bytes());
                    put(&y.to_le_bytes());
                    put(&0_i16.to_le_bytes());
                }
                for corners in [&[0_u32, 1, 2, 3][..], &[0, 1, 2]] {
                    put(&[1]);
                    put(&(corners.len() as i32).to_le_bytes());
                    corners.iter().for_each(|&c| put(&u64::from(c).to_le_bytes()[..size]));
                    put(&2.5_f64.to_le_bytes());
                }
                let other = read(&bytes).unwrap_or_else(|e| panic!("{kind} {order}: {e}"));
                assert_eq!(other.triangles, soup.triangles, "{kind} {order}");
                assert!((0..4).all(|v| other.positions.get(v) == soup.positions.get(v)), "{kind} {order}");
                for end in 0..bytes.len() {
                    assert!(read(&bytes[..end]).is_err(), "cut at {end}");
                }
            }
        }
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
        let text = text.replace("property list uchar int vertex_indices\nproperty list uchar float other\n", "");
        assert!(read(text.as_bytes()).expect_err("no faces").to_string().contains("point cloud"));
    }

    #[test]
    fn a_header_of_lines_that_end_in_cr_takes_no_byte_of_the_data() {
        let mut bytes = HEADER.replace('\n', "\r").into_bytes();
        bytes.splice(0..0, *b"ply\rformat binary_little_endian 1.0\r");
        for x in [f32::from_le_bytes(*b"\n\0\0\x40"), 1.0, 1.0, 0.0] {
            bytes.extend([x, x * x, 0.0].into_iter().flat_map(f32::to_le_bytes).chain([9]));
        }
        bytes.extend(
            [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 0].iter().chain(&[3, 0, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 0]),
        );
        let soup = read(&bytes).expect("readable");
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(soup.positions.get(0).x, f64::from(f32::from_le_bytes(*b"\n\0\0\x40")));
    }
}
