//! Synthetic meshes whose curvature is known exactly: for tests, tables and trying things out.

mod random;
mod rounded_box;
mod scan_noise;
mod surface;

pub use rounded_box::RoundedBox;
pub use scan_noise::ScanNoise;
pub use surface::{Exact, Surface};

use crate::soup::{Positions, Soup};
use glam::{DVec2, DVec3};
use random::Random;
use surface::Axis;

/// A mesh and the exact curvature of the surface under every face's barycentre.
#[derive(Clone, Debug)]
pub struct Synthetic {
    /// The mesh.
    pub soup: Soup,
    /// One value per face. Noise does not change it: it is that of the surface without noise.
    pub exact: Vec<Exact>,
}

impl Synthetic {
    /// The exact values as CSV: face, k_max, k_min and both directions, in the shortest form that
    /// reads back as the same 64-bit numbers.
    pub fn exact_csv(&self) -> String {
        let mut csv = String::from("face,k_max,k_min,dir_max_x,dir_max_y,dir_max_z,dir_min_x,dir_min_y,dir_min_z\n");
        let mut buffer = zmij::Buffer::new();
        for (face, exact) in self.exact.iter().enumerate() {
            csv += &face.to_string();
            let directions = exact.dir_max.to_array().into_iter().chain(exact.dir_min.to_array());
            for value in [exact.k_max, exact.k_min].into_iter().chain(directions) {
                csv.push(',');
                csv += buffer.format(value);
            }
            csv.push('\n');
        }
        csv
    }
}

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
    /// Standard deviation of a random displacement of every coordinate, in mean edges.
    pub noise: f64,
    /// Chooses the random numbers.
    pub seed: u64,
}

impl Grid {
    /// A regular mesh without noise.
    pub fn new(surface: Surface, u: usize, v: usize) -> Self {
        Grid { surface, cells: [u, v], jitter: 0.0, noise: 0.0, seed: 0 }
    }

    /// A mesh of about `faces` faces whose cells are `aspect` times as long along u as along v,
    /// measured in the middle of the surface.
    pub fn with_faces(surface: Surface, faces: usize, aspect: f64) -> Self {
        let [length_u, length_v] = surface.lengths();
        let v = (0.5 * faces as f64 * aspect * length_v / length_u).sqrt();
        let u = 0.5 * faces as f64 / v;
        let [least_u, least_v] = surface.least_cells();
        Grid::new(surface, (u.round() as usize).max(least_u), (v.round() as usize).max(least_v))
    }

    /// The mesh, with the exact curvature of the surface under every face's barycentre.
    pub fn build(&self) -> Synthetic {
        let [nu, nv] = self.cells;
        let axes = self.surface.axes();
        let [rows_u, rows_v] = [points_along(axes[0], nu), points_along(axes[1], nv)];
        let mut random = Random::new(self.seed);
        let mut parameters = Vec::with_capacity(rows_u * rows_v);
        for j in 0..rows_v {
            for i in 0..rows_u {
                let u = parameter(axes[0], nu, i, self.jitter * random.signed());
                let v = parameter(axes[1], nv, j, self.jitter * random.signed());
                parameters.push(DVec2::new(u, v));
            }
        }
        let clean: Vec<DVec3> = parameters.iter().map(|&at| self.surface.jet(at).point).collect();

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
        let points = noisy(&clean, &faces, self.noise, self.seed);
        Synthetic { soup: Soup::new(Positions::F64(points), faces), exact }
    }
}

/// Moves every coordinate by a normal random number, `noise` mean edges strong.
fn noisy(points: &[DVec3], faces: &[[u32; 3]], noise: f64, seed: u64) -> Vec<[f64; 3]> {
    let deviation = noise * mean_edge(points, faces);
    // Another stream than the jitter's.
    let mut random = Random::new(!seed);
    points.iter().map(|p| p.to_array().map(|c| c + deviation * random.normal())).collect()
}

/// Mean length of the faces' sides.
fn mean_edge(points: &[DVec3], faces: &[[u32; 3]]) -> f64 {
    let sides = || faces.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let total: f64 = sides().map(|(a, b)| points[a as usize].distance(points[b as usize])).sum();
    total / (3 * faces.len()).max(1) as f64
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Bounds, Mesh, MeshOptions};

    fn exact(surface: Surface) -> Vec<Exact> {
        Grid { jitter: 0.2, ..Grid::with_faces(surface, 800, 1.0) }.build().exact
    }

    #[test]
    fn exact_values_are_those_of_the_textbook() {
        for e in exact(Surface::Sphere { radius: 4.0 }) {
            assert!((e.k_max - 0.25).abs() < 1e-9 && (e.k_min - 0.25).abs() < 1e-9, "{e:?}");
        }
        for e in exact(Surface::Torus { major: 3.0, minor: 0.5 }) {
            assert!((e.k_max - 2.0).abs() < 1e-9 && e.k_min.abs() < 0.5, "{e:?}");
            assert!(e.dir_max.dot(e.normal).abs() < 1e-12 && e.dir_max.dot(e.dir_min).abs() < 1e-12);
        }
        // An ellipsoid of revolution: along the equator 1/a, across it a/c^2.
        let near_equator = exact(Surface::Ellipsoid { axes: DVec3::new(2.0, 2.0, 3.0) });
        let equator = near_equator.iter().min_by(|a, b| a.normal.z.abs().total_cmp(&b.normal.z.abs())).expect("faces");
        assert!((equator.k_max - 0.5).abs() < 2e-2 && (equator.k_min - 2.0 / 9.0).abs() < 2e-2, "{equator:?}");
    }

    #[test]
    fn closed_shapes_are_closed_and_face_outward() {
        let ellipsoid = Grid::new(Surface::Ellipsoid { axes: DVec3::new(1.0, 2.0, 3.0) }, 16, 9).build();
        let torus = Grid { jitter: 0.3, ..Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 20, 9) }.build();
        let rounded = |fillet| RoundedBox {
            size: DVec3::new(4.0, 3.0, 2.0),
            fillet,
            flat_cells: 3,
            fillet_cells: 2,
            noise: 0.0,
            seed: 0,
        };
        for synthetic in [ellipsoid, torus, rounded(0.0).build(), rounded(0.5).build()] {
            let mesh = Mesh::from_soup(&synthetic.soup, &MeshOptions::default()).expect("a mesh");
            mesh.sanity_check();
            let report = mesh.report();
            assert!(report.closed && !report.has_defects() && report.inside_out_components == 0, "{report:?}");
            assert_eq!((synthetic.exact.len(), report.components), (report.faces, 1));
        }
    }

    #[test]
    fn a_rounded_box_has_flats_cylinders_and_corners() {
        let shape = RoundedBox {
            size: DVec3::new(4.0, 3.0, 2.0),
            fillet: 0.5,
            flat_cells: 4,
            fillet_cells: 2,
            noise: 0.0,
            seed: 0,
        };
        let built = shape.build();
        let with = |max: f64, min: f64| built.exact.iter().filter(|e| e.k_max == max && e.k_min == min).count();
        assert_eq!([with(0.0, 0.0), with(2.0, 0.0), with(2.0, 2.0)], [6 * 32, 6 * 4 * 16, 6 * 4 * 8]);
        assert_eq!(
            Bounds::of((0..built.soup.positions.len()).map(|v| built.soup.positions.get(v))).map(|b| b.max),
            Some(DVec3::new(2.0, 1.5, 1.0))
        );
    }
}
