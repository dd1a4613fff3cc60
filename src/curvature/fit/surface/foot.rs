//! What a fitted surface looks like below a point, for one surface or several side by side.

use super::frame::LocalFrame;
use super::polynomial::{Polynomial, Symmetric};
use super::shape::Shape;
use crate::curvature::vectors::four::{F4, Real, V3};
use glam::{DMat3, DVec3};

/// The place of a surface below a point, in the surface's own frame.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Foot<T> {
    /// Of the point over the surface.
    pub(in crate::curvature::fit) height: T,
    pub(in crate::curvature::fit) normal: V3<T>,
    /// Of the surface's shape.
    pub(in crate::curvature::fit) tensor: Symmetric<T>,
    /// Not above zero where the surface has turned over.
    pub(in crate::curvature::fit) upright: T,
}

/// A surface seen from points side by side. No closure: those are compiled for the vectors all processors have.
pub(in crate::curvature::fit) trait Below {
    /// Below local points, in the local frame.
    fn foot(&self, points: V3<F4>) -> Foot<F4>;
}

/// The surface F = 0.
impl Below for Polynomial<F4> {
    #[inline(always)]
    fn foot(&self, points: V3<F4>) -> Foot<F4> {
        Foot::of(self, points)
    }
}

impl<T: Real> Foot<T> {
    /// On the surface F = 0, after Newton's steps.
    #[inline(always)]
    pub(super) fn of(f: &Polynomial<T>, p: V3<T>) -> Self {
        let one = T::splat(1.0);
        let slope = f.gradient(p);
        let height = f.value(p) / slope.dot(slope).sqrt();
        let foot = f.foot(p);
        let gradient = f.gradient(foot);
        let inverse = one / gradient.dot(gradient).sqrt();
        let normal = gradient.scaled(inverse);
        let tensor = f.hessian(foot).projected(normal).scaled(inverse);
        Foot { height, normal, tensor, upright: one }
    }
}

impl Foot<f64> {
    /// Height and shape in space; `None` where the surface has turned over or a number is not finite.
    pub(super) fn in_space(&self, frame: &LocalFrame) -> Option<(f64, Shape)> {
        let local = DMat3::from(self.tensor);
        let tensor = frame.axes * local * frame.axes.transpose() * (1.0 / frame.unit);
        let normal = frame.axes * DVec3::from(self.normal);
        let is_shape = tensor.is_finite() && normal.is_finite() && self.upright > 0.0;
        is_shape.then_some((self.height * frame.unit, Shape { normal, tensor }))
    }
}

/// A frame, for points side by side.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Sides {
    origin: DVec3,
    axes: [V3<F4>; 3],
    unit: f64,
}

impl Sides {
    #[inline(always)]
    pub(in crate::curvature::fit) fn of(frame: &LocalFrame) -> Self {
        let DMat3 { x_axis, y_axis, z_axis } = frame.axes;
        Sides { origin: frame.origin, axes: [x_axis, y_axis, z_axis].map(V3::splat), unit: frame.unit }
    }

    /// Points as the frame sees them, given by their ways from a place.
    #[inline(always)]
    pub(in crate::curvature::fit) fn to_local(self, way: V3<F4>, place: DVec3) -> V3<F4> {
        let from = way + V3::splat(place - self.origin);
        let [x, y, z] = self.axes;
        V3::new(from.dot(x), from.dot(y), from.dot(z)).scaled(F4::splat(1.0 / self.unit))
    }

    #[inline(always)]
    fn turned(&self, v: V3<F4>) -> V3<F4> {
        let [x, y, z] = self.axes;
        x.scaled(v.x) + y.scaled(v.y) + z.scaled(v.z)
    }

    /// Height and shape in space.
    #[inline(always)]
    pub(in crate::curvature::fit) fn in_space(&self, foot: &Foot<F4>) -> Foot<F4> {
        let Symmetric { xx, xy, yy, xz, yz, zz } = foot.tensor;
        let inverse = F4::splat(1.0 / self.unit);
        // The columns of the tensor, turned; then its rows.
        let a = self.turned(V3::new(xx, xy, xz)).scaled(inverse);
        let b = self.turned(V3::new(xy, yy, yz)).scaled(inverse);
        let c = self.turned(V3::new(xz, yz, zz)).scaled(inverse);
        let x = self.turned(V3::new(a.x, b.x, c.x));
        let y = self.turned(V3::new(a.y, b.y, c.y));
        let z = self.turned(V3::new(a.z, b.z, c.z));
        let tensor = Symmetric { xx: x.x, xy: x.y, yy: y.y, xz: x.z, yz: y.z, zz: z.z };
        Foot { height: foot.height * self.unit, normal: self.turned(foot.normal), tensor, upright: foot.upright }
    }
}
