//! The functions F(x, y, z) = z - sum c_j f_j(x, y, z) over nested bases: values, derivatives, and the shape
//! of the surface F = 0.
//!
//! | size | functions added | surfaces it contains |
//! |---|---|---|
//! | 3 | 1, x, y | planes |
//! | 6 | x^2, xy, y^2 | paraboloids |
//! | 9 | xz, yz, z^2 | all quadrics |
//! | 13 | s x, s y, s z, s^2 with s = x^2 + y^2 + z^2 | Darboux cyclides, tori among them |
//! | 22 | all monomials of degree 3 and 4 in x and y | height polynomials of degree 4 |
//!
//! Coordinates are those of a local frame, lengths in units of the window's size. Everything works on one
//! function or on several side by side.

use crate::curvature::vectors::four::{F4, Real, V3};
use glam::DMat3;

/// The sizes of the nested bases.
pub(in crate::curvature::fit) const SIZES: [usize; 5] = [3, 6, 9, 13, 22];
/// Of that of planes.
pub(in crate::curvature::fit) const PLANE: usize = SIZES[0];
/// Of that of paraboloids.
pub(in crate::curvature::fit) const PARABOLOID: usize = SIZES[1];
/// Of that of all quadrics.
pub(in crate::curvature::fit) const QUADRIC: usize = SIZES[2];
/// Of that of Darboux cyclides.
pub(in crate::curvature::fit) const CYCLIDE: usize = SIZES[3];
/// Of the largest one.
pub(in crate::curvature::fit) const MOST: usize = SIZES[4];

/// The coefficients of a function; those from `size` on are zero and cost nothing.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Polynomial<T> {
    pub(in crate::curvature::fit) coefficients: [T; MOST],
    pub(in crate::curvature::fit) size: usize,
}

/// A symmetric matrix.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Symmetric<T> {
    pub(super) xx: T,
    pub(super) xy: T,
    pub(super) yy: T,
    pub(super) xz: T,
    pub(super) yz: T,
    pub(super) zz: T,
}

/// The functions of a basis of size `N` at a point.
#[inline(always)]
pub(in crate::curvature::fit) fn basis<T: Real, const N: usize>(V3 { x, y, z }: V3<T>, one: T) -> [T; N] {
    let (xx, xy, yy, zz) = (x * x, x * y, y * y, z * z);
    let s = xx + yy + zz;
    let all = [
        one,
        x,
        y,
        xx,
        xy,
        yy,
        x * z,
        y * z,
        zz,
        s * x,
        s * y,
        s * z,
        s * s,
        xx * x,
        xx * y,
        yy * x,
        yy * y,
        xx * xx,
        xx * xy,
        xx * yy,
        xy * yy,
        yy * yy,
    ];
    let mut first = [one; N];
    first.copy_from_slice(&all[..N]);
    first
}

/// The derivatives of the basis functions along a direction.
pub(in crate::curvature::fit) fn basis_along<T: Real>(p: V3<T>, d: V3<T>) -> [T; MOST] {
    let V3 { x, y, z } = p;
    let (s, ds) = (p.dot(p), p.dot(d) * 2.0);
    let (xx, xy, yy) = (x * x, x * y, y * y);
    let (dxx, dxy, dyy) = (x * d.x * 2.0, x * d.y + y * d.x, y * d.y * 2.0);
    [
        T::splat(0.0),
        d.x,
        d.y,
        dxx,
        dxy,
        dyy,
        x * d.z + z * d.x,
        y * d.z + z * d.y,
        z * d.z * 2.0,
        ds * x + s * d.x,
        ds * y + s * d.y,
        ds * z + s * d.z,
        s * ds * 2.0,
        xx * d.x * 3.0,
        xx * d.y + dxx * y,
        yy * d.x + dyy * x,
        yy * d.y * 3.0,
        xx * dxx * 2.0,
        xx * dxy + dxx * xy,
        xx * dyy + dxx * yy,
        xy * dyy + dxy * yy,
        yy * dyy * 2.0,
    ]
}

impl Polynomial<f64> {
    /// The same function in all lanes.
    #[inline(always)]
    pub(in crate::curvature::fit) fn splat(&self) -> Polynomial<F4> {
        let mut coefficients = [F4::ZERO; MOST];
        coefficients.iter_mut().zip(&self.coefficients).for_each(|(to, &from)| *to = F4::splat(from));
        Polynomial { coefficients, size: self.size }
    }
}

