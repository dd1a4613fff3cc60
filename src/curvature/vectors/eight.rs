//! Eight 32-bit numbers side by side, on any processor.
//!
//! The operations of `pulp`, on vectors of one width only, so that the result has the same bits whether the
//! processor has such vectors or not: nothing is fused, and every operation is one that all processors
//! round alike.
//!
//! Everything here and in a kernel must be inlined, down to closures: code outside the function that is compiled for
//! the processor does not use its vectors. Hence no `map` over arrays.

use pulp::{Scalar256b, Simd, cast, f32x8, m32x8, u32x8};
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Lanes of a vector.
pub(in crate::curvature) const LANES: usize = 8;

/// A processor's vectors of eight.
pub(in crate::curvature) trait Eight: Simd<f32s = f32x8, u32s = u32x8, m32s = m32x8> {
    /// The components of eight slots, each in a vector of its own.
    fn transpose(self, slots: [[f32; 4]; LANES]) -> [f32x8; 4];
}

/// Work to be done with vectors of eight.
pub(in crate::curvature) trait Kernel {
    type Output;
    fn run<E: Eight>(self, eight: E) -> Self::Output;
}

/// Runs a kernel with the processor's vectors, where it has some.
pub(in crate::curvature) fn run<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(v3) = pulp::x86::V3::try_new() {
        struct Dispatched<K>(K, pulp::x86::V3);

        impl<K: Kernel> pulp::NullaryFnOnce for Dispatched<K> {
            type Output = K::Output;

            #[inline(always)]
            fn call(self) -> K::Output {
                self.0.run(self.1)
            }
        }
        return v3.vectorize(Dispatched(kernel, v3));
    }
    run_portable(kernel)
}

/// Runs a kernel with plain code.
pub(in crate::curvature) fn run_portable<K: Kernel>(kernel: K) -> K::Output {
    kernel.run(Scalar256b)
}

/// Eight numbers.
#[derive(Clone, Copy)]
pub(in crate::curvature) struct F<E>(E, f32x8);

/// Eight answers.
#[derive(Clone, Copy)]
pub(in crate::curvature) struct M<E>(E, m32x8);

/// Eight edges of the `Steps` that sections are walked over.
#[derive(Clone, Copy)]
pub(in crate::curvature) struct Edges<E>(E, u32x8);

impl<E: Eight> F<E> {
    #[inline(always)]
    pub(in crate::curvature) fn splat(e: E, value: f32) -> Self {
        F(e, e.splat_f32s(value))
    }

    #[inline(always)]
    pub(in crate::curvature) fn new(e: E, values: [f32; LANES]) -> Self {
        F(e, cast(values))
    }

    #[inline(always)]
    pub(in crate::curvature) fn store(self, to: &mut [f32]) {
        to[..LANES].copy_from_slice(&cast::<_, [f32; LANES]>(self.1));
    }

    #[inline(always)]
    pub(in crate::curvature) fn sqrt(self) -> Self {
        F(self.0, self.0.sqrt_f32s(self.1))
    }

    #[inline(always)]
    pub(in crate::curvature) fn abs(self) -> Self {
        F(self.0, self.0.abs_f32s(self.1))
    }

    /// The greater one; this one where one of them is not a number.
    #[inline(always)]
    pub(in crate::curvature) fn max(self, other: Self) -> Self {
        self.less(other).select(other, self)
    }

    #[inline(always)]
    pub(in crate::curvature) fn less(self, than: Self) -> M<E> {
        M(self.0, self.0.less_than_f32s(self.1, than.1))
    }

    #[inline(always)]
    pub(in crate::curvature) fn is_negative(self) -> M<E> {
        self.less(F::splat(self.0, 0.0))
    }
}

impl<E: Eight> M<E> {
    #[inline(always)]
    pub(in crate::curvature) fn select(self, a: F<E>, b: F<E>) -> F<E> {
        F(self.0, self.0.select_f32s(self.1, a.1, b.1))
    }

    #[inline(always)]
    pub(in crate::curvature) fn select_edges(self, a: Edges<E>, b: Edges<E>) -> Edges<E> {
        Edges(self.0, self.0.select_u32s(self.1, a.1, b.1))
    }

    #[inline(always)]
    pub(in crate::curvature) fn is_true_for_all(self) -> bool {
        (!self).is_false_for_all()
    }

