//! Decoder of `EXT_meshopt_compression` and `KHR_meshopt_compression`, as their appendices A and B
//! specify the streams. Own code: the crates that decode them wrap a C++ library. What the filters do to
//! normals, rotations and colours is in [`filters`].

pub(super) mod encode;
mod filters;

pub(super) use filters::exponential_word as exponential;

use serde::Deserialize;
use serde_json::{Map, Value};

/// The extension goes by two names: the vendors' and, since its ratification, Khronos's.
pub(super) const NAMES: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// How the extension describes the compressed data of a buffer view.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Compression {
    /// The buffer with the compressed data.
    pub(super) buffer: u32,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: String,
    filter: Option<String>,
}

/// True when a view or buffer has the extension, by either of its names.
pub(super) fn is_compressed(extensions: &Map<String, Value>) -> bool {
    NAMES.iter().any(|name| extensions.contains_key(*name))
}

/// The description in a view's extensions, or what is wrong with it.
pub(super) fn description(extensions: &Map<String, Value>) -> Option<Result<Compression, String>> {
    let value = NAMES.iter().find_map(|name| extensions.get(*name))?;
    Some(Compression::deserialize(value).map_err(|error| error.to_string()))
}

impl Compression {
    /// Bytes of the decoded view; `None` beyond what a computer can address.
    pub(super) fn decoded_length(&self) -> Option<usize> {
        self.count.checked_mul(self.byte_stride)
    }

    /// Decodes the data, or says why it cannot be. Allocates [`Compression::decoded_length`] bytes.
    pub(super) fn decode(&self, data: &[u8]) -> Result<Vec<u8>, String> {
        let (stride, count) = (self.byte_stride, self.count);
        let is_index = matches!(stride, 2 | 4);
        let filter = self.filter.as_deref().unwrap_or("NONE");
        match (self.mode.as_str(), filter) {
            ("ATTRIBUTES", _) if stride % 4 == 0 && (4..=256).contains(&stride) => {
                let undo = filters::of(filter, stride)?;
                let mut out = attributes(data, stride, count).ok_or("the compressed attributes are damaged")?;
                undo(&mut out);
                Ok(out)
            }
            ("TRIANGLES", "NONE") if is_index && count % 3 == 0 => {
                triangles(data, count / 3, stride).ok_or("the compressed triangles are damaged".into())
            }
            ("INDICES", "NONE") if is_index => {
                indices(data, count, stride).ok_or("the compressed indices are damaged".into())
            }
            ("ATTRIBUTES" | "TRIANGLES" | "INDICES", _) => {
                let what = format!("{count} elements of {stride} bytes do not fit the mode {}", self.mode);
                Err(format!("{what} with the filter {filter:.20}"))
            }
            (mode, _) => Err(format!("the mode {mode:.20} is not known")),
        }
    }
}

/// Bytes read from the front.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1).map(|taken| taken[0])
    }

    /// Up to five bytes of seven bits, lowest first.
    fn variable(&mut self) -> Option<u32> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = u32::from(self.byte()?);
            value |= (byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }
}

fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}

/// Elements per group, whose deltas have one width.
const GROUP: usize = 16;

fn attributes(data: &[u8], stride: usize, count: usize) -> Option<Vec<u8>> {
    let (&header, rest) = data.split_first()?;
    let version = header.checked_sub(0xa0).filter(|version| *version <= 1)?;
    // The first baseline and the channels' modes stand at the end, behind padding.
    let channels = if version == 1 { stride / 4 } else { 0 };
    let tail = (stride + channels).max(if version == 1 { 24 } else { 32 });
    let (body, tail) = rest.split_at_checked(rest.len().checked_sub(tail)?)?;
    let (tail, modes) = tail.split_at(tail.len() - channels);
    let mut baseline = tail[tail.len() - stride..].to_vec();

    let mut body = Bytes(body);
    let mut out = vec![0; stride * count];
    let block = ((8192 / stride) & !(GROUP - 1)).min(256);
    // Deltas of one block, byte by byte of the element, each in whole groups.
    let mut deltas = vec![0; stride * block];
    for elements in out.chunks_mut(stride * block) {
        let controls = body.take(channels)?;
        let count = elements.len() / stride;
        let padded = count.next_multiple_of(GROUP);
        for (k, column) in deltas.chunks_exact_mut(block).enumerate() {
            let control = controls.get(k / 4).map(|bits| bits >> (2 * (k % 4)) & 3);
            match control {
                Some(2) => column[..padded].fill(0),
                Some(3) => column[..count].copy_from_slice(body.take(count)?),
                _ => groups(&mut body, control, &mut column[..padded])?,
            }
        }
        for channel in 0..stride / 4 {
            let mode = modes.get(channel).copied().unwrap_or(0);
            let columns = &deltas[4 * channel * block..][..4 * block];
            let last: &mut [u8; 4] = baseline[4 * channel..].first_chunk_mut()?;
            for (i, element) in elements.chunks_exact_mut(stride).enumerate() {
                let delta = [0, 1, 2, 3].map(|j| columns[j * block + i]);
                *last = add(*last, delta, mode)?;
                element[4 * channel..][..4].copy_from_slice(last);
            }
        }
    }
    body.0.is_empty().then_some(out)
}

