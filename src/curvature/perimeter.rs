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

use super::vectors::four::Real;
use crate::disk::Disk;
use crate::section::Stop;
use std::f64::consts::PI;

/// The end of a leg, as the perimeter sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    /// Way along the leg's direction and height above the face, in radii.
    pub(super) place: [f64; 2],
    pub(super) is_whole: bool,
    /// See [`Leg::aside`](crate::disk::Leg::aside).
    pub(super) aside: f64,
    /// See [`Leg::excess`](crate::disk::Leg::excess); in radii.
    pub(super) excess: f64,
}

/// 6 / r^2 (1 - L / L_flat) over the sectors between full legs; `None` where there is none, save
/// that a disk without height is flat.
pub(super) fn gauss(disk: &Disk) -> Option<f64> {
    let radius = disk.radius();
    let legs = disk.legs();
    let end = |i: usize| End {
        place: [legs[i].end.x / radius, legs[i].end.y / radius],
        is_whole: legs[i].stop == Stop::Length,
        aside: legs[i].aside,
        excess: legs[i].excess / radius,
    };
    gauss_of(legs.len(), end).map(|k| k / (radius * radius))
}

/// The same for the ends of all legs, by angle over the full turn, times the square of the radius.
pub(super) fn gauss_of(count: usize, end: impl Fn(usize) -> End) -> Option<f64> {
    let step = 2.0 * PI / count as f64;
    let (sin, cos) = step.sin_cos();
    let (mut length, mut flat) = (0.0, 0.0);
    for i in 0..count {
        let (end, next) = (end(i), end((i + 1) % count));
        if end.is_whole && next.is_whole {
            length += rim(end.place, next.place, [cos, sin]);
            flat += 2.0 * (0.5 * (step + next.aside - end.aside)).sin();
        }
    }
    if flat > 0.0 {
        return Some(6.0 * (1.0 - length / flat));
    }
    (0..count).all(|i| end(i).excess <= 1e-12).then_some(0.0)
}

/// Distance of two leg ends whose directions differ by a turn (cosine and sine).
#[inline(always)]
pub(super) fn rim<R: Real>(a: [R; 2], b: [R; 2], [cos, sin]: [R; 2]) -> R {
    let (x, y, z) = (b[0] * cos - a[0], b[0] * sin, b[1] - a[1]);
    (x * x + y * y + z * z).sqrt()
}
