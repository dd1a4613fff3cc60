//! Gives one number to all corners that share a position.
//!
//! A soup whose corners have positions of their own (STL) is welded in blocks, each with a small table that
//! stays in the processor's cache, on all threads; what a block finds is then looked up once each in
//! a table of all vertices. In the order of the blocks this gives the numbers that going face by face
//! gives. Faces that share positions already (OBJ, PLY) need one look-up for each position.

use super::vertex_table::{Position, TOGETHER, VertexTable};
use crate::soup::{Group, Positions};
use glam::DVec3;
use rayon::prelude::*;
use std::hash::{BuildHasher, RandomState};
use std::ops::Range;

/// Welded vertices and the faces over them.
pub(super) struct Welded {
    /// One position per vertex, numbered by first use in face order; -0.0 has become 0.0.
    pub(super) positions: Vec<DVec3>,
    /// Vertex numbers per face.
    pub(super) faces: Vec<[u32; 3]>,
    /// Vertices that another vertex at most the weld distance away has absorbed.
    pub(super) merged_by_distance: usize,
}

pub(super) const NONE: u32 = u32::MAX;

/// Faces of a block.
const BLOCK: usize = 1 << 13;
/// Blocks that are welded while the vertices of as many are looked up: enough for many threads, and little to hold.
const AT_ONCE: usize = 32;

/// Faces over positions, and which of them share a coordinate space.
pub(super) struct Faces<'a> {
    /// Taken over: they become those over the vertices.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) bodies: &'a [Group],
}

/// Welds corners whose coordinates are equal, body by body.
pub(super) fn weld_exact(faces: Faces<'_>, positions: &Positions) -> Welded {
    match positions {
        Positions::F32(positions) => weld_faces(faces, positions),
        Positions::F64(positions) => weld_faces(faces, positions),
    }
}

/// Welds corners whose coordinates are equal, body by body.
pub(super) fn weld_faces<P: Position>(faces: Faces<'_>, positions: &[P]) -> Welded {
    let Faces { mut triangles, bodies } = faces;
    // Different in every run, so that no file can be made to collide. The numbering does not depend on it.
    let secret = RandomState::new().hash_one(0);
    // A closed mesh has half as many vertices as faces: sized by that, a soup whose corners are
    // all apart grows its table three times, which is cheaper than clearing a table for the worst.
    let mut table = VertexTable::new(triangles.len() / 2, secret);
    if positions.len() > 2 * triangles.len() {
        weld_blocks(&mut triangles, bodies, positions, &mut table, secret);
    } else {
        weld_shared(&mut triangles, bodies, positions, &mut table);
    }
    let positions = table.positions().par_iter().map(|position| position.wide()).collect();
    Welded { positions, faces: triangles, merged_by_distance: 0 }
}

/// Takes vertices as they are numbered, equal positions or not.
pub(super) fn keep_numbers<P: Position>(mut triangles: Vec<[u32; 3]>, given: &[P]) -> Welded {
    let mut vertex_of: Vec<u32> = vec![NONE; given.len()];
    let mut positions = Vec::with_capacity(given.len().min(3 * triangles.len()));
    for corner in triangles.as_flattened_mut() {
        let known = &mut vertex_of[*corner as usize];
        if *known == NONE {
            *known = positions.len() as u32;
            positions.push(given[*corner as usize].canonical().wide());
        }
        *corner = *known;
    }
    Welded { positions, faces: triangles, merged_by_distance: 0 }
}

/// Looks each position up once for each body that uses it.
fn weld_shared<P: Position>(triangles: &mut [[u32; 3]], bodies: &[Group], positions: &[P], table: &mut VertexTable<P>) {
    /// Faces whose new positions are looked up together: a slot is far away, but many may be on their way at once.
    const FACES: usize = 32;
    /// Stands for the number of a position that is being looked up. Above those of all vertices.
    const WANTED: u32 = NONE - 1;
    let mut vertex_of: Vec<u32> = vec![NONE; positions.len()];
    let mut new: Vec<u32> = Vec::with_capacity(3 * FACES);
    for body in bodies {
        let first = table.begin_body();
        for faces in triangles[range(&body.faces)].chunks_mut(FACES) {
            let corners = faces.as_flattened_mut();
            new.clear();
            for &corner in &*corners {
                let known = &mut vertex_of[corner as usize];
                // A number from before this body belongs to another coordinate space.
                if *known == NONE || *known < first {
                    *known = WANTED;
                    new.push(corner);
                }
            }
            for some in new.chunks(TOGETHER) {
                let (mut found, mut wanted) = ([0; TOGETHER], [P::ORIGIN; TOGETHER]);
                for (position, &corner) in wanted.iter_mut().zip(some) {
                    *position = positions[corner as usize].canonical();
                }
                table.find_all(&wanted[..some.len()], &mut found[..some.len()]);
                some.iter().zip(found).for_each(|(&corner, vertex)| vertex_of[corner as usize] = vertex);
            }
            corners.iter_mut().for_each(|corner| *corner = vertex_of[*corner as usize]);
        }
    }
}

