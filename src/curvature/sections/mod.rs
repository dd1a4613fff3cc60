//! The paper's estimators for all faces of a mesh: legs side by side, in 32 bits.
//!
//! 1. [`steps`]: one 64-byte line per face, in the order of a curve through space.
//! 2. [`walk`]: all legs of a face, eight side by side.
//! 3. [`reading`]: formulas (1) and (3), four diameters side by side; the fit of Euler's formula, four
//!    faces side by side.
//!
//! [`Disk`] has the same rules in 64 bits for one leg at a time. It is what this is tested against, and
//! what faces get whose disk is not one for 32 bits. A face goes there
//! - where a leg crosses an edge 16 radii wide or more: facets that long beside their disk leave too few digits;
//! - where the mesh is 1e18 radii large, as by one stray vertex: steps vanish beside that;
//! - where the radius is 4,096 times the face's size: rounding is then some thousandth of the face;
//! - where a leg finds no edge to leave the face by, crosses 65,536 edges, or comes to where a surface of one
//!   side changes its winding.

mod reading;
mod steps;
mod walk;

use super::euler::{EulerFit, PlanarPrincipal};
use super::perimeter::End;
use super::radius::RadiusSearch;
use super::{CHUNK, CurvatureOptions, FaceCurvature};
use crate::curvature::vectors::eight;
use crate::curvature::vectors::four::{F4, LANES};
use crate::disk::{Disk, Frame};
use crate::mesh::{Face, Mesh, inverse};
use crate::progress::Progress;
use crate::section::Plane;
use crate::unfolding::angle_aside;
use rayon::prelude::*;
use reading::{DiskReading, Reader};
use std::f64::consts::PI;
use steps::Steps;
use walk::{Directions, Legs, Start, Walk};

/// The least size of a face, in radii.
const SMALLEST: f32 = 1.0 / 4096.0;

/// The largest size of the mesh, in radii: beyond, squares of what a step goes are too small for 32 bits.
const LARGEST: f32 = 1e18;

/// Estimates all faces of a mesh but its duplicates, by formula (1); `None` for a mesh that has no [`Steps`].
pub(super) fn estimate(
    mesh: &Mesh,
    options: &CurvatureOptions,
    fixed: Option<f64>,
    progress: &dyn Progress,
) -> Option<Vec<FaceCurvature>> {
    let order = mesh.along_curve();
    let place = inverse(&order, Face::index, |place| place);
    let steps = Steps::new(mesh, &order, &place)?;
    let survey = Survey {
        mesh,
        options,
        fixed,
        steps: &steps,
        directions: Directions::new(options.diameters),
        reader: Reader::new(options.diameters, options.estimator),
    };
    let mut values = vec![FaceCurvature::NOT_ESTIMATED; order.len()];
    let chunks = values.par_chunks_mut(CHUNK).zip(order.par_chunks(CHUNK)).enumerate();
    chunks.for_each_init(
        || Worker::new(&survey),
        |worker, (chunk, (out, faces))| {
            worker.estimate((chunk * CHUNK) as u32, faces, out);
            progress.advance(out.len() as u64);
        },
    );
    drop(steps);
    Some(place.par_iter().map(|&at| values[at as usize]).collect())
}

/// What is the same for all faces.
struct Survey<'s> {
    mesh: &'s Mesh,
    options: &'s CurvatureOptions,
    fixed: Option<f64>,
    steps: &'s Steps,
    directions: Directions,
    reader: Reader,
}

/// Memory for the faces under way.
struct Worker<'s> {
    survey: &'s Survey<'s>,
    legs: Legs,
    fits: EulerFit<F4>,
    ends: Vec<End>,
    disk: Disk,
}

/// A face that looks for its radius.
struct Case {
    face: Face,
    /// Its place in the order.
    place: u32,
    frame: Frame,
    search: RadiusSearch,
    radius: f64,
    /// What the last disk shows besides the fit.
    coverage: f64,
    gauss_perimeter: f64,
    is_blind: bool,
}

