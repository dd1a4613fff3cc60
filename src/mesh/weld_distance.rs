//! Gives one number to vertices that lie close together.

use super::clusters::Clusters;
use super::report::Bounds;
use super::weld::{NONE, Welded};
use crate::soup::Group;
use glam::DVec3;
use std::collections::HashMap;

/// Merges vertices that a chain of steps of at most `distance` connects, body by body.
///
/// The merged vertex keeps the position that is least in (x, y, z) order, so that the result does
/// not depend on the order of the faces.
pub(super) fn weld_distance(mut welded: Welded, bodies: &[Group], distance: f64) -> Welded {
    let before = welded.positions.len();
    let mut clusters = Clusters::new(before);
    let mut first = 0;
    for body in bodies {
        let faces = &welded.faces[body.faces.start as usize..body.faces.end as usize];
        let end = faces.iter().flatten().map(|&v| v + 1).max().unwrap_or(first).max(first);
        join_close(&mut clusters, &welded.positions, first..end, distance);
        first = end;
    }
    let representative = representatives(&mut clusters, &welded.positions);
    let mut number = vec![NONE; before];
    let mut positions = Vec::new();
    for corner in welded.faces.iter_mut().flatten() {
        let kept = representative[*corner as usize];
        if number[kept as usize] == NONE {
            number[kept as usize] = positions.len() as u32;
            positions.push(welded.positions[kept as usize]);
        }
        *corner = number[kept as usize];
    }
    Welded { merged_by_distance: before - positions.len(), positions, faces: welded.faces }
}

/// Sorts the vertices into cubes whose diagonal is the distance: all of one cube belong
/// together, and only cubes at most two apart can hold another close vertex.
fn join_close(clusters: &mut Clusters, positions: &[DVec3], vertices: std::ops::Range<u32>, distance: f64) {
    let side = distance / 3.0_f64.sqrt();
    let inside = positions[vertices.start as usize..vertices.end as usize].iter().copied();
    let Some(bounds) = Bounds::of(inside) else { return };
    // Below the rounding of the coordinates nothing is close but what is equal, and equal is one.
    if bounds.size().max_element() / side > 2.0_f64.powi(53) {
        return;
    }
    let mut cubes: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for v in vertices {
        let p = positions[v as usize];
        if p.is_finite() {
            let cube = ((p - bounds.min) / side).floor().to_array().map(|c| c as i64);
            cubes.entry(cube).or_default().push(v);
        }
    }
    for members in cubes.values() {
        for pair in members.windows(2) {
            clusters.join(pair[0], pair[1]);
        }
    }
    for (cube, members) in &cubes {
        for step in half_of_the_neighbours() {
            let near = [0, 1, 2].map(|i| cube[i].saturating_add(step[i]));
            let Some(others) = cubes.get(&near) else { continue };
            if clusters.root(members[0]) == clusters.root(others[0]) {
                continue;
            }
            let close = members.iter().any(|&a| {
                others
                    .iter()
                    .any(|&b| positions[a as usize].distance_squared(positions[b as usize]) <= distance * distance)
            });
            if close {
                clusters.join(members[0], others[0]);
            }
        }
    }
}

/// Per vertex, the member of its cluster whose position is least.
fn representatives(clusters: &mut Clusters, positions: &[DVec3]) -> Vec<u32> {
    let count = positions.len() as u32;
    let mut least: Vec<u32> = (0..count).collect();
    for v in 0..count {
        let root = clusters.root(v) as usize;
        let (p, q) = (positions[v as usize].to_array(), positions[least[root] as usize].to_array());
        if p < q {
            least[root] = v;
        }
    }
    (0..count).map(|v| least[clusters.root(v) as usize]).collect()
}

/// One of each pair of opposite steps between cubes at most two apart.
fn half_of_the_neighbours() -> impl Iterator<Item = [i64; 3]> {
    (-2..=2).flat_map(|x| (-2..=2).flat_map(move |y| (-2..=2).map(move |z| [x, y, z]))).filter(|step| *step > [0, 0, 0])
}

#[cfg(test)]
mod tests {
    use super::super::weld::tests::{soup_of, weld};
    use super::*;

    #[test]
    fn weld_distance_merges_chains_and_nothing_else() {
        let soup = soup_of(&[
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 0.009],
            [1.0, 0.0, 0.018],
            [1.0, 0.0, 0.009],
        ]);
        let welded = weld_distance(weld(&soup), &soup.bodies, 0.01);
        assert_eq!(welded.faces, [[0, 1, 2], [0, 1, 1]]);
        assert_eq!(welded.merged_by_distance, 3);
        let apart = weld_distance(weld(&soup), &soup.bodies, 0.008);
        assert_eq!(apart.merged_by_distance, 0);
    }
}
