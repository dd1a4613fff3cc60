//! How exactly a mesh's coordinates are written.

use crate::mesh::Mesh;
use glam::DVec3;
use rayon::prelude::*;

/// Most digits behind the point that are looked for.
const MOST_DIGITS: u32 = 9;
/// Coordinates cut to fewer digits than this, as a share of the mesh's size, are rough data, not rounded ones.
const ROUGHEST: f64 = 1e-6;

/// What all coordinates have in common.
#[derive(Clone, Copy)]
struct Digits {
    largest: f64,
    /// True when all are numbers of 32 bits.
    is_single: bool,
    /// Digits behind the point; more than the most where some need more.
    decimals: u32,
}

/// The rounding of the mesh's coordinates, in file units: that of the 32-bit floats or of the decimals that all of them
/// are, or that of 64-bit floats.
pub(super) fn quantum(mesh: &Mesh) -> f64 {
    let origin = mesh.origin();
    let none = Digits { largest: 0.0, is_single: true, decimals: 0 };
    let digits = mesh
        .positions()
        .par_iter()
        .filter(|p| p.is_finite())
        .fold(|| none, |digits, &p| digits.with(p + origin))
        .reduce(|| none, Digits::and);
    let single = if digits.is_single { 6e-8 * digits.largest } else { 1e-16 * digits.largest };
    let decimal = 0.5 * 0.1_f64.powi(digits.decimals as i32);
    let size = mesh.report().bounds.map_or(0.0, |b| b.size().max_element());
    if digits.decimals <= MOST_DIGITS && decimal <= ROUGHEST * size { decimal.max(single) } else { single }
}

impl Digits {
    fn with(self, p: DVec3) -> Self {
        Digits {
            largest: self.largest.max(p.abs().max_element()),
            is_single: self.is_single && p.as_vec3().as_dvec3() == p,
            decimals: p.to_array().into_iter().fold(self.decimals, decimals),
        }
    }

    fn and(self, other: Self) -> Self {
        Digits {
            largest: self.largest.max(other.largest),
            is_single: self.is_single && other.is_single,
            decimals: self.decimals.max(other.decimals),
        }
    }
}

/// The digits behind the point that a number needs, if those are more than others do.
fn decimals(others: u32, x: f64) -> u32 {
    /// Beyond, 64 bits hold too few digits to tell.
    const LARGEST: f64 = 1e12;
    let needs_more = |digits: u32| {
        let scaled = (x * 10.0_f64.powi(digits as i32)).abs();
        scaled > LARGEST || (scaled - scaled.round()).abs() > 4.0 * f64::EPSILON * scaled
    };
    (others..=MOST_DIGITS).find(|&digits| !needs_more(digits)).unwrap_or(MOST_DIGITS + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::soup::{Positions, Soup};

    fn quantum_of(points: [[f64; 3]; 3]) -> f64 {
        let soup = Soup::new(Positions::F64(points.to_vec()), vec![[0, 1, 2]]);
        quantum(&Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh"))
    }

    #[test]
    fn the_digits_of_a_file_are_known() {
        let third = 1.0 / 3.0;
        for (x, y, expected) in [
            (1.234567, -2.5, 5e-7),
            (1.0, third, 1e-16),
            (1.0, f64::from(third as f32), 6e-8),
            (1.0, 1_234_567.000_123, 1.234_567_000_123e-10),
            // Whole numbers are exact, for all that is known.
            (1.0, 2.0, 1.2e-7),
        ] {
            let found = quantum_of([[0.0, 0.0, 0.0], [x, 0.0, 0.0], [0.0, y, 0.0]]);
            assert!((found / expected - 1.0).abs() < 1e-12, "{x} {y}: {found}");
        }
    }
}
