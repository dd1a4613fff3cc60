//! Stepping along a principal direction by the radius (the paper's figures 13 and 14).

use crate::curvature::{CurvatureOptions, FaceCurvature, curvature_at};
use crate::disk::{Disk, Frame, Leg};
use crate::error::Error;
use crate::lines::Polyline;
use crate::mesh::{Face, Mesh};
use crate::place::{Place, nearest_in_triangle};
use crate::progress::{Progress, Stage};
use crate::section::Stop;
use glam::DVec3;
use rayon::prelude::*;

/// The principal direction that a trace follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Along {
    /// That of k_max.
    #[default]
    Max,
    /// That of k_min.
    Min,
}

/// Settings for [`trace`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// The direction followed. Default: that of k_max.
    pub along: Along,
    /// Most steps taken, each as long as the disk's radius, 1 to 1000000. Default 100.
    pub steps: usize,
    /// Also go the other way from the seed, as many steps. Default: no.
    pub both_ways: bool,
}

impl Default for TraceOptions {
    fn default() -> Self {
        TraceOptions { along: Along::Max, steps: 100, both_ways: false }
    }
}

/// Why a trace ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum TraceEnd {
    /// All steps were taken.
    Steps,
    /// A boundary edge was met.
    Boundary,
    /// A feature edge was met.
    Feature,
    /// An edge with three or more faces was met.
    NonManifold,
    /// Both curvatures are alike, so that no direction is principal: an umbilic or flat place. Or there is no estimate.
    Umbilic,
    /// The section of a step closed.
    Stuck,
}

impl TraceEnd {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            TraceEnd::Steps => "steps",
            TraceEnd::Boundary => "boundary",
            TraceEnd::Feature => "feature",
            TraceEnd::NonManifold => "non_manifold",
            TraceEnd::Umbilic => "umbilic",
            TraceEnd::Stuck => "stuck",
        }
    }
}

/// A centre on a trace.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct TracePoint {
    /// Where it is.
    pub place: Place,
    /// The point, relative to the mesh's origin.
    pub point: DVec3,
    /// Curvature of the disk around it.
    pub curvature: FaceCurvature,
    /// The direction of the step from here (into it, for the last point of a trace).
    pub direction: DVec3,
}

/// A path of centres along a principal direction.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Trace {
    /// The centres in their order; for a trace both ways, from its backward end to its forward end.
    pub points: Vec<TracePoint>,
    /// The path over the surface through all centres.
    pub path: Polyline,
    /// Why it ended, forward.
    pub end: TraceEnd,
    /// Why it ended backward, for a trace both ways.
    pub backward_end: Option<TraceEnd>,
}

/// Traces from many seeds, in their order.
///
/// # Errors
/// [`Error::Usage`] for options out of range, or a seed on a face that is not there or has no area.
pub fn trace(
    mesh: &Mesh,
    seeds: &[Place],
    curvature: &CurvatureOptions,
    options: &TraceOptions,
    progress: &dyn Progress,
) -> Result<Vec<Trace>, Error> {
    curvature.check_for(mesh)?;
    if !(1..=1_000_000).contains(&options.steps) {
        return Err(Error::Usage(format!("the number of steps must be 1 to 1000000, not {}", options.steps)));
    }
    seeds.iter().try_for_each(|seed| seed.check(mesh))?;
    progress.begin(Stage::Trace, seeds.len() as u64);
    let walker = Walker { mesh, curvature, options, fixed_radius: curvature.fixed_radius(mesh), progress };
    let trace = |disk: &mut Disk, &seed: &Place| {
        let trace = walker.trace(seed, disk);
        progress.advance(1);
        trace
    };
    let traces = seeds.par_iter().map_init(Disk::new, trace).collect();
    progress.end();
    Ok(traces)
}

struct Walker<'m> {
    mesh: &'m Mesh,
    curvature: &'m CurvatureOptions,
    options: &'m TraceOptions,
    fixed_radius: Option<f64>,
    progress: &'m dyn Progress,
}

/// One way of a trace.
struct Way {
    points: Vec<TracePoint>,
    path: Vec<DVec3>,
    end: TraceEnd,
}

