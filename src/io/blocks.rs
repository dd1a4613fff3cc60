//! Formats faces on all threads and writes them in order.

use crate::progress::Progress;
use rayon::prelude::*;
use std::io::{self, IoSlice, Write};
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
            write_together(&ready, out, progress)
        })?;
        std::mem::swap(&mut ready, &mut next);
    }
    Ok(())
}

/// Writes buffers one behind the other, all in one call where the system takes them: it copies few large pieces faster
/// than many small ones.
fn write_together(buffers: &[Vec<u8>], out: &mut dyn Write, progress: &dyn Progress) -> io::Result<()> {
    let mut slices: Vec<IoSlice<'_>> = buffers.iter().map(|buffer| IoSlice::new(buffer)).collect();
    let mut left = &mut slices[..];
    IoSlice::advance_slices(&mut left, 0);
    while !left.is_empty() {
        match out.write_vectored(left) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(written) => {
                IoSlice::advance_slices(&mut left, written);
                progress.advance(written as u64);
            }
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::NoProgress;

    /// Takes few bytes at a time and is interrupted before each.
    #[derive(Default)]
    struct Slow {
        bytes: Vec<u8>,
        is_ready: bool,
    }

    impl Write for Slow {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.is_ready = !self.is_ready;
            if self.is_ready {
                return Err(io::ErrorKind::Interrupted.into());
            }
            let taken = bytes.len().min(1000);
            self.bytes.extend(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn blocks_are_written_whole_and_in_order() {
        let count = 3 * BLOCK + 5;
        let mut out = Slow::default();
        // Odd numbers only: some blocks may be empty, and all are of different lengths.
        let odd = |faces: Range<u32>, bytes: &mut Vec<u8>| {
            faces.filter(|f| f % 2 == 1 && f / 4096 != 1).for_each(|f| bytes.extend(f.to_le_bytes()));
        };
        in_blocks(count, &mut out, &NoProgress, odd).expect("written");
        let mut expected = Vec::new();
        odd(0..count as u32, &mut expected);
        assert!(out.bytes == expected);
        let error = in_blocks(1, &mut &mut [][..], &NoProgress, |_, bytes| bytes.push(0)).expect_err("no room");
        assert_eq!(error.kind(), io::ErrorKind::WriteZero);
    }
}
