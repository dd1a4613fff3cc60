//! What lies around every vertex.

use super::blocks::Blocks;
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh, Vertex};
use std::ops::Range;
use std::sync::OnceLock;

/// Of more faces at one vertex, as in the middle of a fan, a window takes only the nearest: time for a
/// window is bounded.
pub(super) const CROWDED: usize = 256;

/// The faces and the neighbours of every vertex, and how they hang together.
pub(super) struct Stars<'m> {
    mesh: &'m Mesh,
    /// Made when asked for: many meshes do without.
    faces: OnceLock<Lists>,
    neighbours: Lists,
    marks: Vec<Mark>,
    are_all_inside: bool,
}

/// How the surface goes on around a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Mark {
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
    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        self.faces.get_or_init(|| Lists::of_faces(self.mesh)).of(vertex)
    }

    /// The vertices that share an edge with a vertex; some of them may be named twice.
    #[inline]
    pub(super) fn neighbours(&self, vertex: u32) -> &[u32] {
        self.neighbours.of(vertex)
    }

    /// The share of vertices that lie neither on a border nor on a sharp edge.
    pub(super) fn coverage(&self, vertices: impl ExactSizeIterator<Item = u32>) -> f64 {
        let count = vertices.len() as f64;
        vertices.filter(|&v| self.is_inside(v)).count() as f64 / count
    }

    #[inline]
    pub(super) fn mark(&self, vertex: u32) -> Mark {
        self.marks[vertex as usize]
    }

    /// True where not all faces at a vertex hang together.
    #[inline]
    pub(super) fn is_divided(&self, vertex: u32) -> bool {
        self.mark(vertex) == Mark::Divided
    }

    /// True where the surface goes on all around every vertex.
    pub(super) fn are_all_inside(&self) -> bool {
        self.are_all_inside
    }

    /// True where the surface goes on all around a vertex.
    #[inline]
    pub(super) fn is_inside(&self, vertex: u32) -> bool {
        self.mark(vertex) > Mark::Border
    }
}

/// The half-edges of the faces of a range that take part.
pub(super) fn half_edges(mesh: &Mesh, faces: Range<u32>) -> impl Iterator<Item = HalfEdge> {
    let takes_part = |f: &Face| mesh.is_in_surface(*f);
    faces.map(Face).filter(takes_part).flat_map(Face::half_edges)
}

/// Lists of numbers one behind the other, as many as vertices for instance: first the lengths are counted in `ends`,
/// then there is room, then the numbers are pushed.
pub(super) struct Lists {
    ends: Vec<u32>,
    entries: Vec<u32>,
}

impl Lists {
    fn counted(count: usize) -> Self {
        Lists { ends: vec![0; count], entries: Vec::new() }
    }

    /// From pairs of a list and an entry.
    pub(super) fn of_pairs<I: Iterator<Item = (u32, u32)>>(count: usize, pairs: impl Fn() -> I) -> Self {
        let mut lists = Lists::counted(count);
        pairs().for_each(|(list, _)| lists.ends[list as usize] += 1);
        lists.make_room();
        pairs().for_each(|(list, entry)| lists.push(list, entry));
        lists
    }

    /// From pairs of a vertex and an entry that blocks of faces tell, and some besides.
    fn by_vertex<I: Iterator<Item = (u32, u32)>>(
        count: usize,
        blocks: &Blocks,
        pairs: impl Fn(Range<u32>) -> I + Sync,
        besides: Vec<(u32, u32)>,
    ) -> Self {
        let mut lists = Lists::counted(count);
        let others = blocks.fill(&mut lists.ends, |faces, own, ends| {
            let mut others = Vec::new();
            pairs(faces).for_each(|(v, _)| match own.contains(&(v as usize)) {
                true => ends[v as usize - own.start] += 1,
                false => others.push(v),
            });
            others
        });
        others.into_iter().chain(besides.iter().map(|(v, _)| *v)).for_each(|v| lists.ends[v as usize] += 1);
        lists.make_room();
        let mut shares = Vec::with_capacity(blocks.own().len());
        let (mut ends, mut entries, mut start) = (&mut lists.ends[..], &mut lists.entries[..], 0);
        for own in blocks.own() {
            let of_own;
            (of_own, ends) = ends.split_at_mut(own.len());
            let until = ends.first().map_or(start + entries.len(), |&next| next as usize);
            let share;
            (share, entries) = entries.split_at_mut(until - start);
            shares.push((start, of_own, share));
            start = until;
        }
        let others = blocks.each(shares, |faces, own, (start, ends, entries)| {
            let mut others = Vec::new();
            pairs(faces).for_each(|(v, entry)| {
                if own.contains(&(v as usize)) {
                    let end = &mut ends[v as usize - own.start];
                    entries[*end as usize - start] = entry;
                    *end += 1;
                } else {
                    others.push((v, entry));
                }
            });
            others
        });
        others.into_iter().chain(besides).for_each(|(v, entry)| lists.push(v, entry));
        lists
    }

    fn of_faces(mesh: &Mesh) -> Self {
        // Not by blocks side by side: those who wait for the lists may be what another block would wait for.
        let corners = || {
            let all = 0..mesh.face_count() as u32;
            half_edges(mesh, all).map(|h| (mesh.topology().origin(h).0, h.face().0))
        };
        Lists::of_pairs(mesh.positions().len(), corners)
    }

    /// Turns lengths into starts.
    fn make_room(&mut self) {
        let mut total = 0;
        for end in &mut self.ends {
            total += std::mem::replace(end, total);
        }
        self.entries.resize(total as usize, 0);
    }

    /// Pushing moves the start of each list to its end.
    #[inline]
    fn push(&mut self, list: u32, entry: u32) {
        let at = &mut self.ends[list as usize];
        self.entries[*at as usize] = entry;
        *at += 1;
    }

    #[inline]
    pub(super) fn of(&self, list: u32) -> &[u32] {
        let start = if list == 0 { 0 } else { self.ends[list as usize - 1] };
        &self.entries[start as usize..self.ends[list as usize] as usize]
    }
}
