//! Polygons to triangles, without losing a corner or turning a triangle over.
//!
//! A fan where every corner is strictly convex, ear clipping otherwise. Ears must have an area, so
//! that a corner in the middle of a straight side ends up in real triangles: dropping it would
//! leave a crack towards the neighbour that uses it.

use glam::{DVec2, DVec3};

/// Above this many corners a concave polygon becomes a fan: in the worst case ear clipping takes cubic time.
const MOST_EARS: usize = 1000;

/// What ear clipping may still take, in corners held against an ear. It goes with the square of a
/// polygon's corners, in bad cases with the cube, so that a file of a megabyte could take minutes.
#[derive(Debug)]
pub(crate) struct Effort(u64);

impl Effort {
    /// What each corner adds: polygons of 300 corners need as much.
    const PER_CORNER: u64 = 1000;
}

impl Default for Effort {
    /// Enough for some dozen polygons of a thousand corners, less than half a second.
    fn default() -> Self {
        Effort(1 << 27)
    }
}

/// How [`triangulate`] went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Triangles that keep the polygon's winding and do not overlap.
    Exact,
    /// The outline crosses itself, has no area or is too long: the triangles may overlap.
    Rough,
}

/// Appends the triangles of a polygon: two fewer than it has corners, of which those at the place of the one before
/// do not count, such as a quad has at a pole of a sphere. `effort` is what all polygons of a file share.
pub(crate) fn triangulate(
    corners: &[u32],
    position: impl Fn(u32) -> DVec3 + Copy,
    effort: &mut Effort,
    out: &mut Vec<[u32; 3]>,
) -> Outcome {
    if let [a, b, c] = *corners {
        out.push([a, b, c]);
        return Outcome::Exact;
    }
    let n = corners.len();
    let is_repeated = |i: usize| position(corners[i]) == position(corners[(i + n - 1) % n]);
    if (0..n).any(is_repeated) {
        let apart: Vec<u32> = (0..n).filter(|&i| !is_repeated(i)).map(|i| corners[i]).collect();
        if apart.len() >= 3 {
            return triangulate(&apart, position, effort, out);
        }
    }
    let flat = flatten(corners, position);
    let convex = (0..n).all(|i| turn(flat[(i + n - 1) % n], flat[i], flat[(i + 1) % n]) > 0.0);
    if convex || n > MOST_EARS {
        out.extend((1..n.max(2) - 1).map(|i| [corners[0], corners[i], corners[i + 1]]));
        return if convex { Outcome::Exact } else { Outcome::Rough };
    }
    effort.0 += n as u64 * Effort::PER_CORNER;
    clip_ears(corners, &flat, effort, out)
}

/// The outline seen against its normal (Newell's), so that it runs counter-clockwise.
fn flatten(corners: &[u32], position: impl Fn(u32) -> DVec3) -> Vec<DVec2> {
    let points: Vec<DVec3> = corners.iter().map(|&c| position(c)).collect();
    let base = points[0];
    let normal: DVec3 =
        (0..points.len()).map(|i| (points[i] - base).cross(points[(i + 1) % points.len()] - base)).sum();
    // Dropping the coordinate along which the normal is longest keeps the others as they are.
    let abs = normal.abs();
    let (x, y, sign) = if abs.x >= abs.y && abs.x >= abs.z {
        (1, 2, normal.x)
    } else if abs.y >= abs.z {
        (2, 0, normal.y)
    } else {
        (0, 1, normal.z)
    };
    points
        .iter()
        .map(|p| {
            let p = *p - base;
            if sign < 0.0 { DVec2::new(p[y], p[x]) } else { DVec2::new(p[x], p[y]) }
        })
        .collect()
}

/// Twice the signed area of a triangle; positive for a turn to the left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

fn clip_ears(corners: &[u32], flat: &[DVec2], effort: &mut Effort, out: &mut Vec<[u32; 3]>) -> Outcome {
    let mut rest: Vec<usize> = (0..corners.len()).collect();
    let mut at = 0;
    while rest.len() > 3 {
        let n = rest.len();
        let around = |i: usize| [rest[(i + n - 1) % n], rest[i % n], rest[(i + 1) % n]];
        // Going on from the last ear spreads the triangles instead of fanning around one corner.
        let Some(ear) = (at..at + n).find(|&i| effort.0 > 0 && is_ear(&rest, flat, around(i), effort)) else {
            // The outline crosses itself, so that no rule makes sense of the rest, or it takes too long.
            out.extend((1..n - 1).map(|i| [rest[0], rest[i], rest[i + 1]].map(|i| corners[i])));
            return Outcome::Rough;
        };
        out.push(around(ear).map(|i| corners[i]));
        rest.remove(ear % n);
        at = ear % n % (n - 1);
    }
    let last = [rest[0], rest[1], rest[2]];
    out.push(last.map(|i| corners[i]));
    if turn(flat[last[0]], flat[last[1]], flat[last[2]]) > 0.0 { Outcome::Exact } else { Outcome::Rough }
}

