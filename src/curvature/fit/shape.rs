//! The second fundamental form at a point, as a tensor in space.

use glam::{DMat3, DVec3};

/// How a surface bends at a point. The tensor maps a tangent t to its normal curvature t' T t, in
/// 1/length, positive where the surface bends away from the normal; along the normal it is zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) normal: DVec3,
    pub(super) tensor: DMat3,
}

/// Principal curvatures and directions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Principal {
    pub(super) k_max: f64,
    pub(super) k_min: f64,
    pub(super) dir_max: DVec3,
    pub(super) dir_min: DVec3,
}

impl Shape {
    pub(super) fn principal(&self) -> Principal {
        let u = self.normal.any_orthonormal_vector();
        let v = self.normal.cross(u);
        let (a, b, c) = (u.dot(self.tensor * u), u.dot(self.tensor * v), v.dot(self.tensor * v));
        let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
        let spread = half.hypot(b);
        let (sin, cos) = (0.5 * b.atan2(half)).sin_cos();
        let dir_max = cos * u + sin * v;
        Principal { k_max: mean + spread, k_min: mean - spread, dir_max, dir_min: self.normal.cross(dir_max) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagonal_tensor_has_its_entries_and_axes() {
        let shape = Shape { normal: DVec3::Z, tensor: DMat3::from_diagonal(DVec3::new(-1.0, 3.0, 0.0)) };
        let p = shape.principal();
        assert!((p.k_max - 3.0).abs() < 1e-12 && (p.k_min + 1.0).abs() < 1e-12);
        assert!(p.dir_max.dot(DVec3::Y).abs() > 1.0 - 1e-12 && p.dir_min.dot(DVec3::X).abs() > 1.0 - 1e-12);
    }
}
