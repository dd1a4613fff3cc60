//! How exactly a mesh's coordinates are written.

use crate::mesh::Mesh;
use glam::DVec3;
use rayon::prelude::*;

/// Most digits behind the point that are looked for.
const MOST_DIGITS: u32 = 9;
/// Coordinates cut to fewer digits than this, as a share of the mesh's size, are rough data, not rounded ones.
const ROUGHEST: f64 = 1e-6;
/// The largest size of a mesh of few large faces and many small ones, against a square sheet of as many.
const FAR: f64 = 1e3;

/// The rounding of a mesh's coordinates, in file units: that of the 32-bit floats or of the decimals that all of them
/// are, or that of 64-bit floats. Floats are rounded the more the larger they are, so that a vertex far away says
/// nothing of others.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Quantum {
    /// What the mesh's positions are relative to.
    origin: DVec3,
    /// The rounding of floats of size one.
    of_one: f64,
    /// That of the decimals; otherwise that of floats as large as the mesh, because a program that computed with such
    /// floats has left as much near zero, too.
    least: f64,
}

/// Of 64-bit floats of size one, which positions are kept in.
const OF_DOUBLE: f64 = 1e-16;

impl Quantum {
    /// Within a distance of a place.
    #[inline]
    pub(in crate::curvature::fit) fn around(&self, place: DVec3, distance: f64) -> f64 {
        let written = ((place + self.origin).abs().max_element() + distance) * self.of_one;
        let kept = (place.abs().max_element() + distance) * OF_DOUBLE;
        written.max(kept).max(self.least)
    }
}

/// What all coordinates have in common.
#[derive(Clone, Copy)]
struct Digits {
    /// True when all are numbers of 32 bits.
    is_single: bool,
    /// Digits behind the point; more than the most where some need more.
    decimals: u32,
}

/// How the coordinates of a mesh are rounded whose faces are `width` wide.
pub(in crate::curvature::fit) fn quantum(mesh: &Mesh, width: f64) -> Quantum {
    let origin = mesh.origin();
    let none = Digits { is_single: true, decimals: 0 };
    let digits = mesh
        .positions()
        .par_iter()
        .filter(|p| p.is_finite())
        .fold(|| none, |digits, &p| digits.with(p + origin))
        .reduce(|| none, Digits::and);
    let of_one = if digits.is_single { 6e-8 } else { OF_DOUBLE };
    let decimal = 0.5 * 0.1_f64.powi(digits.decimals as i32);
    // A vertex far away makes the mesh no larger than a square sheet of as many faces.
    let sheet = width * (mesh.face_count() as f64).sqrt();
    let size = mesh.report().bounds.map_or(0.0, |b| b.size().max_element());
    let are_rounded = digits.decimals <= MOST_DIGITS && decimal <= ROUGHEST * size.min(FAR * sheet);
    let of_mesh = of_one * size.min(sheet);
    Quantum { origin, of_one, least: if are_rounded { decimal.max(of_mesh) } else { of_mesh } }
}

impl Digits {
    fn with(self, p: DVec3) -> Self {
        Digits {
            is_single: self.is_single && p.as_vec3().as_dvec3() == p,
            decimals: p.to_array().into_iter().fold(self.decimals, decimals),
        }
    }

    fn and(self, other: Self) -> Self {
        Digits { is_single: self.is_single && other.is_single, decimals: self.decimals.max(other.decimals) }
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
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        let quantum = quantum(&mesh, 1.0);
        mesh.positions().iter().map(|&p| quantum.around(p, 0.0)).fold(0.0, f64::max)
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
