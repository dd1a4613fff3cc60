//! Accessors: typed arrays over buffer views, with sparse substitutions.

use super::buffers::{Buffers, Elements, Run};
use crate::error::ParseError;
use gltf_json::accessor::{Accessor, ComponentType, Type};
use gltf_json::{Index, buffer::View, validation::Checked};

/// An accessor without a buffer view is all zeros and takes no bytes of the file, whatever its
/// count. Up to this count that is allowed for nothing.
const FREE_ZEROS: usize = 1 << 16;

/// The accessors of a document.
pub(super) struct Accessors<'a> {
    accessors: &'a [Accessor],
    buffers: Buffers<'a>,
}

/// The elements of an accessor, found and checked but not yet decoded.
pub(super) struct Array<'b> {
    path: String,
    component: ComponentType,
    normalized: bool,
    count: usize,
    size: usize,
    base: Option<Elements<'b>>,
    sparse: Option<(Indices<'b>, Elements<'b>)>,
}

/// The elements of an accessor as bytes, sparse substitutions made.
pub(super) struct Raw<'b> {
    zero: Vec<u8>,
    base: Option<Elements<'b>>,
    /// Element and the number of the value that replaces it, by element.
    replaced: Vec<(u32, usize)>,
    values: Option<Elements<'b>>,
}

impl Raw<'_> {
    /// The bytes of an element. Panics when `i` is not below the accessor's count.
    #[inline]
    pub(super) fn get(&self, i: u32) -> &[u8] {
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

/// Bytes of an element. Columns of matrices begin at multiples of 4 (specification, 3.6.2.4).
fn element_size(component: ComponentType, shape: Type) -> usize {
    let size = component.size();
    let columns = match shape {
        Type::Mat2 => 2,
        Type::Mat3 => 3,
        Type::Mat4 => 4,
        _ => return size * shape.multiplicity(),
    };
    columns * (size * columns).next_multiple_of(4)
}

/// Unsigned integers: the indices of a primitive or of a sparse accessor.
pub(super) enum Indices<'b> {
    U8(Elements<'b>),
    U16(Elements<'b>),
    U32(Elements<'b>),
    /// From a sparse accessor, whose values stand in two places.
    List(Vec<u32>),
}

impl<'a> Accessors<'a> {
    pub(super) fn new(accessors: &'a [Accessor], buffers: Buffers<'a>) -> Self {
        Accessors { accessors, buffers }
    }

    /// Bytes read so far: what a document may reasonably be expanded from.
    pub(super) fn bytes_at_hand(&self) -> usize {
        self.buffers.bytes_at_hand()
    }

    /// True when the accessor names no data at all, as those of compressed primitives do.
    pub(super) fn is_blank(&self, index: Index<Accessor>) -> bool {
        self.accessors.get(index.value()).is_some_and(|a| a.buffer_view.is_none() && a.sparse.is_none())
    }

    /// The vectors of an accessor. `from` is the JSON path of the reference to it.
    pub(super) fn vectors(&self, index: Index<Accessor>, from: &str) -> Result<Array<'_>, ParseError> {
        self.array(index, from, Some(Type::Vec3))
    }

    /// The elements of an accessor of any type. `from` is the JSON path of the reference to it.
    pub(super) fn any(&self, index: Index<Accessor>, from: &str) -> Result<Array<'_>, ParseError> {
        self.array(index, from, None)
    }

    /// The buffers behind the accessors.
    pub(super) fn buffers(&self) -> &Buffers<'a> {
        &self.buffers
    }

    /// The vertex indices of a primitive. `from` is the JSON path of the reference to them.
    pub(super) fn indices(&self, index: Index<Accessor>, from: &str) -> Result<Indices<'_>, ParseError> {
        let array = self.array(index, from, Some(Type::Scalar))?;
        if let (Some(base), None) = (array.base, &array.sparse) {
            return Indices::new(array.component, base, &array.path);
        }
        let mut list = match array.base {
            Some(base) => Indices::new(array.component, base, &array.path)?.into_list(),
            None => vec![0; array.count],
        };
        if let Some((places, values)) = &array.sparse {
            let values = Indices::new(array.component, *values, &array.path)?;
            for i in 0..places.len() {
                *array.slot(&mut list, places, i)? = values.get(i);
            }
        }
        Ok(Indices::List(list))
    }

    fn array(&self, index: Index<Accessor>, from: &str, wanted: Option<Type>) -> Result<Array<'_>, ParseError> {
        let index = index.value();
        let accessor = self.accessors.get(index).ok_or_else(|| {
            ParseError::json(from, format!("there is no accessor {index} among {}", self.accessors.len()))
        })?;
        let path = format!("accessors[{index}]");
        let Checked::Valid(component) = accessor.component_type else {
            let what = "must be one of 5120, 5121, 5122, 5123, 5125 and 5126";
            return Err(ParseError::json(format!("{path}.componentType"), what));
        };
        let shape = match accessor.type_ {
            Checked::Valid(found) if wanted.is_none_or(|wanted| found == wanted) => found,
            _ => {
                let name = match wanted {
                    Some(Type::Vec3) => "VEC3",
                    Some(_) => "SCALAR",
                    None => "one of SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 and MAT4",
                };
                return Err(ParseError::json(format!("{path}.type"), format!("must be {name} for {from}")));
            }
        };
        let component = component.0;
        let size = element_size(component, shape);
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        let count_path = format!("{path}.count");
        let elements = |view: Index<View>, offset, size, count, path: &str, count_path: &str| {
            self.buffers.elements(&Run { view, offset, size, count, path, count_path })
        };

        let base = accessor
            .buffer_view
            .map(|view| elements(view, offset, size, accessor.count.0, &path, &count_path))
            .transpose()?;
        let sparse = match &accessor.sparse {
            None => None,
            Some(sparse) => {
                let count_path = format!("{path}.sparse.count");
                let path = format!("{path}.sparse.indices");
                let Checked::Valid(kind) = sparse.indices.component_type else {
                    return Err(ParseError::json(
                        format!("{path}.componentType"),
                        "must be one of 5121, 5123 and 5125",
                    ));
                };
                let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset.0);
                let places = elements(view, offset, kind.0.size(), sparse.count.0, &path, &count_path)?;
                let places = Indices::new(kind.0, places, &path)?;
                let path = format!("accessors[{index}].sparse.values");
                let (view, offset) = (sparse.values.buffer_view, sparse.values.byte_offset.0);
                Some((places, elements(view, offset, size, sparse.count.0, &path, &count_path)?))
            }
        };
        let count = match &base {
            Some(base) => base.len(),
            // Every vertex that a face uses takes a byte of indices at least, so that zeros beyond
            // the size of the input serve nobody but an attacker.
            None => usize::try_from(accessor.count.0)
                .ok()
                .filter(|&count| count <= FREE_ZEROS.max(self.bytes_at_hand()))
                .ok_or_else(|| {
                    let what = format!("{} elements without any data are more than the file can use", accessor.count.0);
                    ParseError::json(count_path, what)
                })?,
        };
        Ok(Array { path, component, normalized: accessor.normalized, count, size, base, sparse })
    }
}

