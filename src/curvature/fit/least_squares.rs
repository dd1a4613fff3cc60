//! Least squares over nested bases: one Gram matrix and one Cholesky factor serve every size.
//!
//! The first k columns of the basis, for each size k, are a model of their own; the leading k x k block
//! of the factor is that model's factor.

use super::lanes::{F4, Kernel, LANES, run};

/// Most columns of a basis.
pub(super) const MOST: usize = 15;
type Lane = [f64; LANES];

/// One row per sample: the basis functions there and the value they are to explain. Stored by column.
pub(super) struct Rows {
    columns: Vec<Lane>,
    /// Lanes per column.
    stride: usize,
    count: usize,
    width: usize,
}

/// The normal equations.
pub(super) struct Normal {
    /// Lower triangle by rows; the right side behind the last row.
    gram: [[f64; MOST]; MOST + 1],
    width: usize,
}

/// The normal equations, factored.
pub(super) struct Factor {
    /// Lower triangle by rows, of the equations scaled to unit diagonal.
    lower: [[f64; MOST]; MOST],
    /// Forward substitution of the right side.
    forward: [f64; MOST],
    scale: [f64; MOST],
    width: usize,
}

/// Added to the unit diagonal, so that columns without a part of their own do no harm.
const RIDGE: f64 = 1e-12;

impl Rows {
    pub(super) fn new() -> Self {
        Rows { columns: Vec::new(), stride: 0, count: 0, width: 0 }
    }

    /// Makes room for `count` rows of `width` columns and the value behind them; all zero.
    pub(super) fn reset(&mut self, count: usize, width: usize) {
        self.stride = count.div_ceil(LANES);
        (self.count, self.width) = (count, width);
        self.columns.clear();
        self.columns.resize(self.stride * (width + 1), [0.0; LANES]);
    }

    #[inline]
    pub(super) fn set(&mut self, row: usize, values: &[f64], value: f64) {
        debug_assert!(row < self.count && values.len() == self.width);
        let (lane, part) = (row / LANES, row % LANES);
        for (column, &v) in values.iter().chain(std::iter::once(&value)).enumerate() {
            self.columns[column * self.stride + lane][part] = v;
        }
    }

    /// Sets the four rows from `4 * lane` on; those beyond the last row must be zero.
    #[inline(always)]
    pub(super) fn set_lane(&mut self, lane: usize, values: &[F4], value: F4) {
        for (column, v) in values.iter().chain(std::iter::once(&value)).enumerate() {
            self.columns[column * self.stride + lane] = v.0;
        }
    }

    /// The number of times four rows.
    pub(super) fn lanes(&self) -> usize {
        self.stride
    }

    #[inline(always)]
    fn column(&self, column: usize) -> &[Lane] {
        &self.columns[column * self.stride..(column + 1) * self.stride]
    }

    /// Scalar products of a column with four that follow each other from `b` on.
    #[inline(always)]
    fn dots(&self, a: usize, b: usize) -> [f64; 4] {
        let mut sums = [[0.0; LANES]; 4];
        let others: [&[Lane]; 4] = std::array::from_fn(|k| self.column(b + k));
        for (at, a) in self.column(a).iter().enumerate() {
            for (sum, other) in sums.iter_mut().zip(others) {
                let b = &other[at];
                for i in 0..LANES {
                    sum[i] += a[i] * b[i];
                }
            }
        }
        sums.map(|s| (s[0] + s[2]) + (s[1] + s[3]))
    }

    #[inline(always)]
    fn dot(&self, a: usize, b: usize) -> f64 {
        let mut sums = [0.0; LANES];
        for (a, b) in self.column(a).iter().zip(self.column(b)) {
            for i in 0..LANES {
                sums[i] += a[i] * b[i];
            }
        }
        (sums[0] + sums[2]) + (sums[1] + sums[3])
    }

    /// Forms the normal equations.
    pub(super) fn normal(&self) -> Normal {
        run(FormNormal(self))
    }

    #[inline(always)]
    fn form_normal(&self) -> Normal {
        let mut normal = Normal { gram: [[0.0; MOST]; MOST + 1], width: self.width };
        for (i, row) in normal.gram[..=self.width].iter_mut().enumerate() {
            // Up to the diagonal; for the right side, all columns.
            let end = (i + 1).min(self.width);
            for j in (0..end).step_by(4) {
                if j + 4 <= end {
                    row[j..j + 4].copy_from_slice(&self.dots(i, j));
                } else {
                    (j..end).for_each(|j| row[j] = self.dot(i, j));
                }
            }
        }
        normal
    }

    /// Forms and factors the normal equations.
    pub(super) fn factor(&self) -> Factor {
        self.normal().factor(self.width, &[0.0; MOST])
    }

    /// The sum of squared residuals of the first `until` rows.
    pub(super) fn residual(&self, coefficients: &[f64], until: usize) -> f64 {
        run(SumResidual { rows: self, coefficients, until })
    }

    #[inline(always)]
    fn sum_residual(&self, coefficients: &[f64], until: usize) -> f64 {
        let mut total = 0.0;
        for lane in 0..until.div_ceil(LANES) {
            let mut left = self.columns[self.width * self.stride + lane];
            for (column, c) in coefficients.iter().enumerate() {
                let values = &self.columns[column * self.stride + lane];
                for i in 0..LANES {
                    left[i] -= c * values[i];
                }
            }
            let parts = LANES.min(until - lane * LANES);
            total += left[..parts].iter().map(|r| r * r).sum::<f64>();
        }
        total
    }
}

