//! The mesh as large windows see it: cut open along its sharp edges.
//!
//! A vertex stands once for every fan of faces that hang together around it. A window that grows from fan to fan
//! never has to look at an edge.

use super::Ground;
use super::lists::Lists;
use super::normals::sound_normals;
use super::sites::Sites;
use super::stars::{CROWDED, half_edges};
use crate::mesh::{Face, HalfEdge, Vertex};
use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

/// The fans of a mesh. Fans with numbers below the number of vertices are the first, mostly the only one of their
/// vertex.
pub(in crate::curvature::fit) struct Fans<'g> {
    pub(in crate::curvature::fit) ground: &'g Ground<'g>,
    /// Each sound face, listed at the fan of its least corner, by coordinates in the mesh's own frame, so that it does
    /// not matter which corner a file names first.
    faces: Lists,
    /// No face listed at a fan has its middle further from it.
    spans: Vec<f32>,
    /// None where no vertex is divided.
    split: Option<Split>,
    /// Directions of the normals.
    directions: Vec<Vec3>,
}

/// Fans where vertices have several.
struct Split {
    /// The fans at the corners of all faces.
    corners: Vec<[u32; 3]>,
    /// The vertices of fans that are not the first of theirs.
    vertices: Vec<u32>,
    /// Where the other fans of each vertex begin among them.
    others: Vec<u32>,
    neighbours: Lists,
    normals: Vec<Vec3>,
}

/// In place of the fan of a corner and of a place among other fans.
const NONE: u32 = u32::MAX;

impl<'g> Fans<'g> {
    pub(in crate::curvature::fit) fn new(ground: &'g Ground<'g>) -> Self {
        let count = ground.mesh.positions().len() as u32;
        let is_divided = |v: &u32| ground.stars.is_divided(*v) && !ground.stars.neighbours(*v).is_empty();
        let divided: Vec<u32> = (0..count).filter(is_divided).collect();
        let split = (!divided.is_empty()).then(|| Split::new(ground, &divided));
        let corners = split.as_ref().map_or(ground.mesh.topology().faces(), |split| &split.corners);
        let fans = count as usize + split.as_ref().map_or(0, |split| split.vertices.len());
        let is_sound = |f: &u32| ground.mesh.is_sound(Face(*f));
        let to_own = ground.mesh.own_frame().map_or(DMat3::IDENTITY, |(_, axes, _)| axes.transpose());
        let least = |f: u32| {
            let [a, b, c] = ground.mesh.triangle(Face(f)).map(|p| (to_own * p).to_array());
            let [x, y, z] = corners[f as usize];
            let (first, fan) = if b < a { (b, y) } else { (a, x) };
            if c < first { z } else { fan }
        };
        let least: Vec<u32> = (0..corners.len() as u32).into_par_iter().map(least).collect();
        let sound = || (0..corners.len() as u32).filter(is_sound).map(|f| (least[f as usize], f));
        let faces = Lists::of_pairs(fans, sound);
        let vertex = |fan: u32| split.as_ref().map_or(fan, |split| split.vertex(fan));
        let span = |fan: u32| {
            let at = ground.position(vertex(fan));
            let away = |&f: &u32| ground.mesh.barycentre(Face(f)).distance(at);
            (faces.of(fan).iter().map(away).fold(0.0, f64::max) as f32).next_up()
        };
        let spans = (0..fans as u32).into_par_iter().map(span).collect();
        let normals = split.as_ref().map_or(&ground.normals, |split| &split.normals);
        let directions = normals.par_iter().map(|normal| normal.normalize_or_zero()).collect();
        Fans { ground, faces, spans, split, directions }
    }

    /// The fans at the corners of a face.
    pub(in crate::curvature::fit) fn corners(&self, face: Face) -> [u32; 3] {
        let corners = self.split.as_ref().map_or(self.ground.mesh.topology().faces(), |split| &split.corners);
        corners[face.index()]
    }

    #[inline]
    pub(super) fn vertex(&self, fan: u32) -> u32 {
        self.split.as_ref().map_or(fan, |split| split.vertex(fan))
    }

    /// Faces of a fan: each sound face of the mesh is named by just one.
    #[inline]
    pub(in crate::curvature::fit) fn faces(&self, fan: u32) -> &[u32] {
        self.faces.of(fan)
    }

    /// False where no face of a fan can have its middle within a distance of a point.
    #[inline]
    pub(in crate::curvature::fit) fn may_have_faces_within(&self, fan: u32, centre: DVec3, distance: f64) -> bool {
        let most = distance + f64::from(self.spans[fan as usize]);
        self.position(fan).distance_squared(centre) <= most * most
    }

