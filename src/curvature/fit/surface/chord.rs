//! Height polynomials in chord-length coordinates: the surfaces that noisy samples are fitted with.
//!
//! Let o be a point of the surface with unit normal n, p a sample, L = |p - o|, z = (p - o) . n and t the
//! azimuth of p around n. The circle through o and p that touches the tangent plane at o has curvature
//! 2 |z| / L^2, at any distance along a circular section. So in the coordinates (X, Y) = L (cos t, sin t)
//! a sphere is a paraboloid exactly, and few terms describe what would take a height function many.
//!
//! The surface is z = P(X, Y) with P of degree 3 or 4, with constant and linear terms; the fit moves and tilts
//! the frame until these are small.

use super::bivariate::{HIGHEST, WIDEST, value};
use super::foot::{Below, Foot};
use super::frame::LocalFrame;
use super::polynomial::Symmetric;
use super::shape::Shape;
use crate::curvature::vectors::four::{F4, Real, V3};
use glam::DVec3;

/// A fitted surface patch. The frame's unit is the radius of its window.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Chord {
    pub(in crate::curvature::fit) frame: LocalFrame,
    pub(in crate::curvature::fit) coefficients: [f64; WIDEST],
}

/// Chord coordinates of a local point whose height over the tangent plane is `z`.
#[inline(always)]
pub(in crate::curvature::fit) fn chord<T: Real>(p: V3<T>, z: T) -> (T, T) {
    let planar = p.x * p.x + p.y * p.y;
    let one = T::splat(1.0);
    let stretch = planar.if_positive((one + z * z / planar).min(T::splat(9.0)).sqrt(), one);
    (p.x * stretch, p.y * stretch)
}

/// A function of two variables with its first and second derivatives.
#[derive(Clone, Copy)]
struct Jet<T> {
    value: T,
    first: [T; 2],
    /// xx, xy, yy
    second: [T; 3],
}

impl<T: Real> Jet<T> {
    #[inline(always)]
    fn times(self, o: Jet<T>) -> Jet<T> {
        let [ax, ay] = self.first;
        let [bx, by] = o.first;
        Jet {
            value: self.value * o.value,
            first: [ax * o.value + self.value * bx, ay * o.value + self.value * by],
            second: [
                self.second[0] * o.value + ax * bx * 2.0 + self.value * o.second[0],
                self.second[1] * o.value + ax * by + ay * bx + self.value * o.second[1],
                self.second[2] * o.value + ay * by * 2.0 + self.value * o.second[2],
            ],
        }
    }

    /// f(self) for a function with these derivatives at the value.
    #[inline(always)]
    fn mapped(self, f: T, df: T, ddf: T) -> Jet<T> {
        let [x, y] = self.first;
        Jet {
            value: f,
            first: [df * x, df * y],
            second: [
                ddf * x * x + df * self.second[0],
                ddf * x * y + df * self.second[1],
                ddf * y * y + df * self.second[2],
            ],
        }
    }
}

/// The polynomial at chord coordinates.
#[inline(always)]
fn height<T: Real>(c: &[T; WIDEST], x: T, y: T) -> Jet<T> {
    let (xx, xy, yy) = (x * x, x * y, y * y);
    Jet {
        value: value::<HIGHEST, T>(c, x, y),
        first: [
            c[1] + c[3] * x * 2.0
                + c[4] * y
                + c[6] * xx * 3.0
                + c[7] * xy * 2.0
                + c[8] * yy
                + c[10] * xx * x * 4.0
                + c[11] * xx * y * 3.0
                + c[12] * x * yy * 2.0
                + c[13] * yy * y,
            c[2] + c[4] * x
                + c[5] * y * 2.0
                + c[7] * xx
                + c[8] * xy * 2.0
                + c[9] * yy * 3.0
                + c[11] * xx * x
                + c[12] * xx * y * 2.0
                + c[13] * x * yy * 3.0
                + c[14] * yy * y * 4.0,
        ],
        second: [
            c[3] * 2.0 + c[6] * x * 6.0 + c[7] * y * 2.0 + c[10] * xx * 12.0 + c[11] * xy * 6.0 + c[12] * yy * 2.0,
            c[4] + c[7] * x * 2.0 + c[8] * y * 2.0 + c[11] * xx * 3.0 + c[12] * xy * 4.0 + c[13] * yy * 3.0,
            c[5] * 2.0 + c[8] * x * 2.0 + c[9] * y * 6.0 + c[12] * xx * 2.0 + c[13] * xy * 6.0 + c[14] * yy * 12.0,
        ],
    }
}

