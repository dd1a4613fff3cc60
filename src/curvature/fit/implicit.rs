//! Implicit surfaces: values, derivatives and shape.

use super::basis::basis;
use super::frame::Frame;
use super::least_squares::MOST;
use super::shape::Shape;
use glam::{DMat3, DVec3};

/// A fitted surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Implicit {
    pub(super) frame: Frame,
    pub(super) coefficients: [f64; MOST],
    pub(super) size: usize,
}

impl Implicit {
    /// F at a local point.
    pub(super) fn value(&self, p: DVec3) -> f64 {
        p.z - basis(p)[..self.size].iter().zip(&self.coefficients).map(|(f, c)| f * c).sum::<f64>()
    }

    /// The gradient of F at a local point.
    #[inline]
    pub(super) fn gradient(&self, p: DVec3) -> DVec3 {
        let c = &self.coefficients;
        let DVec3 { x, y, z } = p;
        let mut sum = DVec3::new(c[1] + 2.0 * c[3] * x + c[4] * y, c[2] + c[4] * x + 2.0 * c[5] * y, 0.0);
        if self.size > 6 {
            sum += DVec3::new(c[6] * z, c[7] * z, c[6] * x + c[7] * y + 2.0 * c[8] * z);
        }
        if self.size > 9 {
            let s = p.length_squared();
            let l = DVec3::new(c[9], c[10], c[11]);
            sum += s * l + (2.0 * l.dot(p) + 4.0 * c[12] * s) * p;
        }
        if self.size > 13 {
            let (xx, xy, yy) = (x * x, x * y, y * y);
            sum.x += 3.0 * c[13] * xx
                + 2.0 * c[14] * xy
                + c[15] * yy
                + 4.0 * c[17] * xx * x
                + 3.0 * c[18] * xx * y
                + 2.0 * c[19] * x * yy
                + c[20] * yy * y;
            sum.y += c[14] * xx
                + 2.0 * c[15] * xy
                + 3.0 * c[16] * yy
                + c[18] * xx * x
                + 2.0 * c[19] * xx * y
                + 3.0 * c[20] * x * yy
                + 4.0 * c[21] * yy * y;
        }
        DVec3::Z - sum
    }

    /// The matrix of second derivatives of F at a local point.
    fn hessian(&self, p: DVec3) -> DMat3 {
        let c = &self.coefficients;
        let DVec3 { x, y, z: _ } = p;
        let (mut hxx, mut hxy, mut hyy) = (2.0 * c[3], c[4], 2.0 * c[5]);
        let (mut hxz, mut hyz, mut hzz) = (0.0, 0.0, 0.0);
        if self.size > 6 {
            (hxz, hyz, hzz) = (c[6], c[7], 2.0 * c[8]);
        }
        if self.size > 13 {
            let (xx, xy, yy) = (x * x, x * y, y * y);
            hxx += 6.0 * c[13] * x + 2.0 * c[14] * y + 12.0 * c[17] * xx + 6.0 * c[18] * xy + 2.0 * c[19] * yy;
            hxy += 2.0 * c[14] * x + 2.0 * c[15] * y + 3.0 * c[18] * xx + 4.0 * c[19] * xy + 3.0 * c[20] * yy;
            hyy += 2.0 * c[15] * x + 6.0 * c[16] * y + 2.0 * c[19] * xx + 6.0 * c[20] * xy + 12.0 * c[21] * yy;
        }
        let mut sum = DMat3::from_cols(DVec3::new(hxx, hxy, hxz), DVec3::new(hxy, hyy, hyz), DVec3::new(hxz, hyz, hzz));
        if self.size > 9 {
            // s (l . p): p l' + l p' from the gradient of s, twice, and 2 (l . p) on the diagonal.
            let l = DVec3::new(c[9], c[10], c[11]);
            let diagonal = 2.0 * l.dot(p) + 4.0 * c[12] * p.length_squared();
            let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
            sum += (outer(p, l) + outer(l, p)) * 2.0
                + outer(p, p) * (8.0 * c[12])
                + DMat3::from_diagonal(DVec3::splat(diagonal));
        }
        -sum
    }

    /// The point of the surface nearest to a local point, nearly: three Newton steps along the gradient.
    pub(super) fn foot(&self, mut p: DVec3) -> Option<DVec3> {
        for _ in 0..3 {
            let gradient = self.gradient(p);
            let slope = gradient.length_squared();
            p -= gradient * (self.value(p) / slope);
        }
        p.is_finite().then_some(p)
    }

    /// Nearly the distance of a point from the surface, in file units: negative on the inner side.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let p = self.frame.to_local(point);
        self.value(p) / self.gradient(p).length() * self.frame.unit
    }

    /// The shape of the surface at the foot of a point; `None` where Newton's steps fail.
    pub(super) fn shape_at(&self, point: DVec3) -> Option<Shape> {
        let foot = self.foot(self.frame.to_local(point))?;
        let gradient = self.gradient(foot);
        let length = gradient.length();
        let normal = gradient / length;
        let projection = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let tensor = projection * self.hessian(foot) * projection * (1.0 / (length * self.frame.unit));
        let axes = self.frame.axes;
        let tensor = axes * tensor * axes.transpose();
        tensor.is_finite().then(|| Shape { normal: axes * normal, tensor })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::basis::{SIZES, basis_along};

    fn generic() -> Implicit {
        let coefficients = std::array::from_fn(|i| 0.07 * ((i * 37 % 11) as f64 - 5.0));
        Implicit { frame: Frame { origin: DVec3::ZERO, axes: DMat3::IDENTITY, unit: 1.0 }, coefficients, size: MOST }
    }

    #[test]
    fn derivatives_are_those_of_the_basis() {
        let p = DVec3::new(0.3, -0.4, 0.2);
        for size in SIZES {
            let mut surface = generic();
            surface.size = size;
            surface.coefficients[size..].fill(0.0);
            for d in [DVec3::X, DVec3::Y, DVec3::Z] {
                let along = basis_along(p, d);
                let slope = d.z - along[..size].iter().zip(&surface.coefficients).map(|(f, c)| f * c).sum::<f64>();
                assert!((slope - surface.gradient(p).dot(d)).abs() < 1e-12, "size {size}, {d}");
                let step = 1e-5 * d;
                let by_difference = (surface.value(p + step) - surface.value(p - step)) / 2e-5;
                assert!((slope - by_difference).abs() < 1e-8, "size {size}, {d}");
                let change = (surface.gradient(p + step) - surface.gradient(p - step)) / 2e-5;
                assert!((change - surface.hessian(p) * d).length() < 1e-8, "size {size}, {d}");
            }
        }
    }
}
