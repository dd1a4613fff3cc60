//! The local frame of a fit.

use super::shape::tangents;
use glam::{DMat3, DVec3};

/// Where a fit sees the world from.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Frame {
    pub(in crate::curvature::fit) origin: DVec3,
    /// Columns: two tangents and the normal.
    pub(in crate::curvature::fit) axes: DMat3,
    /// One unit of local length.
    pub(in crate::curvature::fit) unit: f64,
}

impl Frame {
    /// A frame with the normal as given; `None` where that has no direction.
    pub(in crate::curvature::fit) fn upright(origin: DVec3, normal: DVec3, unit: f64) -> Option<Self> {
        let normal = normal.try_normalize()?;
        let (x, y) = tangents(normal.into());
        let axes = DMat3::from_cols(x.into(), y.into(), normal);
        (unit > 0.0 && unit.is_finite()).then_some(Frame { origin, axes, unit })
    }

    /// The frame whose origin lies `height` units over this one along the normal, leaning by the slopes `x` and `y` of
    /// a plane; `None` where that is not of finite numbers.
    pub(in crate::curvature::fit) fn moved(&self, height: f64, x: f64, y: f64) -> Option<Self> {
        let Frame { origin, axes: DMat3 { x_axis: u, y_axis: v, z_axis: n }, unit } = *self;
        let normal = (n - u * x - v * y).normalize();
        let u = u.reject_from_normalized(normal).normalize();
        let moved =
            Frame { origin: origin + n * (height * unit), axes: DMat3::from_cols(u, normal.cross(u), normal), unit };
        (moved.origin.is_finite() && moved.axes.is_finite()).then_some(moved)
    }

    #[inline]
    pub(in crate::curvature::fit) fn to_local(self, p: DVec3) -> DVec3 {
        self.axes.transpose() * ((p - self.origin) / self.unit)
    }
}
