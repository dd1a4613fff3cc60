//! The nested bases of implicit surfaces F(x, y, z) = z - sum c_j f_j(x, y, z) = 0.
//!
//! | size | functions added | surfaces it contains |
//! |---|---|---|
//! | 3 | 1, x, y | planes |
//! | 6 | x^2, xy, y^2 | paraboloids |
//! | 9 | xz, yz, z^2 | all quadrics |
//! | 13 | s x, s y, s z, s^2 with s = x^2 + y^2 + z^2 | Darboux cyclides, tori among them |
//! | 22 | all monomials of degree 3 and 4 in x and y | height polynomials of degree 4 |
//!
//! Coordinates are those of a local frame, lengths in units of the window's size.

use super::least_squares::{Factor, MOST, Rows};
use glam::DVec3;

/// The sizes of the nested bases.
pub(super) const SIZES: [usize; 5] = [3, 6, 9, 13, 22];

/// Curvature, in turns per window, below which priors do not get any narrower.
const LEAST_BEND: f64 = 0.03;

/// The basis functions at a point.
#[inline]
pub(super) fn basis(DVec3 { x, y, z }: DVec3) -> [f64; MOST] {
    let (xx, xy, yy, zz) = (x * x, x * y, y * y, z * z);
    let s = xx + yy + zz;
    [
        1.0,
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
    ]
}

/// The derivatives of the basis functions along a direction.
pub(super) fn basis_along(p: DVec3, d: DVec3) -> [f64; MOST] {
    let DVec3 { x, y, z } = p;
    let (s, ds) = (p.length_squared(), 2.0 * p.dot(d));
    [
        0.0,
        d.x,
        d.y,
        2.0 * x * d.x,
        x * d.y + y * d.x,
        2.0 * y * d.y,
        x * d.z + z * d.x,
        y * d.z + z * d.y,
        2.0 * z * d.z,
        ds * x + s * d.x,
        ds * y + s * d.y,
        ds * z + s * d.z,
        2.0 * s * ds,
        3.0 * x * x * d.x,
        2.0 * x * y * d.x + x * x * d.y,
        2.0 * x * y * d.y + y * y * d.x,
        3.0 * y * y * d.y,
        4.0 * x * x * x * d.x,
        3.0 * x * x * y * d.x + x * x * x * d.y,
        2.0 * x * y * (y * d.x + x * d.y),
        y * y * y * d.x + 3.0 * x * y * y * d.y,
        4.0 * y * y * y * d.y,
    ]
}

/// One row for each point: that F vanishes there. `extra` rows are left free behind them.
pub(super) fn fill(rows: &mut Rows, points: &[DVec3], width: usize, extra: usize) {
    rows.reset(points.len() + extra, width);
    for (row, &p) in points.iter().enumerate() {
        rows.set(row, &basis(p)[..width], p.z);
    }
}

/// The normal equations with a prior on the terms beyond the paraboloid: where rounding (or noise)
/// is strong, terms that a surface bending as this one does has no use for stay small.
pub(super) fn factor_with_prior(rows: &Rows, noise: f64) -> Factor {
    let mut prior = [0.0; MOST];
    let normal = rows.normal();
    if rows.width() <= 6 {
        return normal.factor(rows.width(), &prior);
    }
    let paraboloid = normal.factor(6, &prior).solve(6);
    let [a, b, c] = [paraboloid[3], paraboloid[4], paraboloid[5]];
    let bend = ((a + c).abs() + (a - c).hypot(b)).max(LEAST_BEND);
    for (column, prior) in prior.iter_mut().enumerate().skip(6) {
        let expected = match column {
            6..=8 => bend,
            9..=16 => bend * bend,
            _ => bend * bend * bend,
        };
        *prior = (noise / (0.3 * expected)).powi(2);
    }
    normal.factor(rows.width(), &prior)
}
