//! The elements of an accessor as vectors of 32-bit floats.

use super::Array;
use crate::error::ParseError;
use crate::io::gltf::buffers::Elements;
use gltf_json::accessor::ComponentType;

impl Array<'_> {
    /// Decodes all elements of a vector array onto the end of `out`.
    ///
    /// 32-bit floats keep their bits, NaN payloads included. Integers become floats by the
    /// formulas of the specification (section 3.6.2.2); only 32-bit ones, which no extension
    /// allows for positions, may be rounded.
    pub(in crate::io::gltf) fn append_to(&self, out: &mut Vec<[f32; 3]>) -> Result<(), ParseError> {
        let start = out.len();
        match self.base {
            Some(base) => self.decode(base, out),
            None => out.resize(start + self.count, [0.0; 3]),
        }
        if let Some((places, values)) = &self.sparse {
            let mut decoded = Vec::new();
            self.decode(*values, &mut decoded);
            for (i, value) in decoded.into_iter().enumerate() {
                *self.slot(&mut out[start..], places, i)? = value;
            }
        }
        Ok(())
    }

    fn decode(&self, elements: Elements<'_>, out: &mut Vec<[f32; 3]>) {
        match (self.component, self.normalized) {
            (ComponentType::F32, _) => extend(out, elements, f32::from_le_bytes),
            (ComponentType::I8, false) => extend(out, elements, |b| f32::from(i8::from_le_bytes(b))),
            (ComponentType::U8, false) => extend(out, elements, |b| f32::from(u8::from_le_bytes(b))),
            (ComponentType::I16, false) => extend(out, elements, |b| f32::from(i16::from_le_bytes(b))),
            (ComponentType::U16, false) => extend(out, elements, |b| f32::from(u16::from_le_bytes(b))),
            (ComponentType::U32, false) => extend(out, elements, |b| u32::from_le_bytes(b) as f32),
            (ComponentType::I8, true) => extend(out, elements, |b| (f32::from(i8::from_le_bytes(b)) / 127.0).max(-1.0)),
            (ComponentType::U8, true) => extend(out, elements, |b| f32::from(u8::from_le_bytes(b)) / 255.0),
            (ComponentType::I16, true) => {
                extend(out, elements, |b| (f32::from(i16::from_le_bytes(b)) / 32767.0).max(-1.0));
            }
            (ComponentType::U16, true) => extend(out, elements, |b| f32::from(u16::from_le_bytes(b)) / 65535.0),
            (ComponentType::U32, true) => {
                extend(out, elements, |b| (f64::from(u32::from_le_bytes(b)) / f64::from(u32::MAX)) as f32);
            }
        }
    }
}

/// Appends vectors whose components take N bytes each.
fn extend<const N: usize>(out: &mut Vec<[f32; 3]>, elements: Elements<'_>, convert: impl Fn([u8; N]) -> f32) {
    let vector = |parts: &[[u8; N]]| [convert(parts[0]), convert(parts[1]), convert(parts[2])];
    if let Some(bytes) = elements.side_by_side() {
        let (vectors, _) = bytes.as_chunks::<N>().0.as_chunks::<3>();
        out.extend(vectors.iter().map(|parts| vector(parts)));
    } else {
        out.extend(elements.iter().map(|element| vector(element.as_chunks::<N>().0)));
    }
}
