//! Normals at the corners of faces: those of the faces around, but not across a crease.

use super::super::display::Display;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Cosine of the angle between faces above which an edge looks like a crease.
const CREASE: f64 = 0.766;

/// Unit normals of the three corners of every face, by area, as `turn` sees them; zero for a face without area.
pub(super) fn of_corners(display: &Display, turn: impl Fn(DVec3) -> Vec3 + Sync) -> Vec<[Vec3; 3]> {
    let areas: Vec<DVec3> = (0..display.corners.len())
        .into_par_iter()
        .map(|i| {
            let [a, b, c] = display.triangle(i);
            (b - a).cross(c - a)
        })
        .collect();
    let units: Vec<DVec3> = areas.par_iter().map(|n| n.normalize_or_zero()).collect();
    // The faces around every vertex, one vertex after the other.
    let mut starts = vec![0_u32; display.positions.len() + 1];
    for &v in display.corners.as_flattened() {
        starts[v as usize + 1] += 1;
    }
    for v in 1..starts.len() {
        starts[v] += starts[v - 1];
    }
    let mut next = starts.clone();
    let mut around = vec![0_u32; 3 * display.corners.len()];
    for (corner, &v) in display.corners.as_flattened().iter().enumerate() {
        around[next[v as usize] as usize] = corner as u32 / 3;
        next[v as usize] += 1;
    }
    /// Faces around a vertex, from which on they are held against the mean of all: each against each takes their square.
    const CROWDED: usize = 64;
    let faces_of = |v: u32| &around[starts[v as usize] as usize..starts[v as usize + 1] as usize];
    let is_crowded = |v: &u32| faces_of(*v).len() >= CROWDED;
    let mean = |v: u32| (v, faces_of(v).iter().map(|&f| areas[f as usize]).sum::<DVec3>().normalize_or_zero());
    let means: HashMap<u32, DVec3> =
        (0..display.positions.len() as u32).into_par_iter().filter(is_crowded).map(mean).collect();
    let corner = |face: usize, v: u32| {
        let faces = faces_of(v);
        if let Some(&mean) = means.get(&v) {
            return if mean.dot(units[face]) > CREASE { mean } else { units[face] };
        }
        let alike = faces.iter().map(|&f| f as usize).filter(|&f| units[f].dot(units[face]) > CREASE);
        let sum: DVec3 = alike.map(|f| areas[f]).sum();
        sum.try_normalize().unwrap_or(units[face])
    };
    (0..display.corners.len()).into_par_iter().map(|f| display.corners[f].map(|v| turn(corner(f, v)))).collect()
}
