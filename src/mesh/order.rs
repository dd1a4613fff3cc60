//! An order of faces and vertices in which what lies close together in space lies close together in memory.

use super::ids::{Face, Vertex};
use super::{EdgeKind, Mesh};
use crate::soup::{Group, Scene};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

/// Bits of a coordinate in a first sort along the curve, fewer where the numbers of faces need the room; and over the
/// whole curve, for faces that share a cell then.
const COARSE: u32 = 13;
const FINE: u32 = 21;

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
    /// What `of` makes of values of the faces along the curve, for those of the file.
    pub(crate) fn sorted<T: Copy + Sync, U: Send>(&self, values: &[T], of: impl Fn(T) -> U + Sync) -> Vec<U> {
        self.places.par_iter().map(|place| of(values[place.index()])).collect()
    }
}

impl Mesh {
    /// The same surface with its faces along a Morton curve and its vertices by first use. Files bring faces in any
    /// order, and the caches of processors reward good ones. Bodies, scene and duplicates are put aside.
    pub(crate) fn into_order(mut self) -> (Mesh, FileOrder) {
        let faces = self.along_curve();
        let duplicates = std::mem::take(&mut self.duplicates);
        let (bodies, scene) = (std::mem::take(&mut self.bodies), self.scene.take());
        let (present, vertices) = self.by_first_use(&faces);
        let places = inverse(&faces, Face::index, Face);
        let mesh = self.renumbered(
            &Renumbering { present: &faces, new: &places },
            &Renumbering { present: &present, new: &vertices },
        );
        (mesh, FileOrder { places, vertices, duplicates, bodies, scene })
    }