/// True when the corner's triangle has an area and no other corner lies in it or on its rim.
fn is_ear(rest: &[usize], flat: &[DVec2], ear: [usize; 3], effort: &mut Effort) -> bool {
    let [a, b, c] = ear.map(|i| flat[i]);
    let blocks = |&i: &usize| {
        let p = flat[i];
        // The same point twice is a bridge to a hole, not an obstacle; the ear's own corners are none.
        let outside = p == a || p == b || p == c || turn(a, b, p) < 0.0 || turn(b, c, p) < 0.0 || turn(c, a, p) < 0.0;
        !outside
    };
    if turn(a, b, c).is_nan() || turn(a, b, c) <= 0.0 {
        return false;
    }
    let obstacle = rest.iter().position(blocks);
    effort.0 = effort.0.saturating_sub(obstacle.unwrap_or(rest.len()) as u64 + 1);
    obstacle.is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(outline: &[[f64; 2]]) -> (Vec<[u32; 3]>, Outcome) {
        let corners: Vec<u32> = (0..outline.len() as u32).collect();
        let mut out = Vec::new();
        // Tilted, so that no coordinate can simply be dropped.
        let lift = |i: u32| {
            let [x, y] = outline[i as usize];
            DVec3::new(x, y, 0.3 * x - 0.2 * y)
        };
        let outcome = triangulate(&corners, lift, &mut Effort::default(), &mut out);
        (out, outcome)
    }

    fn areas(outline: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<f64> {
        let point = |i: u32| DVec2::from_array(outline[i as usize]);
        triangles.iter().map(|t| 0.5 * turn(point(t[0]), point(t[1]), point(t[2]))).collect()
    }

    #[test]
    fn a_concave_pentagon_keeps_its_area_and_winding() {
        let arrow = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5], [0.0, 2.0]];
        let (triangles, outcome) = run(&arrow);
        let areas = areas(&arrow, &triangles);
        assert_eq!((triangles.len(), outcome), (3, Outcome::Exact));
        assert!(areas.iter().all(|&a| a > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - 2.5).abs() < 1e-12);
    }

    #[test]
    fn a_corner_on_a_straight_side_is_kept_in_real_triangles() {
        let outline = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        for shift in 0..5 {
            let mut turned = outline;
            turned.rotate_left(shift);
            let (triangles, outcome) = run(&turned);
            assert_eq!((triangles.len(), outcome), (3, Outcome::Exact));
            assert!(areas(&turned, &triangles).iter().all(|&a| a > 0.0));
        }
    }

    #[test]
    fn a_hole_reached_over_a_bridge_stays_open() {
        let ring = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        let (triangles, _) = run(&ring);
        let area: f64 = areas(&ring, &triangles).iter().sum();
        assert_eq!(triangles.len(), 8);
        assert!((area - 12.0).abs() < 1e-12, "{area}");
    }

    #[test]
    fn what_takes_too_long_becomes_a_fan() {
        let n = 200;
        let around = |i: usize| (i as f64 / n as f64 * std::f64::consts::TAU).sin_cos();
        let outline: Vec<[f64; 2]> =
            (0..n).map(|i| (around(i), if i % 2 == 0 { 1.0 } else { 0.1 })).map(|((y, x), r)| [x * r, y * r]).collect();
        assert_eq!(run(&outline).1, Outcome::Exact);
        let corners: Vec<u32> = (0..n as u32).collect();
        let flat: Vec<DVec2> = outline.iter().map(|&p| DVec2::from_array(p)).collect();
        let (mut out, mut effort) = (Vec::new(), Effort(5000));
        assert_eq!(clip_ears(&corners, &flat, &mut effort, &mut out), Outcome::Rough);
        assert_eq!((out.len(), effort.0), (n - 2, 0));
    }

    #[test]
    fn corners_at_one_place_count_once() {
        let (triangles, outcome) = run(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [0.0, 0.0]]);
        assert_eq!((triangles.len(), outcome), (1, Outcome::Exact));
        // A pole with a vertex for each quad.
        let (triangles, outcome) = run(&[[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]);
        assert_eq!((triangles.len(), outcome), (1, Outcome::Exact));
        // Of a polygon without area nothing is lost in silence.
        let (triangles, outcome) = run(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
        assert_eq!((triangles.len(), outcome), (2, Outcome::Rough));
    }

    #[test]
    fn a_bow_tie_is_called_rough_and_ends() {
        let (triangles, outcome) = run(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
        assert_eq!((triangles.len(), outcome), (2, Outcome::Rough));
    }
}
