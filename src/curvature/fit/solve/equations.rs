//! Least squares over nested bases, a problem in each lane: one Gram matrix and one Cholesky factor serve
//! every size.
//!
//! The first k columns of a basis, for each size k, are a model of their own; the leading k x k block
//! of the factor is that model's factor.

use crate::curvature::fit::surface::polynomial::PARABOLOID;
use crate::curvature::vectors::four::{F4, LANES, Real};

/// Added to the unit diagonal, so that columns without a part of their own do no harm.
const RIDGE: f64 = 1e-12;

/// The normal equations of `N` columns.
pub(in crate::curvature::fit) struct Normal<const N: usize> {
    /// Lower triangle.
    gram: [[F4; N]; N],
    right: [F4; N],
}

/// The normal equations scaled to unit diagonal, factored as far as asked for.
pub(in crate::curvature::fit) struct Factor<const N: usize> {
    /// Lower triangle; what is not factored yet is what the factored columns leave of the equations.
    lower: [[F4; N]; N],
    /// Forward substitution of the right side.
    forward: [F4; N],
    scale: [F4; N],
    /// One over the diagonal of the factor.
    inverse: [F4; N],
    done: usize,
}

impl<const N: usize> Normal<N> {
    /// From one row of basis functions per sample and the value it is to explain.
    #[inline(always)]
    pub(in crate::curvature::fit) fn new(rows: &[[F4; N]], values: &[F4]) -> Self {
        /// So many rows stay in the nearest cache.
        const TILE: usize = 48;
        let mut normal = Normal { gram: [[F4::ZERO; N]; N], right: [F4::ZERO; N] };
        for (rows, values) in rows.chunks(TILE).zip(values.chunks(TILE)) {
            normal.add_tile(rows, values);
        }
        normal
    }

    /// From the entries of the lower triangle and of the right side.
    #[inline(always)]
    pub(super) fn of(gram: impl Fn(usize, usize) -> F4, right: impl Fn(usize) -> F4) -> Self {
        let mut normal = Normal { gram: [[F4::ZERO; N]; N], right: [F4::ZERO; N] };
        for i in 0..N {
            for j in 0..=i {
                normal.gram[i][j] = gram(i, j);
            }
            normal.right[i] = right(i);
        }
        normal
    }

    #[inline(always)]
    fn add_tile(&mut self, rows: &[[F4; N]], values: &[F4]) {
        for i in 0..N {
            add_products(&mut self.gram[i], i + 1, rows, || rows.iter().map(|row| row[i]));
        }
        add_products(&mut self.right, N, rows, || values.iter().copied());
    }

    /// Adds a row to the problem of one lane.
    pub(in crate::curvature::fit) fn add(&mut self, lane: usize, row: &[f64; N], value: f64) {
        for i in 0..N {
            for j in 0..=i {
                self.gram[i][j].0[lane] += row[i] * row[j];
            }
            self.right[i].0[lane] += row[i] * value;
        }
    }
}

/// Adds the products of the first `until` columns with a lead in each row.
#[inline(always)]
fn add_products<const N: usize, I: Iterator<Item = F4>>(
    totals: &mut [F4; N],
    until: usize,
    rows: &[[F4; N]],
    leads: impl Fn() -> I,
) {
    /// Columns at a time, whose sums stay in registers.
    const BLOCK: usize = 6;
    for first in (0..until).step_by(BLOCK) {
        // The last block begins earlier: it ends with the last column.
        let start = first.min(N - BLOCK);
        let mut sums = [F4::ZERO; BLOCK];
        for (row, lead) in rows.iter().zip(leads()) {
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += lead * row[start + k];
            }
        }
        for k in first - start..BLOCK {
            totals[start + k] += sums[k];
        }
    }
}

impl<const N: usize> Factor<N> {
    #[inline(always)]
    pub(in crate::curvature::fit) fn new(normal: &Normal<N>) -> Self {
        let mut factor =
            Factor { lower: normal.gram, forward: normal.right, scale: [F4::ZERO; N], inverse: [F4::ZERO; N], done: 0 };
        for i in 0..N {
            let diagonal = normal.gram[i][i];
            let scale = diagonal.if_positive(F4::ONE / diagonal.sqrt(), F4::ZERO);
            factor.scale[i] = scale;
            for j in 0..i {
                factor.lower[i][j] = factor.lower[i][j] * scale * factor.scale[j];
            }
            factor.lower[i][i] = F4::splat(1.0 + RIDGE);
            factor.forward[i] = factor.forward[i] * scale;
        }
        factor
    }