    /// All fans of a vertex.
    pub(in crate::curvature::fit) fn of(&self, vertex: u32) -> impl Iterator<Item = u32> + Clone + use<'_, 'g> {
        let count = self.ground.mesh.positions().len();
        let others = self.split.iter().flat_map(move |split| {
            let first = split.others[vertex as usize];
            let places = if first == NONE { 0..0 } else { first as usize..split.vertices.len() };
            places.take_while(move |&i| split.vertices[i] == vertex).map(move |i| (count + i) as u32)
        });
        std::iter::once(vertex).chain(others)
    }
}

impl Sites for Fans<'_> {
    const LEAST: usize = 16;

    fn fans(&self) -> &Fans<'_> {
        self
    }

    fn count(&self) -> usize {
        self.ground.mesh.positions().len() + self.split.as_ref().map_or(0, |split| split.vertices.len())
    }

    #[inline]
    fn of_fan(&self, fan: u32) -> u32 {
        fan
    }

    #[inline]
    fn position(&self, fan: u32) -> DVec3 {
        self.ground.position(self.vertex(fan))
    }

    /// As long as its faces are wide against the mesh.
    #[inline]
    fn normal(&self, fan: u32) -> Vec3 {
        self.split.as_ref().map_or(&self.ground.normals, |split| &split.normals)[fan as usize]
    }

    #[inline]
    fn direction(&self, fan: u32) -> Vec3 {
        self.directions[fan as usize]
    }

    #[inline]
    fn neighbours(&self, fan: u32) -> &[u32] {
        self.split.as_ref().map_or_else(|| self.ground.stars.neighbours(fan), |split| split.neighbours.of(fan))
    }

    #[inline]
    fn weight(&self, _: u32) -> f64 {
        1.0
    }

    #[inline]
    fn shared_vertex(&self, fan: u32) -> Option<u32> {
        let split = self.split.as_ref()?;
        let vertex = split.vertex(fan);
        (split.others[vertex as usize] != NONE).then_some(vertex)
    }

    fn coverage(&self, fans: &[u32]) -> f64 {
        self.ground.stars.coverage(fans.iter().map(|&fan| self.vertex(fan)))
    }
}

impl Split {
    #[inline]
    fn vertex(&self, fan: u32) -> u32 {
        match (fan as usize).checked_sub(self.others.len()) {
            Some(i) => self.vertices[i],
            None => fan,
        }
    }

    fn new(ground: &Ground<'_>, divided: &[u32]) -> Self {
        let mesh = ground.mesh;
        let mut corners = mesh.topology().faces().to_vec();
        let mut vertices = Vec::new();
        for &v in divided {
            split_star(ground, Vertex(v), &mut corners, &mut vertices);
        }
        let mut others = vec![NONE; mesh.positions().len()];
        for (i, &v) in vertices.iter().enumerate().rev() {
            others[v as usize] = i as u32;
        }
        let count = mesh.positions().len() + vertices.len();
        let neighbours = Lists::of_pairs(count, || {
            half_edges(mesh, 0..mesh.face_count() as u32).flat_map(|h| neighbours(ground, &corners, h))
        });
        let mut normals = vec![Vec3::ZERO; count];
        for (f, normal) in sound_normals(mesh, 0..mesh.face_count() as u32, ground.width) {
            corners[f.index()].iter().for_each(|&fan| normals[fan as usize] += normal);
        }
        Split { corners, vertices, others, neighbours, normals }
    }
}

/// Gives each fan of faces around a vertex but the first a number of its own.
fn split_star(ground: &Ground<'_>, vertex: Vertex, corners: &mut [[u32; 3]], vertices: &mut Vec<u32>) {
    let topology = ground.mesh.topology();
    let corner = |f: u32| topology.faces()[f as usize].iter().position(|&v| v == vertex.0).map(|c| (f as usize, c));
    let star = ground.stars.of(vertex.0);
    for (f, c) in star.iter().filter_map(|&f| corner(f)) {
        corners[f][c] = NONE;
    }
    let mut fan = vertex.0;
    for (f, c) in star.iter().filter_map(|&f| corner(f)) {
        if corners[f][c] != NONE {
            continue;
        }
        corners[f][c] = fan;
        // Around the vertex both ways; windings may differ from face to face.
        for first in Face(f as u32).half_edges().into_iter().filter(|&h| topology.apex(h) != vertex) {
            let mut h = first;
            // Of a star with too many faces, each part is a fan: time for a window is bounded.
            for _ in 0..CROWDED / 2 {
                let Some(twin) = topology.twin(h).filter(|_| ground.is_open(h)) else { break };
                let Some((f, c)) = corner(twin.face().0).filter(|&(f, c)| corners[f][c] == NONE) else { break };
                corners[f][c] = fan;
                h = topology.other_side_at(twin, vertex);
            }
        }
        fan = (ground.mesh.positions().len() + vertices.len()) as u32;
        vertices.push(vertex.0);
    }
    // The number after the last one has not been given.
    vertices.pop();
}

