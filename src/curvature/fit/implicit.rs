//! A fitted implicit surface in space.

use super::frame::Frame;
use super::polynomial::Polynomial;
use super::shape::Shape;
use glam::{DMat3, DVec3};

/// The surface F = 0 in a frame of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Implicit {
    pub(super) frame: Frame,
    pub(super) f: Polynomial<f64>,
}

impl Implicit {
    /// F at a local point.
    pub(super) fn value(&self, p: DVec3) -> f64 {
        self.f.value(p.into())
    }

    /// The gradient of F at a local point.
    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        self.f.gradient(p.into()).into()
    }

    /// Nearly the distance of a point from the surface, in file units: negative on the inner side.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let p = self.frame.to_local(point);
        self.value(p) / self.gradient(p).length() * self.frame.unit
    }

    /// The shape of the surface at the foot of a point; `None` where Newton's steps fail.
    pub(super) fn shape_at(&self, point: DVec3) -> Option<Shape> {
        let foot = self.f.foot(self.frame.to_local(point).into());
        let gradient = DVec3::from(self.f.gradient(foot));
        let length = gradient.length();
        let normal = gradient / length;
        let h = self.f.hessian(foot);
        let hessian =
            DMat3::from_cols(DVec3::new(h.xx, h.xy, h.xz), DVec3::new(h.xy, h.yy, h.yz), DVec3::new(h.xz, h.yz, h.zz));
        let projection = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let tensor = projection * hessian * projection * (1.0 / (length * self.frame.unit));
        let axes = self.frame.axes;
        let tensor = axes * tensor * axes.transpose();
        tensor.is_finite().then(|| Shape { normal: axes * normal, tensor })
    }
}
