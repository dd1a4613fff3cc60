//! Synthetic meshes whose curvature is known exactly: for tests, tables and trying things out.

mod surface;

pub use surface::{Exact, Surface};

use crate::soup::{Positions, Soup};
use glam::{DVec2, DVec3};
use surface::Axis;

/// A triangulated piece of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The surface.
    pub surface: Surface,
    /// Cells along u and v, each of two triangles. At least 3 around a periodic direction.
    pub cells: [usize; 2],
    /// Every parameter moves by up to this share of a cell at random; 0 for a regular mesh. Vertices
    /// on a border move along it only.
    pub jitter: f64,
    /// Standard deviation of a random displacement of every coordinate, in units of length.
    pub noise: f64,
    /// Chooses the random numbers.
    pub seed: u64,
}

impl Grid {
    /// A regular mesh without noise.
    pub fn new(surface: Surface, u: usize, v: usize) -> Self {
        Grid { surface, cells: [u, v], jitter: 0.0, noise: 0.0, seed: 0 }
    }

    /// The mesh, with the exact curvature of the surface under every face's barycentre.
    pub fn build(&self) -> (Soup, Vec<Exact>) {
        let [nu, nv] = self.cells;
        let axes = self.surface.axes();
        let [rows_u, rows_v] = [points_along(axes[0], nu), points_along(axes[1], nv)];
        let mut random = Random(self.seed);
        let mut parameters = Vec::with_capacity(rows_u * rows_v);
        for j in 0..rows_v {
            for i in 0..rows_u {
                let u = parameter(axes[0], nu, i, self.jitter * random.signed());
                let v = parameter(axes[1], nv, j, self.jitter * random.signed());
                parameters.push(DVec2::new(u, v));
            }
        }
        let clean: Vec<DVec3> = parameters.iter().map(|&at| self.surface.jet(at).point).collect();
        let points: Vec<[f64; 3]> =
            clean.iter().map(|p| p.to_array().map(|c| c + self.noise * random.normal())).collect();

        let (mut faces, mut exact) = (Vec::new(), Vec::new());
        for j in 0..nv {
            for i in 0..nu {
                let corner = |di: usize, dj: usize| {
                    let (i, j) = ((i + di) % rows_u, (j + dj) % rows_v);
                    // Both poles are one vertex each: the first of their row.
                    let pole = self.surface.has_poles() && (j == 0 || j == nv);
                    (rows_u * j + if pole { 0 } else { i }) as u32
                };
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                for face in [[a, b, c], [a, c, d]] {
                    if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
                        continue;
                    }
                    let middle = face.iter().map(|&v| clean[v as usize]).sum::<DVec3>() / 3.0;
                    let start = DVec2::new(parameter(axes[0], nu, i, 0.5), parameter(axes[1], nv, j, 0.5));
                    faces.push(face);
                    exact.push(self.surface.exact_at_foot(start, middle));
                }
            }
        }
        (Soup::new(Positions::F64(points), faces), exact)
    }
}

fn points_along(axis: Axis, cells: usize) -> usize {
    if axis.periodic { cells } else { cells + 1 }
}

/// The parameter of grid line `i`, moved by a share of a cell unless it is a border.
fn parameter(axis: Axis, cells: usize, i: usize, moved: f64) -> f64 {
    let border = !axis.periodic && (i == 0 && moved.abs() < 0.5 || i == cells);
    let at = i as f64 + if border { 0.0 } else { moved };
    axis.start + (axis.end - axis.start) * at / cells as f64
}

/// SplitMix64 (Steele, Lea, Flood 2014): small, seeded, the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Uniform in [-1, 1).
    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Normal with mean 0 and deviation 1 (Box and Muller).
    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.unit()).ln()).sqrt() * (2.0 * std::f64::consts::PI * self.unit()).cos()
    }
}
