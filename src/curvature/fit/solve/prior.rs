//! What is expected of the terms beyond the paraboloid: where rounding or noise is strong, terms that a
//! surface bending as this one does has no use for stay small.

use crate::curvature::fit::surface::polynomial::{CYCLIDE, PARABOLOID, QUADRIC};
use crate::curvature::vectors::four::Real;

/// Radians that the surface turns by over the window, below which priors do not get any narrower.
const LEAST_BEND: f64 = 0.03;

/// Where the terms of degree 4 in x and y begin, behind those of degree 3.
const QUARTIC: usize = CYCLIDE + 4;

/// What to add to the diagonal of the normal equations in each column, from the coefficients of the
/// paraboloid and the noise of the samples, in units of the frame.
#[inline(always)]
pub(in crate::curvature::fit) fn priors<T: Real, const N: usize>([a, b, c]: [T; 3], noise: T) -> [T; N] {
    let bend = ((a + c).abs() + ((a - c) * (a - c) + b * b).sqrt()).max(T::splat(LEAST_BEND));
    let tight = noise / (bend * 0.3);
    let first = tight * tight;
    let second = first / (bend * bend);
    let third = second / (bend * bend);
    let mut priors = [T::splat(0.0); N];
    for (column, prior) in priors.iter_mut().enumerate().skip(PARABOLOID) {
        *prior = match column {
            PARABOLOID..QUADRIC => first,
            QUADRIC..QUARTIC => second,
            _ => third,
        };
    }
    priors
}
