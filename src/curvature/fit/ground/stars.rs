//! What lies around every vertex.

use super::blocks::Blocks;
use super::lists::Lists;
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh, Vertex};
use std::ops::Range;
use std::sync::OnceLock;

/// Of more faces at one vertex, as in the middle of a fan, a window takes only the nearest: time for a
/// window is bounded.
pub(in crate::curvature::fit) const CROWDED: usize = 256;

/// The faces and the neighbours of every vertex, and how they hang together.
pub(in crate::curvature::fit) struct Stars<'m> {
    mesh: &'m Mesh,
    /// Made when asked for: many meshes do without.
    faces: OnceLock<Lists>,
    neighbours: Lists,
    marks: Vec<Mark>,
    are_all_inside: bool,
}

/// How the surface goes on around a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::curvature::fit) enum Mark {
    /// Not at all or in several fans, as sharp or non-manifold edges or several borders tell; or the faces are too
    /// many. Fans without a border that touch in the vertex alone are not told apart.
    Divided,
    /// In one fan, with a border on both sides.
    Border,
    /// All around it, but not all around a neighbour.
    BesideEdge,
    /// All around it and its neighbours, but not theirs.
    NearEdge,
    /// All around it, its neighbours and theirs.
    Deep,
}

impl<'m> Stars<'m> {
    pub(super) fn new(mesh: &'m Mesh, blocks: &Blocks, ignore_features: bool) -> Self {
        let topology = mesh.topology();
        let count = mesh.positions().len();
        let (mut borders, mut marks) = (vec![0_u8; count], vec![Mark::Deep; count]);
        // Where windings agree, the half-edges of both faces show an edge from both ends.
        let is_shown_once = |h: &HalfEdge| topology.twin(*h).is_none_or(|twin| topology.is_flipped(*h, twin));
        let ends = |h: HalfEdge| (topology.origin(h).0, topology.target(h).0);
        let shown_once = blocks.of_faces(|faces| half_edges(mesh, faces).filter(is_shown_once).collect());
        let from_others = shown_once.into_iter().map(|h| (ends(h).1, ends(h).0)).collect();
        let neighbours = Lists::by_vertex(count, blocks, |faces| half_edges(mesh, faces).map(ends), from_others);
        let is_no_inner = |h: &HalfEdge| mesh.edge_kind(*h) != EdgeKind::Inner;
        let others = blocks.of_faces(|faces| half_edges(mesh, faces).filter(is_no_inner).collect());
        for h in others {
            let both = [topology.origin(h), topology.target(h)].map(Vertex::index);
            match mesh.edge_kind(h) {
                EdgeKind::Inner => {}
                EdgeKind::Boundary => both.into_iter().for_each(|v| borders[v] = borders[v].saturating_add(1)),
                EdgeKind::NonManifold => both.into_iter().for_each(|v| marks[v] = Mark::Divided),
                EdgeKind::Feature if ignore_features => {}
                EdgeKind::Feature => both.into_iter().for_each(|v| marks[v] = Mark::Divided),
            }
        }
        for (v, mark) in marks.iter_mut().enumerate() {
            let by_borders = match borders[v] {
                0 => Mark::Deep,
                1 | 2 => Mark::Border,
                _ => Mark::Divided,
            };
            *mark = if neighbours.of(v as u32).len() > CROWDED { Mark::Divided } else { by_borders.min(*mark) };
        }
        let are_all_inside = marks.iter().all(|&mark| mark == Mark::Deep);
        if !are_all_inside {
            let mut spread = |from: fn(Mark) -> bool, to: Mark| {
                let beside = |v: usize| neighbours.of(v as u32).iter().any(|&w| from(marks[w as usize]));
                let found: Vec<usize> = (0..count).filter(|&v| marks[v] == Mark::Deep && beside(v)).collect();
                found.into_iter().for_each(|v| marks[v] = to);
            };
            spread(|mark| mark <= Mark::Border, Mark::BesideEdge);
            spread(|mark| mark == Mark::BesideEdge, Mark::NearEdge);
        }
        Stars { mesh, faces: OnceLock::new(), neighbours, marks, are_all_inside }
    }

    /// The faces at a vertex.
    #[inline]
    pub(in crate::curvature::fit) fn of(&self, vertex: u32) -> &[u32] {
        self.faces.get_or_init(|| faces_around(self.mesh)).of(vertex)
    }

    /// The vertices that share an edge with a vertex; some of them may be named twice.
    #[inline]
    pub(in crate::curvature::fit) fn neighbours(&self, vertex: u32) -> &[u32] {
        self.neighbours.of(vertex)
    }

    /// The share of vertices that lie neither on a border nor on a sharp edge.
    pub(in crate::curvature::fit) fn coverage(&self, vertices: impl ExactSizeIterator<Item = u32>) -> f64 {
        let count = vertices.len() as f64;
        vertices.filter(|&v| self.is_inside(v)).count() as f64 / count
    }

    #[inline]
    pub(in crate::curvature::fit) fn mark(&self, vertex: u32) -> Mark {
        self.marks[vertex as usize]
    }

    /// True where not all faces at a vertex hang together.
    #[inline]
    pub(in crate::curvature::fit) fn is_divided(&self, vertex: u32) -> bool {
        self.mark(vertex) == Mark::Divided
    }

    /// True where the surface goes on all around every vertex.
    pub(in crate::curvature::fit) fn are_all_inside(&self) -> bool {
        self.are_all_inside
    }

    /// True where the surface goes on all around a vertex.
    #[inline]
    pub(in crate::curvature::fit) fn is_inside(&self, vertex: u32) -> bool {
        self.mark(vertex) > Mark::Border
    }
}

/// The faces around every vertex.
fn faces_around(mesh: &Mesh) -> Lists {
    // Not by blocks side by side: those who wait for the lists may be what another block would wait for.
    let corners = || {
        let all = 0..mesh.face_count() as u32;
        half_edges(mesh, all).map(|h| (mesh.topology().origin(h).0, h.face().0))
    };
    Lists::of_pairs(mesh.positions().len(), corners)
}

/// The half-edges of the faces of a range that take part.
pub(super) fn half_edges(mesh: &Mesh, faces: Range<u32>) -> impl Iterator<Item = HalfEdge> {
    let takes_part = |f: &Face| mesh.is_in_surface(*f);
    faces.map(Face).filter(takes_part).flat_map(Face::half_edges)
}
