//! Finds the vertex at a position.

use glam::DVec3;

/// Coordinates in the width the file stores them.
pub(super) trait Position: Copy + Send + Sync {
    /// Zero on every axis.
    const ORIGIN: Self;
    /// With 0.0 for -0.0.
    fn canonical(self) -> Self;
    /// The coordinates' bits in two words that are equal for equal positions only, or nearly so.
    fn words(self) -> [u64; 2];
    /// True when all bits are equal: a NaN then equals itself, too.
    fn is(self, other: Self) -> bool;
    /// In 64 bits.
    fn wide(self) -> DVec3;
}

impl Position for [f32; 3] {
    const ORIGIN: Self = [0.0; 3];

    #[inline]
    fn canonical(self) -> Self {
        // Adding 0.0 turns -0.0 into 0.0 and leaves every other number as it is.
        self.map(|c| c + 0.0)
    }

    #[inline]
    fn words(self) -> [u64; 2] {
        let [x, y, z] = self.map(|c| u64::from(c.to_bits()));
        [x | y << 32, z]
    }

    #[inline]
    fn is(self, other: Self) -> bool {
        self.map(f32::to_bits) == other.map(f32::to_bits)
    }

    #[inline]
    fn wide(self) -> DVec3 {
        DVec3::from_array(self.map(f64::from))
    }
}

impl Position for [f64; 3] {
    const ORIGIN: Self = [0.0; 3];

    #[inline]
    fn canonical(self) -> Self {
        self.map(|c| c + 0.0)
    }

    #[inline]
    fn words(self) -> [u64; 2] {
        let [x, y, z] = self.map(f64::to_bits);
        [x ^ z.rotate_left(23).wrapping_mul(0x9e37_79b9_7f4a_7c15), y ^ z]
    }

    #[inline]
    fn is(self, other: Self) -> bool {
        self.map(f64::to_bits) == other.map(f64::to_bits)
    }

    #[inline]
    fn wide(self) -> DVec3 {
        DVec3::from_array(self)
    }
}

/// Slots hold the upper half of a hash and a vertex number. No vertex has the number of an empty one.
const EMPTY: u64 = u64::MAX;

/// Positions that are looked up together.
pub(super) const TOGETHER: usize = 24;

/// A hash table with linear probing. Keys are the vertices' positions; the half of the hash in each slot
/// spares most looks at those of other vertices.
pub(super) struct VertexTable<P> {
    slots: Vec<u64>,
    positions: Vec<P>,
    /// The first vertex of each body; part of the seed of the body's hashes.
    bodies: Vec<u32>,
    secret: u64,
}

impl<P: Position> VertexTable<P> {
    /// A table that has room for so many vertices at first.
    pub(super) fn new(expected: usize, secret: u64) -> Self {
        let capacity = (2 * expected.max(8)).next_power_of_two();
        VertexTable { slots: vec![EMPTY; capacity], positions: Vec::with_capacity(expected), bodies: vec![0], secret }
    }

    /// Forgets all vertices.
    pub(super) fn clear(&mut self) {
        if !self.positions.is_empty() {
            self.slots.fill(EMPTY);
            self.positions.clear();
        }
    }

    /// Positions by vertex.
    pub(super) fn positions(&self) -> &[P] {
        &self.positions
    }

    /// Vertices made from here on are not found by positions of before. Returns the next number.
    pub(super) fn begin_body(&mut self) -> u32 {
        let first = self.positions.len() as u32;
        self.bodies.push(first);
        first
    }

    /// The vertex of this body at a canonical position, made if there is none yet.
    #[inline]
    pub(super) fn vertex_at(&mut self, position: P) -> u32 {
        let hash = hash(position.words(), self.seed());
        self.find_or_make(position, hash)
    }

    /// The vertices at many canonical positions.
    pub(super) fn vertices_at(&mut self, positions: &[P]) -> Vec<u32> {
        let mut vertices = vec![0; positions.len()];
        for (positions, vertices) in positions.chunks(TOGETHER).zip(vertices.chunks_mut(TOGETHER)) {
            self.find_all(positions, vertices);
        }
        vertices
    }

    /// The vertices at up to [`TOGETHER`] canonical positions. Slots that are far from the processor
    /// are fetched together, not one after another.
    #[inline]
    pub(super) fn find_all(&mut self, positions: &[P], vertices: &mut [u32]) {
        let seed = self.seed();
        let mask = self.slots.len() - 1;
        let mut hashes = [0; TOGETHER];
        let mut fetched = 0;
        for (kept, position) in hashes.iter_mut().zip(positions) {
            *kept = hash(position.words(), seed);
            fetched ^= self.slots[*kept as usize & mask];
        }
        std::hint::black_box(fetched);
        for ((vertex, &position), hash) in vertices.iter_mut().zip(positions).zip(hashes) {
            *vertex = self.find_or_make(position, hash);
        }
    }

    /// Different for each body: equal positions of ten thousand copies of a screw must not queue up
    /// behind one another.
    #[inline]
    fn seed(&self) -> u64 {
        self.secret ^ u64::from(self.bodies[self.bodies.len() - 1])
    }

    #[inline]
    fn find_or_make(&mut self, position: P, hash: u64) -> u32 {
        if 2 * (self.positions.len() + 1) > self.slots.len() {
            self.grow();
        }
        let first = self.bodies[self.bodies.len() - 1];
        let mask = self.slots.len() - 1;
        let tag = hash & TAG;
        let mut slot = hash as usize & mask;
        loop {
            let found = self.slots[slot];
            if found == EMPTY {
                let new = self.positions.len() as u32;
                self.slots[slot] = tag | u64::from(new);
                self.positions.push(position);
                return new;
            }
            let vertex = found as u32;
            if found & TAG == tag && vertex >= first && self.positions[vertex as usize].is(position) {
                return vertex;
            }
            slot = (slot + 1) & mask;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let mask = 2 * self.slots.len() - 1;
        let mut slots = vec![EMPTY; mask + 1];
        let mut bodies = self.bodies.iter().peekable();
        let mut first = 0;
        for (vertex, &position) in self.positions.iter().enumerate() {
            while let Some(&next) = bodies.next_if(|&&next| next as usize <= vertex) {
                first = next;
            }
            let hash = hash(position.words(), self.secret ^ u64::from(first));
            let mut slot = hash as usize & mask;
            while slots[slot] != EMPTY {
                slot = (slot + 1) & mask;
            }
            slots[slot] = hash & TAG | vertex as u64;
        }
        self.slots = slots;
    }
}

/// The half of a hash that is kept.
const TAG: u64 = u64::MAX << 32;

/// Multiply and fold, once per word.
#[inline]
fn hash(words: [u64; 2], seed: u64) -> u64 {
    words.into_iter().fold(seed, |h, word| {
        let product = u128::from((h ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15)) * 0xd6e8_feb8_6659_fd93;
        (product as u64) ^ ((product >> 64) as u64)
    })
}
