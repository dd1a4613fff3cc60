//! A box whose edges are rounded, or sharp for a fillet of zero.

use super::{Exact, Synthetic, noisy};
use crate::soup::{Positions, Soup};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_4;

/// A closed box centred at zero: six flats, twelve quarter cylinders, eight spherical corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedBox {
    /// Lengths along x, y and z, fillets included.
    pub size: DVec3,
    /// Radius of the fillets, below half the shortest length; 0 for a box with sharp edges.
    pub fillet: f64,
    /// Cells along each flat's sides.
    pub flat_cells: usize,
    /// Cells across half a fillet (45 degrees), 1 or more where there is a fillet.
    pub fillet_cells: usize,
    /// Standard deviation of a random displacement of every coordinate, in mean edges.
    pub noise: f64,
    /// Chooses the random numbers.
    pub seed: u64,
}

/// A grid line across a side: the flat's coordinate, -1 to 1, or the angle into a fillet.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// Share of the inner box's half length.
    flat: f64,
    /// Angle from the flat's normal, -45 to 45 degrees.
    angle: f64,
}

impl RoundedBox {
    /// The mesh, with the exact curvature of every face's piece of the surface.
    pub fn build(&self) -> Synthetic {
        let lines = self.lines();
        let inner = 0.5 * self.size - DVec3::splat(self.fillet);
        let mut builder = Builder { positions: Vec::new(), vertex_at: HashMap::new() };
        let (mut faces, mut exact) = (Vec::new(), Vec::new());
        for axis in 0..3 {
            for side in [1.0, -1.0] {
                let frame = Frame { axis, side, inner, fillet: self.fillet };
                for (a, lines_a) in lines.windows(2).enumerate() {
                    for (b, lines_b) in lines.windows(2).enumerate() {
                        let corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
                            .map(|(i, j)| builder.vertex(frame.point(lines_a[i], lines_b[j])));
                        let [p, q, r, s] =
                            if side > 0.0 { corners } else { [corners[0], corners[3], corners[2], corners[1]] };
                        let middle =
                            frame.exact(self.is_fillet(a), self.is_fillet(b), middle_of(lines_a), middle_of(lines_b));
                        for face in [[p, q, r], [p, r, s]] {
                            faces.push(face);
                            exact.push(middle);
                        }
                    }
                }
            }
        }
        let positions = noisy(&builder.positions, &faces, self.noise, self.seed);
        Synthetic { soup: Soup::new(Positions::F64(positions), faces), exact }
    }

    fn arc_cells(&self) -> usize {
        if self.fillet > 0.0 { self.fillet_cells } else { 0 }
    }

    /// True for cells of the grid across a side that lie in a fillet.
    fn is_fillet(&self, cell: usize) -> bool {
        let arc = self.arc_cells();
        cell < arc || cell >= arc + self.flat_cells
    }

    fn lines(&self) -> Vec<Line> {
        let arc = self.arc_cells();
        let angle = |i: usize| FRAC_PI_4 * i as f64 / arc as f64;
        let before = (1..=arc).rev().map(|i| Line { flat: -1.0, angle: -angle(i) });
        let flat =
            (0..=self.flat_cells).map(|i| Line { flat: 2.0 * i as f64 / self.flat_cells as f64 - 1.0, angle: 0.0 });
        let after = (1..=arc).map(|i| Line { flat: 1.0, angle: angle(i) });
        before.chain(flat).chain(after).collect()
    }
}

fn middle_of(lines: &[Line]) -> Line {
    Line { flat: 0.5 * (lines[0].flat + lines[1].flat), angle: 0.5 * (lines[0].angle + lines[1].angle) }
}

/// One of the six sides.
struct Frame {
    axis: usize,
    side: f64,
    inner: DVec3,
    fillet: f64,
}

impl Frame {
    /// Unit normal of the surface where two grid lines cross.
    fn normal(&self, a: Line, b: Line) -> DVec3 {
        let mut normal = DVec3::ZERO;
        normal[self.axis] = self.side;
        normal[(self.axis + 1) % 3] = a.angle.tan();
        normal[(self.axis + 2) % 3] = b.angle.tan();
        normal.normalize()
    }

    fn point(&self, a: Line, b: Line) -> DVec3 {
        let mut core = self.inner;
        core[self.axis] *= self.side;
        core[(self.axis + 1) % 3] *= a.flat;
        core[(self.axis + 2) % 3] *= b.flat;
        core + self.fillet * self.normal(a, b)
    }

    fn exact(&self, fillet_a: bool, fillet_b: bool, a: Line, b: Line) -> Exact {
        let normal = self.normal(a, b);
        let bent = |is: bool| if is { 1.0 / self.fillet } else { 0.0 };
        let axis = |i: usize| {
            let mut axis = DVec3::ZERO;
            axis[(self.axis + i) % 3] = 1.0;
            axis
        };
        // Around a fillet along one axis; any tangent will do on a flat and on a corner.
        let along = if fillet_a && !fillet_b { axis(2) } else { axis(1) };
        let dir_min = (along - along.dot(normal) * normal).normalize();
        Exact {
            k_max: bent(fillet_a || fillet_b),
            k_min: bent(fillet_a && fillet_b),
            dir_max: dir_min.cross(normal),
            dir_min,
            normal,
        }
    }
}

/// Gives sides that share an edge the same vertices there.
struct Builder {
    positions: Vec<DVec3>,
    vertex_at: HashMap<[i64; 3], u32>,
}

impl Builder {
    fn vertex(&mut self, p: DVec3) -> u32 {
        // Both sides compute a shared point with the same numbers but for the last bits.
        let key = (p * 1e9).round().to_array().map(|c| c as i64);
        *self.vertex_at.entry(key).or_insert_with(|| {
            self.positions.push(p);
            self.positions.len() as u32 - 1
        })
    }
}
