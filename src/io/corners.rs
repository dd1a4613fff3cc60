//! Corners of files that spell out each face's positions anew, as STL does.
//!
//! Six faces or so meet at a vertex, and mostly soon after one another. A corner whose position was seen not
//! long ago, the same to the bit, therefore takes the number it had then: a third of the memory to bring
//! into use, and fewer positions to weld. Which ones are missed matters to nobody; the weld finds them.

use crate::soup::{Positions, Soup};
use std::collections::TryReserveError;

/// Positions that are remembered: with their slots, little enough to stay near the processor.
const SLOTS: usize = 1 << 13;
/// Faces after which is decided whether looking for positions is worth its while.
const BLOCK: usize = 1 << 10;
/// Of so many blocks one is always looked through.
const LOOK_EVERY: usize = 16;

/// A coordinate in the width the file stores it.
pub(super) trait Coordinate: Copy {
    fn bits(self) -> u64;
    fn positions(points: Vec<[Self; 3]>) -> Positions;
}

impl Coordinate for f32 {
    #[inline]
    fn bits(self) -> u64 {
        self.to_bits().into()
    }

    fn positions(points: Vec<[Self; 3]>) -> Positions {
        Positions::F32(points)
    }
}

impl Coordinate for f64 {
    #[inline]
    fn bits(self) -> u64 {
        self.to_bits()
    }

    fn positions(points: Vec<[Self; 3]>) -> Positions {
        Positions::F64(points)
    }
}

/// Faces by their corners' positions.
pub(super) struct Corners<C> {
    positions: Vec<[C; 3]>,
    triangles: Vec<[u32; 3]>,
    /// The last position of each hash.
    slots: Box<[u32; SLOTS]>,
    is_sharing: bool,
    blocks: usize,
    /// Faces of the current block, and positions that they added.
    faces_in_block: usize,
    new_in_block: usize,
}

impl<C: Coordinate> Corners<C> {
    pub(super) fn new() -> Self {
        Corners {
            positions: Vec::new(),
            triangles: Vec::new(),
            slots: Box::new([0; SLOTS]),
            is_sharing: true,
            blocks: 0,
            faces_in_block: 0,
            new_in_block: 0,
        }
    }

    /// Makes room for so many faces, which must be known to be there.
    pub(super) fn try_reserve(&mut self, faces: usize) -> Result<(), TryReserveError> {
        self.triangles.try_reserve_exact(faces)?;
        // Closed meshes have half as many vertices as faces.
        self.positions.try_reserve_exact(faces / 2)
    }

    pub(super) fn face_count(&self) -> usize {
        self.triangles.len()
    }

    /// Adds faces, of which there may be [`MAX_FACES`](crate::soup::MAX_FACES) in all. Many at a time take
    /// half as long.
    #[inline]
    pub(super) fn extend(&mut self, faces: impl ExactSizeIterator<Item = [[C; 3]; 3]>) {
        let (count, before) = (faces.len(), self.positions.len());
        let Corners { positions, triangles, slots, .. } = self;
        if self.is_sharing {
            let mut number = |corner| number(corner, positions, slots);
            triangles.extend(faces.map(|[a, b, c]| [number(a), number(b), number(c)]));
        } else {
            let first = before as u32;
            positions.extend(faces.flatten());
            triangles.extend((0..count as u32).map(|f| 3 * f + first).map(|a| [a, a + 1, a + 2]));
        }
        self.faces_in_block += count;
        self.new_in_block += self.positions.len() - before;
        if self.faces_in_block >= BLOCK {
            self.end_block();
        }
    }

    /// Faces in no order at all share nothing soon: looking would be in vain.
    fn end_block(&mut self) {
        self.blocks += 1;
        self.is_sharing = if self.is_sharing {
            2 * self.new_in_block < 5 * self.faces_in_block
        } else {
            self.blocks.is_multiple_of(LOOK_EVERY)
        };
        (self.faces_in_block, self.new_in_block) = (0, 0);
    }

    pub(super) fn into_soup(self) -> Soup {
        Soup::new(C::positions(self.positions), self.triangles)
    }
}

/// The number of a position that was seen not long ago, or a new one.
#[inline]
fn number<C: Coordinate>(corner: [C; 3], positions: &mut Vec<[C; 3]>, slots: &mut [u32; SLOTS]) -> u32 {
    let [x, y, z] = bits(corner);
    let mixed = (x ^ y.rotate_left(32)) ^ z.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let hash = mixed.wrapping_mul(0xd6e8_feb8_6659_fd93) >> (u64::BITS - SLOTS.ilog2());
    let slot = &mut slots[hash as usize % SLOTS];
    let is_known = positions.get(*slot as usize).is_some_and(|&known| {
        // Arrays would be compared in memory, which takes longer than all the rest.
        let [u, v, w] = bits(known);
        (u ^ x) | (v ^ y) | (w ^ z) == 0
    });
    if !is_known {
        *slot = positions.len() as u32;
        positions.push(corner);
    }
    *slot
}

#[inline]
fn bits<C: Coordinate>([x, y, z]: [C; 3]) -> [u64; 3] {
    [x.bits(), y.bits(), z.bits()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Mesh, MeshOptions};
    use crate::synth::{Grid, Surface};

    /// The faces of a torus, in order or not, with corners of their own.
    fn faces(stride: usize) -> Vec<[[f32; 3]; 3]> {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 100, 97).build().soup;
        let count = soup.face_count();
        let face =
            |f: usize| soup.triangles[f * stride % count].map(|v| soup.positions.get(v as usize).as_vec3().into());
        (0..count).map(face).collect()
    }

    fn soup_of(faces: &[[[f32; 3]; 3]]) -> Soup {
        let mut corners = Corners::new();
        corners.try_reserve(faces.len()).expect("memory");
        faces.chunks(700).for_each(|some| corners.extend(some.iter().copied()));
        corners.into_soup()
    }

    #[test]
    fn corners_keep_their_positions_to_the_bit() {
        let odd = [[-0.0, 0.0, f32::NAN], [0.0, -0.0, f32::NAN], [0.0, 0.0, -f32::NAN]];
        for (faces, most) in [(faces(1), 1.0), (faces(7919), 3.0), (vec![odd; 3000], 1e-3)] {
            let soup = soup_of(&faces);
            assert!(soup.positions.len() as f64 <= most * faces.len() as f64, "{}", soup.positions.len());
            let Positions::F32(positions) = &soup.positions else { panic!("floats stay floats") };
            let read =
                soup.triangles.iter().map(|face| face.map(|corner| positions[corner as usize].map(f32::to_bits)));
            assert!(read.eq(faces.iter().map(|face| face.map(|corner| corner.map(f32::to_bits)))));
        }
    }

    #[test]
    fn the_mesh_is_that_of_corners_with_positions_of_their_own() {
        for stride in [1, 7919] {
            let faces = faces(stride);
            let apart = Soup::new(
                Positions::F32(faces.concat()),
                (0..faces.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect(),
            );
            let [shared, apart] = [soup_of(&faces), apart]
                .map(|soup| Mesh::from_soup(&soup, &MeshOptions::default()).expect("a closed mesh"));
            assert_eq!((shared.positions(), shared.report()), (apart.positions(), apart.report()));
            let corners = |mesh: &Mesh| {
                (0..mesh.face_count() as u32).map(|f| mesh.topology().corners(crate::mesh::Face(f))).collect::<Vec<_>>()
            };
            assert_eq!(corners(&shared), corners(&apart));
        }
    }
}
