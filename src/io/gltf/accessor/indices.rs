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

    pub(super) fn into_list(self) -> Vec<u32> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }
}
