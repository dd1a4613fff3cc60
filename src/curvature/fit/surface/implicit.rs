//! A fitted implicit surface in space.

use super::foot::Foot;
use super::frame::LocalFrame;
use super::polynomial::{CYCLIDE, MOST, PLANE, Polynomial};
use super::shape::Shape;
use crate::curvature::vectors::four::{F4, Real};
use glam::DVec3;

/// The surface F = 0 in a frame of its own.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Implicit {
    pub(in crate::curvature::fit) frame: LocalFrame,
    pub(in crate::curvature::fit) f: Polynomial<f64>,
}

impl Implicit {
    /// The plane through a frame's origin; `None` where it is steep in the frame.
    pub(in crate::curvature::fit) fn plane(frame: LocalFrame, normal: DVec3) -> Option<Self> {
        /// Slopes beyond ten are none that a window's mean normal has.
        const STEEP: f64 = 0.1;
        let n = frame.axes.transpose() * normal;
        if n.z.abs() < STEEP {
            return None;
        }
        let mut f = Polynomial { coefficients: [0.0; MOST], size: PLANE };
        f.coefficients[1..PLANE].copy_from_slice(&[-n.x / n.z, -n.y / n.z]);
        Some(Implicit { frame, f })
    }

    /// F at a local point.
    pub(in crate::curvature::fit) fn value(&self, p: DVec3) -> f64 {
        self.f.value(p.into())
    }

    /// The gradient of F at a local point.
    pub(in crate::curvature::fit) fn gradient(&self, p: DVec3) -> DVec3 {
        self.f.gradient(p.into()).into()
    }

    /// Height of a point over the surface, and the shape of the surface below it; `None` where Newton's steps fail.
    pub(in crate::curvature::fit) fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        Foot::of(&self.f, self.frame.to_local(point).into()).in_space(&self.frame)
    }

    /// A cyclide, for points side by side.
    #[inline(always)]
    pub(in crate::curvature::fit) fn side_by_side(&self) -> Polynomial<F4> {
        debug_assert!(self.f.size <= CYCLIDE, "no cyclide");
        let mut f = Polynomial { coefficients: [F4::ZERO; MOST], size: CYCLIDE };
        for (to, &from) in f.coefficients[..CYCLIDE].iter_mut().zip(&self.f.coefficients) {
            *to = F4::splat(from);
        }
        f
    }
}
