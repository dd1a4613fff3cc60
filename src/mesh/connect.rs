//! Finds the sides of every edge.
//!
//! Half-edges are sorted into buckets by the lesser of their vertices (a counting sort), a range of vertices at a
//! time: the buckets of a range stay in the processor's cache, and ranges are independent of one another. Which
//! ranges a block of faces touches is noted first, so that each range looks at its own blocks only.

use super::ids::{Face, HalfEdge};
use super::topology::{BOUNDARY, Found, NON_MANIFOLD};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Faces whose ranges are noted together.
const BLOCK: usize = 1 << 12;
/// Vertices of a range at least.
const FEW: usize = 1 << 12;
/// Ranges at most: the bits of a block's note.
const RANGES: usize = 64;

/// The half-edge across each half-edge, [`BOUNDARY`] or [`NON_MANIFOLD`].
pub(super) fn connect(faces: &[[u32; 3]], vertex_count: usize, left_out: &[bool]) -> (Vec<u32>, Found) {
    let sides = Sides { faces, left_out };
    // Every half-edge belongs to one range, whose thread alone writes it.
    let across: Vec<AtomicU32> = (0..3 * faces.len()).into_par_iter().map(|_| AtomicU32::new(BOUNDARY)).collect();
    let ranges = Ranges::new(&sides, vertex_count);
    let parts: Vec<Found> = (0..ranges.count())
        .into_par_iter()
        .map_init(Buckets::default, |buckets, range| {
            let blocks = || ranges.blocks_of(range).flat_map(|block| sides.of_block(block));
            buckets.fill(ranges.vertices(range), blocks);
            sides.join(buckets, &across)
        })
        .collect();
    let mut found = Found::default();
    for part in parts {
        found.non_manifold_edges += part.non_manifold_edges;
        found.duplicates.extend(part.duplicates);
    }
    // Each pair turns up once per edge; a copy belongs to the earliest face like it.
    found.duplicates.sort_unstable();
    found.duplicates.dedup_by_key(|(copy, _)| *copy);
    (across.into_iter().map(AtomicU32::into_inner).collect(), found)
}

/// The half-edges of faces that take part.
struct Sides<'a> {
    faces: &'a [[u32; 3]],
    left_out: &'a [bool],
}

impl Sides<'_> {
    fn block_count(&self) -> usize {
        self.faces.len().div_ceil(BLOCK)
    }

    /// Lesser vertex, greater vertex and number of the half-edges of a block of faces.
    #[inline]
    fn of_block(&self, block: usize) -> impl Iterator<Item = (u32, u32, u32)> {
        let faces = block * BLOCK..((block + 1) * BLOCK).min(self.faces.len());
        let present = faces.clone().zip(&self.faces[faces.clone()]).zip(&self.left_out[faces]);
        present.filter(|(_, left_out)| !**left_out).flat_map(|((f, &[a, b, c]), _)| {
            let h = 3 * f as u32;
            [(a.min(b), a.max(b), h), (b.min(c), b.max(c), h + 1), (c.min(a), c.max(a), h + 2)]
        })
    }

    /// Joins the half-edges in buckets.
    fn join(&self, buckets: &mut Buckets, across: &[AtomicU32]) -> Found {
        let mut found = Found::default();
        buckets.for_each_edge(|sides| match *sides {
            [_] => {}
            [a, b] => {
                let [a, b] = [a as u32, b as u32];
                across[a as usize].store(b, Relaxed);
                across[b as usize].store(a, Relaxed);
                if self.apex(a) == self.apex(b) {
                    found.duplicates.push((HalfEdge(b).face(), HalfEdge(a).face()));
                }
            }
            _ => {
                found.non_manifold_edges += 1;
                let mut sides: Vec<u32> = sides.iter().map(|&side| side as u32).collect();
                sides.iter().for_each(|&h| across[h as usize].store(NON_MANIFOLD, Relaxed));
                self.note_duplicates(&mut sides, &mut found.duplicates);
            }
        });
        found
    }

    /// Faces on one edge with the same opposite vertex are copies of the first of them.
    fn note_duplicates(&self, sides: &mut [u32], duplicates: &mut Vec<(Face, Face)>) {
        sides.sort_unstable_by_key(|&h| (self.apex(h), h));
        for alike in sides.chunk_by(|&a, &b| self.apex(a) == self.apex(b)) {
            let first = HalfEdge(alike[0]).face();
            duplicates.extend(alike[1..].iter().map(|&h| (HalfEdge(h).face(), first)));
        }
    }

    /// The corner of a half-edge's face that is not on it.
    #[inline]
    fn apex(&self, h: u32) -> u32 {
        self.faces.as_flattened()[HalfEdge(h).prev().index()]
    }
}

/// Ranges of vertices, and the blocks of faces that touch each.
struct Ranges {
    vertex_count: usize,
    /// Vertices of each but the last.
    width: usize,
    /// For each block of faces a bit for each range.
    touched: Vec<u64>,
}

