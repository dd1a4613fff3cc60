//! The paper's geodesic disk: legs walked from a face's centre in evenly spaced normal planes.

use crate::mesh::{Face, Mesh};
use crate::place::Place;
use crate::section::{Crossing, Features, Plane, Stop};
use crate::unfolding::angle_aside;
use glam::{DVec2, DVec3};

/// A face's own frame: its centre, its oriented unit normal and two tangent axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point that legs start from, relative to the mesh's origin.
    pub centre: DVec3,
    /// Unit normal, by the winding of the component's majority.
    pub normal: DVec3,
    /// Unit tangent, the direction of angle zero: along the face's longest edge.
    pub x: DVec3,
    /// normal x x, the direction of angle pi / 2.
    pub y: DVec3,
}

impl Frame {
    /// The frame at a face's barycentre; `None` for a face without area.
    pub fn at_barycentre(mesh: &Mesh, face: Face) -> Option<Self> {
        Frame::around(mesh, face, mesh.barycentre(face))
    }

    /// The frame at a place on the mesh; `None` for a face without area.
    ///
    /// On an edge or a corner the section through the centre has no first face of its own, so the
    /// centre keeps a millionth of the face's size away from them.
    pub fn at(mesh: &Mesh, place: Place) -> Option<Self> {
        const INSIDE: f64 = 1e-6;
        let kept = place.weights.map(|w| w.max(INSIDE));
        let sum: f64 = kept.iter().sum();
        Frame::around(mesh, place.face, mesh.point(Place { face: place.face, weights: kept.map(|w| w / sum) }))
    }

    fn around(mesh: &Mesh, face: Face, centre: DVec3) -> Option<Self> {
        let [a, b, c] = mesh.triangle(face);
        let up = (b - a).cross(c - a).try_normalize()?;
        let normal = if mesh.is_flipped(face) { -up } else { up };
        let mut longest = b - a;
        for edge in [c - b, a - c] {
            if edge.length_squared() > longest.length_squared() {
                longest = edge;
            }
        }
        let x = (longest - longest.dot(normal) * normal).try_normalize()?;
        Some(Frame { centre, normal, x, y: normal.cross(x) })
    }

    /// A point given in the plane coordinates of a direction.
    pub fn lift(&self, direction: DVec3, p: DVec2) -> DVec3 {
        self.centre + p.x * direction + p.y * self.normal
    }

    /// The unit tangent at an angle (radians) from `x` towards `y`.
    #[inline]
    pub fn direction(&self, angle: f64) -> DVec3 {
        let (sin, cos) = angle.sin_cos();
        cos * self.x + sin * self.y
    }
}

/// One leg: the section of the mesh from the centre one way.
///
/// Plane coordinates are (u, z): u along the leg's direction, z along the face's normal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Leg {
    /// The leg's end, in plane coordinates.
    pub end: DVec2,
    /// Unit tangent of the last segment, in plane coordinates.
    pub tangent: DVec2,
    /// Sums of t s^n, n = 0 to 4, over the edges crossed, where t is the angle by which the section
    /// turns at an edge, positive towards the normal, and s the edge's distance from the centre.
    pub turns: [f64; 5],
    /// Length along the mesh; the disk's radius where nothing stopped the leg.
    pub length: f64,
    /// `length - end.x`, summed without cancellation.
    pub excess: f64,
    /// Length of the first segment up to the first edge, also where the leg ends before it.
    pub first: f64,
    /// Sums of p m and p m^2 over the segments after the first, where p is the part of a segment
    /// that belongs to the leg and m the distance of the whole segment's middle from the centre.
    pub moments: [f64; 2],
    /// Angle (radians, positive to the left) from the leg's direction to its end within the surface, that
    /// is with the faces it passes unfolded. Measured by [`Disk::walk`] where the next leg on one side is
    /// whole and that on the other is not; 0 elsewhere, since around a whole disk it cancels.
    pub aside: f64,
    /// The face it ended in.
    pub face: Face,
    /// Why it ended.
    pub stop: Stop,
}