struct FormNormal<'r>(&'r Rows);

impl Kernel for FormNormal<'_> {
    type Output = Normal;

    #[inline(always)]
    fn run(self) -> Normal {
        self.0.form_normal()
    }
}

struct SumResidual<'r> {
    rows: &'r Rows,
    coefficients: &'r [f64],
    until: usize,
}

impl Kernel for SumResidual<'_> {
    type Output = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        self.rows.sum_residual(self.coefficients, self.until)
    }
}

impl Normal {
    /// Factors the leading block of `width` columns, with `prior` added to the diagonal.
    pub(super) fn factor(&self, width: usize, prior: &[f64; MOST]) -> Factor {
        let mut f = Factor { lower: [[0.0; MOST]; MOST], forward: [0.0; MOST], scale: [0.0; MOST], width };
        for (i, prior) in prior[..width].iter().enumerate() {
            let diagonal = self.gram[i][i] + prior;
            f.scale[i] = if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 0.0 };
            for j in 0..i {
                f.lower[i][j] = self.gram[i][j] * f.scale[i] * f.scale[j];
            }
            f.lower[i][i] = 1.0 + RIDGE;
            f.forward[i] = self.gram[self.width][i] * f.scale[i];
        }
        f.decompose();
        f
    }
}

impl Factor {
    fn decompose(&mut self) {
        for i in 0..self.width {
            for j in 0..i {
                let (done, rest) = self.lower.split_at_mut(i);
                let (a, b) = (&mut rest[0], &done[j]);
                let mut sum = a[j];
                for k in 0..j {
                    sum -= a[k] * b[k];
                }
                a[j] = sum / b[j];
            }
            let row = &self.lower[i];
            let pivot = row[i] - row[..i].iter().map(|l| l * l).sum::<f64>();
            let forward = self.forward[i] - row[..i].iter().zip(&self.forward).map(|(l, y)| l * y).sum::<f64>();
            // A pivot that rounding took below the ridge: the column has no part of its own.
            let root = pivot.max(RIDGE).sqrt();
            self.lower[i][i] = root;
            self.forward[i] = forward / root;
        }
    }

    /// Coefficients of the model of the first `size` columns; the others are zero.
    pub(super) fn solve(&self, size: usize) -> [f64; MOST] {
        let mut x = [0.0; MOST];
        x[..size].copy_from_slice(&self.forward[..size]);
        self.substitute_back(&mut x, size);
        for (x, scale) in x[..size].iter_mut().zip(&self.scale) {
            *x *= scale;
        }
        x
    }

    fn substitute_back(&self, x: &mut [f64; MOST], size: usize) {
        for i in (0..size).rev() {
            x[i] /= self.lower[i][i];
            let solved = x[i];
            for (x, l) in x[..i].iter_mut().zip(&self.lower[i]) {
                *x -= l * solved;
            }
        }
    }

    /// a' C a for the model of the first `size` columns, where C is the inverse of its normal equations:
    /// the variance of the combination `a` of its coefficients, for samples of unit variance.
    pub(super) fn variance(&self, a: &[f64; MOST], size: usize) -> f64 {
        let mut y = [0.0; MOST];
        for i in 0..size {
            let sum: f64 = self.lower[i][..i].iter().zip(&y).map(|(l, y)| l * y).sum();
            y[i] = (a[i] * self.scale[i] - sum) / self.lower[i][i];
        }
        y[..size].iter().map(|y| y * y).sum()
    }

    /// Variance of the shape tensor (its squared Frobenius norm) that x^2, xy and y^2 in columns 3 to 5
    /// span, in units of the frame, for samples of unit variance.
    pub(super) fn tensor_variance(&self, size: usize) -> f64 {
        let of = |at: usize| self.variance(&std::array::from_fn(|i| f64::from(i == at)), size);
        4.0 * of(3) + 2.0 * of(4) + 4.0 * of(5)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = 2 - 3 x + x^3 at nine points, in the basis 1, x, x^2, x^3.
    fn cubic() -> Rows {
        let mut rows = Rows::new();
        rows.reset(9, 4);
        for i in 0..9 {
            let x = i as f64 - 4.0;
            rows.set(i, &[1.0, x, x * x, x * x * x], 2.0 - 3.0 * x + x * x * x);
        }
        rows
    }

    #[test]
    fn nested_models_come_from_one_factor() {
        let rows = cubic();
        let factor = rows.factor();
        let full = factor.solve(4);
        for (got, wanted) in full.iter().zip([2.0, -3.0, 0.0, 1.0]) {
            assert!((got - wanted).abs() < 1e-8, "{full:?}");
        }
        assert!(rows.residual(&full[..4], 9) < 1e-12);
        // The best line through the odd part: slope -3 + sum x^4 / sum x^2 = -3 + 708 / 60.
        let line = factor.solve(2);
        assert!((line[1] - 8.8).abs() < 1e-9 && (line[0] - 2.0).abs() < 1e-9, "{line:?}");
        assert!((rows.residual(&line[..2], 5) - rows.residual(&line[..2], 9) / 2.0).abs() < 1e-6);
    }

    #[test]
    fn variances_are_those_of_the_textbook() {
        let factor = cubic().factor();
        let slope = std::array::from_fn(|i| f64::from(i == 1));
        assert!((factor.variance(&slope, 2) - 1.0 / 60.0).abs() < 1e-12);
    }
}
