//! Principal curvatures and directions of second fundamental forms.

use super::polynomial::Symmetric;
use crate::curvature::vectors::four::{Real, V3};
use glam::{DMat3, DVec3};

/// How a surface bends at a point. The tensor maps a tangent t to its normal curvature t' T t, in
/// 1/length, positive where the surface bends away from the normal; along the normal it is zero.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Shape {
    pub(in crate::curvature::fit) normal: DVec3,
    pub(in crate::curvature::fit) tensor: DMat3,
}

/// Principal curvatures and directions.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Principal<T = f64> {
    pub(in crate::curvature::fit) k_max: T,
    pub(in crate::curvature::fit) k_min: T,
    pub(in crate::curvature::fit) dir_max: V3<T>,
    pub(in crate::curvature::fit) dir_min: V3<T>,
}

impl Principal {
    /// The larger absolute curvature.
    pub(in crate::curvature::fit) fn size(&self) -> f64 {
        self.k_max.abs().max(self.k_min.abs())
    }

    /// The same with another value of the larger absolute curvature; `None` where that has another sign or is less than
    /// the other one.
    pub(in crate::curvature::fit) fn with_larger(self, k: f64) -> Option<Self> {
        if k >= 0.0 && self.k_max >= -self.k_min {
            (k >= self.k_min).then_some(Principal { k_max: k, ..self })
        } else if k <= 0.0 && self.k_max <= -self.k_min {
            (k <= self.k_max).then_some(Principal { k_min: k, ..self })
        } else {
            None
        }
    }
}

impl<T: Real> Principal<T> {
    /// From a unit normal and a matrix whose products with tangents are those of the tensor.
    #[inline(always)]
    pub(in crate::curvature::fit) fn of(normal: V3<T>, tensor: &Symmetric<T>) -> Self {
        let (u, v) = tangents(normal);
        let (tu, tv) = (tensor.times(u), tensor.times(v));
        let (a, b, c) = (u.dot(tu), u.dot(tv), v.dot(tv));
        let (mean, half) = ((a + c) * 0.5, (a - c) * 0.5);
        let spread = (half * half + b * b).sqrt();
        let (x, y) = half_angle(half, b, spread);
        let dir_max = u.scaled(x) + v.scaled(y);
        Principal { k_max: mean + spread, k_min: mean - spread, dir_max, dir_min: normal.cross(dir_max) }
    }
}

/// Cosine (not negative) and sine of half the angle of (x, y), whose length is given: the direction of the larger
/// eigenvalue of a matrix with x the half difference of its diagonal and y beside it. (1, 0) where no direction stands
/// out.
#[inline(always)]
pub(in crate::curvature::fit) fn half_angle<T: Real>(x: T, y: T, length: T) -> (T, T) {
    // The sum that does not cancel.
    let sum = length + x.abs();
    let cos = x.select(sum, y.abs());
    let sin = x.select(y, y.select(sum, -sum));
    let length = (cos * cos + sin * sin).sqrt();
    (length.if_positive(cos / length, T::splat(1.0)), length.if_positive(sin / length, T::splat(0.0)))
}

/// Two unit vectors that are perpendicular to a unit vector and to each other (Duff and others 2017, "Building
/// an orthonormal basis, revisited").
#[inline(always)]
pub(in crate::curvature::fit) fn tangents<T: Real>(n: V3<T>) -> (V3<T>, V3<T>) {
    let sign = n.z.select(T::splat(1.0), T::splat(-1.0));
    let a = T::splat(-1.0) / (sign + n.z);
    let b = n.x * n.y * a;
    let u = V3::new(T::splat(1.0) + sign * n.x * n.x * a, sign * b, -(sign * n.x));
    (u, V3::new(b, sign + n.y * n.y * a, -n.y))
}

impl Shape {
    /// The tensor as its upper triangle.
    pub(in crate::curvature::fit) fn symmetric(&self) -> Symmetric<f64> {
        let [x, y, z] = [self.tensor.x_axis, self.tensor.y_axis, self.tensor.z_axis];
        Symmetric { xx: x.x, xy: x.y, yy: y.y, xz: x.z, yz: y.z, zz: z.z }
    }

    pub(in crate::curvature::fit) fn principal(&self) -> Principal {
        Principal::of(self.normal.into(), &self.symmetric())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_tensor_has_its_entries_and_axes() {
        for (x, y) in [(-1.0, 3.0), (3.0, -1.0), (2.0, 2.0)] {
            let shape = Shape { normal: DVec3::Z, tensor: DMat3::from_diagonal(DVec3::new(x, y, 0.0)) };
            let p = shape.principal();
            assert!((p.k_max - x.max(y)).abs() < 1e-12 && (p.k_min - x.min(y)).abs() < 1e-12);
            let (along_x, along_y) = (p.dir_max.x.abs(), p.dir_max.y.abs());
            assert!(x == y || (if x > y { along_x } else { along_y }) > 1.0 - 1e-12);
            assert!((p.dir_max.dot(p.dir_max) - 1.0).abs() < 1e-12 && p.dir_max.dot(p.dir_min).abs() < 1e-12);
        }
    }

    #[test]
    fn a_turned_tensor_turns_its_directions() {
        for step in 0..64 {
            let (sin, cos) = (f64::from(step) * 0.1).sin_cos();
            let d = DVec3::new(cos, sin, 0.0);
            let tensor = DMat3::from_cols(d * d.x, d * d.y, d * d.z) * 2.0;
            let p = Shape { normal: DVec3::Z, tensor }.principal();
            assert!((p.k_max - 2.0).abs() < 1e-12 && p.k_min.abs() < 1e-12);
            assert!((p.dir_max.x * d.x + p.dir_max.y * d.y).abs() > 1.0 - 1e-12, "{step}");
        }
    }
}
