//! The vertices around a place, ring by ring.

use super::ground::Ground;

/// Vertices in whole rings around a start. Reused from place to place.
pub(super) struct Rings {
    pub(super) vertices: Vec<u32>,
    /// Vertices before this place have all their neighbours among the vertices.
    pub(super) inner: usize,
    seen: Seen,
}

impl Rings {
    pub(super) fn new() -> Self {
        Rings { vertices: Vec::new(), inner: 0, seen: Seen::new() }
    }

    pub(super) fn start(&mut self, vertices: impl IntoIterator<Item = u32>) {
        self.vertices.clear();
        self.inner = 0;
        self.seen.clear();
        for v in vertices {
            if self.seen.insert(v) {
                self.vertices.push(v);
            }
        }
    }

    /// True when the last ring added nothing: this is the whole patch.
    #[inline]
    pub(super) fn is_exhausted(&self) -> bool {
        self.inner == self.vertices.len()
    }

    /// Adds the neighbours of all vertices. False, and in an undefined state, where one fan of faces at a vertex would
    /// have to be told from another for that.
    #[inline]
    pub(super) fn grow(&mut self, ground: &Ground<'_>) -> bool {
        self.grow_to(|v| (!ground.stars.is_divided(v)).then(|| ground.stars.neighbours(v)))
    }

    /// Adds what `neighbours` has for all in the last ring, vertices or fans. False, and in an undefined state, where it has
    /// none.
    #[inline]
    pub(super) fn grow_to<'n>(&mut self, neighbours: impl Fn(u32) -> Option<&'n [u32]>) -> bool {
        let ring = self.inner..self.vertices.len();
        self.inner = ring.end;
        for at in ring {
            let Some(neighbours) = neighbours(self.vertices[at]) else { return false };
            self.seen.make_room(neighbours.len());
            for &w in neighbours {
                if self.seen.insert(w) {
                    self.vertices.push(w);
                }
            }
        }
        true
    }
}

/// A small set of vertices that is emptied without touching its memory.
struct Seen {
    /// Age and number.
    slots: Vec<u64>,
    age: u64,
    count: usize,
}

impl Seen {
    const AGE: u64 = 1 << 32;

    fn new() -> Self {
        Seen { slots: vec![0; 256], age: Seen::AGE, count: 0 }
    }

    fn clear(&mut self) {
        self.count = 0;
        // After four thousand million starts what was seen in the first ones would come to life.
        self.age = self.age.checked_add(Seen::AGE).unwrap_or_else(|| {
            self.slots.fill(0);
            Seen::AGE
        });
    }

    /// Keeps the table at most half full.
    #[inline]
    fn make_room(&mut self, more: usize) {
        while 2 * (self.count + more) > self.slots.len() {
            let larger = vec![0; 2 * self.slots.len()];
            let held = std::mem::replace(&mut self.slots, larger);
            self.count = 0;
            for held in held {
                if held >= self.age {
                    self.insert(held as u32);
                }
            }
        }
    }

    /// False when the vertex was there already. There must be room.
    #[inline]
    fn insert(&mut self, vertex: u32) -> bool {
        let mask = self.slots.len() - 1;
        let wanted = self.age | u64::from(vertex);
        let mut at = (u64::from(vertex).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as usize;
        loop {
            let held = &mut self.slots[at & mask];
            if *held == wanted {
                return false;
            }
            if *held < self.age {
                *held = wanted;
                self.count += 1;
                return true;
            }
            at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sees_each_vertex_once_and_forgets() {
        let mut seen = Seen::new();
        for round in 0..3 {
            for v in (0..5000_u32).map(|v| v.wrapping_mul(2_654_435_761)) {
                seen.make_room(1);
                assert!(seen.insert(v), "{round}");
                assert!(!seen.insert(v));
            }
            seen.clear();
        }
    }
}
