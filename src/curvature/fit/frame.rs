//! The local frame of a fit.

use glam::{DMat3, DVec3};

/// Where a fit sees the world from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) origin: DVec3,
    /// Columns: two tangents and the normal.
    pub(super) axes: DMat3,
    /// One unit of local length.
    pub(super) unit: f64,
}

impl Frame {
    /// A frame at `origin` for samples at `points`: the normal as given, the tangents along the principal
    /// axes of the samples, the unit their root mean square distance.
    pub(super) fn around(origin: DVec3, normal: DVec3, points: impl Iterator<Item = DVec3>) -> Option<Self> {
        let normal = normal.try_normalize()?;
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        let (mut total, mut count) = (0.0, 0);
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        for p in points {
            let d = p - origin;
            let (a, b) = (d.dot(u), d.dot(v));
            uu += a * a;
            uv += a * b;
            vv += b * b;
            total += d.length_squared();
            count += 1;
        }
        let unit = (total / f64::from(count)).sqrt();
        let (sin, cos) = (0.5 * (2.0 * uv).atan2(uu - vv)).sin_cos();
        let x = cos * u + sin * v;
        let axes = DMat3::from_cols(x, normal.cross(x), normal);
        (unit > 0.0 && unit.is_finite()).then_some(Frame { origin, axes, unit })
    }

    #[inline]
    pub(super) fn to_local(self, p: DVec3) -> DVec3 {
        self.axes.transpose() * ((p - self.origin) / self.unit)
    }
}
