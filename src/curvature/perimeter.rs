//! Formula (3): Gaussian curvature from the perimeter of the disk.
//!
//! On a surface the circle of geodesic radius r is shorter than on the plane by the factor
//! 1 - K r^2 / 6 + O(r^4). The paper compares the polygon of leg ends with the full circle, which
//! calls a plane curved as soon as there are finitely many legs. Here each sector is compared with
//! the same sector on the plane, so that a plane gives zero for any number of legs, and sectors with
//! a short leg are left out of both sums.
//!
//! Source: M. Szilvasi-Nagy, Face-based Estimations of Curvatures on Triangle Meshes, equation 3.

use crate::disk::Disk;
use crate::section::Stop;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// 6 / r^2 (1 - L / L_flat) over the sectors between full legs; `None` where there is none, save
/// that a disk without height is flat.
pub(super) fn gauss(disk: &Disk) -> Option<f64> {
    let legs = disk.legs();
    let step = 2.0 * PI / legs.len() as f64;
    let radius = disk.radius();
    let mut sectors = 0;
    let mut length = 0.0;
    for (i, leg) in legs.iter().enumerate() {
        let next = &legs[(i + 1) % legs.len()];
        if leg.stop == Stop::Length && next.stop == Stop::Length {
            sectors += 1;
            length += rim(leg.end, next.end, step);
        }
    }
    if sectors > 0 {
        let flat = f64::from(sectors) * 2.0 * radius * (0.5 * step).sin();
        return Some(6.0 / (radius * radius) * (1.0 - length / flat));
    }
    legs.iter().all(|leg| leg.excess <= 1e-12 * radius).then_some(0.0)
}

/// Distance of two leg ends whose directions differ by an angle.
fn rim(a: DVec2, b: DVec2, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    DVec3::new(b.x * cos - a.x, b.x * sin, b.y - a.y).length()
}