    /// Adds to the diagonal of the columns that are not factored yet.
    #[inline(always)]
    pub(in crate::curvature::fit) fn add_priors(&mut self, priors: &[F4; N]) {
        for (column, (&prior, &scale)) in priors.iter().zip(&self.scale).enumerate().skip(self.done) {
            self.lower[column][column] += prior * scale * scale;
        }
    }

    /// The coefficients of x^2, xy and y^2 in the model of the first six columns.
    #[inline(always)]
    pub(in crate::curvature::fit) fn paraboloid(&self) -> [F4; 3] {
        let x = self.solve(PARABOLOID);
        [x[3], x[4], x[5]]
    }

    /// Factors the columns before `until`.
    #[inline(always)]
    pub(in crate::curvature::fit) fn factor(&mut self, until: usize) {
        for j in self.done..until {
            // A pivot that rounding took below the ridge: the column has no part of its own.
            let root = self.lower[j][j].max(F4::splat(RIDGE)).sqrt();
            let inverse = F4::ONE / root;
            self.inverse[j] = inverse;
            self.lower[j][j] = root;
            for i in j + 1..N {
                self.lower[i][j] = self.lower[i][j] * inverse;
            }
            self.forward[j] = self.forward[j] * inverse;
            let forward = self.forward[j];
            for i in j + 1..N {
                let l = self.lower[i][j];
                for k in j + 1..=i {
                    let other = self.lower[k][j];
                    self.lower[i][k] -= l * other;
                }
                self.forward[i] -= l * forward;
            }
        }
        self.done = until;
    }

    /// Coefficients of the model of the first `size` columns; the others are zero.
    #[inline(always)]
    pub(in crate::curvature::fit) fn solve(&self, size: usize) -> [F4; N] {
        self.solve_from(self.forward, size)
    }

    /// Coefficients of a model of as many columns as is said for each lane; the others are zero.
    #[inline(always)]
    pub(super) fn solve_each(&self, sizes: [usize; LANES]) -> [F4; N] {
        let mut forward = self.forward;
        for (column, value) in forward.iter_mut().enumerate() {
            let of_lane = |lane: usize| if column < sizes[lane] { value.0[lane] } else { 0.0 };
            *value = F4([of_lane(0), of_lane(1), of_lane(2), of_lane(3)]);
        }
        self.solve_from(forward, N)
    }

    #[inline(always)]
    fn solve_from(&self, forward: [F4; N], size: usize) -> [F4; N] {
        let mut x = [F4::ZERO; N];
        x[..size].copy_from_slice(&forward[..size]);
        self.substitute_back(&mut x, size);
        for (x, &scale) in x[..size].iter_mut().zip(&self.scale) {
            *x = *x * scale;
        }
        x
    }

    #[inline(always)]
    fn substitute_back(&self, x: &mut [F4; N], size: usize) {
        for i in (0..size).rev() {
            x[i] = x[i] * self.inverse[i];
            let solved = x[i];
            for (x, &l) in x[..i].iter_mut().zip(&self.lower[i]) {
                *x -= l * solved;
            }
        }
    }

    /// a' C a for the model of the first `size` columns of each lane, where C is the inverse of its normal equations
    /// and `a` picks one column: the variance of that coefficient for samples of unit variance.
    #[inline(always)]
    fn variance(&self, column: usize, size: [usize; LANES], most: usize) -> F4 {
        let mut y = [F4::ZERO; N];
        let mut sum = F4::ZERO;
        y[column] = self.scale[column];
        for i in column..most {
            y[i] = y[i] * self.inverse[i];
            let solved = y[i];
            let inside = F4::of(size, |size| if i < size { 1.0 } else { 0.0 });
            sum += solved * solved * inside;
            for (y, row) in y[i + 1..most].iter_mut().zip(&self.lower[i + 1..most]) {
                *y -= row[i] * solved;
            }
        }
        sum
    }

    /// Variance of the shape tensor (its squared Frobenius norm) that x^2, xy and y^2 in columns 3 to 5
    /// span, in units of the frame, for samples of unit variance and the model of the first `size` columns of
    /// each lane, none above `most`.
    #[inline(always)]
    pub(in crate::curvature::fit) fn tensor_variance(&self, size: [usize; LANES], most: usize) -> F4 {
        self.variance(3, size, most) * 4.0 + self.variance(4, size, most) * 2.0 + self.variance(5, size, most) * 4.0
    }

