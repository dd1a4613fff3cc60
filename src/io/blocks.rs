//! Formats faces on all threads and writes them in order.

use crate::progress::Progress;
use rayon::prelude::*;
use std::io::{self, Write};
use std::ops::Range;

/// Faces formatted by one thread at a time: their bytes stay in its cache until they are written.
const BLOCK: usize = 1 << 12;
/// Blocks formatted while as many are written: enough to keep threads busy, few enough to stay in a few MB.
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
    let fill = |batch: &[Range<u32>], buffers: &mut Vec<Vec<u8>>| {
        buffers.resize_with(batch.len(), Vec::new);
        batch.par_iter().zip(buffers.par_iter_mut()).for_each(|(faces, buffer)| {
            buffer.clear();
            format(faces.clone(), buffer);
        });
    };
    let mut batches = blocks.chunks(AT_ONCE);
    let (mut ready, mut next) = (Vec::new(), Vec::new());
    fill(batches.next().unwrap_or_default(), &mut ready);
    while !ready.is_empty() {
        let batch = batches.next().unwrap_or_default();
        // Writing is the system's copying: other threads go on meanwhile.
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| fill(batch, &mut next));
            ready.iter().try_for_each(|buffer| {
                out.write_all(buffer)?;
                progress.advance(buffer.len() as u64);
                Ok::<(), io::Error>(())
            })
        })?;
        std::mem::swap(&mut ready, &mut next);
    }
    Ok(())
}
