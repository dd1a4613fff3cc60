//! Four numbers side by side, and code that runs on one or on four.
//!
//! Kernels work on four fits at a time, or on four samples of one fit. Every operation is one that all processors
//! round alike (sums, products, quotients, square roots), none is fused, and the order of sums is fixed: the
//! result has the same bits with and without vector instructions.

use pulp::Arch;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Lanes of a vector.
pub(in crate::curvature) const LANES: usize = 4;

/// Four numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(in crate::curvature) struct F4(pub(in crate::curvature) [f64; LANES]);

/// Work to be done with vectors. It and all that it calls must be inlined, or the processor's wider vectors
/// are not used.
pub(in crate::curvature) trait Kernel {
    type Output;
    fn run(self) -> Self::Output;
}

/// Runs a kernel with the widest vectors of the processor.
pub(in crate::curvature) fn run<K: Kernel>(kernel: K) -> K::Output {
    struct Dispatched<K>(K);

    impl<K: Kernel> pulp::WithSimd for Dispatched<K> {
        type Output = K::Output;

        #[inline(always)]
        fn with_simd<S: pulp::Simd>(self, _: S) -> K::Output {
            self.0.run()
        }
    }
    Arch::new().dispatch(Dispatched(kernel))
}

/// A number, or several side by side.
pub(in crate::curvature) trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
{
    fn splat(value: f64) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// The greater one; `other` where one of them is not a number.
    fn max(self, other: Self) -> Self;
    /// The lesser one; `other` where one of them is not a number.
    fn min(self, other: Self) -> Self;
    /// `a` where the sign is plus, `b` where it is minus, zeros included.
    fn select(self, a: Self, b: Self) -> Self;
    /// `a` where this is above zero, `b` elsewhere.
    fn if_positive(self, a: Self, b: Self) -> Self;
}

impl Real for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn select(self, a: Self, b: Self) -> Self {
        if self.is_sign_positive() { a } else { b }
    }

    #[inline(always)]
    fn if_positive(self, a: Self, b: Self) -> Self {
        if self > 0.0 { a } else { b }
    }
}

impl F4 {
    pub(in crate::curvature) const ZERO: F4 = F4([0.0; LANES]);
    pub(in crate::curvature) const ONE: F4 = F4([1.0; LANES]);

    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> F4 {
        let [a, b, c, d] = self.0;
        F4([f(a), f(b), f(c), f(d)])
    }

    #[inline(always)]
    fn zip(self, o: F4, f: impl Fn(f64, f64) -> f64) -> F4 {
        let ([a, b, c, d], [e, g, h, i]) = (self.0, o.0);
        F4([f(a, e), f(b, g), f(c, h), f(d, i)])
    }

    #[inline(always)]
    fn pick(self, is_first: impl Fn(f64) -> bool, a: F4, b: F4) -> F4 {
        let one = |i: usize| if is_first(self.0[i]) { a.0[i] } else { b.0[i] };
        F4([one(0), one(1), one(2), one(3)])
    }

    /// One number from each of four other things.
    #[inline(always)]
    pub(in crate::curvature) fn of<T: Copy>(from: [T; LANES], number: impl Fn(T) -> f64) -> F4 {
        let [a, b, c, d] = from;
        F4([number(a), number(b), number(c), number(d)])
    }
}

impl F4 {
    /// Of all lanes, in an order that is always the same.
    #[inline(always)]
    pub(in crate::curvature) fn sum(self) -> f64 {
        let [a, b, c, d] = self.0;
        (a + b) + (c + d)
    }
}

/// Whether something holds, lane by lane.
#[inline(always)]
pub(in crate::curvature) fn which(is: impl Fn(usize) -> bool) -> [bool; LANES] {
    [is(0), is(1), is(2), is(3)]
}

impl Real for F4 {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        F4([value; LANES])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(f64::sqrt)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.map(f64::abs)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    #[inline(always)]
    fn select(self, a: Self, b: Self) -> Self {
        self.pick(f64::is_sign_positive, a, b)
    }

    #[inline(always)]
    fn if_positive(self, a: Self, b: Self) -> Self {
        self.pick(|x| x > 0.0, a, b)
    }
}

macro_rules! by_lane {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for F4 {
            type Output = F4;

            #[inline(always)]
            fn $method(self, o: F4) -> F4 {
                self.zip(o, |a, b| a $op b)
            }
        }
    };
}

by_lane!(Add, add, +);
by_lane!(Sub, sub, -);
by_lane!(Mul, mul, *);
by_lane!(Div, div, /);

impl Mul<f64> for F4 {
    type Output = F4;

    #[inline(always)]
    fn mul(self, o: f64) -> F4 {
        self.map(|a| a * o)
    }
}

impl Neg for F4 {
    type Output = F4;

    #[inline(always)]
    fn neg(self) -> F4 {
        self.map(|a| -a)
    }
}

impl AddAssign for F4 {
    #[inline(always)]
    fn add_assign(&mut self, o: F4) {
        *self = *self + o;
    }
}

impl SubAssign for F4 {
    #[inline(always)]
    fn sub_assign(&mut self, o: F4) {
        *self = *self - o;
    }
}

/// A vector in space, or several side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::curvature) struct V3<T> {
    pub(in crate::curvature) x: T,
    pub(in crate::curvature) y: T,
    pub(in crate::curvature) z: T,
}

impl<T: Real> V3<T> {
    #[inline(always)]
    pub(in crate::curvature) fn new(x: T, y: T, z: T) -> Self {
        V3 { x, y, z }
    }

    #[inline(always)]
    pub(in crate::curvature) fn dot(self, o: Self) -> T {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub(in crate::curvature) fn cross(self, o: Self) -> Self {
        V3::new(self.y * o.z - self.z * o.y, self.z * o.x - self.x * o.z, self.x * o.y - self.y * o.x)
    }

    #[inline(always)]
    pub(in crate::curvature) fn scaled(self, by: T) -> Self {
        V3::new(self.x * by, self.y * by, self.z * by)
    }
}

impl<T: Real> Add for V3<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, o: Self) -> Self {
        V3::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<T: Real> Sub for V3<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        V3::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl From<glam::DVec3> for V3<f64> {
    fn from(v: glam::DVec3) -> Self {
        V3 { x: v.x, y: v.y, z: v.z }
    }
}

impl From<V3<f64>> for glam::DVec3 {
    fn from(v: V3<f64>) -> Self {
        glam::DVec3::new(v.x, v.y, v.z)
    }
}

impl From<V3<f64>> for glam::Vec3 {
    fn from(v: V3<f64>) -> Self {
        glam::DVec3::from(v).as_vec3()
    }
}

impl V3<F4> {
    pub(in crate::curvature) const ZERO: Self = V3 { x: F4::ZERO, y: F4::ZERO, z: F4::ZERO };

    /// The same in all lanes.
    #[inline(always)]
    pub(in crate::curvature) fn splat(v: glam::DVec3) -> Self {
        V3 { x: F4::splat(v.x), y: F4::splat(v.y), z: F4::splat(v.z) }
    }

    #[inline(always)]
    pub(in crate::curvature) fn set(&mut self, lane: usize, v: glam::DVec3) {
        (self.x.0[lane], self.y.0[lane], self.z.0[lane]) = (v.x, v.y, v.z);
    }

    #[inline(always)]
    pub(in crate::curvature) fn get(&self, lane: usize) -> glam::DVec3 {
        glam::DVec3::new(self.x.0[lane], self.y.0[lane], self.z.0[lane])
    }
}