impl<'s> Worker<'s> {
    fn new(survey: &'s Survey<'s>) -> Self {
        Worker {
            survey,
            legs: Legs::new(&survey.directions),
            fits: EulerFit::new(),
            ends: Vec::new(),
            disk: Disk::new(),
        }
    }

    /// Estimates faces that follow one another in the order, the first of them at `first`.
    fn estimate(&mut self, first: u32, faces: &[Face], out: &mut [FaceCurvature]) {
        let survey = self.survey;
        let mut waiting = (first..).zip(faces).filter_map(|(place, &face)| survey.case(place, face));
        let mut cases: [Option<Case>; LANES] = [const { None }; LANES];
        loop {
            for (lane, slot) in cases.iter_mut().enumerate() {
                loop {
                    if slot.is_none() {
                        *slot = waiting.next();
                    }
                    let Some(case) = slot else { break };
                    if self.lay(case, lane) {
                        break;
                    }
                    out[(case.place - first) as usize] = self.walk_mesh(case);
                    *slot = None;
                }
            }
            if cases.iter().all(Option::is_none) {
                return;
            }
            for (slot, principal) in cases.iter_mut().zip(reading::solve(&self.fits)) {
                if let Some(case) = slot {
                    match case.search.next(case.radius, principal.largest(), || case.is_blind) {
                        Some(radius) => case.radius = radius,
                        None => {
                            out[(case.place - first) as usize] = case.value(&principal, survey.options);
                            *slot = None;
                        }
                    }
                }
            }
        }
    }

    /// Lays the disk of a case's radius and puts what it shows into a lane; false where the walk cannot be trusted.
    fn lay(&mut self, case: &mut Case, lane: usize) -> bool {
        let Survey { mesh, steps, directions, reader, .. } = self.survey;
        let start = case.start(mesh, steps.scale());
        let is_large = start.corners.as_flattened().iter().any(|c| c.abs() > SMALLEST);
        let is_there = start.axes.as_flattened().iter().all(|a| a.abs() < LARGEST);
        if !is_large || !is_there || !eight::run(Walk { steps, start: &start, directions, legs: &mut self.legs }) {
            return false;
        }
        self.legs.close(2 * self.survey.options.diameters);
        let reading = reader.read(&self.legs, &mut self.fits, lane);
        case.coverage = reader.coverage(&reading);
        case.is_blind = reader.is_blind(&self.legs);
        case.gauss_perimeter = self.gauss(case, &reading);
        true
    }

    fn gauss(&mut self, case: &Case, reading: &DiskReading) -> f64 {
        let Survey { mesh, options, reader, .. } = self.survey;
        let aside = |leg: usize| {
            let direction = case.frame.direction(PI * leg as f64 / options.diameters as f64);
            let plane = Plane { point: case.frame.centre, normal: case.frame.normal.cross(direction) };
            angle_aside(mesh, &plane, case.face, direction, case.radius)
        };
        reader.gauss(reading, &self.legs, &mut self.ends, aside).map_or(f64::NAN, |k| k / (case.radius * case.radius))
    }

    #[cold]
    fn walk_mesh(&mut self, case: &Case) -> FaceCurvature {
        let Survey { mesh, options, fixed, .. } = *self.survey;
        super::curvature_at(mesh, case.face, &case.frame, options, fixed, &mut self.disk)
    }
}

impl Survey<'_> {
    fn case(&self, place: u32, face: Face) -> Option<Case> {
        let mesh = self.mesh;
        let frame = Frame::at_barycentre(mesh, face).filter(|_| mesh.is_sound(face))?;
        let (search, radius) = RadiusSearch::new(mesh, face, self.options, self.fixed);
        Some(Case { face, place, frame, search, radius, coverage: 0.0, gauss_perimeter: f64::NAN, is_blind: false })
    }
}