/// Two opposite legs: a section through the centre.
#[derive(Clone, Copy, Debug)]
pub struct Diameter<'d> {
    /// Angle of the forward leg from the frame's `x`, in [0, pi).
    pub angle: f64,
    /// The leg at `angle`.
    pub forward: &'d Leg,
    /// The leg at `angle + pi`; its u points the other way.
    pub backward: &'d Leg,
}

/// The legs of a face. Reusable: walking another face into it allocates nothing.
#[derive(Clone, Debug)]
pub struct Disk {
    radius: f64,
    /// Forward legs of all diameters, then the backward legs in the same order: by angle, full turn.
    legs: Vec<Leg>,
}

impl Disk {
    /// An empty disk, to be filled by [`Disk::walk`].
    pub fn new() -> Self {
        Disk { radius: 0.0, legs: Vec::new() }
    }

    /// Walks `2 * diameters` legs of at most `radius` from the frame's centre, which must lie in
    /// `face`.
    pub fn walk(&mut self, mesh: &Mesh, face: Face, frame: &Frame, radius: f64, diameters: usize) {
        self.radius = radius;
        self.legs.clear();
        let step = std::f64::consts::PI / diameters as f64;
        for turn in [1.0, -1.0] {
            self.legs.extend(
                (0..diameters)
                    .map(|i| Leg::walk(mesh, face, frame, turn * frame.direction(i as f64 * step), radius, |_| {})),
            );
        }
        self.measure_aside(mesh, face, frame);
    }

    /// Fills in [`Leg::aside`].
    fn measure_aside(&mut self, mesh: &Mesh, face: Face, frame: &Frame) {
        let count = self.legs.len();
        let is_whole = |legs: &[Leg], i: usize| legs[i % count].stop == Stop::Length;
        for i in 0..count {
            let legs = &self.legs;
            let beside = is_whole(legs, i + 1) != is_whole(legs, i + count - 1);
            if beside && is_whole(legs, i) {
                let direction = frame.direction(2.0 * std::f64::consts::PI * i as f64 / count as f64);
                let plane = Plane { point: frame.centre, normal: frame.normal.cross(direction) };
                self.legs[i].aside = angle_aside(mesh, &plane, face, direction, self.radius);
            }
        }
    }

    /// The length a leg has where nothing stops it.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// All legs, by angle over the full turn.
    pub fn legs(&self) -> &[Leg] {
        &self.legs
    }

    /// All diameters, by angle over half a turn.
    pub fn diameters(&self) -> impl ExactSizeIterator<Item = Diameter<'_>> {
        let (forward, backward) = self.legs.split_at(self.legs.len() / 2);
        let step = std::f64::consts::PI / forward.len() as f64;
        forward.iter().zip(backward).enumerate().map(move |(i, (forward, backward))| Diameter {
            angle: i as f64 * step,
            forward,
            backward,
        })
    }

    /// The way of every leg over the mesh from the centre, in the order of [`legs`](Disk::legs), for the face and the
    /// frame that the disk was walked with.
    pub fn paths(&self, mesh: &Mesh, face: Face, frame: &Frame) -> impl ExactSizeIterator<Item = Vec<DVec3>> {
        (0..self.legs.len()).map(move |i| {
            let direction = self.direction(frame, i);
            let mut path = vec![frame.centre];
            Leg::walk(mesh, face, frame, direction, self.radius, |p| path.push(frame.lift(direction, p)));
            path
        })
    }

    /// The unit tangent along which a leg starts.
    pub fn direction(&self, frame: &Frame, leg: usize) -> DVec3 {
        frame.direction(std::f64::consts::TAU * leg as f64 / self.legs.len() as f64)
    }

    /// Share of the legs that reached the radius, 0 to 1.
    pub fn coverage(&self) -> f64 {
        let full = self.legs.iter().filter(|leg| leg.stop == Stop::Length).count();
        full as f64 / self.legs.len() as f64
    }
}

impl Default for Disk {
    fn default() -> Self {
        Disk::new()
    }
}

