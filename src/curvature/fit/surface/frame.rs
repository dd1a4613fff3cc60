//! The local frame of a fit.

use super::shape::tangents;
use crate::curvature::vectors::four::{Real, V3};
use glam::{DMat3, DVec3};

/// Where a fit sees the world from.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct LocalFrame {
    pub(in crate::curvature::fit) origin: DVec3,
    /// Columns: two tangents and the normal.
    pub(in crate::curvature::fit) axes: DMat3,
    /// One unit of local length.
    pub(in crate::curvature::fit) unit: f64,
}

impl LocalFrame {
    /// A frame with the normal as given; `None` where that has no direction.
    pub(in crate::curvature::fit) fn upright(origin: DVec3, normal: DVec3, unit: f64) -> Option<Self> {
        let normal = normal.try_normalize()?;
        let (x, y) = tangents(normal.into());
        let axes = DMat3::from_cols(x.into(), y.into(), normal);
        (unit > 0.0 && unit.is_finite()).then_some(LocalFrame { origin, axes, unit })
    }

    /// The frame whose origin lies `height` units over this one along the normal, leaning by the slopes `x` and `y` of
    /// a plane; `None` where that is not of finite numbers.
    pub(in crate::curvature::fit) fn moved(&self, height: f64, x: f64, y: f64) -> Option<Self> {
        let LocalFrame { origin, axes: DMat3 { x_axis: u, y_axis: v, z_axis: n }, unit } = *self;
        let [x, y, z] = leaning([u.into(), v.into(), n.into()], x, y);
        let axes = DMat3::from_cols(x.into(), y.into(), z.into());
        let moved = LocalFrame { origin: origin + n * (height * unit), axes, unit };
        (moved.origin.is_finite() && moved.axes.is_finite()).then_some(moved)
    }

    #[inline]
    pub(in crate::curvature::fit) fn to_local(self, p: DVec3) -> DVec3 {
        self.axes.transpose() * ((p - self.origin) / self.unit)
    }
}

/// Two tangents and a normal that lean by the slopes `x` and `y` of a plane over those given.
#[inline(always)]
pub(in crate::curvature::fit) fn leaning<T: Real>([u, v, n]: [V3<T>; 3], x: T, y: T) -> [V3<T>; 3] {
    let one = T::splat(1.0);
    let lean = n - u.scaled(x) - v.scaled(y);
    let n = lean.scaled(one / lean.dot(lean).sqrt());
    let u = u - n.scaled(u.dot(n));
    let u = u.scaled(one / u.dot(u).sqrt());
    [u, n.cross(u), n]
}