/// The four bytes that follow `last`.
fn add(last: [u8; 4], delta: [u8; 4], mode: u8) -> Option<[u8; 4]> {
    match (mode & 15, mode >> 4) {
        (0, 0) => Some([0, 1, 2, 3].map(|j| last[j].wrapping_add(unzigzag(delta[j].into()) as u8))),
        (1, 0) => {
            let half = |j: usize| {
                let delta = unzigzag(u16::from_le_bytes([delta[j], delta[j + 1]]).into()) as u16;
                u16::from_le_bytes([last[j], last[j + 1]]).wrapping_add(delta).to_le_bytes()
            };
            let ([a, b], [c, d]) = (half(0), half(2));
            Some([a, b, c, d])
        }
        (2, rotation) => {
            let delta = u32::from_le_bytes(delta).rotate_right(rotation.into());
            Some((u32::from_le_bytes(last) ^ delta).to_le_bytes())
        }
        _ => None,
    }
}

/// The deltas of one byte of all elements of a block. The header has two bits for each group, which
/// choose from the widths that `control` allows.
fn groups(body: &mut Bytes<'_>, control: Option<u8>, column: &mut [u8]) -> Option<()> {
    let widths = match control {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(_) => [1, 2, 4, 8],
    };
    let header = body.take(column.len().div_ceil(4 * GROUP))?;
    for (g, group) in column.chunks_exact_mut(GROUP).enumerate() {
        let width = widths[usize::from(header[g / 4] >> (2 * (g % 4)) & 3)];
        match width {
            0 => group.fill(0),
            8 => group.copy_from_slice(body.take(GROUP)?),
            _ => {
                let packed = body.take(2 * width)?;
                let all_ones = (1 << width) - 1;
                for (i, delta) in group.iter_mut().enumerate() {
                    let bit = i * width;
                    // Single bits stand lowest first, wider ones highest first.
                    let shift = if width == 1 { bit % 8 } else { 8 - width - bit % 8 };
                    let value = packed[bit / 8] >> shift & all_ones;
                    // All ones stand for a value that does not fit and follows as a byte.
                    *delta = if value == all_ones { body.byte()? } else { value };
                }
            }
        }
    }
    Some(())
}

/// The last sixteen things, newest first. Those never pushed are beyond any number of vertices.
struct Recent<T> {
    ring: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    fn new(nothing: T) -> Self {
        Recent { ring: [nothing; 16], next: 0 }
    }

    fn push(&mut self, new: T) {
        self.ring[self.next & 15] = new;
        self.next += 1;
    }

    fn get(&self, age: usize) -> T {
        self.ring[self.next.wrapping_sub(1 + age) & 15]
    }
}

fn push_index(out: &mut Vec<u8>, index: u32, size: usize) {
    out.extend_from_slice(&index.to_le_bytes()[..size]);
}