impl Leg {
    #[inline]
    fn add_turn(&mut self, turn: f64) {
        let mut moment = turn;
        for sum in &mut self.turns {
            *sum += moment;
            moment *= self.length;
        }
    }

    /// Walks from the frame's centre, which must lie in `face`, along the unit tangent `direction`
    /// for at most `radius`. `visit` is given every point after the centre, in plane coordinates.
    pub fn walk(
        mesh: &Mesh,
        face: Face,
        frame: &Frame,
        direction: DVec3,
        radius: f64,
        mut visit: impl FnMut(DVec2),
    ) -> Leg {
        let plane = Plane { point: frame.centre, normal: frame.normal.cross(direction) };
        let in_plane = |p: DVec3| {
            let d = p - frame.centre;
            DVec2::new(d.dot(direction), d.dot(frame.normal))
        };
        let mut leg = Leg {
            end: DVec2::ZERO,
            aside: 0.0,
            tangent: DVec2::X,
            turns: [0.0; 5],
            length: 0.0,
            excess: 0.0,
            first: 0.0,
            moments: [0.0; 2],
            face,
            stop: Stop::Missed,
        };
        let Some(mut crossing) = Crossing::leaving(mesh, &plane, face) else { return leg };
        let mut is_first = true;
        loop {
            let point = in_plane(crossing.point);
            let step = point - leg.end;
            let whole = step.length();
            let room = radius - leg.length;
            let used = if whole < room { whole } else { room };
            // Beside a vertex a section may have segments as short as the rounding of their ends, which
            // point anywhere.
            if whole > 1e-10 * radius {
                let tangent = step / whole;
                if tangent.x <= 0.0 {
                    leg.stop = Stop::Turned;
                    return leg;
                }
                leg.add_turn(angle_between(leg.tangent, tangent));
                leg.tangent = tangent;
            }
            if is_first {
                leg.first = whole;
                is_first = false;
            } else {
                let middle = leg.length + 0.5 * whole;
                leg.moments[0] += used * middle;
                leg.moments[1] += used * middle * middle;
            }
            leg.excess += used * versine(leg.tangent);
            leg.face = crossing.half_edge.face();
            if whole >= room {
                leg.end += room * leg.tangent;
                leg.length = radius;
                leg.stop = Stop::Length;
                visit(leg.end);
                return leg;
            }
            leg.end = point;
            leg.length += whole;
            visit(point);
            match crossing.advance(mesh, &plane, Features::Stop) {
                Ok(next) if next.half_edge.face() == face => {
                    leg.stop = Stop::Closed;
                    return leg;
                }
                Ok(next) => crossing = next,
                Err(stop) => {
                    leg.stop = stop;
                    return leg;
                }
            }
        }
    }
}

/// The angle from one unit vector to another, in (-pi, pi].
#[inline]
fn angle_between(a: DVec2, b: DVec2) -> f64 {
    let (sin, cos) = (a.perp_dot(b), a.dot(b));
    let x = sin * sin;
    if x < 0.01 && cos > 0.0 {
        // The arcsine's series, good to 1e-11 of itself here, where nearly all turns lie.
        let tail = 1.0 + x * (25.0 / 42.0) * (1.0 + x * (49.0 / 72.0));
        sin * (1.0 + x / 6.0 * (1.0 + x * (9.0 / 20.0) * tail))
    } else {
        sin.atan2(cos)
    }
}

/// 1 - cos of the angle between a unit vector and the u axis, below a right angle, without
/// cancellation near zero.
fn versine(tangent: DVec2) -> f64 {
    tangent.y * tangent.y / (1.0 + tangent.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_arc_tangent() {
        for i in -1000..=1000 {
            let angle = 3.0 * f64::from(i) / 1000.0;
            for from in [0.0, 1.0, -2.0] {
                let found = angle_between(DVec2::from_angle(from), DVec2::from_angle(from + angle));
                assert!((found - angle).abs() < 1e-10 * angle.abs() + 1e-15, "{angle}: {found}");
            }
        }
    }
}