    /// The mesh as it was before it was put in order.
    pub(crate) fn back_to(self, order: FileOrder) -> Mesh {
        let FileOrder { places, vertices, duplicates, bodies, scene } = order;
        let mesh = self.renumbered(
            &Renumbering { present: &places, new: &inverse(&places, Face::index, Face) },
            &Renumbering { present: &vertices, new: &inverse(&vertices, Vertex::index, Vertex) },
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

    /// The vertices by first use in faces that are taken in an order, all, since no vertex is without a face; and the
    /// number each of them gets.
    fn by_first_use(&self, faces: &[Face]) -> (Vec<Vertex>, Vec<Vertex>) {
        const UNSEEN: Vertex = Vertex(u32::MAX);
        let mut numbers = vec![UNSEEN; self.positions.len()];
        let mut vertices = Vec::with_capacity(numbers.len());
        for v in faces.iter().flat_map(|&f| self.topology.corners(f)) {
            let number = &mut numbers[v.index()];
            if *number == UNSEEN {
                *number = Vertex(vertices.len() as u32);
                vertices.push(v);
            }
        }
        (vertices, numbers)
    }

    /// The same surface with other numbers. One list after the other, so that no more than one is there twice.
    fn renumbered(mut self, faces: &Renumbering<'_, Face>, vertices: &Renumbering<'_, Vertex>) -> Mesh {
        let corners = |old: &Face| self.topology.corners(*old).map(|v| vertices.new[v.index()].0);
        let corners: Vec<[u32; 3]> = faces.present.par_iter().map(corners).collect();
        self.positions = vertices.present.par_iter().map(|old| self.positions[old.index()]).collect();
        let moved = |h: u32| 3 * faces.new[h as usize / 3].0 + h % 3;
        let faces = faces.present;
        self.topology = self.topology.renumbered(corners, faces, moved);
        if !is_uniform(&self.kinds) {
            let kinds = |old: &Face| old.half_edges().map(|h| self.kinds[h.index()]);
            self.kinds = faces.par_iter().map(kinds).collect::<Vec<[EdgeKind; 3]>>().into_flattened();
        }
        if !is_uniform(&self.states) {
            self.states = faces.par_iter().map(|old| self.states[old.index()]).collect();
        }
        if !is_uniform(&self.flipped) {
            self.flipped = faces.par_iter().map(|old| self.flipped[old.index()]).collect();
        }
        self
    }

    /// The faces by where their barycentres lie on a Morton curve through the mesh.
    pub(crate) fn along_curve(&self) -> Vec<Face> {
        let Some((centre, axes, size)) = self.own_frame() else {
            return (0..self.face_count() as u32).map(Face).collect();
        };
        let to_local = axes.transpose() * size.recip();
        let local = |face: Face| to_local * (self.barycentre(face) - centre);
        // A place on the curve and the number of its face share 64 bits.
        let number_bits = u32::BITS - (self.face_count() as u32).leading_zeros();
        let bits = COARSE.min((u64::BITS - number_bits) / 3);
        let coarse = |f: u32| place(local(Face(f)), bits) << number_bits | u64::from(f);
        let mut places: Vec<u64> = (0..self.face_count() as u32).into_par_iter().map(coarse).collect();
        radsort::sort_by_key(&mut places, |place| place >> number_bits);
        let face = |place: u64| Face((place & ((1 << number_bits) - 1)) as u32);
        let is_in_one_cell = |a: &u64, b: &u64| a >> number_bits == b >> number_bits;
        let cells = places.par_chunk_by_mut(is_in_one_cell).filter(|cell| cell.len() > 1);
        cells.for_each_init(Vec::new, |finer, cell| {
            finer.clear();
            finer.extend(cell.iter().map(|&coarse| {
                let local = local(face(coarse));
                (place(local, FINE), local, coarse)
            }));
            finer.sort_unstable_by(|a, b| a.0.cmp(&b.0).then_with(|| by_coordinates(a.1, b.1)).then(a.2.cmp(&b.2)));
            cell.iter_mut().zip(&*finer).for_each(|(to, from)| *to = from.2);
        });
        places.into_par_iter().map(face).collect()
    }

    /// A frame that turns and moves with the mesh, and a size that grows with it: the mean of the vertices, the way
    /// from there to where most that is far away lies, the same across that way, and four times the mean distance (root
    /// of the mean square), which a lone far vertex changes little. Noise of the vertices hardly turns it, unless the
    /// shape is alike on opposite sides: then the farthest vertex says where.
    pub(crate) fn own_frame(&self) -> Option<(DVec3, DMat3, f64)> {
        // In chunks, so that sums do not depend on the threads.
        let chunks = || self.positions.par_chunks(1 << 14).map(|chunk| chunk.iter().filter(|p| p.is_finite()));
        let sums: Vec<(DVec3, usize)> =
            chunks().map(|chunk| chunk.fold((DVec3::ZERO, 0), |(sum, count), p| (sum + p, count + 1))).collect();
        let (sum, count) = sums.into_iter().fold((DVec3::ZERO, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        let centre = sum / count as f64;
        let squares: Vec<f64> = chunks().map(|chunk| chunk.map(|p| p.distance_squared(centre)).sum()).collect();
        let size = 4.0 * (squares.into_iter().sum::<f64>() / count as f64).sqrt();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let far = |from: &(dyn Fn(DVec3) -> DVec3 + Sync)| {
            let ways: Vec<Far> = chunks()
                .map(|chunk| chunk.fold(Far::NONE, |far, &p| far.or(Far::of(p, from((p - centre) / size)))))
                .collect();
            ways.into_iter().fold(Far::NONE, Far::or).way()
        };
        let x = far(&|d| d).try_normalize()?;
        let across = |d: DVec3| d.reject_from_normalized(x);
        let y = across(far(&across)).try_normalize().unwrap_or(x.any_orthonormal_vector());
        Some((centre, DMat3::from_cols(x, y, x.cross(y)), size))
    }
}

/// Which way vertices lie that are far from something.
#[derive(Clone, Copy)]
struct Far {
    /// The square of the farthest one's distance, the vertex, and the way to it.
    farthest: (f64, DVec3, DVec3),
    /// The sum of the ways, by the sixth power of the distances.
    sum: DVec3,
    /// That of their lengths.
    lengths: f64,
}

impl Far {
    const NONE: Far = Far { farthest: (-1.0, DVec3::ZERO, DVec3::ZERO), sum: DVec3::ZERO, lengths: 0.0 };

    fn of(vertex: DVec3, way: DVec3) -> Self {
        let square = way.length_squared();
        let weight = square * square * square;
        Far { farthest: (square, vertex, way), sum: way * weight, lengths: square.sqrt() * weight }
    }

    /// Of both.
    fn or(self, other: Far) -> Far {
        let (a, b) = (self.farthest, other.farthest);
        // Among equals not the first in the file.
        let is_further = a.0 < b.0 || a.0 == b.0 && by_coordinates(a.1, b.1).is_lt();
        Far {
            farthest: if is_further { b } else { a },
            sum: self.sum + other.sum,
            lengths: self.lengths + other.lengths,
        }
    }

    fn way(&self) -> DVec3 {
        /// What is less may be by chance, on shapes that are alike on opposite sides.
        const LEAST: f64 = 1e-3;
        if self.sum.length() >= LEAST * self.lengths { self.sum } else { self.farthest.2 }
    }
}

/// New numbers for faces or vertices.
struct Renumbering<'n, T> {
    /// The present number of every new one.
    present: &'n [T],
    /// The new number of every present one.
    new: &'n [T],
}

/// Where in a list of all faces or vertices each of them is.
pub(crate) fn inverse<T: Copy + Sync, U: Send>(all: &[T], index: fn(T) -> usize, numbered: fn(u32) -> U) -> Vec<U> {
    let places: Vec<AtomicU32> = (0..all.len()).into_par_iter().map(|_| AtomicU32::new(0)).collect();
    // Each is stored once, by whatever thread.
    all.par_iter().enumerate().for_each(|(place, &of)| places[index(of)].store(place as u32, Relaxed));
    places.into_par_iter().map(|place| numbered(place.into_inner())).collect()
}

/// True where all values are the same, in whatever order.
fn is_uniform<T: PartialEq>(values: &[T]) -> bool {
    values.first().is_none_or(|first| values.iter().all(|value| value == first))
}

/// Where on the curve a point is, whose coordinates are from -1 to 1; what lies further out shares the last cells.
#[inline]
fn place(point: DVec3, bits: u32) -> u64 {
    let half = f64::from(1_u32 << (bits - 1));
    let cell = |c: f64| spread(((c + 1.0) * half).clamp(0.0, 2.0 * half - 1.0) as u32);
    cell(point.x) | cell(point.y) << 1 | cell(point.z) << 2
}

fn by_coordinates(a: DVec3, b: DVec3) -> Ordering {
    let pairs = a.to_array().into_iter().zip(b.to_array());
    pairs.fold(Ordering::Equal, |order, (a, b)| order.then(a.total_cmp(&b)))
}

/// The lower 21 bits of a number, two zeros behind each.
#[inline]
fn spread(x: u32) -> u64 {
    let x = u64::from(x) & ((1 << FINE) - 1);
    let x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{HalfEdge, MeshOptions};
    use crate::synth::{Grid, Surface};
    use crate::{Positions, Soup};

    #[test]
    fn bits_are_spread() {
        for bit in 0..FINE {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }

    /// Vertices that are nearly equally far take turns in being the farthest: that turns nothing.
    #[test]
    fn noise_hardly_turns_the_own_frame() {
        let egg = |noise: f64| {
            let vertex = |i: u32| {
                let (t, z) = (f64::from(i) * 2.4, f64::from(i) / 500.0 - 1.0);
                let round = (1.0 - z * z).sqrt() * (1.0 + 0.2 * z) * (1.0 + 0.1 * t.cos());
                let of = |j: u32| (f64::from(3 * i + j) * 12.9898).sin() * noise;
                [1.5 * z + 0.2 * z * z + of(0), round * t.cos() + of(1), round * t.sin() + of(2)]
            };
            let triangles = (0..998).map(|i| [i, i + 1, i + 2]).collect();
            let soup = Soup::new(Positions::F64((0..1000).map(vertex).collect()), triangles);
            Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh").own_frame().expect("a frame").1
        };
        let (clean, noisy) = (egg(0.0), egg(0.02));
        assert!(clean.col(0).dot(noisy.col(0)) > 0.999 && clean.col(1).dot(noisy.col(1)) > 0.99, "{clean} {noisy}");
    }

    /// A vertex far away makes all others share a few cells.
    #[test]
    fn neighbours_stay_close_beside_one_far_vertex() {
        let soup = Grid::new(Surface::Saddle, 100, 100).build().soup;
        let far = soup.positions.len() as u32;
        let mut positions: Vec<[f64; 3]> = (0..far).map(|v| soup.positions.get(v as usize).to_array()).collect();
        positions.push([1e5, 3e4, 2e4]);
        let triangles = [&soup.triangles[..], &[[0, 1, far]]].concat();
        let mesh = Mesh::from_soup(&Soup::new(Positions::F64(positions), triangles), &MeshOptions::default());
        let (mesh, _) = mesh.expect("a mesh").into_order();
        let across =
            (0..3 * mesh.face_count() as u32).filter_map(|h| Some((h / 3, mesh.topology().twin(HalfEdge(h))?)));
        let mut ways: Vec<u32> = across.map(|(f, twin)| f.abs_diff(twin.face().0)).collect();
        ways.sort_unstable();
        // 15 along the curve; 48 by coordinates.
        assert!(ways[ways.len() * 3 / 4] < 25, "{}", ways[ways.len() * 3 / 4]);
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

        assert!(order.sorted(&faces, |face| face).iter().enumerate().all(|(f, number)| f == number.index()));
        let back = ordered.back_to(order);
        assert_eq!(back.positions(), mesh.positions());
        assert_eq!(back.topology().faces(), mesh.topology().faces());
        for h in (0..mesh.face_count() as u32).map(Face).flat_map(Face::half_edges) {
            assert_eq!((back.topology().across(h), back.edge_kind(h)), (mesh.topology().across(h), mesh.edge_kind(h)));
        }
    }
}
