//! An order of faces and vertices in which what lies close together in space lies close together in memory.

use super::Mesh;
use super::ids::{Face, Vertex};
use crate::soup::{Group, Scene};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Bits of a coordinate in a place on the curve.
const BITS: u32 = 21;

/// What it takes to bring a mesh back from the order along the curve.
pub(crate) struct FileOrder {
    /// Where on the curve each face of the file is.
    places: Vec<Face>,
    /// The numbers that the vertices of the file have along the curve.
    vertices: Vec<Vertex>,
    duplicates: Vec<(Face, Face)>,
    bodies: Vec<Group>,
    scene: Option<Scene>,
}

impl FileOrder {
    /// Values of the faces along the curve as those of the file.
    pub(crate) fn sorted<T: Copy + Send + Sync>(&self, values: &[T]) -> Vec<T> {
        self.places.par_iter().map(|place| values[place.index()]).collect()
    }
}

impl Mesh {
    /// The same surface with its faces along a Morton curve and its vertices by first use. Files bring faces in any order,
    /// and the caches of processors reward good ones. Bodies, scene and duplicates are put aside.
    pub(crate) fn into_order(mut self) -> (Mesh, FileOrder) {
        let faces = self.along_curve();
        let duplicates = std::mem::take(&mut self.duplicates);
        let (bodies, scene) = (std::mem::take(&mut self.bodies), self.scene.take());
        let present = self.by_first_use(&faces);
        let (places, vertices) = (inverse(&faces, Face::index, Face), inverse(&present, Vertex::index, Vertex));
        let mesh =
            self.renumbered(&Numbers { present: &faces, new: &places }, &Numbers { present: &present, new: &vertices });
        (mesh, FileOrder { places, vertices, duplicates, bodies, scene })
    }

    /// The mesh as it was before it was put in order.
    pub(crate) fn back_to(self, order: FileOrder) -> Mesh {
        let FileOrder { places, vertices, duplicates, bodies, scene } = order;
        let mesh = self.renumbered(
            &Numbers { present: &places, new: &inverse(&places, Face::index, Face) },
            &Numbers { present: &vertices, new: &inverse(&vertices, Vertex::index, Vertex) },
        );
        Mesh { duplicates, bodies, scene, ..mesh }
    }

    /// A copy of the surface alone, without bodies, scene and duplicates.
    pub(crate) fn surface(&self) -> Mesh {
        Mesh {
            origin: self.origin,
            positions: self.positions.clone(),
            topology: self.topology.clone(),
            kinds: self.kinds.clone(),
            states: self.states.clone(),
            flipped: self.flipped.clone(),
            duplicates: Vec::new(),
            bodies: Vec::new(),
            scene: None,
            report: self.report.clone(),
        }
    }

    /// The vertices by first use in faces that are taken in an order: all, since no vertex is without a face.
    fn by_first_use(&self, faces: &[Face]) -> Vec<Vertex> {
        let mut is_seen = vec![false; self.positions.len()];
        let mut vertices = Vec::with_capacity(self.positions.len());
        for v in faces.iter().flat_map(|&f| self.topology.corners(f)) {
            if !std::mem::replace(&mut is_seen[v.index()], true) {
                vertices.push(v);
            }
        }
        vertices
    }

    /// The same surface with other numbers. One list after the other, so that no more than one is there twice.
    fn renumbered(mut self, faces: &Numbers<'_, Face>, vertices: &Numbers<'_, Vertex>) -> Mesh {
        let corners = |old: &Face| self.topology.corners(*old).map(|v| vertices.new[v.index()].0);
        let corners: Vec<[u32; 3]> = faces.present.par_iter().map(corners).collect();
        self.positions = vertices.present.par_iter().map(|old| self.positions[old.index()]).collect();
        let moved = |h: u32| 3 * faces.new[h as usize / 3].0 + h % 3;
        let faces = faces.present;
        self.topology = self.topology.renumbered(corners, faces, moved);
        self.kinds = faces.par_iter().flat_map_iter(|old| old.half_edges().map(|h| self.kinds[h.index()])).collect();
        self.states = faces.par_iter().map(|old| self.states[old.index()]).collect();
        self.flipped = faces.par_iter().map(|old| self.flipped[old.index()]).collect();
        self
    }