    /// An upper bound, close in practice, of the least eigenvalue of the leading block, scaled to unit
    /// diagonal: two inverse iterations.
    #[inline(always)]
    pub(in crate::curvature::fit) fn least_eigenvalue(&self, size: usize) -> F4 {
        let mut x = [F4::ZERO; N];
        for (i, x) in x[..size].iter_mut().enumerate() {
            *x = F4::splat(if i % 2 == 0 { 1.0 } else { -0.7 });
        }
        let norm = |x: &[F4; N]| x[..size].iter().fold(F4::ZERO, |s, &v| s + v * v).sqrt();
        let mut value = F4::ZERO;
        for _ in 0..2 {
            let inverse = F4::ONE / norm(&x);
            x[..size].iter_mut().for_each(|v| *v = *v * inverse);
            for i in 0..size {
                x[i] = x[i] * self.inverse[i];
                let solved = x[i];
                for (x, row) in x[i + 1..size].iter_mut().zip(&self.lower[i + 1..size]) {
                    *x -= row[i] * solved;
                }
            }
            self.substitute_back(&mut x, size);
            value = F4::ONE / norm(&x);
        }
        value
    }
}

/// The sums of squared residuals of samples.
#[inline(always)]
pub(in crate::curvature::fit) fn residual<const N: usize>(
    rows: &[[F4; N]],
    values: &[F4],
    coefficients: &[F4; N],
    size: usize,
) -> F4 {
    let mut total = F4::ZERO;
    for (row, &value) in rows.iter().zip(values) {
        let mut left = value;
        for (&f, &c) in row[..size].iter().zip(coefficients) {
            left -= c * f;
        }
        total += left * left;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 2 - 3 x + x^3 at nine points, in the basis 1, x, x^2, ... x^5.
    fn cubic() -> (Vec<[F4; 6]>, Vec<F4>) {
        let x = |i: i32| f64::from(i) - 4.0;
        let rows = (0..9).map(|i| std::array::from_fn(|power| F4::splat(x(i).powi(power as i32)))).collect();
        let values = (0..9).map(|i| F4::splat(2.0 - 3.0 * x(i) + x(i).powi(3))).collect();
        (rows, values)
    }

    fn factor(rows: &[[F4; 6]], values: &[F4]) -> Factor<6> {
        let mut factor = Factor::new(&Normal::new(rows, values));
        factor.factor(6);
        factor
    }

    #[test]
    fn nested_models_come_from_one_factor() {
        let (rows, values) = cubic();
        let factor = factor(&rows, &values);
        let full = factor.solve(4);
        for (got, wanted) in full.iter().zip([2.0, -3.0, 0.0, 1.0, 0.0, 0.0]) {
            assert!((got.0[1] - wanted).abs() < 1e-8, "{full:?}");
        }
        assert!(residual(&rows, &values, &full, 4).0[2] < 1e-12);
        // The best line through the odd part: slope -3 + sum x^4 / sum x^2 = -3 + 708 / 60.
        let line = factor.solve(2);
        assert!((line[1].0[0] - 8.8).abs() < 1e-9 && (line[0].0[0] - 2.0).abs() < 1e-9, "{line:?}");
    }

    #[test]
    fn variances_are_those_of_the_textbook() {
        let (rows, values) = cubic();
        let factor = factor(&rows, &values);
        // Of the slope of a line, 1 / sum x^2; of the cubic's, with moments 60, 708 and 9780.
        let variance = factor.variance(1, [2, 4, 2, 4], 4);
        assert!((variance.0[0] - 1.0 / 60.0).abs() < 1e-12);
        assert!((variance.0[1] - 9780.0 / (60.0 * 9780.0 - 708.0 * 708.0)).abs() < 1e-9, "{variance:?}");
    }

    #[test]
    fn lanes_are_problems_of_their_own() {
        let (mut rows, mut values) = cubic();
        for (row, value) in rows.iter_mut().zip(&mut values) {
            value.0[3] = row[2].0[3];
            row.iter_mut().skip(3).for_each(|f| f.0[3] = 0.0);
        }
        let x = factor(&rows, &values).solve(4);
        assert!((x[2].0[3] - 1.0).abs() < 1e-9 && x[1].0[3].abs() < 1e-9 && x[3].0[3] == 0.0);
        assert!((x[3].0[0] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_column_without_a_part_of_its_own_is_noticed() {
        let (mut rows, values) = cubic();
        for row in &mut rows {
            row[2] = row[1] * 2.0 - row[0];
        }
        let factor = factor(&rows, &values);
        assert!(factor.least_eigenvalue(3).0[0] < 1e-10 && factor.least_eigenvalue(2).0[0] > 1e-3);
    }
}