    #[inline(always)]
    pub(in crate::curvature) fn is_false_for_all(self) -> bool {
        self.0.first_true_m32s(self.1) == LANES
    }
}

impl<E: Eight> Edges<E> {
    #[inline(always)]
    pub(in crate::curvature) fn splat(e: E, edge: u32) -> Self {
        Edges(e, e.splat_u32s(edge))
    }

    #[inline(always)]
    pub(in crate::curvature) fn are_below(self, edge: u32) -> M<E> {
        let e = self.0;
        M(e, e.less_than_i32s(e.transmute_i32s_u32s(self.1), e.splat_i32s(edge as i32)))
    }

    /// The edges themselves or, where the answer is yes, those one further.
    #[inline(always)]
    pub(in crate::curvature) fn one_further(self, which: M<E>) -> Self {
        // A yes is -1.
        Edges(self.0, self.0.sub_u32s(self.1, self.0.transmute_u32s_m32s(which.1)))
    }

    /// What lies across: the way to the corner there, and the first edge beyond.
    #[inline(always)]
    pub(in crate::curvature) fn across(self, slots: &[[f32; 4]]) -> ([F<E>; 3], Self) {
        let e = self.0;
        let [a, b, c, d, f, g, h, i]: [u32; LANES] = cast(self.1);
        let [x, y, z, next] = e.transpose([
            slots[a as usize],
            slots[b as usize],
            slots[c as usize],
            slots[d as usize],
            slots[f as usize],
            slots[g as usize],
            slots[h as usize],
            slots[i as usize],
        ]);
        ([F(e, x), F(e, y), F(e, z)], Edges(e, e.transmute_u32s_f32s(next)))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $for:ident, $operation:ident) => {
        impl<E: Eight> $trait for $for<E> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $for(self.0, self.0.$operation(self.1, other.1))
            }
        }
    };
}

operator!(Add, add, F, add_f32s);
operator!(Sub, sub, F, sub_f32s);
operator!(Mul, mul, F, mul_f32s);
operator!(Div, div, F, div_f32s);
operator!(BitAnd, bitand, M, and_m32s);
operator!(BitOr, bitor, M, or_m32s);

impl<E: Eight> Neg for F<E> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        F(self.0, self.0.neg_f32s(self.1))
    }
}

impl<E: Eight> Not for M<E> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        M(self.0, self.0.not_m32s(self.1))
    }
}

impl Eight for Scalar256b {
    #[inline(always)]
    fn transpose(self, s: [[f32; 4]; LANES]) -> [f32x8; 4] {
        [
            f32x8(s[0][0], s[1][0], s[2][0], s[3][0], s[4][0], s[5][0], s[6][0], s[7][0]),
            f32x8(s[0][1], s[1][1], s[2][1], s[3][1], s[4][1], s[5][1], s[6][1], s[7][1]),
            f32x8(s[0][2], s[1][2], s[2][2], s[3][2], s[4][2], s[5][2], s[6][2], s[7][2]),
            f32x8(s[0][3], s[1][3], s[2][3], s[3][3], s[4][3], s[5][3], s[6][3], s[7][3]),
        ]
    }
}

#[cfg(target_arch = "x86_64")]
impl Eight for pulp::x86::V3 {
    #[inline(always)]
    fn transpose(self, s: [[f32; 4]; LANES]) -> [f32x8; 4] {
        let avx = self.avx;
        let a = avx._mm256_set_m128(cast(s[4]), cast(s[0]));
        let b = avx._mm256_set_m128(cast(s[5]), cast(s[1]));
        let c = avx._mm256_set_m128(cast(s[6]), cast(s[2]));
        let d = avx._mm256_set_m128(cast(s[7]), cast(s[3]));
        let (low, high) = (avx._mm256_unpacklo_ps(a, b), avx._mm256_unpackhi_ps(a, b));
        let (low2, high2) = (avx._mm256_unpacklo_ps(c, d), avx._mm256_unpackhi_ps(c, d));
        [
            cast(avx._mm256_shuffle_ps::<0x44>(low, low2)),
            cast(avx._mm256_shuffle_ps::<0xEE>(low, low2)),
            cast(avx._mm256_shuffle_ps::<0x44>(high, high2)),
            cast(avx._mm256_shuffle_ps::<0xEE>(high, high2)),
        ]
    }
}