impl<T: Real> Polynomial<T> {
    /// F at a point.
    #[inline(always)]
    pub(in crate::curvature::fit) fn value(&self, p: V3<T>) -> T {
        let c = &self.coefficients;
        let V3 { x, y, z } = p;
        let mut sum = c[0] + c[1] * x + c[2] * y;
        if self.size > PLANE {
            sum += (c[3] * x + c[4] * y) * x + c[5] * (y * y);
        }
        if self.size > PARABOLOID {
            sum += (c[6] * x + c[7] * y + c[8] * z) * z;
        }
        if self.size > QUADRIC {
            let s = p.dot(p);
            sum += (c[9] * x + c[10] * y + c[11] * z + c[12] * s) * s;
        }
        if self.size > CYCLIDE {
            let (xx, xy, yy) = (x * x, x * y, y * y);
            sum += (c[13] * x + c[14] * y) * xx + (c[15] * x + c[16] * y) * yy;
            sum += (c[17] * xx + c[18] * xy + c[19] * yy) * xx + (c[20] * xy + c[21] * yy) * yy;
        }
        z - sum
    }

    /// The gradient of F at a point.
    #[inline(always)]
    pub(in crate::curvature::fit) fn gradient(&self, p: V3<T>) -> V3<T> {
        let c = &self.coefficients;
        let V3 { x, y, z } = p;
        let mut sum = V3::new(c[1], c[2], T::splat(0.0));
        if self.size > PLANE {
            sum.x += c[3] * x * 2.0 + c[4] * y;
            sum.y += c[4] * x + c[5] * y * 2.0;
        }
        if self.size > PARABOLOID {
            sum.x += c[6] * z;
            sum.y += c[7] * z;
            sum.z += c[6] * x + c[7] * y + c[8] * z * 2.0;
        }
        if self.size > QUADRIC {
            let s = p.dot(p);
            let l = V3::new(c[9], c[10], c[11]);
            sum = sum + l.scaled(s) + p.scaled(l.dot(p) * 2.0 + c[12] * s * 4.0);
        }
        if self.size > CYCLIDE {
            let (xx, xy, yy) = (x * x, x * y, y * y);
            sum.x += c[13] * xx * 3.0 + c[14] * xy * 2.0 + c[15] * yy;
            sum.x += c[17] * xx * x * 4.0 + c[18] * xx * y * 3.0 + c[19] * x * yy * 2.0 + c[20] * yy * y;
            sum.y += c[14] * xx + c[15] * xy * 2.0 + c[16] * yy * 3.0;
            sum.y += c[18] * xx * x + c[19] * xx * y * 2.0 + c[20] * x * yy * 3.0 + c[21] * yy * y * 4.0;
        }
        V3::new(-sum.x, -sum.y, T::splat(1.0) - sum.z)
    }

    /// The matrix of second derivatives of F at a point.
    #[inline(always)]
    pub(in crate::curvature::fit) fn hessian(&self, p: V3<T>) -> Symmetric<T> {
        let c = &self.coefficients;
        let V3 { x, y, z } = p;
        let zero = T::splat(0.0);
        let (mut xx, mut xy, mut yy) = (c[3] * 2.0, c[4], c[5] * 2.0);
        let (mut xz, mut yz, mut zz) = (zero, zero, zero);
        if self.size > PARABOLOID {
            (xz, yz, zz) = (c[6], c[7], c[8] * 2.0);
        }
        if self.size > QUADRIC {
            // Of s (l . p): p l' + l p' from the gradient of s, twice, and 2 (l . p) on the diagonal.
            let l = V3::new(c[9], c[10], c[11]);
            let diagonal = l.dot(p) * 2.0 + c[12] * p.dot(p) * 4.0;
            let square = c[12] * 8.0;
            xx += l.x * x * 4.0 + square * (x * x) + diagonal;
            yy += l.y * y * 4.0 + square * (y * y) + diagonal;
            zz += l.z * z * 4.0 + square * (z * z) + diagonal;
            xy += (l.x * y + l.y * x) * 2.0 + square * (x * y);
            xz += (l.x * z + l.z * x) * 2.0 + square * (x * z);
            yz += (l.y * z + l.z * y) * 2.0 + square * (y * z);
        }
        if self.size > CYCLIDE {
            let (x2, x1y1, y2) = (x * x, x * y, y * y);
            xx += c[13] * x * 6.0 + c[14] * y * 2.0 + c[17] * x2 * 12.0 + c[18] * x1y1 * 6.0 + c[19] * y2 * 2.0;
            xy += (c[14] * x + c[15] * y) * 2.0 + c[18] * x2 * 3.0 + c[19] * x1y1 * 4.0 + c[20] * y2 * 3.0;
            yy += c[15] * x * 2.0 + c[16] * y * 6.0 + c[19] * x2 * 2.0 + c[20] * x1y1 * 6.0 + c[21] * y2 * 12.0;
        }
        Symmetric { xx: -xx, xy: -xy, yy: -yy, xz: -xz, yz: -yz, zz: -zz }
    }