    /// The faces by where their barycentres lie on a Morton curve through the mesh.
    pub(crate) fn along_curve(&self) -> Vec<Face> {
        let Some((centre, axes, size)) = self.own_frame() else {
            return (0..self.face_count() as u32).map(Face).collect();
        };
        let cells = f64::from(1_u32 << (BITS - 1));
        let local = |f: u32| (axes.transpose() * (self.barycentre(Face(f)) - centre) / size).to_array();
        let mut places: Vec<(u64, u32)> = (0..self.face_count() as u32)
            .into_par_iter()
            .map(|f| {
                // From 0 to 2 per axis; what lies further out shares the last cell.
                let [x, y, z] = local(f).map(|c| spread(((c + 1.0) * cells).clamp(0.0, 2.0 * cells - 1.0) as u64));
                (x | y << 1 | z << 2, f)
            })
            .collect();
        radsort::sort_by_key(&mut places, |place| place.0);
        for alike in places.chunk_by_mut(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
            alike.sort_by(|a, b| {
                let pairs = local(a.1).into_iter().zip(local(b.1));
                pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b))).then(a.1.cmp(&b.1))
            });
        }
        places.into_iter().map(|place| Face(place.1)).collect()
    }

    /// A frame that turns and moves with the mesh, and a size that grows with it: the mean of the vertices, the way to
    /// the vertex farthest from there, the way to the vertex farthest from that line, and four times the mean distance
    /// (root of the mean square), which a lone far vertex changes little.
    fn own_frame(&self) -> Option<(DVec3, DMat3, f64)> {
        let all = || self.positions.par_iter().copied().filter(|p| p.is_finite());
        // In chunks, so that the sum does not depend on the threads.
        let sums: Vec<(DVec3, usize)> = self
            .positions
            .par_chunks(1 << 16)
            .map(|chunk| {
                let finite = chunk.iter().filter(|p| p.is_finite());
                finite.fold((DVec3::ZERO, 0), |(sum, count), p| (sum + p, count + 1))
            })
            .collect();
        let (sum, count) = sums.into_iter().fold((DVec3::ZERO, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        let centre = sum / count as f64;
        // Among equals not the first in the file.
        let farthest = |from: &(dyn Fn(DVec3) -> DVec3 + Sync)| {
            all().map(|p| (from(p - centre).length_squared(), p)).reduce_with(|a, b| {
                let is_less = a.0.total_cmp(&b.0).then_with(|| {
                    let pairs = a.1.to_array().into_iter().zip(b.1.to_array());
                    pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
                });
                if is_less == Ordering::Less { b } else { a }
            })
        };
        let (_, end) = farthest(&|d| d)?;
        let x = (end - centre).try_normalize()?;
        let (_, side) = farthest(&|d| d.reject_from_normalized(x))?;
        let y = (side - centre).reject_from_normalized(x).try_normalize().unwrap_or(x.any_orthonormal_vector());
        let squares: Vec<f64> = self
            .positions
            .par_chunks(1 << 16)
            .map(|chunk| chunk.iter().filter(|p| p.is_finite()).map(|p| p.distance_squared(centre)).sum())
            .collect();
        let size = 4.0 * (squares.into_iter().sum::<f64>() / count as f64).sqrt();
        (size > 0.0 && size.is_finite()).then(|| (centre, DMat3::from_cols(x, y, x.cross(y)), size))
    }
}

/// New numbers for faces or vertices.
struct Numbers<'n, T> {
    /// The present number of every new one.
    present: &'n [T],
    /// The new number of every present one.
    new: &'n [T],
}

/// Where in a list of all faces or vertices each of them is.
fn inverse<T: Copy>(all: &[T], index: fn(T) -> usize, numbered: fn(u32) -> T) -> Vec<T> {
    let mut places = vec![numbered(0); all.len()];
    for (place, &of) in all.iter().enumerate() {
        places[index(of)] = numbered(place as u32);
    }
    places
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
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a sound mesh");
        let (ordered, order) = mesh.surface().into_order();
        let mut seen = vec![false; mesh.face_count()];
        let faces = inverse(&order.places, Face::index, Face);
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

        assert!(order.sorted(&faces).iter().enumerate().all(|(f, number)| f == number.index()));
        let back = ordered.back_to(order);
        assert_eq!(back.positions(), mesh.positions());
        assert_eq!(back.topology().faces(), mesh.topology().faces());
        for h in (0..mesh.face_count() as u32).map(Face).flat_map(Face::half_edges) {
            assert_eq!((back.topology().across(h), back.edge_kind(h)), (mesh.topology().across(h), mesh.edge_kind(h)));
        }
    }
}