/// The fans at the ends of a half-edge, as neighbours of each other; the second way round only where the face across
/// does not say so.
fn neighbours(ground: &Ground<'_>, corners: &[[u32; 3]], h: HalfEdge) -> impl Iterator<Item = (u32, u32)> {
    let ends = |h: HalfEdge| [h, h.next()].map(|h| corners[h.face().index()][h.index() % 3]);
    let [a, b] = ends(h);
    let is_shown_twice = ground.mesh.topology().twin(h).is_some_and(|twin| ends(twin) == [b, a]);
    std::iter::once((a, b)).chain((!is_shown_twice).then_some((b, a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::ground::work::Work;
    use crate::progress::NoProgress;
    use crate::{Mesh, MeshOptions, Positions, Soup};

    fn mesh(corners: &[[f64; 3]], triangles: &[[u32; 3]]) -> Mesh {
        let positions = Positions::F64(corners.to_vec());
        let options = MeshOptions { feature_angle: 55.0, ..MeshOptions::default() };
        Mesh::from_soup(&Soup::new(positions, triangles.to_vec()), &options).expect("a mesh")
    }

    /// The faces in each part that hangs together, by number.
    fn parts(fans: &Fans<'_>) -> Vec<Vec<u32>> {
        let mut part_of = std::collections::BTreeMap::new();
        for f in 0..fans.ground.mesh.face_count() as u32 {
            let mut open = fans.corners(Face(f)).to_vec();
            let mut least = f;
            let mut seen = std::collections::BTreeSet::new();
            while let Some(fan) = open.pop() {
                if seen.insert(fan) {
                    open.extend(fans.neighbours(fan));
                    least = fans.faces(fan).iter().copied().min().unwrap_or(least).min(least);
                }
            }
            part_of.entry(least).or_insert_with(Vec::new).push(f);
        }
        part_of.into_values().collect()
    }

    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    /// Each side of the cube in two faces.
    const SIDES: [[u32; 3]; 12] = [
        [0, 2, 1],
        [0, 3, 2],
        [4, 5, 6],
        [4, 6, 7],
        [0, 1, 5],
        [0, 5, 4],
        [1, 2, 6],
        [1, 6, 5],
        [2, 3, 7],
        [2, 7, 6],
        [3, 0, 4],
        [3, 4, 7],
    ];

    #[test]
    fn a_cube_falls_into_its_sides() {
        let mesh = mesh(&CUBE, &SIDES);
        let work = Work::new(&NoProgress, 0);
        let cut = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&cut);
        let pairs: Vec<Vec<u32>> = (0..6).map(|side| vec![2 * side, 2 * side + 1]).collect();
        assert_eq!(parts(&fans), pairs);
        // Three sides meet at each corner; a fan's normal is that of its side.
        for v in 0..8 {
            assert_eq!(fans.of(v).count(), 3);
            assert!(fans.of(v).all(|fan| fans.vertex(fan) == v && fans.shared_vertex(fan) == Some(v)));
        }
        for f in (0..12).map(Face) {
            let along = |fan: u32| fans.normal(fan).as_dvec3().normalize().dot(mesh.normal(f));
            assert!(fans.corners(f).into_iter().all(|fan| along(fan) > 1.0 - 1e-6));
        }
    }

    #[test]
    fn over_sharp_edges_a_cube_is_one() {
        let mesh = mesh(&CUBE, &SIDES);
        let work = Work::new(&NoProgress, 0);
        let whole = Ground::new(&mesh, true, &work);
        let fans = Fans::new(&whole);
        assert_eq!(parts(&fans), [(0..12).collect::<Vec<u32>>()]);
        assert!((0..8).all(|v| fans.of(v).eq([v]) && fans.shared_vertex(v).is_none()));
    }

    #[test]
    fn where_a_sharp_edge_ends_all_faces_are_one_fan() {
        // Flat all around but for a nose, of which only the ridge, from 0 to 5, is sharp.
        let corners =
            [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [2.0, 0.0, 1.5]];
        let triangles = [[0, 2, 5], [0, 5, 1], [0, 1, 4], [0, 4, 3], [0, 3, 2]];
        let mesh = mesh(&corners, &triangles);
        let sharp = (0..5)
            .flat_map(|f| Face(f).half_edges())
            .filter(|&h| mesh.edge_kind(h) == crate::EdgeKind::Feature)
            .count();
        assert_eq!(sharp, 2);
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let fans = Fans::new(&ground);
        assert_eq!(fans.of(0).count(), 1);
        let faces: usize = (0..6).flat_map(|v| fans.of(v)).map(|fan| fans.faces(fan).len()).sum();
        assert_eq!(faces, 5);
    }
}
