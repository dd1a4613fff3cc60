//! The mesh as legs walk it: what lies across every edge, one 64-byte line per face.
//!
//! A leg that crosses an edge needs the neighbour's far corner, and the edge by which it may go on. Both
//! stand in one 16-byte slot, so that a crossing waits for memory once. The corner is seen from the edge's
//! start: in 32 bits that keeps seven digits of the face's own size, wherever in space the mesh lies and
//! however large it is.
//!
//! Faces are wound as their component's majority, so that an edge that a leg leaves by always starts below
//! the leg's plane and ends above it. Of the two edges beyond, the first rises from the same start, the
//! second to the same end. The fourth slot repeats the first: the second edge is always one slot further.

use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use rayon::prelude::*;

/// The far corner across an edge, and the bits of the number of the first edge beyond.
pub(super) type Slot = [f32; 4];

/// Slots of a face.
const LINE: usize = 4;
/// Bytes after which lines begin: a multiple of that is one fetch from memory.
const ALIGNMENT: usize = 64;

/// What lies across every edge. Edge `4 f + i` is the i-th of the f-th face in the order given.
#[derive(Debug)]
pub(super) struct Steps {
    slots: Vec<Slot>,
    /// Slots before the first line.
    skipped: usize,
    stop: u32,
    scale: f64,
}

/// Numbers of edges are compared with signs.
const MOST_FACES: usize = (1 << 29) - 2;

impl Steps {
    /// The lines of a mesh's faces in `order`; `place` has the place in it of every face. `None` where the
    /// mesh is too large for it, or has no size that can be scaled to one.
    pub(super) fn new(mesh: &Mesh, order: &[Face], place: &[u32]) -> Option<Self> {
        let scale = mesh.report().bounds.and_then(|bounds| to_one(bounds.size().max_element()))?;
        if order.len() > MOST_FACES {
            return None;
        }
        let stop = (LINE * order.len()) as u32;
        let builder = Builder { mesh, place, scale, stop };
        let mut slots = vec![[0.0; 4]; LINE * (order.len() + 3)];
        let skipped = slots.as_ptr().align_offset(ALIGNMENT).min(LINE - 1);
        let (lines, ends) = slots[skipped..].split_at_mut(LINE * order.len());
        lines.as_chunks_mut::<LINE>().0.par_iter_mut().zip(order).for_each(|(line, &face)| *line = builder.line(face));
        // Whoever comes to one of the last two lines stays there.
        ends[..LINE].fill(slot([0.0; 3], stop));
        ends[LINE..2 * LINE].fill(slot([0.0; 3], stop + LINE as u32));
        Some(Steps { slots, skipped, stop, scale })
    }

    /// Lengths here are those of the mesh times this power of two.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    /// What lies across every edge, by edge.
    #[inline(always)]
    pub(super) fn slots(&self) -> &[Slot] {
        &self.slots[self.skipped..]
    }

    /// The edge of legs that have ended; greater ones are the ends of legs, too.
    #[inline(always)]
    pub(super) fn stop(&self) -> u32 {
        self.stop
    }

    /// The edge of legs that can only be walked with the mesh itself.
    #[inline(always)]
    pub(super) fn lost(&self) -> u32 {
        self.stop + LINE as u32
    }
}

fn slot([x, y, z]: [f32; 3], edge: u32) -> Slot {
    [x, y, z, f32::from_bits(edge)]
}

/// The power of two that brings a size to between one and two; `None` where there is none.
fn to_one(size: f64) -> Option<f64> {
    let exponent = size.to_bits() >> 52;
    (1..2046).contains(&exponent).then(|| f64::from_bits((2046 - exponent) << 52))
}

struct Builder<'m> {
    mesh: &'m Mesh,
    place: &'m [u32],
    scale: f64,
    stop: u32,
}

impl Builder<'_> {
    fn line(&self, face: Face) -> [Slot; LINE] {
        let [a, b, c] = face.half_edges().map(|h| self.across(h));
        // Wound the other way round, the first edge comes last.
        if self.mesh.is_flipped(face) { [c, b, a, c] } else { [a, b, c, a] }
    }

    fn across(&self, h: HalfEdge) -> Slot {
        let (mesh, topology) = (self.mesh, self.mesh.topology());
        let Some(twin) = topology.twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner) else {
            return slot([0.0; 3], self.stop);
        };
        let is_flipped = mesh.is_flipped(h.face());
        let twin_is_flipped = mesh.is_flipped(twin.face());
        // Only where a surface has but one side.
        if topology.is_flipped(h, twin) != (is_flipped != twin_is_flipped) {
            return slot([0.0; 3], self.stop + LINE as u32);
        }
        let start = if is_flipped { topology.target(h) } else { topology.origin(h) };
        let apex = topology.apex(twin);
        let seen = self.scale * (mesh.position(apex) - mesh.position(start));
        let index = twin.0 % 3;
        let next = if twin_is_flipped { 3 - index } else { index + 1 } % 3;
        slot(seen.as_vec3().to_array(), LINE as u32 * self.place[twin.face().index()] + next)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_brought_to_one() {
        for size in [1e-300, 3e-5, 1.0, 1.5, 2.0, 7e7, 1e300] {
            let scale = to_one(size).expect("a scale");
            assert!((1.0..2.0).contains(&(size * scale)), "{size}");
        }
        assert!([0.0, 1e-320, f64::INFINITY, f64::NAN].into_iter().all(|size| to_one(size).is_none()));
    }
}
