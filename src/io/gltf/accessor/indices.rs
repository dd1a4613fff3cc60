//! Unsigned integers: the indices of a primitive or of a sparse accessor.

use crate::error::ParseError;
use crate::io::gltf::buffers::Elements;
use gltf_json::accessor::ComponentType;

/// Unsigned integers: the indices of a primitive or of a sparse accessor.
pub(in crate::io::gltf) enum Indices<'b> {
    U8(Elements<'b>),
    U16(Elements<'b>),
    U32(Elements<'b>),
    /// From a sparse accessor, whose values stand in two places.
    List(Vec<u32>),
}

impl<'b> Indices<'b> {
    pub(super) fn new(component: ComponentType, elements: Elements<'b>, path: &str) -> Result<Self, ParseError> {
        match component {
            ComponentType::U8 => Ok(Indices::U8(elements)),
            ComponentType::U16 => Ok(Indices::U16(elements)),
            ComponentType::U32 => Ok(Indices::U32(elements)),
            _ => {
                let what = "indices must be unsigned integers: 5121, 5123 or 5125";
                Err(ParseError::json(format!("{path}.componentType"), what))
            }
        }
    }

    /// Number of indices.
    pub(in crate::io::gltf) fn len(&self) -> usize {
        match self {
            Indices::U8(e) | Indices::U16(e) | Indices::U32(e) => e.len(),
            Indices::List(list) => list.len(),
        }
    }

    /// An index. Panics when `i >= len()`.
    #[inline]
    pub(in crate::io::gltf) fn get(&self, i: usize) -> u32 {
        match self {
            Indices::U8(e) => u32::from(e.get(i)[0]),
            Indices::U16(e) => e.get(i).first_chunk().map_or(0, |&b| u32::from(u16::from_le_bytes(b))),
            Indices::U32(e) => e.get(i).first_chunk().map_or(0, |&b| u32::from_le_bytes(b)),
            Indices::List(list) => list[i],
        }
    }

    /// Appends them three by three, which goes fast where they lie side by side; false where they do
    /// not, and nothing is appended.
    pub(in crate::io::gltf) fn append_triangles_to(&self, out: &mut Vec<[u32; 3]>) -> bool {
        fn append<const N: usize>(
            elements: &Elements<'_>,
            out: &mut Vec<[u32; 3]>,
            number: impl Fn([u8; N]) -> u32,
        ) -> bool {
            let Some(bytes) = elements.side_by_side() else { return false };
            let (corners, _) = bytes.as_chunks::<N>();
            let (triangles, _) = corners.as_chunks::<3>();
            out.extend(triangles.iter().map(|&[a, b, c]| [number(a), number(b), number(c)]));
            true
        }
        match self {
            Indices::U8(e) => append(e, out, |[byte]| u32::from(byte)),
            Indices::U16(e) => append(e, out, |b| u32::from(u16::from_le_bytes(b))),
            Indices::U32(e) => append(e, out, u32::from_le_bytes),
            Indices::List(_) => false,
        }
    }

    pub(super) fn into_list(self) -> Vec<u32> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }
}