impl Walker<'_> {
    fn trace(&self, seed: Place, disk: &mut Disk) -> Trace {
        let forward = self.go(seed, None, disk);
        let mut trace =
            Trace { points: forward.points, path: Polyline::open(forward.path), end: forward.end, backward_end: None };
        let first = trace.points.first().map(|p| p.direction);
        if let Some(direction) = first.filter(|_| self.options.both_ways) {
            let backward = self.go(seed, Some(-direction), disk);
            // The seed stands in both ways; it is kept from the forward one.
            let points = backward.points.into_iter().skip(1).rev().map(|p| TracePoint { direction: -p.direction, ..p });
            trace.points.splice(0..0, points);
            let path = backward.path.into_iter().rev().chain(std::mem::take(&mut trace.path.points));
            trace.path = Polyline::open(path);
            trace.backward_end = Some(backward.end);
        }
        trace
    }

    /// Steps from a seed. `heading` chooses between a direction and its opposite.
    fn go(&self, seed: Place, mut heading: Option<DVec3>, disk: &mut Disk) -> Way {
        let mut way = Way { points: Vec::new(), path: Vec::new(), end: TraceEnd::Steps };
        let mut place = seed;
        for step in 0..=self.options.steps {
            // A trace may be long; this is where it may be cancelled.
            self.progress.advance(0);
            let Some(frame) = Frame::at(self.mesh, place) else {
                way.end = TraceEnd::Stuck;
                return way;
            };
            let value = curvature_at(self.mesh, place.face, &frame, self.curvature, self.fixed_radius, disk);
            let principal = match self.options.along {
                Along::Max => value.dir_max.as_dvec3(),
                Along::Min => value.dir_min.as_dvec3(),
            };
            // A direction has no sign: keep going the way we came.
            let direction = match heading {
                Some(heading) if principal.dot(heading) < 0.0 => -principal,
                _ => principal,
            };
            way.points.push(TracePoint { place, point: frame.centre, curvature: value, direction });
            if way.path.is_empty() {
                way.path.push(frame.centre);
            }
            if step == self.options.steps {
                return way;
            }
            if !has_principal_direction(&value) {
                way.end = TraceEnd::Umbilic;
                return way;
            }
            // Exactly in the face's plane, which a 32-bit direction is only nearly.
            let Some(direction) = (direction - direction.dot(frame.normal) * frame.normal).try_normalize() else {
                way.end = TraceEnd::Stuck;
                return way;
            };
            let path = &mut way.path;
            let leg = Leg::walk(self.mesh, place.face, &frame, direction, disk.radius(), |p| {
                path.push(frame.lift(direction, p));
            });
            match leg.stop {
                // A radius over which the surface turns by a right angle makes for a shorter step.
                Stop::Length | Stop::Turned => {}
                Stop::Boundary => way.end = TraceEnd::Boundary,
                Stop::Feature => way.end = TraceEnd::Feature,
                Stop::NonManifold => way.end = TraceEnd::NonManifold,
                Stop::Closed | Stop::Missed => way.end = TraceEnd::Stuck,
            }
            if way.end != TraceEnd::Steps || leg.length == 0.0 {
                return way;
            }
            place = place_of(self.mesh, leg.face, frame.lift(direction, leg.end));
            heading = Some(leg.tangent.x * direction + leg.tangent.y * frame.normal);
        }
        way
    }
}

/// True where the surface bends, and more one way than the other. Relative to the bending and not to the
/// disk, as classes are: on a fine mesh all disks are nearly flat.
fn has_principal_direction(value: &FaceCurvature) -> bool {
    let (max, min) = (f64::from(value.k_max), f64::from(value.k_min));
    let bending = max.abs().max(min.abs());
    bending * f64::from(value.radius) > 1e-4 && max - min > 0.05 * bending
}

fn place_of(mesh: &Mesh, face: Face, point: DVec3) -> Place {
    Place { face, weights: nearest_in_triangle(mesh.triangle(face), point) }
}

