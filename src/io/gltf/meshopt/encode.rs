//! Encoder of `EXT_meshopt_compression`, in version 0 of its streams, which every decoder knows. Own code
//! like the decoder: the crates wrap a C++ library.

use super::GROUP;
use rayon::prelude::*;

/// Elements of `stride` bytes, a multiple of 4 and at most 256.
pub(in crate::io::gltf) fn attributes(data: &[u8], stride: usize) -> Vec<u8> {
    let length = stride * ((8192 / stride) & !(GROUP - 1)).min(256);
    let blocks: Vec<Vec<u8>> = (0..data.len().div_ceil(length))
        .into_par_iter()
        .map(|b| {
            let block = &data[b * length..data.len().min((b + 1) * length)];
            // The first element has itself as its baseline, which stands at the end.
            let before = (b * length).saturating_sub(stride);
            self::block(block, &data[before..before + stride], stride)
        })
        .collect();
    let tail = stride.max(32);
    let mut out = Vec::with_capacity(1 + blocks.iter().map(Vec::len).sum::<usize>() + tail);
    out.push(0xa0);
    blocks.iter().for_each(|block| out.extend_from_slice(block));
    out.resize(out.len() + tail - stride.min(data.len()), 0);
    out.extend_from_slice(&data[..stride.min(data.len())]);
    out
}

/// One byte of all elements after the other, as differences in groups of sixteen.
fn block(elements: &[u8], before: &[u8], stride: usize) -> Vec<u8> {
    let count = elements.len() / stride;
    let mut column = vec![0_u8; count.next_multiple_of(GROUP)];
    let mut out = Vec::with_capacity(elements.len() / 2);
    for k in 0..stride {
        let mut last = before[k];
        for (delta, element) in column.iter_mut().zip(elements.chunks_exact(stride)) {
            let difference = element[k].wrapping_sub(last) as i8;
            *delta = ((difference << 1) ^ (difference >> 7)) as u8;
            last = element[k];
        }
        let header = out.len();
        out.resize(header + column.len().div_ceil(4 * GROUP), 0);
        for (g, group) in column.chunks_exact(GROUP).enumerate() {
            out[header + g / 4] |= self::group(group, &mut out) << (2 * (g % 4));
        }
    }
    out
}

/// Writes a group in the width that takes least, and gives the width's number.
fn group(deltas: &[u8], out: &mut Vec<u8>) -> u8 {
    let beyond = |most: u8| deltas.iter().filter(|&&delta| delta >= most).count();
    let (narrow, half) = (4 + beyond(3), 8 + beyond(15));
    if beyond(1) == 0 {
        0
    } else if narrow <= half && narrow < GROUP {
        pack(deltas, 2, out);
        1
    } else if half < GROUP {
        pack(deltas, 4, out);
        2
    } else {
        out.extend_from_slice(deltas);
        3
    }
}

/// Deltas of a few bits, the first highest; all ones stand for one that follows as a byte.
fn pack(deltas: &[u8], width: usize, out: &mut Vec<u8>) {
    let ones = (1 << width) - 1;
    let per_byte = 8 / width;
    out.extend(deltas.chunks_exact(per_byte).map(|few| few.iter().fold(0, |byte, &d| byte << width | d.min(ones))));
    out.extend(deltas.iter().filter(|&&delta| delta >= ones));
}

/// Indices of `size` bytes, 2 or 4, in their order: each as the difference from one of two baselines. `None`
/// where a difference is too large for the stream.
pub(in crate::io::gltf) fn indices(data: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(data.len() / 2 + 5);
    out.push(0xd1);
    let mut last = [0_u32; 2];
    for bytes in data.chunks_exact(size) {
        let mut word = [0; 4];
        word[..size].copy_from_slice(bytes);
        let index = u32::from_le_bytes(word);
        let differences = last.map(|last| index.wrapping_sub(last) as i32);
        let nearer = usize::from(differences[1].unsigned_abs() < differences[0].unsigned_abs());
        last[nearer] = index;
        let difference = i64::from(differences[nearer]);
        let difference = ((difference << 1) ^ (difference >> 63)) as u64;
        let mut value = u32::try_from(difference << 1 | nearer as u64).ok()?;
        while value > 0x7f {
            out.push(value as u8 | 0x80);
            value >>= 7;
        }
        out.push(value as u8);
    }
    out.extend([0; 4]);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that jump and bytes that creep, from a small generator.
    fn noise(count: usize) -> Vec<u8> {
        let mut state = 1_u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..count).map(|i| if i % 5 == 0 { next() } else { (next() % 4).wrapping_add((i / 900) as u8) }).collect()
    }

    #[test]
    fn what_is_encoded_is_decoded() {
        for stride in [4, 12, 16, 64, 256] {
            for count in [1, 15, 16, 17, 255, 256, 257, 1000] {
                let data = noise(stride * count);
                let coded = attributes(&data, stride);
                assert_eq!(
                    super::super::attributes(&coded, stride, count).as_ref(),
                    Some(&data),
                    "{count} of {stride}"
                );
            }
        }
        let even = [7_u8, 0, 1, 2].repeat(4096);
        assert!(attributes(&even, 4).len() < even.len() / 30, "what repeats takes little");
    }

    #[test]
    fn indices_stay_in_their_order() {
        let list: Vec<u32> = (0..999).map(|i| if i % 3 == 0 { i } else { 70_000 - 2 * i }).chain([0, 7]).collect();
        for size in [2, 4] {
            let data: Vec<u8> = list.iter().flat_map(|i| i.to_le_bytes()[..size].to_vec()).collect();
            let coded = indices(&data, size).expect("small numbers");
            assert_eq!(super::super::indices(&coded, list.len(), size), Some(data), "{size}");
        }
        assert_eq!(indices(&[u32::MAX / 2, 0].map(u32::to_le_bytes).concat(), 4), None);
    }
}
