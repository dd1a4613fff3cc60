//! Values of faces as one list for each accessor.
//!
//! A face's values stand side by side in memory, but a file takes one quantity of all faces after the other. To fetch
//! all values from memory for each would take longer than all else that writing does; so several streams that follow
//! one another are taken out at once.

use super::draft::Piece;
use super::layout::{Stream, stored_value, texel, texel_of};
use super::vertices::Owners;
use crate::annotation::Annotation;
use crate::io::blocks::in_blocks;
use crate::mesh::Face;
use crate::numbers::Numbers;
use crate::progress::Progress;
use crate::quantity::{Quantity, finite};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::io::{self, Write};

/// Streams taken out at once: four bytes a face for each are little beside the values themselves.
const AT_ONCE: usize = 6;
/// Faces whose values are taken out of the nearest caches.
const BLOCK: usize = 1 << 10;

/// The lists of the streams that come next.
#[derive(Default)]
pub(super) struct Columns {
    ready: VecDeque<Vec<f32>>,
    spent: Vec<Vec<f32>>,
}

impl Columns {
    /// Writes the first of some pieces if it is a stream with a value for each face; `None` if it is none.
    pub(super) fn write(
        &mut self,
        pieces: &[Piece<'_>],
        annotation: &Annotation<'_>,
        out: &mut dyn Write,
        progress: &dyn Progress,
    ) -> Option<io::Result<()>> {
        let (stream, faces) = of_faces(pieces.first()?)?;
        if self.ready.is_empty() {
            let alike = pieces.iter().map_while(of_faces).take_while(|(_, others)| *others == faces);
            let streams: Vec<&Stream<'_>> = alike.take(AT_ONCE).map(|(stream, _)| stream).collect();
            self.take_out(&streams, faces, annotation);
        }
        let column = self.ready.pop_front()?;
        let written = match stream {
            Stream::PaletteCoordinate { .. } => {
                let v = texel(None).to_le_bytes();
                write_column(&column, out, progress, |u| [u.to_le_bytes(), v, u.to_le_bytes(), v, u.to_le_bytes(), v])
            }
            Stream::Value { owners: Owners::Faces(_), .. } => {
                write_column(&column, out, progress, |value| [value.to_le_bytes()])
            }
            _ => write_column(&column, out, progress, |value| [value.to_le_bytes(); 3]),
        };
        self.spent.push(column);
        Some(written)
    }

    fn take_out(&mut self, streams: &[&Stream<'_>], faces: &Numbers, annotation: &Annotation<'_>) {
        let mut columns: Vec<Vec<f32>> = streams.iter().map(|_| self.spent.pop().unwrap_or_default()).collect();
        self.spent.clear();
        columns.iter_mut().for_each(|column| column.resize(faces.len(), 0.0));
        let mut blocks: Vec<Vec<&mut [f32]>> = Vec::new();
        blocks.resize_with(faces.len().div_ceil(BLOCK), Vec::new);
        for column in &mut columns {
            blocks.iter_mut().zip(column.chunks_mut(BLOCK)).for_each(|(block, part)| block.push(part));
        }
        blocks.into_par_iter().enumerate().for_each(|(n, block)| {
            let first = (n * BLOCK) as u32;
            block.into_iter().zip(streams).for_each(|(column, stream)| fill(column, stream, faces, first, annotation));
        });
        self.ready.extend(columns);
    }
}

/// A stream with a value for each face, and the faces.
fn of_faces<'p>(piece: &'p Piece<'_>) -> Option<(&'p Stream<'p>, &'p Numbers)> {
    let Piece::Stream(stream) = piece else { return None };
    match stream {
        Stream::Value { owners: Owners::Corners(faces) | Owners::Faces(faces), .. }
        | Stream::PaletteCoordinate { owners: Owners::Corners(faces), v: None, .. } => Some((stream, faces)),
        _ => None,
    }
}

/// Sets the part of a stream's column that begins at a place.
fn fill(column: &mut [f32], stream: &Stream<'_>, faces: &Numbers, place: u32, annotation: &Annotation<'_>) {
    match (stream, faces) {
        (Stream::Value { quantity, component, .. }, Numbers::Run(run)) => {
            let first = Face(run.start + place);
            let is_direction = matches!(quantity, Quantity::DirMax | Quantity::DirMin);
            let turned = is_direction.then(|| annotation.space.turned_component(*component));
            let (component, sign) = turned.unwrap_or((*component, 1.0));
            let factor = f64::from(sign) * annotation.space.factor(quantity.dimension());
            quantity.values(first, &annotation.values[first.index()..], component, column);
            column.iter_mut().for_each(|value| *value = finite(f64::from(*value) * factor));
        }
        (Stream::Value { quantity, component, .. }, _) => {
            let stored = stored_value(annotation, *quantity, *component);
            column.iter_mut().zip(place..).for_each(|(slot, place)| *slot = stored(Some(Face(faces.at(place)))));
        }
        (Stream::PaletteCoordinate { u, .. }, _) => {
            let colors = annotation.colors.get(*u);
            let texel = |place| texel_of(colors, annotation, Some(Face(faces.at(place))));
            column.iter_mut().zip(place..).for_each(|(slot, place)| *slot = texel(place));
        }
        _ => {}
    }
}

/// Writes `N` numbers for each of a list.
fn write_column<const N: usize>(
    column: &[f32],
    out: &mut dyn Write,
    progress: &dyn Progress,
    of: impl Fn(f32) -> [[u8; 4]; N] + Sync,
) -> io::Result<()> {
    in_blocks(column.len(), out, progress, |block, bytes| {
        let column = &column[block.start as usize..block.end as usize];
        bytes.resize(4 * N * column.len(), 0);
        let (words, _) = bytes.as_chunks_mut::<4>();
        for (words, &value) in words.as_chunks_mut::<N>().0.iter_mut().zip(column) {
            *words = of(value);
        }
    })
}
