//! How wide the faces of a mesh are.

use crate::mesh::{Face, Mesh};
use rayon::prelude::*;

/// Two to the power of the mean binary exponent of all sides of sound faces: nearly as much as most faces are wide.
/// Single faces, however large or far from others, do not count for more, and neither does the order of faces or of
/// their corners.
pub(super) fn typical_width(mesh: &Mesh) -> f64 {
    let exponents = |f: u32| {
        let [a, b, c] = mesh.triangle(Face(f));
        [b - a, c - b, a - c].into_iter().map(|side| i64::from(exponent_of(side.length()))).sum::<i64>()
    };
    let (sum, count) = (0..mesh.face_count() as u32)
        .into_par_iter()
        .filter(|&f| mesh.is_sound(Face(f)))
        .map(|f| (exponents(f), 3))
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    let mean = if count > 0 { sum.div_euclid(count) } else { 0 };
    2.0_f64.powi(mean.clamp(-1000, 1000) as i32)
}

/// Of a number's power of two.
fn exponent_of(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MeshOptions;
    use crate::soup::{Positions, Soup};
    use crate::synth::{Grid, Surface};

    #[test]
    fn one_face_far_away_does_not_count() {
        let mut soup = Grid::new(Surface::Saddle, 20, 20).build().soup;
        let width = |soup: &Soup| typical_width(&Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh"));
        let alone = width(&soup);
        assert!((0.05..0.2).contains(&alone), "{alone}");
        let mut points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|i| soup.positions.get(i).to_array()).collect();
        let next = points.len() as u32;
        points.extend([[1e9, 0.0, 0.0], [1e9, 1e6, 0.0], [1e9, 0.0, 1e6]]);
        soup.triangles.push([next, next + 1, next + 2]);
        assert_eq!(width(&Soup::new(Positions::F64(points), soup.triangles)), alone);
    }
}
