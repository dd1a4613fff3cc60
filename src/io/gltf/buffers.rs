//! The bytes behind a glTF document: the BIN chunk, data URIs and external files.
//!
//! A buffer is loaded when the first accessor asks for it, so that the images and animations of a
//! large scene are never read.

use super::meshopt::{self, is_compressed};
use super::uri::{decode_data_uri, find_external, is_data, read_external};
use crate::error::ParseError;
use crate::io::folders::Folders;
use gltf_json::{Buffer, Index, buffer::View};
use std::borrow::Cow;
use std::cell::{Cell, OnceCell, RefCell};
use std::collections::HashMap;
use std::path::PathBuf;

/// Where the bytes of buffers can come from.
pub(super) struct Source<'a> {
    /// The whole input file.
    pub(super) file: &'a [u8],
    /// The BIN chunk of a GLB.
    pub(super) bin: Option<&'a [u8]>,
    /// Where external files may be.
    pub(super) folders: Folders<'a>,
}

/// The buffers and buffer views of a document.
pub(super) struct Buffers<'a> {
    buffers: &'a [Buffer],
    views: &'a [View],
    source: Source<'a>,
    meshopt_required: bool,
    loaded: Vec<OnceCell<Cow<'a, [u8]>>>,
    /// The buffer that holds the bytes of each: another one where both name the same file, which is
    /// in memory once however many do.
    holders: Vec<Cell<usize>>,
    /// Files that were read, and the buffers that hold them.
    files: RefCell<HashMap<PathBuf, usize>>,
    /// Views that were compressed.
    decoded: Vec<OnceCell<Vec<u8>>>,
    /// Bytes of all decoded views.
    decoded_bytes: Cell<usize>,
}

/// What compressed views may always expand to together, and beyond that for each byte of input.
/// Positions shrink to a tenth, constant ones to a thousandth.
const FREE_DECODED: usize = 8 << 20;
const MOST_EXPANSION: usize = 50;

/// Equally spaced elements in a buffer, all inside the bytes that are really there.
#[derive(Clone, Copy)]
pub(super) struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    /// Number of elements.
    pub(super) fn len(&self) -> usize {
        self.count
    }

    /// The bytes of an element. Panics when `index >= len()`.
    #[inline]
    pub(super) fn get(&self, index: usize) -> &'a [u8] {
        let start = index * self.stride;
        &self.bytes[start..start + self.size]
    }

    /// The bytes of all elements where there are none between them.
    pub(super) fn side_by_side(&self) -> Option<&'a [u8]> {
        (self.stride == self.size).then_some(self.bytes)
    }

    /// The bytes of all elements in order.
    pub(super) fn iter(self) -> impl Iterator<Item = &'a [u8]> {
        // The last chunk is as short as an element; the others may have a gap behind it.
        self.bytes.chunks(self.stride).map(move |chunk| &chunk[..self.size])
    }
}

/// A run of elements that an accessor asks for, and where it says so.
pub(super) struct Run<'p> {
    /// The view to read.
    pub(super) view: Index<View>,
    /// Byte offset of the first element in the view.
    pub(super) offset: u64,
    /// Bytes of one element, at least 1.
    pub(super) size: usize,
    /// Number of elements.
    pub(super) count: u64,
    /// JSON path of the object with `bufferView` and `byteOffset`.
    pub(super) path: &'p str,
    /// JSON path of the count.
    pub(super) count_path: &'p str,
}

impl<'a> Buffers<'a> {
    /// `meshopt_required` says that compressed views have no other content to fall back on.
    pub(super) fn new(buffers: &'a [Buffer], views: &'a [View], meshopt_required: bool, source: Source<'a>) -> Self {
        let loaded = buffers.iter().map(|_| OnceCell::new()).collect();
        let decoded = views.iter().map(|_| OnceCell::new()).collect();
        let holders = (0..buffers.len()).map(Cell::new).collect();
        let (files, decoded_bytes) = (RefCell::default(), Cell::new(0));
        Buffers { buffers, views, source, meshopt_required, loaded, holders, files, decoded, decoded_bytes }
    }

