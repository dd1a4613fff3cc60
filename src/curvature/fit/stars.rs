//! What lies around every vertex.

use crate::mesh::{EdgeKind, Face, FaceState, HalfEdge, Mesh, Vertex};

/// Of more faces at one vertex, as in the middle of a fan, a window takes only the nearest: time for a
/// window is bounded.
pub(super) const CROWDED: usize = 256;

/// The faces and the neighbours of every vertex, and how they hang together.
pub(super) struct Stars {
    faces: Lists,
    neighbours: Lists,
    marks: Vec<Mark>,
}

/// How the faces at a vertex hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Mark {
    /// All around it.
    Inside,
    /// In one fan, with a border on both sides.
    Border,
    /// Not at all or in several fans: sharp or non-manifold edges, several borders; or they are too many.
    Divided,
}

impl Stars {
    pub(super) fn new(mesh: &Mesh, ignore_features: bool) -> Self {
        let topology = mesh.topology();
        let count = mesh.positions().len();
        let takes_part = |f: &Face| matches!(mesh.face_state(*f), FaceState::Sound | FaceState::NoArea);
        let half_edges = || faces_of(mesh).filter(takes_part).flat_map(Face::half_edges);
        let (mut borders, mut marks) = (vec![0_u8; count], vec![Mark::Inside; count]);
        for h in half_edges() {
            let both = [topology.origin(h), topology.target(h)].map(Vertex::index);
            match mesh.edge_kind(h) {
                EdgeKind::Boundary => both.into_iter().for_each(|v| borders[v] = borders[v].saturating_add(1)),
                EdgeKind::NonManifold => both.into_iter().for_each(|v| marks[v] = Mark::Divided),
                EdgeKind::Feature if !ignore_features => both.into_iter().for_each(|v| marks[v] = Mark::Divided),
                EdgeKind::Feature | EdgeKind::Inner => {}
            }
        }
        let corners = || half_edges().map(|h| (topology.origin(h), h.face().0));
        let faces = Lists::new(count, corners);
        // Where windings agree, the half-edges of both faces show an edge from both ends.
        let is_shown_twice = |h: HalfEdge| topology.twin(h).is_some_and(|twin| !topology.is_flipped(h, twin));
        let neighbours = Lists::new(count, || {
            half_edges().flat_map(|h| {
                let (a, b) = (topology.origin(h), topology.target(h));
                let back = (!is_shown_twice(h)).then_some((b, a.0));
                std::iter::once((a, b.0)).chain(back)
            })
        });
        for (v, mark) in marks.iter_mut().enumerate() {
            let by_borders = match borders[v] {
                0 => Mark::Inside,
                1 | 2 => Mark::Border,
                _ => Mark::Divided,
            };
            *mark = if faces.of(v as u32).len() > CROWDED { Mark::Divided } else { by_borders.max(*mark) };
        }
        Stars { faces, neighbours, marks }
    }

    /// The faces at a vertex.
    #[inline]
    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        self.faces.of(vertex)
    }

    /// The vertices that share an edge with a vertex; some of them may be named twice.
    #[inline]
    pub(super) fn neighbours(&self, vertex: u32) -> &[u32] {
        self.neighbours.of(vertex)
    }

    /// True where not all faces at a vertex hang together.
    #[inline]
    pub(super) fn is_divided(&self, vertex: u32) -> bool {
        self.marks[vertex as usize] == Mark::Divided
    }

    /// True where the surface goes on all around a vertex.
    #[inline]
    pub(super) fn is_inside(&self, vertex: u32) -> bool {
        self.marks[vertex as usize] == Mark::Inside
    }
}

fn faces_of(mesh: &Mesh) -> impl Iterator<Item = Face> {
    (0..mesh.face_count() as u32).map(Face)
}

/// A list of numbers for every vertex, one behind the other.
struct Lists {
    ends: Vec<u32>,
    entries: Vec<u32>,
}

impl Lists {
    /// From pairs (vertex, entry), which are asked for twice; entries keep their order.
    fn new<I: Iterator<Item = (Vertex, u32)>>(count: usize, pairs: impl Fn() -> I) -> Self {
        let mut ends = vec![0_u32; count + 1];
        for (v, _) in pairs() {
            ends[v.index() + 1] += 1;
        }
        for v in 1..=count {
            ends[v] += ends[v - 1];
        }
        let mut entries = vec![0; ends[count] as usize];
        // Filling moves the start of each list to its end.
        for (v, entry) in pairs() {
            let at = &mut ends[v.index()];
            entries[*at as usize] = entry;
            *at += 1;
        }
        ends.pop();
        Lists { ends, entries }
    }

    #[inline]
    fn of(&self, vertex: u32) -> &[u32] {
        let start = if vertex == 0 { 0 } else { self.ends[vertex as usize - 1] };
        &self.entries[start as usize..self.ends[vertex as usize] as usize]
    }
}