impl Ranges {
    fn new(sides: &Sides<'_>, vertex_count: usize) -> Self {
        let width = vertex_count.div_ceil(RANGES).max(FEW).next_power_of_two();
        let shift = width.trailing_zeros();
        let touched = (0..sides.block_count())
            .into_par_iter()
            .map(|block| sides.of_block(block).fold(0, |touched, (lesser, ..)| touched | 1 << (lesser >> shift)))
            .collect();
        let mut ranges = Ranges { vertex_count, width, touched };
        // Blocks that lie all over the mesh are looked at by all ranges: fewer of them are then better.
        while ranges.looks() > 2 * sides.block_count() && ranges.count() > rayon::current_num_threads() {
            ranges.widen();
        }
        ranges
    }

    fn count(&self) -> usize {
        self.vertex_count.div_ceil(self.width)
    }

    /// How many blocks all ranges look at together.
    fn looks(&self) -> usize {
        self.touched.iter().map(|touched| touched.count_ones() as usize).sum()
    }

    /// Makes one range of every two.
    fn widen(&mut self) {
        self.width *= 2;
        for touched in &mut self.touched {
            let wide = *touched | *touched >> 1;
            *touched = (0..RANGES / 2).fold(0, |all, range| all | (wide >> (2 * range) & 1) << range);
        }
    }

    fn vertices(&self, range: usize) -> Range<usize> {
        range * self.width..((range + 1) * self.width).min(self.vertex_count)
    }

    fn blocks_of(&self, range: usize) -> impl Iterator<Item = usize> {
        self.touched.iter().enumerate().filter(move |(_, touched)| *touched >> range & 1 == 1).map(|(block, _)| block)
    }
}

/// Half-edges sorted into buckets by their lesser vertex.
#[derive(Default)]
struct Buckets {
    ends: Vec<u32>,
    /// The greater vertex in the upper half, the half-edge in the lower: one number sorts faster than two.
    entries: Vec<u64>,
}

impl Buckets {
    /// Takes those of the half-edges whose lesser vertex is in a range.
    fn fill<I: Iterator<Item = (u32, u32, u32)>>(&mut self, vertices: Range<usize>, half_edges: impl Fn() -> I) {
        let Buckets { ends, entries } = self;
        ends.clear();
        ends.resize(vertices.len() + 1, 0);
        let first = vertices.start as u32;
        // What is below the range wraps around to beyond it.
        let counts = &mut ends[1..];
        half_edges().for_each(|(lesser, ..)| {
            if let Some(count) = counts.get_mut(lesser.wrapping_sub(first) as usize) {
                *count += 1;
            }
        });
        let mut total = 0;
        for end in ends.iter_mut() {
            total += *end;
            *end = total;
        }
        entries.clear();
        entries.resize(total as usize, 0);
        // Filling moves each bucket's start to its end, which is all that reading needs.
        let starts = &mut ends[..vertices.len()];
        half_edges().for_each(|(lesser, greater, h)| {
            if let Some(place) = starts.get_mut(lesser.wrapping_sub(first) as usize) {
                entries[*place as usize] = u64::from(greater) << 32 | u64::from(h);
                *place += 1;
            }
        });
    }

    /// Calls `each` with the sides of every edge, in face order.
    fn for_each_edge(&mut self, mut each: impl FnMut(&[u64])) {
        let mut start = 0;
        for &end in &self.ends[..self.ends.len().saturating_sub(1)] {
            let bucket = &mut self.entries[start..end as usize];
            start = end as usize;
            bucket.sort_unstable();
            bucket.chunk_by(|a, b| a >> 32 == b >> 32).for_each(&mut each);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::{Grid, Surface};
    use std::collections::BTreeMap;

    /// Face by face, with a map of all edges.
    fn plainly(faces: &[[u32; 3]]) -> (Vec<u32>, usize) {
        let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for (f, &[a, b, c]) in faces.iter().enumerate() {
            for (i, [p, q]) in [[a, b], [b, c], [c, a]].into_iter().enumerate() {
                edges.entry([p.min(q), p.max(q)]).or_default().push((3 * f + i) as u32);
            }
        }
        let mut across = vec![BOUNDARY; 3 * faces.len()];
        for sides in edges.values() {
            match **sides {
                [_] => {}
                [a, b] => (across[a as usize], across[b as usize]) = (b, a),
                _ => sides.iter().for_each(|&h| across[h as usize] = NON_MANIFOLD),
            }
        }
        (across, edges.values().filter(|sides| sides.len() > 2).count())
    }

    /// Faces in file order touch few ranges each, faces in any order all of them; both several at a time.
    #[test]
    fn ranges_and_threads_change_nothing() {
        let soup = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, 12 * BLOCK, 1.0).build().soup;
        let vertices = soup.positions.len();
        assert!(vertices > 4 * FEW);
        let mut faces = soup.triangles;
        // Boundaries, and edges with three faces.
        faces.drain(7000..7100);
        let fins: Vec<[u32; 3]> = (0..100).map(|i| [faces[i][0], faces[i][1], faces[i + 9000][2]]).collect();
        faces.extend(fins);
        let mut shuffled = faces.clone();
        (0..shuffled.len()).for_each(|i| shuffled.swap(i, i * 7919 % faces.len()));
        for faces in [faces, shuffled] {
            let (expected, non_manifold_edges) = plainly(&faces);
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let (across, found) = pool.install(|| connect(&faces, vertices, &vec![false; faces.len()]));
                assert_eq!(across, expected);
                assert!(found.duplicates.is_empty() && non_manifold_edges >= 100);
                assert_eq!(found.non_manifold_edges, non_manifold_edges);
            }
        }
    }
}
