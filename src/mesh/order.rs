//! An order of faces and vertices in which what lies close together in space lies close together in memory.

use super::ids::Face;
use super::topology::Topology;
use super::{EdgeKind, Mesh};
use glam::DVec3;
use rayon::prelude::*;

/// Bits of a coordinate in a place on the curve.
const BITS: u32 = 21;

impl Mesh {
    /// The same surface with its faces along a Morton curve and its vertices by first use, and the number in this mesh
    /// of every face of that one. Files bring faces in any order, and the caches of processors reward good
    /// ones. Neither bodies nor scenes nor duplicates are kept.
    pub(crate) fn in_order(&self) -> (Mesh, Vec<Face>) {
        let faces = self.along_curve();
        let mut place = vec![0_u32; faces.len()];
        for (new, old) in faces.iter().enumerate() {
            place[old.index()] = new as u32;
        }
        let moved = |h: u32| 3 * place[h as usize / 3] + h % 3;

        const UNSEEN: u32 = u32::MAX;
        let mut number = vec![UNSEEN; self.positions.len()];
        let mut positions = Vec::with_capacity(self.positions.len());
        let corners: Vec<[u32; 3]> = faces
            .iter()
            .map(|&old| {
                self.topology.corners(old).map(|v| {
                    let new = &mut number[v.index()];
                    if *new == UNSEEN {
                        *new = positions.len() as u32;
                        positions.push(self.positions[v.index()]);
                    }
                    *new
                })
            })
            .collect();
        let kinds: Vec<EdgeKind> =
            faces.par_iter().flat_map_iter(|old| old.half_edges().map(|h| self.kinds[h.index()])).collect();
        let topology = Topology::reordered(&self.topology, corners, &faces, moved);
        let mesh = Mesh {
            origin: self.origin,
            positions,
            topology,
            kinds,
            states: faces.par_iter().map(|old| self.states[old.index()]).collect(),
            flipped: faces.par_iter().map(|old| self.flipped[old.index()]).collect(),
            duplicates: Vec::new(),
            bodies: Vec::new(),
            scene: None,
            report: self.report.clone(),
        };
        (mesh, faces)
    }

    /// The faces by where their barycentres lie on a Morton curve through the mesh.
    fn along_curve(&self) -> Vec<Face> {
        let (corner, size) = self.report.bounds.map_or((DVec3::ZERO, 1.0), |b| (b.min, b.size().max_element()));
        let corner = corner - self.origin;
        let scale = f64::from((1_u32 << BITS) - 1) / size;
        let mut places: Vec<(u64, u32)> = (0..self.face_count() as u32)
            .into_par_iter()
            .map(|f| {
                let cell = (self.barycentre(Face(f)) - corner) * scale;
                // What is not finite comes first.
                let [x, y, z] = cell.to_array().map(|c| spread(c as u64));
                (x | y << 1 | z << 2, f)
            })
            .collect();
        radsort::sort_by_key(&mut places, |place| place.0);
        places.into_iter().map(|place| Face(place.1)).collect()
    }
}

/// The lower 21 bits of a number, two zeros behind each.
fn spread(x: u64) -> u64 {
    let x = x.min((1 << BITS) - 1);
    let x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::synth::{Grid, Surface};

    #[test]
    fn bits_are_spread() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }

    #[test]
    fn the_surface_stays_the_same() {
        let soup = Grid::new(Surface::Saddle, 9, 7).build().soup;
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).unwrap();
        let (ordered, faces) = mesh.in_order();
        let mut seen = vec![false; mesh.face_count()];
        for (new, &old) in faces.iter().enumerate() {
            let new = Face(new as u32);
            assert!(!std::mem::replace(&mut seen[old.index()], true));
            assert_eq!(ordered.triangle(new), mesh.triangle(old));
            for (a, b) in new.half_edges().into_iter().zip(old.half_edges()) {
                assert_eq!(ordered.edge_kind(a), mesh.edge_kind(b));
                let across = |mesh: &Mesh, h| mesh.topology().twin(h).map(|h| mesh.triangle(h.face()));
                assert_eq!(across(&ordered, a), across(&mesh, b));
            }
        }
        assert_eq!(ordered.positions().len(), mesh.positions().len());
    }
}
