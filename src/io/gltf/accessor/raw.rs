//! The elements of an accessor as bytes.

use super::Array;
use crate::error::ParseError;
use crate::io::gltf::buffers::Elements;

/// The elements of an accessor as bytes, sparse substitutions made.
pub(in crate::io::gltf) struct Raw<'b> {
    zero: Vec<u8>,
    base: Option<Elements<'b>>,
    /// Element and the number of the value that replaces it, by element.
    replaced: Vec<(u32, usize)>,
    values: Option<Elements<'b>>,
}

impl Raw<'_> {
    /// The bytes of an element. Panics when `i` is not below the accessor's count.
    #[inline]
    pub(in crate::io::gltf) fn get(&self, i: u32) -> &[u8] {
        if let Some(values) = &self.values {
            let after = self.replaced.partition_point(|&(place, _)| place <= i);
            if let Some(&(place, value)) = after.checked_sub(1).and_then(|last| self.replaced.get(last))
                && place == i
            {
                return values.get(value);
            }
        }
        match &self.base {
            Some(base) => base.get(i as usize),
            None => &self.zero,
        }
    }
}

impl<'b> Array<'b> {
    /// The bytes of all elements, to be looked up by number.
    pub(in crate::io::gltf) fn raw(self) -> Result<Raw<'b>, ParseError> {
        let mut replaced = Vec::new();
        if let Some((places, values)) = self.sparse {
            for i in 0..places.len() {
                let place = places.get(i);
                if place as usize >= self.count {
                    let what = format!("replaces element {place}, but the accessor has only {}", self.count);
                    return Err(ParseError::json(format!("{}.sparse.indices", self.path), what));
                }
                replaced.push((place, i));
            }
            // Stable, so that of several replacements the last comes last.
            replaced.sort_by_key(|&(place, _)| place);
            return Ok(Raw { zero: vec![0; self.size], base: self.base, replaced, values: Some(values) });
        }
        Ok(Raw { zero: vec![0; self.size], base: self.base, replaced, values: None })
    }
}
