//! Newtype ids, so that a face number cannot be taken for a vertex number.

/// A face (triangle), numbered as in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Face(pub u32);

/// A welded vertex, numbered by first use in face order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Vertex(pub u32);

/// One side of an edge: half-edge `3 f + i` runs from corner `i` of face `f` to its next corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HalfEdge(pub u32);

impl Face {
    /// The face's half-edges, in its winding.
    #[inline]
    pub fn half_edges(self) -> [HalfEdge; 3] {
        let first = 3 * self.0;
        [HalfEdge(first), HalfEdge(first + 1), HalfEdge(first + 2)]
    }

    /// The id as an index.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl Vertex {
    /// The id as an index.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl HalfEdge {
    /// The face it belongs to.
    #[inline]
    pub fn face(self) -> Face {
        Face(self.0 / 3)
    }

    /// The next half-edge of the same face.
    #[inline]
    pub fn next(self) -> HalfEdge {
        HalfEdge(if self.0 % 3 == 2 { self.0 - 2 } else { self.0 + 1 })
    }

    /// The previous half-edge of the same face.
    #[inline]
    pub fn prev(self) -> HalfEdge {
        HalfEdge(if self.0.is_multiple_of(3) { self.0 + 2 } else { self.0 - 1 })
    }

    /// The id as an index.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}