/// Welds blocks of faces for themselves, then their vertices.
fn weld_blocks<P: Position>(
    triangles: &mut [[u32; 3]],
    bodies: &[Group],
    positions: &[P],
    table: &mut VertexTable<P>,
    secret: u64,
) {
    let weld = |faces: &mut [[u32; 3]]| -> Vec<Vec<P>> {
        faces
            .par_chunks_mut(BLOCK)
            .map_init(|| VertexTable::new(BLOCK, secret), |table, block| weld_block(block, positions, table))
            .collect()
    };
    for body in bodies {
        table.begin_body();
        let faces = &mut triangles[range(&body.faces)];
        if faces.len() <= BLOCK {
            for corner in faces.as_flattened_mut() {
                *corner = table.vertex_at(positions[*corner as usize].canonical());
            }
            continue;
        }
        let mut batches = faces.chunks_mut(BLOCK * AT_ONCE);
        let mut ready = batches.next().map(|batch| (weld(batch), batch));
        while let Some((vertices, batch)) = ready {
            let next = batches.next();
            // All vertices are looked up in turn; other threads go on meanwhile.
            let (welded, numbers) = rayon::join(
                || next.map(|batch| (weld(batch), batch)),
                || vertices.iter().map(|positions| table.vertices_at(positions)).collect::<Vec<_>>(),
            );
            let blocks = batch.par_chunks_mut(BLOCK).zip(&numbers);
            blocks.for_each(|(block, numbers)| {
                block.as_flattened_mut().iter_mut().for_each(|corner| *corner = numbers[*corner as usize]);
            });
            ready = welded;
        }
    }
}

/// Welds faces for themselves: their corners become numbers of the positions returned.
fn weld_block<P: Position>(block: &mut [[u32; 3]], positions: &[P], table: &mut VertexTable<P>) -> Vec<P> {
    table.clear();
    let mut corners = [P::ORIGIN; TOGETHER];
    for vertices in block.as_flattened_mut().chunks_mut(TOGETHER) {
        for (position, &corner) in corners.iter_mut().zip(vertices.iter()) {
            *position = positions[corner as usize].canonical();
        }
        table.find_all(&corners[..vertices.len()], vertices);
    }
    table.positions().to_vec()
}

fn range(faces: &Range<u32>) -> Range<usize> {
    faces.start as usize..faces.end as usize
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::soup::Soup;

    pub(in crate::mesh) fn soup_of(points: &[[f64; 3]]) -> Soup {
        let triangles = (0..points.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
        Soup::new(Positions::F64(points.to_vec()), triangles)
    }

    /// Welds the faces of a soup.
    pub(in crate::mesh) fn weld(soup: &Soup) -> Welded {
        weld_exact(Faces { triangles: soup.triangles.clone(), bodies: &soup.bodies }, &soup.positions)
    }

    #[test]
    fn negative_zero_is_zero() {
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, -0.0], [1.0, -0.0, 0.0], [0.0, 0.0, 1.0]];
        let welded = weld(&soup_of(&points));
        assert_eq!(welded.faces, [[0, 1, 2], [0, 1, 3]]);
        assert!(welded.positions.iter().all(|p| p.to_array().iter().all(|c| c.is_sign_positive())));
        let narrow = points.map(|p| p.map(|c| c as f32));
        let narrow = weld(&Soup { positions: Positions::F32(narrow.to_vec()), ..soup_of(&points) });
        assert_eq!((narrow.faces, narrow.positions), (welded.faces, welded.positions));
    }

    #[test]
    fn bodies_stay_apart_however_often_the_table_grows() {
        let mut soup = soup_of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].repeat(500));
        soup.bodies = (0..500).map(|f| Group { name: String::new(), faces: f..f + 1 }).collect();
        assert_eq!(weld(&soup).positions.len(), 1500);
        soup.bodies = vec![Group { name: String::new(), faces: 0..500 }];
        assert_eq!(weld(&soup).positions.len(), 3);
        // The same as faces that share three positions.
        let shared = Soup { positions: Positions::F64(vec![[0.0; 3], [1.0; 3], [2.0; 3]]), ..soup };
        let mut shared = Soup { triangles: vec![[2, 0, 1]; 500], ..shared };
        assert_eq!(weld(&shared).faces, [[0, 1, 2]; 500]);
        shared.bodies = (0..500).map(|f| Group { name: String::new(), faces: f..f + 1 }).collect();
        assert_eq!(weld(&shared).faces[499], [1497, 1498, 1499]);
    }

    /// Blocks, threads and sharing change nothing: vertices are numbered by first use in face order.
    #[test]
    fn numbers_are_those_of_going_face_by_face() {
        let mut random = 1_u64;
        let mut next = |below: u64| {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 33) % below
        };
        let count = 3 * (2 * BLOCK + 777);
        // Some positions in one block only, others in all.
        let points: Vec<[f64; 3]> =
            (0..count).map(|i| [next(40) as f64, next(40) as f64, (i / 9000) as f64 * next(2) as f64]).collect();
        let mut soup = soup_of(&points);
        let half = soup.face_count() as u32 / 2;
        let group = |faces| Group { name: String::new(), faces };
        soup.bodies = vec![group(0..half), group(half..soup.face_count() as u32)];
        let welded = weld(&soup);
        let mut seen = std::collections::HashMap::new();
        let mut expected = Vec::new();
        for (f, triangle) in soup.triangles.iter().enumerate() {
            expected.push(triangle.map(|corner| {
                let number = seen.len() as u32;
                let key = (f as u32 >= half, points[corner as usize].map(f64::to_bits));
                *seen.entry(key).or_insert(number)
            }));
        }
        assert_eq!(welded.faces, expected);
        assert_eq!(welded.positions.len(), seen.len());
        let mut table = VertexTable::new(10, 0);
        weld_shared(&mut soup.triangles, &soup.bodies, &points, &mut table);
        assert_eq!(soup.triangles, expected);
    }
}