impl<'b> Array<'b> {
    /// Number of elements.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// Bytes of one element.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// The bytes of all elements, to be looked up by number.
    pub(super) fn raw(self) -> Result<Raw<'b>, ParseError> {
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

    /// Decodes all elements of a vector array onto the end of `out`.
    ///
    /// 32-bit floats keep their bits, NaN payloads included. Integers become floats by the
    /// formulas of the specification (section 3.6.2.2); only 32-bit ones, which no extension
    /// allows for positions, may be rounded.
    pub(super) fn append_to(&self, out: &mut Vec<[f32; 3]>) -> Result<(), ParseError> {
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

    /// The element that the sparse index at `i` replaces.
    fn slot<'v, T>(&self, values: &'v mut [T], places: &Indices<'_>, i: usize) -> Result<&'v mut T, ParseError> {
        let place = places.get(i);
        let slot = usize::try_from(place).ok().and_then(|place| values.get_mut(place));
        slot.ok_or_else(|| {
            let what = format!("replaces element {place}, but the accessor has only {}", self.count);
            ParseError::json(format!("{}.sparse.indices", self.path), what)
        })
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

impl<'b> Indices<'b> {
    fn new(component: ComponentType, elements: Elements<'b>, path: &str) -> Result<Self, ParseError> {
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
    pub(super) fn len(&self) -> usize {
        match self {
            Indices::U8(e) | Indices::U16(e) | Indices::U32(e) => e.len(),
            Indices::List(list) => list.len(),
        }
    }

    /// An index. Panics when `i >= len()`.
    #[inline]
    pub(super) fn get(&self, i: usize) -> u32 {
        match self {
            Indices::U8(e) => u32::from(e.get(i)[0]),
            Indices::U16(e) => e.get(i).first_chunk().map_or(0, |&b| u32::from(u16::from_le_bytes(b))),
            Indices::U32(e) => e.get(i).first_chunk().map_or(0, |&b| u32::from_le_bytes(b)),
            Indices::List(list) => list[i],
        }
    }

    /// Appends them three by three, which goes fast where they lie side by side; false where they do
    /// not, and nothing is appended.
    pub(super) fn append_triangles_to(&self, out: &mut Vec<[u32; 3]>) -> bool {
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

    fn into_list(self) -> Vec<u32> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::buffers::Source;
    use super::*;
    use serde_json::{Value, json};

    /// Calls `check` with the accessor, over views that each cover the whole of `bin`.
    fn with<T>(accessor: &Value, bin: &[u8], check: impl FnOnce(&Accessors<'_>) -> T) -> T {
        let length = bin.len();
        let buffers = [serde_json::from_str(&json!({ "byteLength": length }).to_string()).expect("a buffer")];
        let views: Vec<View> = [None, Some(16)]
            .map(|stride: Option<u32>| json!({ "buffer": 0, "byteLength": length, "byteStride": stride }))
            .iter()
            .map(|view| serde_json::from_str(&view.to_string()).expect("a view"))
            .collect();
        let accessors = [serde_json::from_str(&accessor.to_string()).expect("an accessor")];
        let source = Source { file: bin, bin: Some(bin), folders: crate::io::folders::Folders::default() };
        check(&Accessors::new(&accessors, Buffers::new(&buffers, &views, false, source)))
    }

    fn vectors(accessor: &Value, bin: &[u8]) -> Result<Vec<[f32; 3]>, ParseError> {
        with(accessor, bin, |accessors| {
            let mut out = vec![[9.0; 3]];
            accessors.vectors(Index::new(0), "here")?.append_to(&mut out)?;
            assert_eq!(out.remove(0), [9.0; 3], "what stood there before stays");
            Ok(out)
        })
    }

    fn indices(accessor: &Value, bin: &[u8]) -> Result<Vec<u32>, ParseError> {
        with(accessor, bin, |accessors| accessors.indices(Index::new(0), "here").map(Indices::into_list))
    }

    fn floats(values: &[f32]) -> Vec<u8> {
        values.iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    #[test]
    fn floats_keep_their_bits() {
        let bits = [0x7fc0_1234, 0x8000_0000, 0x0000_0001, 0x7f80_0000, 0xffa0_0001, 0x3f80_0000u32];
        let bin: Vec<u8> = bits.iter().flat_map(|b| b.to_le_bytes()).collect();
        let read = vectors(&json!({ "bufferView": 0, "componentType": 5126, "count": 2, "type": "VEC3" }), &bin);
        assert_eq!(read.expect("readable").as_flattened().iter().map(|v| v.to_bits()).collect::<Vec<_>>(), bits);
    }

    #[test]
    fn interleaved_vectors_are_found() {
        let bin = floats(&[9.0, 1.0, 2.0, 3.0, 9.0, 4.0, 5.0, 6.0]);
        let accessor = json!({ "bufferView": 1, "byteOffset": 4, "componentType": 5126, "count": 2, "type": "VEC3" });
        assert_eq!(vectors(&accessor, &bin).expect("readable"), [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    }

    #[test]
    fn integers_become_floats_as_the_specification_says() {
        for (component, normalized, bin, expected) in [
            (5120, false, &[0x80, 0, 127][..], [-128.0, 0.0, 127.0]),
            (5120, true, &[0x80, 0x81, 127], [-1.0, -1.0, 1.0]),
            (5121, false, &[0, 128, 255], [0.0, 128.0, 255.0]),
            (5121, true, &[0, 51, 255], [0.0, 0.2, 1.0]),
            (5122, false, &[0, 0x80, 1, 0, 0xff, 0x7f], [-32768.0, 1.0, 32767.0]),
            (5122, true, &[0, 0x80, 1, 0, 0xff, 0x7f], [-1.0, 1.0 / 32767.0, 1.0]),
            (5123, false, &[0, 0, 1, 0, 0xff, 0xff], [0.0, 1.0, 65535.0]),
            (5123, true, &[0, 0, 1, 0, 0xff, 0xff], [0.0, 1.0 / 65535.0, 1.0]),
            (5125, false, &[0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x80], [0.0, 1.0, 2_147_483_648.0]),
            (5125, true, &[0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0x80], [0.0, 1.0, 0.5]),
        ] {
            let accessor = json!({ "bufferView": 0, "componentType": component, "normalized": normalized, "count": 1, "type": "VEC3" });
            assert_eq!(vectors(&accessor, bin).expect("readable"), [expected], "{component} {normalized}");
        }
    }

    #[test]
    fn indices_come_in_three_widths() {
        for (component, bin) in
            [(5121, &[7, 255, 0][..]), (5123, &[7, 0, 255, 0, 0, 0]), (5125, &[7, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0])]
        {
            let accessor = json!({ "bufferView": 0, "componentType": component, "count": 3, "type": "SCALAR" });
            assert_eq!(indices(&accessor, bin).expect("readable"), [7, 255, 0]);
        }
    }

    fn sparse(base: Option<u32>, count: u64, replaced: u64) -> Value {
        json!({ "bufferView": base, "byteOffset": 8, "componentType": 5126, "count": count, "type": "VEC3", "sparse": {
            "count": replaced,
            "indices": { "bufferView": 0, "byteOffset": 0, "componentType": 5123 },
            "values": { "bufferView": 0, "byteOffset": 32 }
        }})
    }

    #[test]
    fn sparse_values_replace_those_of_the_base_or_zeros() {
        let mut bin = vec![1, 0, 2, 0, 0, 0, 0, 0];
        bin.extend(floats(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]));
        let read = vectors(&sparse(Some(0), 3, 2), &bin).expect("readable");
        assert_eq!(read, [[1.0, 2.0, 3.0], [7.0, 8.0, 9.0], [10.0, 11.0, 12.0]]);
        let read = vectors(&sparse(None, 4, 1), &bin).expect("readable");
        assert_eq!(read, [[0.0; 3], [7.0, 8.0, 9.0], [0.0; 3], [0.0; 3]]);
        let error = vectors(&sparse(None, 2, 2), &bin).expect_err("element 2 of 2");
        assert!(error.to_string().starts_with("accessors[0].sparse.indices: "), "{error}");
        assert!(vectors(&sparse(None, 4, 3), &bin).expect_err("two values").to_string().contains("sparse.count"));
    }

    #[test]
    fn sparse_indices_are_read_too() {
        let accessor = json!({ "bufferView": 0, "componentType": 5121, "count": 3, "type": "SCALAR", "sparse": {
            "count": 1,
            "indices": { "bufferView": 0, "byteOffset": 3, "componentType": 5121 },
            "values": { "bufferView": 0, "byteOffset": 4 }
        }});
        assert_eq!(indices(&accessor, &[5, 6, 7, 2, 99]).expect("readable"), [5, 6, 99]);
    }

    #[test]
    fn zeros_are_bounded_by_the_size_of_the_input() {
        let zeros = |count: u64| json!({ "componentType": 5126, "count": count, "type": "VEC3" });
        assert_eq!(vectors(&zeros(3), &[]).expect("readable"), [[0.0; 3]; 3]);
        for count in [70_000, 1 << 40, u64::MAX] {
            assert!(vectors(&zeros(count), &[]).expect_err("huge").to_string().starts_with("accessors[0].count: "));
        }
        assert_eq!(vectors(&zeros(70_000), &[0; 70_000]).expect("readable").len(), 70_000);
        let flat = json!({ "componentType": 5125, "count": u64::MAX, "type": "SCALAR" });
        assert!(indices(&flat, &[]).is_err());
    }

    #[test]
    fn wrong_types_are_named_by_their_path() {
        let accessor = |component: u32, kind: &str| json!({ "bufferView": 0, "componentType": component, "count": 1, "type": kind });
        for (result, path) in [
            (vectors(&accessor(5124, "VEC3"), &[0; 24]), "accessors[0].componentType"),
            (vectors(&accessor(5126, "VEC2"), &[0; 24]), "accessors[0].type"),
            (vectors(&accessor(5126, "vec3"), &[0; 24]), "accessors[0].type"),
            (indices(&accessor(5126, "SCALAR"), &[0; 24]).map(|_| Vec::new()), "accessors[0].componentType"),
            (indices(&accessor(5122, "SCALAR"), &[0; 24]).map(|_| Vec::new()), "accessors[0].componentType"),
        ] {
            let error = result.expect_err(path);
            assert!(error.to_string().starts_with(&format!("{path}: ")), "{error}");
        }
        let gone =
            with(&accessor(5126, "VEC3"), &[], |a| a.vectors(Index::new(7), "here").err()).expect("no accessor 7");
        assert!(gone.to_string().starts_with("here: "));
    }
}
