//! How exactly a mesh's coordinates are written.

use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
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
    /// That of the decimals, or what flats tell ([`hidden`]), where that is more; otherwise that of floats as large as the
    /// mesh, because a program that computed with such floats has left as much near zero, too.
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
    let written = if are_rounded { decimal.max(of_mesh) } else { of_mesh };
    let quantum = Quantum { origin, of_one, least: written };
    Quantum { least: written.max(hidden(mesh, &quantum).min(ROUGHEST * size.min(sheet))), ..quantum }
}

/// The rounding that coordinates had before they were scaled, turned or moved, which their digits do not tell: flats do,
/// whose faces lie in one plane but for it, now above and now below. 0 where nothing tells of any. A power of two, so
/// that it does not depend on which faces are looked at.
fn hidden(mesh: &Mesh, written: &Quantum) -> f64 {
    /// Faces looked at.
    const FACES: usize = 1 << 16;
    /// Where among the folds, from the least on, a sharp one is.
    const SHARP: f64 = 0.995;
    /// The share of the sharp fold below which a fold is none.
    const NONE: f64 = 1e-4;
    /// Least share of edges that have to tell.
    const LEAST: f64 = 0.1;
    /// Largest mean of what is off, in root mean squares: what bends is off to one side.
    const ONE_SIDED: f64 = 0.2;
    let step = mesh.face_count().div_ceil(FACES);
    // How far the corner beyond an edge is above the plane, and its share of the height there: the angle of the fold.
    let fold = |h: HalfEdge| {
        let twin = mesh.topology().twin(h)?;
        let corner = mesh.position(mesh.topology().apex(twin));
        let off = (corner - mesh.position(mesh.topology().origin(h))).dot(mesh.normal(h.face()));
        let slack = 4.0 * written.around(corner, mesh.height(twin));
        Some((off.abs() / mesh.height(twin), off, off.abs() > slack))
    };
    let faces = (0..mesh.face_count()).into_par_iter().step_by(step).map(|f| Face(f as u32));
    let sides = faces.filter(|&f| mesh.is_sound(f)).flat_map_iter(Face::half_edges);
    let inner = sides.filter(|&h| mesh.edge_kind(h) == EdgeKind::Inner);
    let mut folds: Vec<(f64, f64, bool)> = inner.filter_map(fold).filter(|fold| fold.0.is_finite()).collect();
    folds.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(sharp, ..)) = folds.get((folds.len() as f64 * SHARP) as usize) else { return 0.0 };
    let flat = folds.iter().take_while(|fold| fold.0 < NONE * sharp).filter(|fold| fold.2);
    let mut off: Vec<f64> = flat.map(|fold| fold.1).collect();
    let count = off.len() as f64;
    let (sum, squares) = off.iter().fold((0.0, 0.0), |(sum, squares), off| (sum + off, squares + off * off));
    if count < LEAST * folds.len() as f64 || sum.abs() > ONE_SIDED * (count * squares).sqrt() {
        return 0.0;
    }
    off.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    off.get(off.len() / 2).map_or(0.0, |off| off.abs().log2().ceil().exp2())
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
    use crate::synth::{Grid, RoundedBox, Surface};

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

    /// 32-bit coordinates in other units, written with all digits, are no more exact than they were, as flats and flat
    /// cells tell; those that were computed with all digits are what they seem.
    #[test]
    fn flats_tell_of_a_rounding_that_digits_do_not() {
        let of = |soup: &Soup, change: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let points = (0..soup.positions.len()).map(|v| change(soup.positions.get(v).to_array())).collect();
            let soup = Soup::new(Positions::F64(points), soup.triangles.clone());
            let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
            quantum(&mesh, 1.0).around(DVec3::ZERO, 0.0)
        };
        let turned = |[x, y, z]: [f64; 3]| [0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y, z + 0.1];
        let inches = |p: [f64; 3]| turned(p).map(|c| f64::from(c as f32) * 25.4);
        let box_ = RoundedBox {
            size: DVec3::new(4.0, 3.0, 2.0),
            fillet: 0.5,
            flat_cells: 6,
            fillet_cells: 3,
            noise: 0.0,
            seed: 0,
        }
        .build()
        .soup;
        // A cap that hardly bends, within a rim that bends much.
        let lens = |[x, y, z]: [f64; 3]| {
            let r = x.hypot(y);
            [x, y, z - r * r / 2e5 - (r - 0.9).max(0.0).powi(2)]
        };
        let plane = Grid::new(Surface::Plane, 60, 60).build().soup;
        assert!(of(&plane, &|p| turned(lens(p))) < 1e-14, "{}", of(&plane, &|p| turned(lens(p))));
        // Its cells are flat.
        let torus = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 200, 100).build().soup;
        let wave = Grid::new(Surface::Wave, 100, 100).build().soup;
        for (soup, has_flats) in [(box_, true), (torus, true), (wave, false)] {
            assert!(of(&soup, &turned) < 1e-14, "{}", of(&soup, &turned));
            let found = of(&soup, &inches);
            assert!(if has_flats { (1e-7..1e-5).contains(&found) } else { found < 1e-13 }, "{found}");
        }
    }
}
