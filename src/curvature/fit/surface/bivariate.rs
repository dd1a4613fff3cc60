//! Polynomials in two variables, their terms by degree: values and powers.

use crate::curvature::vectors::four::Real;

/// Degrees of polynomials that bend.
pub(in crate::curvature::fit) const QUADRATIC: usize = 2;
pub(in crate::curvature::fit) const CUBIC: usize = 3;
/// The highest degree of a polynomial, and its number of terms.
pub(in crate::curvature::fit) const HIGHEST: usize = 4;
pub(in crate::curvature::fit) const WIDEST: usize = terms(HIGHEST);

/// Number of terms up to a degree.
pub(in crate::curvature::fit) const fn terms(degree: usize) -> usize {
    (degree + 1) * (degree + 2) / 2
}

/// Powers of x and y in each term, by degree.
pub(in crate::curvature::fit) const POWERS: [[usize; 2]; WIDEST] = {
    let mut powers = [[0; 2]; WIDEST];
    let (mut degree, mut at) = (0, 0);
    while degree <= HIGHEST {
        let mut y = 0;
        while y <= degree {
            powers[at] = [degree - y, y];
            at += 1;
            y += 1;
        }
        degree += 1;
    }
    powers
};

/// The polynomial of degree `D` at a point, by Horner's scheme.
#[inline(always)]
pub(in crate::curvature::fit) fn value<const D: usize, T: Real>(c: &[T; WIDEST], x: T, y: T) -> T {
    let mut value = T::splat(0.0);
    for j in (0..=D).rev() {
        let mut along = T::splat(0.0);
        for i in (0..=D - j).rev() {
            // The terms of a degree begin where those of lower degrees end.
            along = if i == D - j { c[terms_before(i + j) + j] } else { along * x + c[terms_before(i + j) + j] };
        }
        value = if j == D { along } else { value * y + along };
    }
    value
}

#[inline(always)]
const fn terms_before(degree: usize) -> usize {
    degree * (degree + 1) / 2
}