/// The shape of the surface below a local point, in the local frame; see [`Foot`].
#[inline(always)]
fn foot_of<T: Real>(c: &[T; WIDEST], p: V3<T>) -> Foot<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (x, y) = chord(p, p.z - c[0] - c[1] * p.x - c[2] * p.y);
    let z = height(c, x, y);
    // Heights over the tangent plane alone shorten the way along it from chord to foot.
    let bent = Jet {
        value: z.value - c[0] - c[1] * x - c[2] * y,
        first: [z.first[0] - c[1], z.first[1] - c[2]],
        second: z.second,
    };
    let square = x * x + y * y;
    let is_away = square - T::splat(1e-6);
    let inverse = one / square;
    let of_square = Jet { value: square, first: [x * 2.0, y * 2.0], second: [T::splat(2.0), zero, T::splat(2.0)] };
    let of_square = of_square.mapped(inverse, -(inverse * inverse), inverse * inverse * inverse * 2.0);
    let steep = bent.times(bent).times(of_square);
    // Where this is not above zero the surface has turned over.
    let left = is_away.if_positive(one - steep.value, one);
    let root = left.sqrt();
    let Jet { first: [x1, y1], second: [x2, xy, y2], .. } =
        steep.mapped(root, T::splat(-0.5) / root, T::splat(-0.25) / (left * root));
    let away = |d: T| is_away.if_positive(d, zero);
    let shortened = Jet { value: root, first: [away(x1), away(y1)], second: [away(x2), away(xy), away(y2)] };
    let px = Jet { value: x, first: [one, zero], second: [zero; 3] }.times(shortened);
    let py = Jet { value: y, first: [zero, one], second: [zero; 3] }.times(shortened);
    let a = V3::new(px.first[0], py.first[0], z.first[0]);
    let b = V3::new(px.first[1], py.first[1], z.first[1]);
    let cross = a.cross(b);
    let length = cross.dot(cross).sqrt();
    let normal = cross.scaled(one / length);
    // Dual tangents, and the second form on them.
    let (da, db) = (b.cross(normal).scaled(one / length), normal.cross(a).scaled(one / length));
    let form = |i: usize| -(normal.x * px.second[i] + normal.y * py.second[i] + normal.z * z.second[i]);
    let across = Symmetric::outer(da, db, form(1) * 2.0);
    let tensor = Symmetric::outer(da, da, form(0)).plus(across).plus(Symmetric::outer(db, db, form(2)));
    let upright = (left - T::splat(0.05)).min(normal.z);
    Foot { height: (p.z - z.value) * normal.z, normal, tensor, upright }
}

impl Chord {
    /// The plane that a frame lies in.
    pub(in crate::curvature::fit) fn plane(frame: LocalFrame) -> Self {
        Chord { frame, coefficients: [0.0; WIDEST] }
    }

    /// Height of a point over the surface, and the shape of the surface below it. `None` where the
    /// surface has turned over.
    pub(in crate::curvature::fit) fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        foot_of(&self.coefficients, self.frame.to_local(point).into()).in_space(&self.frame)
    }

    /// The same surface, for points side by side.
    #[inline(always)]
    pub(in crate::curvature::fit) fn side_by_side(&self) -> ChordAbreast {
        ChordAbreast(self.coefficients.map(F4::splat))
    }
}

/// A [`Chord`] that is looked at from points side by side.
pub(in crate::curvature::fit) struct ChordAbreast([F4; WIDEST]);

impl Below for ChordAbreast {
    #[inline(always)]
    fn foot(&self, points: V3<F4>) -> Foot<F4> {
        foot_of(&self.0, points)
    }
}