    /// Bytes read so far: what a document may reasonably be expanded from.
    pub(super) fn bytes_at_hand(&self) -> usize {
        let loaded = self.loaded.iter().filter_map(OnceCell::get);
        let owned = loaded.filter(|bytes| matches!(bytes, Cow::Owned(_))).map(|bytes| bytes.len());
        owned.fold(self.source.file.len(), usize::saturating_add)
    }

    /// The elements of a run, checked against view and buffer.
    pub(super) fn elements(&self, run: &Run<'_>) -> Result<Elements<'_>, ParseError> {
        let index = run.view.value();
        let view = self.views.get(index).ok_or_else(|| {
            let views = self.views.len();
            ParseError::json(
                format!("{}.bufferView", run.path),
                format!("there is no buffer view {index} among {views}"),
            )
        })?;
        let stride = match view.byte_stride {
            None => run.size,
            Some(stride) if stride.0 == 0 => run.size,
            Some(stride) if stride.0 >= run.size => stride.0,
            Some(stride) => {
                let what = format!("a stride of {} bytes is less than the {} bytes of an element", stride.0, run.size);
                return Err(ParseError::json(format!("bufferViews[{index}].byteStride"), what));
            }
        };
        let too_long = || {
            let what = format!(
                "{} elements from byte {} at {stride} bytes each do not fit bufferViews[{index}], which has {} bytes",
                run.count, run.offset, view.byte_length.0
            );
            ParseError::json(run.count_path, what)
        };
        let count = usize::try_from(run.count).map_err(|_| too_long())?;
        if count == 0 {
            return Ok(Elements { bytes: &[], stride, size: run.size, count });
        }
        let span = (count - 1).checked_mul(stride).and_then(|gaps| gaps.checked_add(run.size)).ok_or_else(too_long)?;
        let end = run.offset.checked_add(span as u64).filter(|&end| end <= view.byte_length.0).ok_or_else(too_long)?;

        let (data, offset) = if self.needs_decoding(view) {
            (self.decoded(view, index)?, 0)
        } else {
            (self.data(view.buffer, index)?, view.byte_offset.map_or(0, |offset| offset.0))
        };
        let missing = || {
            let buffer = view.buffer.value();
            let what = format!(
                "the view's bytes are needed up to {end} from byte {offset}, but buffers[{buffer}] has only {} bytes",
                data.len()
            );
            ParseError::json(format!("bufferViews[{index}]"), what)
        };
        let start = offset.checked_add(run.offset).ok_or_else(missing)?;
        let start = usize::try_from(start).map_err(|_| missing())?;
        let end = start.checked_add(span).ok_or_else(missing)?;
        let bytes = data.get(start..end).ok_or_else(missing)?;
        Ok(Elements { bytes, stride, size: run.size, count })
    }

    /// Where there is a fallback that is not compressed, it says the same and needs no decoding.
    fn needs_decoding(&self, view: &View) -> bool {
        view.extensions.as_ref().is_some_and(|e| is_compressed(&e.others))
            && (self.meshopt_required || !self.has_data(view.buffer))
    }

    /// What a compressed view decodes to; `None` for a view whose bytes are at hand as they are.
    pub(super) fn unpacked(&self, view: usize) -> Result<Option<&[u8]>, ParseError> {
        match self.views.get(view).filter(|view| self.needs_decoding(view)) {
            Some(compressed) => self.decoded(compressed, view).map(Some),
            None => Ok(None),
        }
    }

    /// The bytes of a compressed view, decoded on the first call.
    fn decoded(&self, view: &View, index: usize) -> Result<&[u8], ParseError> {
        let cell = &self.decoded[index];
        if let Some(bytes) = cell.get() {
            return Ok(bytes);
        }
        let path = format!("bufferViews[{index}].extensions");
        let failed = |what: String| ParseError::json(&path, format!("the data is compressed with meshopt, but {what}"));
        let description = view.extensions.as_ref().and_then(|e| meshopt::description(&e.others));
        let compression = description.unwrap_or_else(|| Err("nothing says how".into())).map_err(failed)?;

        let data = self.data(Index::new(compression.buffer), index)?;
        let start = usize::try_from(compression.byte_offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(usize::try_from(compression.byte_length).unwrap_or(usize::MAX));
        let data = data.get(start..end).ok_or_else(|| {
            failed(format!("its bytes {start} to {end} are not in the buffer, which has {}", data.len()))
        })?;
        let limit = FREE_DECODED.max(self.bytes_at_hand().saturating_mul(MOST_EXPANSION));
        let total = compression.decoded_length().and_then(|length| length.checked_add(self.decoded_bytes.get()));
        let total = total.filter(|&total| total <= limit).ok_or_else(|| {
            failed(format!("it expands to more than {limit} bytes, which no mesh of the file's size does"))
        })?;
        let bytes = compression.decode(data).map_err(failed)?;
        self.decoded_bytes.set(total);
        Ok(cell.get_or_init(|| bytes))
    }

    /// True when the buffer says where its bytes are.
    fn has_data(&self, index: Index<Buffer>) -> bool {
        self.buffers.get(index.value()).is_some_and(|buffer| {
            let placeholder = buffer.extensions.as_ref().is_some_and(|e| is_compressed(&e.others));
            buffer.uri.is_some() || (index.value() == 0 && self.source.bin.is_some() && !placeholder)
        })
    }

    /// The bytes of a buffer, for a copy of the whole; `None` for one that only stands for what a
    /// compressed view decodes to.
    pub(super) fn whole(&self, index: usize) -> Result<Option<&[u8]>, ParseError> {
        let Some(buffer) = self.buffers.get(index) else { return Ok(None) };
        let is_placeholder = buffer.extensions.as_ref().is_some_and(|e| is_compressed(&e.others));
        if is_placeholder && buffer.uri.is_none() {
            return Ok(None);
        }
        self.data(Index::new(index as u32), 0).map(Some)
    }

    /// All bytes of a buffer, loaded on the first call.
    fn data(&self, index: Index<Buffer>, view: usize) -> Result<&[u8], ParseError> {
        let index = index.value();
        let (Some(buffer), Some(holder)) = (self.buffers.get(index), self.holders.get(index)) else {
            let what = format!("there is no buffer {index} among {}", self.buffers.len());
            return Err(ParseError::json(format!("bufferViews[{view}].buffer"), what));
        };
        if let Some(bytes) = self.loaded[holder.get()].get() {
            return Ok(bytes);
        }
        let failed = |what| ParseError::json(format!("buffers[{index}].uri"), what);
        let bytes = match (&buffer.uri, self.source.bin) {
            (Some(uri), _) if is_data(uri) => decode_data_uri(uri).map_err(failed)?,
            (Some(uri), _) => {
                let file = find_external(uri, self.source.folders).map_err(failed)?;
                let first = *self.files.borrow_mut().entry(file.clone()).or_insert(index);
                if let Some(bytes) = self.loaded[first].get() {
                    holder.set(first);
                    return Ok(bytes);
                }
                Cow::Owned(read_external(uri, &file).map_err(failed)?)
            }
            (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
            (None, _) => {
                let what =
                    "the buffer has no uri, and only the first buffer may be a GLB's BIN chunk, where there is one";
                return Err(ParseError::json(format!("buffers[{index}]"), what));
            }
        };
        Ok(self.loaded[index].get_or_init(|| bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gltf_json::validation::USize64;
    use serde_json::Value;

    fn buffers(value: Value) -> Vec<Buffer> {
        serde_json::from_value::<Vec<Value>>(value)
            .expect("an array")
            .iter()
            .map(|v| serde_json::from_str(&v.to_string()).expect("a buffer"))
            .collect()
    }

    fn view(text: &str) -> Vec<View> {
        vec![serde_json::from_str(text).expect("a view")]
    }

    fn run(offset: u64, size: usize, count: u64) -> Run<'static> {
        Run { view: Index::new(0), offset, size, count, path: "accessors[0]", count_path: "accessors[0].count" }
    }

    fn source(bin: &[u8]) -> Source<'_> {
        Source { file: bin, bin: Some(bin), folders: Folders::default() }
    }

    #[test]
    fn elements_keep_inside_view_and_buffer() {
        let buffers_list = buffers(serde_json::json!([{ "byteLength": 10 }]));
        let views = view(r#"{ "buffer": 0, "byteOffset": 2, "byteLength": 8, "byteStride": 4 }"#);
        let bin = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9];
        let all = Buffers::new(&buffers_list, &views, false, source(&bin));
        let elements = all.elements(&run(1, 2, 2)).expect("inside");
        assert_eq!(elements.iter().collect::<Vec<_>>(), [[3, 4], [7, 8]]);
        assert_eq!((elements.len(), elements.get(1)), (2, &[7, 8][..]));
        assert_eq!(all.elements(&run(u64::MAX, 2, 0)).expect("nothing asked for").iter().count(), 0);
        for (offset, size, count) in
            [(3, 2, 2), (0, 4, 3), (9, 1, 1), (0, 1, u64::MAX), (u64::MAX, 1, 1), (u64::MAX - 3, 4, 1 << 62)]
        {
            let error = all.elements(&run(offset, size, count)).err().expect("outside");
            assert!(error.to_string().starts_with("accessors[0].count: "), "{error}");
        }
        assert!(all.elements(&run(0, 8, 1)).err().expect("stride 4").to_string().contains("bufferViews[0].byteStride"));
    }

    #[test]
    fn a_short_buffer_matters_only_where_it_is_read() {
        let buffers_list = buffers(serde_json::json!([{ "byteLength": 100 }]));
        let mut views = view(r#"{ "buffer": 0, "byteLength": 100 }"#);
        let all = Buffers::new(&buffers_list, &views, false, source(&[7; 10]));
        assert!(all.elements(&run(0, 5, 2)).is_ok());
        assert!(all.elements(&run(0, 11, 1)).err().expect("too far").to_string().starts_with("bufferViews[0]: "));
        views[0].byte_offset = Some(USize64(u64::MAX));
        let all = Buffers::new(&buffers_list, &views, false, source(&[7; 10]));
        assert!(all.elements(&run(0, 5, 2)).is_err());
        views[0].buffer = Index::new(3);
        let all = Buffers::new(&buffers_list, &views, false, source(&[7; 10]));
        assert!(
            all.elements(&run(0, 1, 1)).err().expect("no buffer").to_string().starts_with("bufferViews[0].buffer: ")
        );
    }

    #[test]
    fn compressed_views_are_decoded_where_there_is_no_fallback() {
        // One element of four bytes: all deltas zero, so that it is the baseline at the end.
        let data = [&[0xa0, 0, 0, 0, 0][..], &[0; 28], b"wxyz"].concat();
        let extension = |length: usize, count: u64| {
            format!(
                r#"{{ "buffer": 1, "byteLength": 4, "extensions": {{ "EXT_meshopt_compression":
                {{ "buffer": 0, "byteLength": {length}, "byteStride": 4, "count": {count}, "mode": "ATTRIBUTES" }} }} }}"#
            )
        };
        let empty = buffers(serde_json::json!([
            { "byteLength": 4 }, { "byteLength": 4, "extensions": { "EXT_meshopt_compression": { "fallback": true } } }
        ]));
        let full = buffers(serde_json::json!([{ "byteLength": 4 }, { "byteLength": 4, "uri": "data:,abcd" }]));
        let read = |list: &[Buffer], required, length, count| {
            let views = view(&extension(length, count));
            let all = Buffers::new(list, &views, required, source(&data));
            all.elements(&run(0, 4, 1)).map(|elements| elements.get(0).to_vec())
        };
        assert_eq!(read(&full, false, 37, 1).expect("a fallback"), b"abcd");
        assert_eq!(read(&empty, false, 37, 1).expect("compressed"), b"wxyz");
        assert_eq!(read(&full, true, 37, 1).expect("compressed"), b"wxyz");
        for (length, count, what) in
            [(37, 1 << 24, "expands"), (37, u64::MAX, "expands"), (36, 1, "damaged"), (99, 1, "not in the buffer")]
        {
            let error = read(&empty, true, length, count).expect_err(what).to_string();
            assert!(error.starts_with("bufferViews[0].extensions: ") && error.contains(what), "{error}");
        }
    }
}
