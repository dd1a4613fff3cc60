//! Formula (3): Gaussian curvature from the perimeter of the disk.
//!
//! On a surface the circle of geodesic radius r is shorter than on the plane by the factor
//! 1 - K r^2 / 6 + O(r^4). The paper compares the polygon of leg ends with the full circle, which
//! calls a plane curved as soon as there are finitely many legs. Here each sector is compared with
//! the same sector on the plane, so that a plane gives zero for any number of legs, and sectors with
//! a short leg are left out of both sums.
//!
//! "The same sector" needs care, as legs are plane sections and no geodesics. In a direction of normal
//! curvature k and geodesic torsion t a section bends within the surface by k t s at the distance s, so
//! its end lies at an angle of k t r^2 / 6 beside that of the geodesic. Around the full circle that only
//! moves ends along the rim; a part of it is wider or narrower than the legs' directions by the difference
//! at its two borders, which goes into K whole, however small the radius: on a cylinder with a disk from rim
//! to rim, 13 % of k^2 instead of nothing. So the two legs at the borders of a part are taken in the
//! directions in which their ends lie within the surface ([`Leg::aside`](crate::disk::Leg::aside)).
//!
//! Source: M. Szilvasi-Nagy, Face-based Estimations of Curvatures on Triangle Meshes, equation 3; the
//! sectors are our own.

use crate::disk::Disk;
use crate::section::Stop;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// 6 / r^2 (1 - L / L_flat) over the sectors between full legs; `None` where there is none, save
/// that a disk without height is flat.
pub(super) fn gauss(disk: &Disk) -> Option<f64> {
    let legs = disk.legs();
    let step = 2.0 * PI / legs.len() as f64;
    let turn = DVec2::from_angle(step);
    let radius = disk.radius();
    let (mut length, mut flat) = (0.0, 0.0);
    for (leg, next) in legs.iter().zip(legs.iter().cycle().skip(1)) {
        if leg.stop == Stop::Length && next.stop == Stop::Length {
            length += rim(leg.end, next.end, turn);
            flat += 2.0 * radius * (0.5 * (step + next.aside - leg.aside)).sin();
        }
    }
    if flat > 0.0 {
        return Some(6.0 / (radius * radius) * (1.0 - length / flat));
    }
    legs.iter().all(|leg| leg.excess <= 1e-12 * radius).then_some(0.0)
}

/// Distance of two leg ends whose directions differ by a turn (cosine and sine).
fn rim(a: DVec2, b: DVec2, turn: DVec2) -> f64 {
    DVec3::new(b.x * turn.x - a.x, b.x * turn.y, b.y - a.y).length()
}
