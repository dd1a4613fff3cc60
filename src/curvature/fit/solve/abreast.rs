//! Windows of samples side by side, for fits of four at a time.

use crate::curvature::fit::surface::frame::{LocalFrame, leaning};
use crate::curvature::vectors::four::{F4, LANES, V3};
use glam::{DMat3, DVec3};

/// Up to four windows of samples, one in each lane.
pub(in crate::curvature::fit) struct Abreast {
    /// Where the points of each window are seen from.
    origins: [DVec3; LANES],
    pub(super) frames: LocalFrames,
    /// Samples as seen from the origins, in file units; zero beyond the end of a lane's window.
    pub(super) points: Vec<V3<F4>>,
    /// Roots of the samples' weights; zero beyond the end of a lane's window.
    pub(super) roots: Vec<F4>,
    pub(super) counts: [usize; LANES],
}

/// Frames side by side.
#[derive(Clone, Copy)]
pub(super) struct LocalFrames {
    /// As seen from where the points are seen from.
    pub(super) origin: V3<F4>,
    /// Two tangents and the normal.
    pub(super) axes: [V3<F4>; 3],
    /// One unit of local length.
    pub(super) unit: F4,
}

impl LocalFrames {
    const NONE: LocalFrames = LocalFrames { origin: V3::ZERO, axes: [V3::ZERO; 3], unit: F4::ONE };

    #[inline(always)]
    pub(super) fn to_local(self, p: V3<F4>) -> V3<F4> {
        let (d, [x, y, z]) = (p - self.origin, self.axes);
        V3::new(d.dot(x), d.dot(y), d.dot(z)).scaled(F4::ONE / self.unit)
    }

    /// The frames whose origins lie `height` over these along the normals, leaning by the slopes `x` and `y` of a
    /// plane.
    #[inline(always)]
    pub(super) fn moved(self, height: F4, x: F4, y: F4) -> LocalFrames {
        let origin = self.origin + self.axes[2].scaled(height * self.unit);
        LocalFrames { origin, axes: leaning(self.axes, x, y), unit: self.unit }
    }
}

impl Abreast {
    pub(in crate::curvature::fit) fn new() -> Self {
        let origins = [DVec3::ZERO; LANES];
        Abreast { origins, frames: LocalFrames::NONE, points: vec![], roots: vec![], counts: [0; LANES] }
    }

    pub(in crate::curvature::fit) fn clear(&mut self) {
        self.frames = LocalFrames::NONE;
        self.points.clear();
        self.roots.clear();
        self.counts = [0; LANES];
    }

    /// Puts a window into a lane: its samples, the roots of their weights, and the frame to begin with.
    pub(in crate::curvature::fit) fn load(
        &mut self,
        lane: usize,
        frame: LocalFrame,
        samples: impl ExactSizeIterator<Item = (DVec3, f64)>,
    ) {
        let count = samples.len();
        if self.points.len() < count {
            self.points.resize(count, V3::ZERO);
            self.roots.resize(count, F4::ZERO);
        }
        for ((point, root), (at, weight)) in self.points.iter_mut().zip(&mut self.roots).zip(samples) {
            point.set(lane, at - frame.origin);
            root.0[lane] = weight;
        }
        self.origins[lane] = frame.origin;
        self.counts[lane] = count;
        self.frames.unit.0[lane] = frame.unit;
        let axes = [frame.axes.x_axis, frame.axes.y_axis, frame.axes.z_axis];
        self.frames.axes.iter_mut().zip(axes).for_each(|(to, axis)| to.set(lane, axis));
    }

    /// The frame of a lane; `None` where it is not of finite numbers or the lane is empty.
    pub(in crate::curvature::fit) fn frame(&self, lane: usize) -> Option<LocalFrame> {
        let LocalFrames { origin, axes: [x, y, z], unit } = &self.frames;
        let axes = DMat3::from_cols(x.get(lane), y.get(lane), z.get(lane));
        let origin = self.origins[lane] + origin.get(lane);
        let is_frame = self.counts[lane] > 0 && origin.is_finite() && axes.is_finite();
        is_frame.then_some(LocalFrame { origin, axes, unit: unit.0[lane] })
    }
}