    /// The point of the surface nearest to a point, nearly: three Newton steps along the gradient.
    #[inline(always)]
    pub(in crate::curvature::fit) fn foot(&self, mut p: V3<T>) -> V3<T> {
        for _ in 0..3 {
            let gradient = self.gradient(p);
            p = p - gradient.scaled(self.value(p) / gradient.dot(gradient));
        }
        p
    }
}

impl Symmetric<F4> {
    #[inline(always)]
    pub(in crate::curvature::fit) fn lane(&self, lane: usize) -> Symmetric<f64> {
        let Symmetric { xx, xy, yy, xz, yz, zz } = self;
        let [xx, xy, yy] = [xx.0[lane], xy.0[lane], yy.0[lane]];
        Symmetric { xx, xy, yy, xz: xz.0[lane], yz: yz.0[lane], zz: zz.0[lane] }
    }
}

impl Symmetric<f64> {
    pub(in crate::curvature::fit) const ZERO: Self = Symmetric { xx: 0.0, xy: 0.0, yy: 0.0, xz: 0.0, yz: 0.0, zz: 0.0 };

    #[inline(always)]
    pub(in crate::curvature::fit) fn is_finite(&self) -> bool {
        let Symmetric { xx, xy, yy, xz, yz, zz } = self;
        (xx + xy + yy + xz + yz + zz).is_finite()
    }
}

impl From<Symmetric<f64>> for DMat3 {
    fn from(m: Symmetric<f64>) -> DMat3 {
        let Symmetric { xx, xy, yy, xz, yz, zz } = m;
        DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
    }
}

impl<T: Real> Symmetric<T> {
    /// The symmetric part of a b', times `by`.
    #[inline(always)]
    pub(super) fn outer(a: V3<T>, b: V3<T>, by: T) -> Self {
        let half = by * 0.5;
        Symmetric {
            xx: by * a.x * b.x,
            xy: half * (a.x * b.y + a.y * b.x),
            yy: by * a.y * b.y,
            xz: half * (a.x * b.z + a.z * b.x),
            yz: half * (a.y * b.z + a.z * b.y),
            zz: by * a.z * b.z,
        }
    }

    #[inline(always)]
    pub(in crate::curvature::fit) fn plus(self, o: Self) -> Self {
        Symmetric {
            xx: self.xx + o.xx,
            xy: self.xy + o.xy,
            yy: self.yy + o.yy,
            xz: self.xz + o.xz,
            yz: self.yz + o.yz,
            zz: self.zz + o.zz,
        }
    }

    #[inline(always)]
    pub(in crate::curvature::fit) fn scaled(self, by: T) -> Self {
        let Symmetric { xx, xy, yy, xz, yz, zz } = self;
        Symmetric { xx: xx * by, xy: xy * by, yy: yy * by, xz: xz * by, yz: yz * by, zz: zz * by }
    }

    /// What is left of it in the plane perpendicular to a unit vector.
    #[inline(always)]
    pub(in crate::curvature::fit) fn projected(self, n: V3<T>) -> Self {
        let along = self.times(n);
        let both = Symmetric::outer(n, n, n.dot(along)).plus(Symmetric::outer(n, along, T::splat(-2.0)));
        self.plus(both)
    }

    #[inline(always)]
    pub(super) fn times(&self, v: V3<T>) -> V3<T> {
        V3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_basis() {
        let p = V3::new(0.3, -0.4, 0.2);
        for size in SIZES {
            let coefficients =
                std::array::from_fn(|i| if i < size { 0.07 * ((i * 37 % 11) as f64 - 5.0) } else { 0.0 });
            let f = Polynomial { coefficients, size };
            let by_basis = basis::<f64, MOST>(p, 1.0).iter().zip(&coefficients).map(|(f, c)| f * c).sum::<f64>();
            assert!((f.value(p) - (p.z - by_basis)).abs() < 1e-14);
            for d in [V3::new(1.0, 0.0, 0.0), V3::new(0.0, 1.0, 0.0), V3::new(0.0, 0.0, 1.0)] {
                let slope = d.z - basis_along(p, d).iter().zip(&coefficients).map(|(f, c)| f * c).sum::<f64>();
                assert!((slope - f.gradient(p).dot(d)).abs() < 1e-12, "size {size}, {d:?}");
                let (ahead, behind) = (p + d.scaled(1e-5), p - d.scaled(1e-5));
                let by_difference = (f.value(ahead) - f.value(behind)) / 2e-5;
                assert!((slope - by_difference).abs() < 1e-8, "size {size}, {d:?}");
                let change = (f.gradient(ahead) - f.gradient(behind)).scaled(1.0 / 2e-5);
                let error = change - f.hessian(p).times(d);
                assert!(error.dot(error).sqrt() < 1e-8, "size {size}, {d:?}");
            }
        }
    }
}
