//! The shapes that nearly all binary PLY files have, read row by row instead of value by value:
//! vertices without lists, and faces with one list of whole numbers.

use super::values::{Element, Scalar, Values};
use crate::error::ParseError;
use crate::io::polygons::Polygons;

/// The coordinates at `offsets` of each row.
pub(super) fn points(rows: &[u8], stride: usize, big: bool, offsets: [(usize, Scalar); 3]) -> Vec<[f64; 3]> {
    let read = |row: &[u8]| offsets.map(|(at, scalar)| scalar.decode(&row[at..at + scalar.size()], big));
    rows.chunks_exact(stride).map(read).collect()
}

/// The same for three 32-bit floats, which need no conversion.
pub(super) fn points_f32(rows: &[u8], stride: usize, big: bool, offsets: [usize; 3]) -> Vec<[f32; 3]> {
    if big {
        floats(rows, stride, offsets, f32::from_be_bytes)
    } else {
        floats(rows, stride, offsets, f32::from_le_bytes)
    }
}

fn floats(rows: &[u8], stride: usize, offsets: [usize; 3], float: impl Fn([u8; 4]) -> f32) -> Vec<[f32; 3]> {
    let [x, y, z] = offsets;
    // Most often the three follow one another.
    if (y, z) == (x + 4, x + 8) {
        let point = |row: &[u8]| {
            row[x..].first_chunk::<12>().map_or([0.0; 3], |point| {
                let (values, _) = point.as_chunks::<4>();
                [float(values[0]), float(values[1]), float(values[2])]
            })
        };
        return rows.chunks_exact(stride).map(point).collect();
    }
    let read = |row: &[u8]| offsets.map(|at| row[at..].first_chunk().map_or(0.0, |&bytes| float(bytes)));
    rows.chunks_exact(stride).map(read).collect()
}

/// Reads faces; `None` where the element is of another shape, which leaves `values` as they were.
pub(super) fn faces(
    element: &Element,
    list: usize,
    values: &mut Values<'_>,
    polygons: &mut Polygons,
) -> Option<Result<(), ParseError>> {
    let Values::Binary { bytes, at, big } = values else { return None };
    let (before, after) = (&element.properties[..list], &element.properties[list + 1..]);
    if before.iter().chain(after).any(|property| property.list.is_some()) {
        return None;
    }
    let [before, after] = [before, after].map(|list| list.iter().map(|property| property.scalar.size()).sum::<usize>());
    let length = element.properties[list].list?;
    let (bytes, big) = (*bytes, *big);
    let scalar = element.properties[list].scalar;
    let fast = Triangles::of(before, length, scalar, after);
    let mut left = element.count;
    let mut read = |size: usize, corners: &dyn Fn(&[u8], &mut Polygons) -> Option<()>| {
        while left > 0 {
            if let Some(fast) = &fast {
                let rows = &bytes[*at..];
                let (faces, used) = if big {
                    fast.read(rows, left, polygons, u32::from_be_bytes)
                } else {
                    fast.read(rows, left, polygons, u32::from_le_bytes)
                };
                (left, *at) = (left - faces, *at + used);
                if left == 0 {
                    break;
                }
            }
            let failed = |at: usize, what: &str| Err(ParseError::byte(at as u64, what));
            let start = *at + before;
            let Some(raw) = bytes.get(start..start + length.size()) else {
                return failed(*at, "the file ends before its last value");
            };
            let count = length.decode(raw, big);
            let from = start + length.size();
            let fits = count >= 0.0 && count * size as f64 + after as f64 <= (bytes.len() - from) as f64;
            if !fits {
                let what = format!("a list of {count} values does not fit into the file, which may be truncated");
                return Err(ParseError::byte(start as u64, what));
            }
            let to = from + count as usize * size;
            if corners(&bytes[from..to], polygons).is_none() {
                return failed(from, "a vertex number is below 0");
            }
            polygons.end_face();
            *at = to + after;
            left -= 1;
        }
        Ok(())
    };
    let result = match scalar {
        Scalar::I32 => read(4, &|raw, polygons| add(raw, polygons, |b| swap(b, big, i32::from_le_bytes).into())),
        Scalar::U32 => read(4, &|raw, polygons| add(raw, polygons, |b| swap(b, big, u32::from_le_bytes).into())),
        Scalar::I16 => read(2, &|raw, polygons| add(raw, polygons, |b| swap(b, big, i16::from_le_bytes).into())),
        Scalar::U16 => read(2, &|raw, polygons| add(raw, polygons, |b| swap(b, big, u16::from_le_bytes).into())),
        _ => return None,
    };
    Some(result)
}

/// The row that nearly every face of nearly every file has: a byte that says three, and three 32-bit
/// numbers.
struct Triangles {
    /// Bytes in front of the list.
    before: usize,
    /// Bytes of a row.
    row: usize,
    /// The largest number that is not negative.
    largest: u32,
}

impl Triangles {
    fn of(before: usize, length: Scalar, scalar: Scalar, after: usize) -> Option<Self> {
        let largest = match scalar {
            Scalar::I32 => i32::MAX as u32,
            Scalar::U32 => u32::MAX,
            _ => return None,
        };
        let row = before + 13 + after;
        matches!(length, Scalar::U8 | Scalar::I8).then_some(Triangles { before, row, largest })
    }

    /// Adds faces up to the first that is no triangle, or not one that makes sense; tells how many
    /// there were and the bytes they took.
    fn read(&self, bytes: &[u8], most: u64, polygons: &mut Polygons, number: impl Fn([u8; 4]) -> u32) -> (u64, usize) {
        let rows = bytes.chunks_exact(self.row).take(usize::try_from(most).unwrap_or(usize::MAX));
        polygons.reserve(rows.len());
        let mut faces = 0;
        for row in rows {
            let Some((&[3, ref corners @ ..], _)) = row[self.before..].split_first_chunk::<13>() else { break };
            let (corners, _) = corners.as_chunks::<4>();
            let corners = [number(corners[0]), number(corners[1]), number(corners[2])];
            if corners.iter().any(|&corner| corner > self.largest) {
                break;
            }
            polygons.triangle(corners);
            faces += 1;
        }
        (faces, faces as usize * self.row)
    }
}

#[inline]
fn swap<const N: usize, T>(mut bytes: [u8; N], big: bool, convert: impl Fn([u8; N]) -> T) -> T {
    if big {
        bytes.reverse();
    }
    convert(bytes)
}

/// Adds the corners of a face; `None` where one is negative.
#[inline]
fn add<const N: usize>(raw: &[u8], polygons: &mut Polygons, convert: impl Fn([u8; N]) -> i64) -> Option<()> {
    for &bytes in raw.as_chunks::<N>().0 {
        polygons.corner(u32::try_from(convert(bytes)).ok()?);
    }
    Some(())
}
