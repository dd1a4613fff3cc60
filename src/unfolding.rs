//! The strip of faces along a leg, unfolded into the plane of its first face.
//!
//! Unfolding keeps all lengths within the strip, so where a leg's end comes to lie says in which direction
//! it is within the surface. A section in a plane is no geodesic: on a cylinder one in a slanting plane
//! ends up to 0.05 (k r)^2 radians beside the geodesic that sets out with it.
//!
//! The two ends of the crossed edge are carried along and no angle is taken, so that segments as short as
//! rounding, which point anywhere, do no harm.

use crate::mesh::{Face, Mesh};
use crate::section::{Crossing, Features, Plane};
use glam::{DVec2, DVec3};

/// The angle (radians) from a leg's direction to its unfolded end, positive to the left, for a leg of
/// `radius` in the plane through `plane.point` in `face`; 0 where it does not get that far.
pub(crate) fn angle_aside(mesh: &Mesh, plane: &Plane, face: Face, direction: DVec3, radius: f64) -> f64 {
    let Some(mut crossing) = Crossing::leaving(mesh, plane, face) else { return 0.0 };
    let mut strip = Strip::start(&crossing, plane, direction);
    let (mut end, mut length) = (DVec2::ZERO, 0.0);
    loop {
        let point = strip.point(&crossing);
        let whole = end.distance(point);
        if length + whole >= radius {
            let share = if whole > 0.0 { (radius - length) / whole } else { 0.0 };
            end = end.lerp(point, share);
            return end.y.atan2(end.x);
        }
        (end, length) = (point, length + whole);
        match crossing.advance(mesh, plane, Features::Stop) {
            Ok(next) if next.half_edge.face() != face => {
                strip.advance(&crossing, &next);
                crossing = next;
            }
            _ => return 0.0,
        }
    }
}

/// The crossed edge in the plane of the first face.
#[derive(Clone, Copy, Debug)]
struct Strip {
    below: DVec2,
    above: DVec2,
}

impl Strip {
    /// At the edge by which the walk leaves its first face, in coordinates along its direction and the
    /// plane's normal.
    fn start(crossing: &Crossing, plane: &Plane, direction: DVec3) -> Self {
        let flat = |p: DVec3| DVec2::new((p - plane.point).dot(direction), plane.distance(p));
        let [below, above] = crossing.ends();
        Strip { below: flat(below), above: flat(above) }
    }

    /// Goes through the face between two crossings that follow one another.
    fn advance(&mut self, from: &Crossing, to: &Crossing) {
        let [below, above] = from.ends();
        let edge = above - below;
        let to_apex = to.newer() - below;
        // Not zero: the ends lie on different sides of the plane.
        let squared = edge.length_squared();
        let along = to_apex.dot(edge) / squared;
        let away = to_apex.cross(edge).length() / squared;
        let flat = self.above - self.below;
        // The walk has the upper side on its left: forward is to the right of the edge.
        let place = self.below + along * flat + away * DVec2::new(flat.y, -flat.x);
        if to.newer_is_above() { self.above = place } else { self.below = place }
    }

    fn point(&self, crossing: &Crossing) -> DVec2 {
        self.below.lerp(self.above, crossing.share())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::{Frame, Leg};
    use crate::mesh::MeshOptions;
    use crate::section::Stop;
    use crate::synth::{Grid, Surface};
    use std::f64::consts::PI;

    /// A cylinder of facets unrolls: the unfolded end must lie where the end is on the unrolled sheet.
    #[test]
    fn a_cylinder_unfolds_into_its_sheet() {
        let cells = 40.0;
        let soup = Grid::new(Surface::Cylinder { radius: 1.0, height: 6.0 }, 40, 5).build().soup;
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        // Along the facets, counted in facets from the x axis, and up.
        let width = 2.0 * (PI / cells).sin();
        let sheet = |p: DVec3| {
            let turn = p.y.atan2(p.x) * cells / (2.0 * PI);
            let within = (turn - turn.floor() - 0.5) * 2.0 * PI / cells;
            DVec2::new((turn.floor() + 0.5) * width + (PI / cells).cos() * within.tan(), p.z)
        };
        for face in [170, 180, 181].map(Face) {
            let frame = Frame::at_barycentre(&mesh, face).expect("a frame");
            let around = DVec3::Z.cross(frame.normal);
            for i in 0..24 {
                let direction = frame.direction(f64::from(i) * PI / 12.0);
                let leg = Leg::walk(&mesh, face, &frame, direction, 1.2, |_| {});
                assert_eq!(leg.stop, Stop::Length);
                let plane = Plane { point: frame.centre, normal: frame.normal.cross(direction) };
                let aside = angle_aside(&mesh, &plane, face, direction, 1.2);
                let start = DVec2::new(direction.dot(around), direction.z);
                let end = sheet(frame.lift(direction, leg.end)) - sheet(frame.centre);
                // Seen from outside, up is to the left of around.
                assert!((start.angle_to(end) - aside).abs() < 1e-12, "{face:?} {i}: {aside}");
            }
        }
    }
}
