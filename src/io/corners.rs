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
    /// Positions when the current block began.
    before: usize,
}

impl<C: Coordinate> Corners<C> {
    pub(super) fn new() -> Self {
        let (positions, triangles) = (Vec::new(), Vec::new());
        Corners { positions, triangles, slots: Box::new([0; SLOTS]), is_sharing: true, before: 0 }
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

    /// Adds a face. There may be up to [`MAX_FACES`](crate::soup::MAX_FACES).
    #[inline]
    pub(super) fn add(&mut self, corners: [[C; 3]; 3]) {
        if self.triangles.len().is_multiple_of(BLOCK) {
            self.begin_block();
        }
        let triangle = if self.is_sharing {
            let [a, b, c] = corners;
            [self.number(a), self.number(b), self.number(c)]
        } else {
            let first = self.positions.len() as u32;
            self.positions.extend(corners);
            [first, first + 1, first + 2]
        };
        self.triangles.push(triangle);
    }

    /// Faces in no order at all share nothing soon: looking would be in vain.
    fn begin_block(&mut self) {
        let new = self.positions.len() - self.before;
        self.is_sharing = if self.is_sharing {
            new < 5 * BLOCK / 2
        } else {
            (self.triangles.len() / BLOCK).is_multiple_of(LOOK_EVERY)
        };
        self.before = self.positions.len();
    }

    #[inline]
    fn number(&mut self, corner: [C; 3]) -> u32 {
        let [x, y, z] = bits(corner);
        let mixed = (x ^ y.rotate_left(32)) ^ z.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = mixed.wrapping_mul(0xd6e8_feb8_6659_fd93) >> (u64::BITS - SLOTS.ilog2());
        let slot = &mut self.slots[hash as usize % SLOTS];
        let is_known = self.positions.get(*slot as usize).is_some_and(|&known| bits(known) == [x, y, z]);
        if !is_known {
            *slot = self.positions.len() as u32;
            self.positions.push(corner);
        }
        *slot
    }

    pub(super) fn into_soup(self) -> Soup {
        Soup::new(C::positions(self.positions), self.triangles)
    }
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
        faces.iter().for_each(|&face| corners.add(face));
        corners.into_soup()
    }

    #[test]
    fn corners_keep_their_positions_to_the_bit() {
        let odd = [[-0.0, 0.0, f32::NAN], [0.0, -0.0, f32::NAN], [0.0, 0.0, -f32::NAN]];
        for (faces, most) in [(faces(1), 1.0), (faces(7919), 3.0), (vec![odd; 3000], 1e-3)] {
            let soup = soup_of(&faces);
            assert!((soup.positions.len() as f64) < most * faces.len() as f64, "{}", soup.positions.len());
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