impl Case {
    /// The face as the walk sees it; `scale` is that of the [`Steps`].
    fn start(&self, mesh: &Mesh, scale: f64) -> Start {
        let Frame { centre, normal, x, y } = self.frame;
        let [a, b, c] = mesh.triangle(self.face);
        let corners = if mesh.is_flipped(self.face) { [a, c, b] } else { [a, b, c] };
        let unit = 1.0 / self.radius;
        let in_frame = |p: glam::DVec3| [(p - centre).dot(x) * unit, (p - centre).dot(y) * unit].map(|c| c as f32);
        let per_step = unit / scale;
        Start {
            corners: corners.map(in_frame),
            axes: [x, y, normal].map(|axis| (per_step * axis).as_vec3().to_array()),
            edge: 4 * self.place,
        }
    }

    fn value(&self, principal: &PlanarPrincipal, options: &CurvatureOptions) -> FaceCurvature {
        let PlanarPrincipal { k_max, k_min, direction } = *principal;
        let in_units = PlanarPrincipal { k_max: k_max / self.radius, k_min: k_min / self.radius, direction };
        super::value_from(&self.frame, &in_units, self.radius, self.gauss_perimeter, self.coverage, options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::{Estimator, Radius};
    use crate::mesh::MeshOptions;
    use crate::synth::{Grid, Surface};

    fn bits(all: &[f32]) -> Vec<u32> {
        all.iter().map(|value| value.to_bits()).collect()
    }

    /// On closed surfaces and at borders, with legs that end for any reason.
    #[test]
    fn plain_code_and_the_processors_vectors_give_the_same_bits() {
        let torus = Grid { jitter: 0.2, noise: 0.1, ..Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 40, 20) };
        let saddle = Grid { jitter: 0.3, ..Grid::new(Surface::Saddle, 20, 20) };
        for (grid, diameters) in [(torus, 12), (saddle, 7), (saddle, 40)] {
            let mesh = Mesh::from_soup(&grid.build().soup, &MeshOptions::default()).expect("a mesh");
            let order: Vec<Face> = (0..mesh.face_count() as u32).map(Face).collect();
            let place: Vec<u32> = order.iter().map(|face| face.0).collect();
            let options = CurvatureOptions {
                estimator: Estimator::Osculating,
                radius: Radius::FaceFactor(3.0),
                diameters,
                ..CurvatureOptions::default()
            };
            let steps = Steps::new(&mesh, &order, &place).expect("steps");
            let survey = Survey {
                mesh: &mesh,
                options: &options,
                fixed: None,
                steps: &steps,
                directions: Directions::new(diameters),
                reader: Reader::new(diameters, options.estimator),
            };
            let [mut fast, mut plain] = [0, 1].map(|_| Legs::new(&survey.directions));
            for &face in &order {
                let case = survey.case(face.0, face).expect("a sound face");
                let start = case.start(&mesh, steps.scale());
                let walk = |legs| Walk { steps: &steps, start: &start, directions: &survey.directions, legs };
                assert!(eight::run(walk(&mut fast)) && eight::run_portable(walk(&mut plain)));
                for (a, b) in [
                    (&fast.length, &plain.length),
                    (&fast.excess, &plain.excess),
                    (&fast.height, &plain.height),
                    (&fast.first, &plain.first),
                    (&fast.moments[0], &plain.moments[0]),
                    (&fast.moments[1], &plain.moments[1]),
                ] {
                    assert_eq!(bits(a), bits(b), "{face:?}");
                }
                fast.close(2 * diameters);
                plain.close(2 * diameters);
                let [mut fits, mut plain_fits] = [EulerFit::new(); 2];
                let reading = survey.reader.read(&fast, &mut fits, 1);
                assert_eq!(reading, survey.reader.read_portable(&fast, &mut plain_fits, 1), "{face:?}");
                assert_eq!(fits, plain_fits, "{face:?}");
            }
        }
    }
}