/// At most `count` faces spread evenly over the area of a mesh, as seeds: the same ones for the same mesh. A face that
/// is larger than several shares of the area is one seed.
pub fn spread_seeds(mesh: &Mesh, count: usize) -> Vec<Place> {
    let areas: Vec<f64> = (0..mesh.face_count() as u32)
        .map(|f| mesh.area(Face(f)))
        .map(|a| if a.is_finite() { a } else { 0.0 })
        .collect();
    let total: f64 = areas.iter().sum();
    let mut seeds = Vec::with_capacity(count.min(areas.len()));
    let (mut until, mut shares) = (0.0, 0);
    for (f, area) in areas.iter().enumerate() {
        until += area;
        let is_passed = |share: usize| share < count && until > (share as f64 + 0.5) * total / count as f64;
        if is_passed(shares) {
            seeds.push(Place::barycentre(Face(f as u32)));
        }
        while is_passed(shares) {
            shares += 1;
        }
    }
    seeds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::progress::NoProgress;
    use crate::synth::{Grid, Surface};

    fn torus() -> Mesh {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 120, 48).build().soup;
        Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh")
    }

    /// A large face does not make all faces behind it seeds.
    #[test]
    fn seeds_are_spread_by_area() {
        let mut points = vec![[0.0; 3], [0.0, 10.0, 0.0], [-10.0, 0.0, 0.0]];
        let mut triangles = vec![[0, 1, 2]];
        for i in 0..200_u32 {
            points.push([f64::from(i / 2) * 0.1, -1.0 - 0.1 * f64::from(i % 2), 0.0]);
            if i >= 2 {
                triangles.push([i + 1, i + 2, i + 3]);
            }
        }
        let soup = crate::Soup::new(crate::Positions::F64(points), triangles);
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        let faces: Vec<u32> = spread_seeds(&mesh, 10).iter().map(|seed| seed.face.0).collect();
        assert_eq!(faces, [0]);
        let faces: Vec<u32> = spread_seeds(&mesh, 1000).iter().map(|seed| seed.face.0).collect();
        let gaps: Vec<u32> = faces.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(faces.len() > 10 && gaps[1..].iter().all(|&gap| gap.abs_diff(gaps[1]) <= 1), "{faces:?}");
    }

    /// The meridian circle through the first point: its plane holds the axis. Degrees off it.
    fn off_meridian(trace: &Trace) -> f64 {
        let angle = |p: &TracePoint| p.point.y.atan2(p.point.x);
        let first = angle(&trace.points[0]);
        trace.points.iter().map(|p| (angle(p) - first).sin().abs().asin().to_degrees()).fold(0.0, f64::max)
    }

    #[test]
    fn the_path_of_k_max_on_a_torus_is_its_meridian() {
        let mesh = torus();
        for face in [0, 1234, 5000, 9999] {
            for weights in [[1.0 / 3.0; 3], [0.98, 0.01, 0.01], [0.1, 0.2, 0.7], [0.0, 0.5, 0.5]] {
                let seed = Place { face: Face(face), weights };
                let options = TraceOptions { steps: 24, ..TraceOptions::default() };
                let traces = trace(&mesh, &[seed], &CurvatureOptions::default(), &options, &NoProgress).expect("valid");
                let length = traces[0].path.length();
                assert_eq!((traces[0].points.len(), traces[0].end), (25, TraceEnd::Steps));
                assert!(length > 2.0 * std::f64::consts::PI, "a full turn: {length}");
                let off = off_meridian(&traces[0]);
                assert!(off < 1.0, "face {face} {weights:?}: {off} degrees");
            }
        }
    }

    #[test]
    fn traces_end_for_a_stated_reason() {
        let build = |surface| {
            Mesh::from_soup(&Grid::new(surface, 40, 20).build().soup, &MeshOptions::default()).expect("a mesh")
        };
        let run = |mesh: &Mesh, along| {
            let options = TraceOptions { along, both_ways: true, ..TraceOptions::default() };
            let seed = Place::barycentre(Face(mesh.face_count() as u32 / 2));
            trace(mesh, &[seed], &CurvatureOptions::default(), &options, &NoProgress).expect("valid").remove(0)
        };
        let sphere = run(&build(Surface::Sphere { radius: 1.0 }), Along::Max);
        assert_eq!((sphere.end, sphere.points.len()), (TraceEnd::Umbilic, 1));
        let cylinder = run(&build(Surface::Cylinder { radius: 1.0, height: 4.0 }), Along::Min);
        assert_eq!((cylinder.end, cylinder.backward_end), (TraceEnd::Boundary, Some(TraceEnd::Boundary)));
        assert!((cylinder.path.length() - 4.0).abs() < 0.05, "{}", cylinder.path.length());
    }

    #[test]
    fn seeds_are_spread_over_the_area() {
        let mesh = torus();
        assert_eq!(spread_seeds(&mesh, 10).len(), 10);
        assert_eq!(spread_seeds(&mesh, 1_000_000).len(), mesh.face_count());
    }
}
