//! The vertices around a place, ring by ring.

use crate::curvature::fit::ground::Ground;

/// Vertices in whole rings around a start. Reused from place to place.
pub(super) struct Rings {
    /// With room behind the vertices, so that it need not be cleared for every one of them.
    room: Vec<u32>,
    count: usize,
    /// Vertices before this place have all their neighbours among the vertices.
    pub(super) inner: usize,
    seen: Seen,
}

impl Rings {
    /// For so many vertices or fans.
    pub(super) fn new(count: usize) -> Self {
        Rings { room: Vec::new(), count: 0, inner: 0, seen: Seen::new(count) }
    }

    pub(super) fn start(&mut self, vertices: impl IntoIterator<Item = u32>) {
        self.count = 0;
        self.inner = 0;
        self.seen.clear();
        for v in vertices {
            if self.seen.insert(v) {
                self.make_room(1);
                self.room[self.count] = v;
                self.count += 1;
            }
        }
    }

    /// Takes vertices that were gathered elsewhere.
    pub(super) fn take(&mut self, vertices: &[u32]) {
        self.count = 0;
        self.make_room(vertices.len());
        self.room[..vertices.len()].copy_from_slice(vertices);
        self.count = vertices.len();
    }

    #[inline]
    pub(super) fn vertices(&self) -> &[u32] {
        &self.room[..self.count]
    }

    #[inline]
    fn make_room(&mut self, more: usize) {
        let least = self.count + more;
        if self.room.len() < least {
            self.room.resize(2 * least, 0);
        }
    }

    /// True when the last ring added nothing: this is the whole patch.
    #[inline]
    pub(super) fn is_exhausted(&self) -> bool {
        self.inner == self.count
    }

    /// Adds the neighbours of all vertices. False, and in an undefined state, where one fan of faces at a vertex would
    /// have to be told from another for that.
    #[inline]
    pub(super) fn grow(&mut self, ground: &Ground<'_>) -> bool {
        self.grow_to(|v| (!ground.stars.is_divided(v)).then(|| ground.stars.neighbours(v)))
    }

    /// Adds what `neighbours` has for all in the last ring, vertices or fans. False, and in an undefined state, where
    /// it has none.
    #[inline]
    pub(super) fn grow_to<'n>(&mut self, neighbours: impl Fn(u32) -> Option<&'n [u32]>) -> bool {
        let ring = self.inner..self.count;
        self.inner = ring.end;
        for at in ring {
            let Some(neighbours) = neighbours(self.room[at]) else { return false };
            self.make_room(neighbours.len());
            let mut count = self.count;
            // Most have been seen, but which is hard to foretell: all are written down, and kept by counting.
            for &w in neighbours {
                self.room[count] = w;
                count += usize::from(self.seen.insert(w));
            }
            self.count = count;
        }
        true
    }
}

/// A set of vertices that is soon emptied.
struct Seen {
    /// When each vertex was last seen. Only what windows come to is brought into use: the system hands out zeros.
    times: Vec<u16>,
    now: u16,
}

impl Seen {
    fn new(count: usize) -> Self {
        Seen { times: vec![0; count], now: 1 }
    }

    fn clear(&mut self) {
        match self.now.checked_add(1) {
            Some(next) => self.now = next,
            None => *self = Seen::new(self.times.len()),
        }
    }

    /// False when the vertex was there already.
    #[inline]
    fn insert(&mut self, vertex: u32) -> bool {
        std::mem::replace(&mut self.times[vertex as usize], self.now) != self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sees_each_vertex_once_and_forgets() {
        let mut seen = Seen::new(50);
        for round in 0..70_000 {
            for v in 0..50_u32 {
                assert!(seen.insert(v), "{round}");
                assert!(!seen.insert(v));
            }
            seen.clear();
        }
    }
}
