//! Formats faces on all threads and writes them in order.

use crate::progress::Progress;
use rayon::prelude::*;
use std::io::{self, Write};
use std::ops::Range;

/// Faces formatted by one thread at a time.
const BLOCK: usize = 1 << 14;
/// Blocks held in memory at a time: enough to keep threads busy, few enough to stay in a few MB.
const AT_ONCE: usize = 16;

/// Calls `format` for runs of faces, which together cover `0..count`, and writes what it appends,
/// in face order. Progress is in bytes.
pub(super) fn in_blocks(
    count: usize,
    out: &mut dyn Write,
    progress: &dyn Progress,
    format: impl Fn(Range<u32>, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let blocks: Vec<Range<u32>> =
        (0..count).step_by(BLOCK).map(|first| first as u32..(first + BLOCK).min(count) as u32).collect();
    let mut buffers: Vec<Vec<u8>> = vec![Vec::new(); AT_ONCE];
    for batch in blocks.chunks(AT_ONCE) {
        batch.par_iter().zip(&mut buffers).for_each(|(faces, buffer)| {
            buffer.clear();
            format(faces.clone(), buffer);
        });
        for buffer in &buffers[..batch.len()] {
            out.write_all(buffer)?;
            progress.advance(buffer.len() as u64);
        }
    }
    Ok(())
}
