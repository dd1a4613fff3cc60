//! Blocks of faces that fill lists by vertex side by side.
//!
//! Faces lie along a curve and vertices are numbered by first use, so that nearly all vertices of a block of faces are
//! named by it first: they are its own, and no other block writes to them. What a block has to say of vertices before
//! its own is told later, block by block. So each vertex hears of its faces in their order, whatever the number of
//! threads. Of other numberings the result is the same, only slower.

use crate::mesh::Mesh;
use rayon::prelude::*;
use std::ops::Range;

/// Faces of a block.
const FACES: usize = 1 << 14;

/// The blocks of a mesh.
pub(super) struct Blocks {
    faces: usize,
    /// The vertices of each block.
    own: Vec<Range<usize>>,
}

impl Blocks {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let faces = mesh.topology().faces();
        let last = |block: &[[u32; 3]]| block.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        let ends: Vec<usize> = faces.par_chunks(FACES).map(last).collect();
        let mut start = 0;
        let next = |end: usize| {
            let own = start..end.max(start);
            start = own.end;
            own
        };
        Blocks { faces: faces.len(), own: ends.into_iter().map(next).collect() }
    }

    /// Shows each block its faces, its vertices and their values, by vertex; returns what it leaves to be told later,
    /// in the order of blocks.
    pub(super) fn fill<T: Send, L: Send>(
        &self,
        mut values: &mut [T],
        fill: impl Fn(Range<u32>, Range<usize>, &mut [T]) -> Vec<L> + Sync,
    ) -> Vec<L> {
        let mut shares = Vec::with_capacity(self.own.len());
        for own in &self.own {
            let (share, rest) = values.split_at_mut(own.len());
            shares.push(share);
            values = rest;
        }
        self.each(shares, fill)
    }

    /// The same for shares of any kind, one for each block.
    pub(super) fn each<S: Send, L: Send>(
        &self,
        shares: Vec<S>,
        fill: impl Fn(Range<u32>, Range<usize>, S) -> Vec<L> + Sync,
    ) -> Vec<L> {
        let blocks = shares.into_par_iter().zip(&self.own).enumerate();
        let faces = |block: usize| (block * FACES) as u32..self.faces.min((block + 1) * FACES) as u32;
        let later: Vec<Vec<L>> = blocks.map(|(block, (share, own))| fill(faces(block), own.clone(), share)).collect();
        later.into_iter().flatten().collect()
    }

    /// What the blocks have to tell, in their order.
    pub(super) fn of_faces<L: Send>(&self, tell: impl Fn(Range<u32>) -> Vec<L> + Sync) -> Vec<L> {
        self.each(vec![(); self.own.len()], |faces, _, ()| tell(faces))
    }

    /// The vertices of each block.
    pub(super) fn own(&self) -> &[Range<usize>] {
        &self.own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::{Grid, Surface};
    use crate::{MeshOptions, Soup};

    /// Which faces each vertex hears of, in that order.
    fn heard(mesh: &Mesh) -> Vec<Vec<u32>> {
        let mut all = vec![Vec::new(); mesh.positions().len()];
        let faces = mesh.topology().faces();
        let later = Blocks::new(mesh).fill(&mut all, |block, own, values: &mut [Vec<u32>]| {
            let mut later = Vec::new();
            for f in block {
                for v in faces[f as usize] {
                    match own.contains(&(v as usize)) {
                        true => values[v as usize - own.start].push(f),
                        false => later.push((v, f)),
                    }
                }
            }
            later
        });
        later.into_iter().for_each(|(v, f)| all[v as usize].push(f));
        all
    }

    #[test]
    fn vertices_hear_of_their_faces_in_order_however_they_are_numbered() {
        let soup = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, 3 * FACES + 100, 1.0).build().soup;
        let mut scattered = soup.triangles.clone();
        let count = scattered.len();
        (0..count).for_each(|f| scattered.swap(f, f * 7919 % count));
        for triangles in [soup.triangles, scattered] {
            let soup = Soup::new(soup.positions.clone(), triangles);
            let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
            let mut wanted = vec![Vec::new(); mesh.positions().len()];
            for (f, corners) in mesh.topology().faces().iter().enumerate() {
                corners.iter().for_each(|&v| wanted[v as usize].push(f as u32));
            }
            assert!(heard(&mesh) == wanted);
        }
    }
}