fn triangles(data: &[u8], count: usize, size: usize) -> Option<Vec<u8>> {
    let (&header, rest) = data.split_first()?;
    if header & 0xf0 != 0xe0 || header & 15 > 1 {
        return None;
    }
    // Version 0 has no codes for neighbours of the last index, so that all below 0xf are vertices.
    let neighbour = if header & 15 == 1 { 13 } else { 15 };
    let (codes, rest) = rest.split_at_checked(count)?;
    let (body, table) = rest.split_at_checked(rest.len().checked_sub(16)?)?;
    let mut body = Bytes(body);
    let mut edges = Recent::new([u32::MAX; 2]);
    let mut vertices = Recent::new(u32::MAX);
    let (mut next, mut last) = (0_u32, 0_u32);
    let mut out = Vec::with_capacity(3 * size * count);
    for &code in codes {
        let [high, low] = [code >> 4, code & 15].map(usize::from);
        let fresh = |next: &mut u32| {
            let index = *next;
            *next = next.wrapping_add(1);
            index
        };
        let [a, b, c] = if high < 15 {
            let [a, b] = edges.get(high);
            let c = match low {
                0 => fresh(&mut next),
                _ if low < neighbour => vertices.get(low),
                15 => {
                    last = last.wrapping_add(unzigzag(body.variable()?));
                    last
                }
                // One before or one behind the last index.
                _ => {
                    last = if low == 13 { last.wrapping_sub(1) } else { last.wrapping_add(1) };
                    last
                }
            };
            if low == 0 || low >= neighbour {
                vertices.push(c);
            }
            [a, b, c]
        } else {
            let (first, pair) = if low < 14 { (0, table[low]) } else { (if low == 14 { 0 } else { 15 }, body.byte()?) };
            if low >= 14 && pair == 0 {
                next = 0;
            }
            let kinds = [first, usize::from(pair >> 4), usize::from(pair & 15)];
            let mut corner = |kind: usize| {
                Some(match kind {
                    0 => fresh(&mut next),
                    15 => {
                        last = last.wrapping_add(unzigzag(body.variable()?));
                        last
                    }
                    _ => vertices.get(kind - 1),
                })
            };
            let corners = [corner(kinds[0])?, corner(kinds[1])?, corner(kinds[2])?];
            edges.push([corners[1], corners[0]]);
            for (kind, corner) in kinds.into_iter().zip(corners) {
                if kind == 0 || kind == 15 {
                    vertices.push(corner);
                }
            }
            corners
        };
        edges.push([c, b]);
        edges.push([a, c]);
        for index in [a, b, c] {
            push_index(&mut out, index, size);
        }
    }
    body.0.is_empty().then_some(out)
}

fn indices(data: &[u8], count: usize, size: usize) -> Option<Vec<u8>> {
    let (&header, rest) = data.split_first()?;
    if header & 0xf0 != 0xd0 || header & 15 > 1 {
        return None;
    }
    let (body, _) = rest.split_at_checked(rest.len().checked_sub(4)?)?;
    let mut body = Bytes(body);
    let mut last = [0_u32; 2];
    let mut out = Vec::with_capacity(size * count.min(body.0.len()));
    for _ in 0..count {
        let value = body.variable()?;
        let baseline = &mut last[(value & 1) as usize];
        *baseline = baseline.wrapping_add(unzigzag(value >> 1));
        push_index(&mut out, *baseline, size);
    }
    body.0.is_empty().then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_specifications_example_of_four_bit_deltas() {
        let mut body = Bytes(&[0b10, 0x17, 0x5f, 0xf0, 0xbc, 0x77, 0xa9, 0x21, 0x00, 0x34, 0xb5]);
        let mut column = [0; 16];
        groups(&mut body, None, &mut column).expect("whole");
        let decoded = column.map(|delta| unzigzag(delta.into()) as i8);
        assert_eq!(decoded, [-1, -4, -3, 26, -91, 0, -6, 6, -4, -4, 5, -5, 1, -1, 0, 0]);
        assert!(body.0.is_empty());
    }

    #[test]
    fn numbers_of_variable_length() {
        for (bytes, value) in
            [(&[0x7f][..], Some(0x7f)), (&[0x81, 0x04], Some(0x201)), (&[0xff, 0xa0, 0x05], Some(0x1_507f))]
        {
            assert_eq!(Bytes(bytes).variable(), value);
        }
        assert_eq!(Bytes(&[0xff; 9]).variable(), None);
        assert_eq!(Bytes(&[0x80]).variable(), None);
    }

    #[test]
    fn triangles_of_a_strip_take_a_byte_each() {
        // Three new vertices, then a new one across the newest edge, then across the second newest.
        let data = [&[0xe1, 0xf0, 0x00, 0x10][..], &[0; 16]].concat();
        let decoded = triangles(&data, 3, 2).expect("whole");
        let decoded: Vec<u16> = decoded.as_chunks().0.iter().map(|&b| u16::from_le_bytes(b)).collect();
        assert_eq!(decoded, [0, 1, 2, 0, 2, 3, 3, 2, 4]);
        for end in 0..data.len() {
            assert!(triangles(&data[..end], 3, 2).is_none());
        }
    }

    #[test]
    fn indices_have_two_baselines() {
        let code = |delta: i32, baseline: u8| ((delta << 1 ^ delta >> 31) as u8) << 1 | baseline;
        let data = [&[0xd1, code(5, 0), code(20, 1), code(1, 0), code(-2, 1)][..], &[0; 4]].concat();
        let decoded = indices(&data, 4, 4).expect("whole");
        let decoded: Vec<u32> = decoded.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect();
        assert_eq!(decoded, [5, 20, 6, 18]);
        assert!(indices(&data, 3, 4).is_none() && indices(&data, 5, 4).is_none());
    }
}
