//! Curvature of every face: settings, values, and the loop over faces.

mod classify;
mod euler;
mod fit;
mod method;
mod options;
mod osculating;
mod perimeter;
mod radius;
mod sections;
mod tangent;
mod values;
mod vectors;

pub use classify::FaceClass;
pub use method::Method;
pub use options::{CurvatureOptions, Estimator, Radius};
pub use values::FaceCurvature;

use crate::disk::{Diameter, Disk, Frame, Leg};
use crate::error::Error;
use crate::mesh::{Face, FileOrder, Mesh};
use crate::place::Place;
use crate::progress::{Progress, Stage, Uncounted};
use euler::{EulerFit, PlanarPrincipal};
use radius::RadiusSearch;
use rayon::prelude::*;
use std::ops::Range;

/// A normal curvature as one diameter shows it, or as several do side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sample<R = f64> {
    /// Signed normal curvature.
    curvature: R,
    /// How much the diameter can say, relative to the face's other diameters; 0 for nothing.
    weight: R,
}

/// What formula (1) needs of a diameter.
#[derive(Clone, Copy, Debug)]
struct Section<R> {
    forward: Part<R>,
    backward: Part<R>,
}

/// What formula (1) needs of a leg, see [`Leg`].
#[derive(Clone, Copy, Debug)]
struct Part<R> {
    length: R,
    excess: R,
    /// Of the end, above the face.
    height: R,
    first: R,
    moments: [R; 2],
}

impl Section<f64> {
    /// A diameter, measured in units.
    fn of(diameter: &Diameter<'_>, unit: f64) -> Self {
        let part = |leg: &Leg| Part {
            length: leg.length / unit,
            excess: leg.excess / unit,
            height: leg.end.y / unit,
            first: leg.first / unit,
            moments: [leg.moments[0] / (unit * unit), leg.moments[1] / (unit * unit * unit)],
        };
        Section { forward: part(diameter.forward), backward: part(diameter.backward) }
    }
}

/// Faces estimated between two reports of progress; also the unit of work of a thread.
const CHUNK: usize = 4096;

/// Estimates the curvature of every face of a mesh: one value per face, in face order.
///
/// Work is shared among the threads of the current rayon pool; the result does not depend on their
/// number. Faces without an area or with coordinates that are not finite come out as
/// [`FaceCurvature::NOT_ESTIMATED`]; a duplicate face gets the values of the first face over its
/// vertices.
///
/// # Errors
/// [`Error::Usage`] for options out of range.
pub fn estimate(mesh: &Mesh, options: &CurvatureOptions, progress: &dyn Progress) -> Result<Vec<FaceCurvature>, Error> {
    let fixed = begin(mesh, options, progress)?;
    let values = match by_sections(mesh, options, fixed, progress) {
        Some(values) => values,
        None => {
            let (_, order, values) = in_order(mesh.surface(), options, fixed, progress);
            order.sorted(&values, FaceCurvature::within_32_bits)
        }
    };
    Ok(finish(mesh, values, progress))
}

/// The same for a mesh that may be put in another order meanwhile, which saves a copy of it.
///
/// # Errors
/// Those of [`estimate`].
pub fn estimate_owned(
    mesh: Mesh,
    options: &CurvatureOptions,
    progress: &dyn Progress,
) -> Result<(Mesh, Vec<FaceCurvature>), Error> {
    let fixed = begin(&mesh, options, progress)?;
    let (mesh, values) = match by_sections(&mesh, options, fixed, progress) {
        Some(values) => (mesh, values),
        None => {
            let (ordered, order, values) = in_order(mesh, options, fixed, progress);
            let sorted = order.sorted(&values, FaceCurvature::within_32_bits);
            drop(values);
            (ordered.back_to(order), sorted)
        }
    };
    let values = finish(&mesh, values, progress);
    Ok((mesh, values))
}

/// The radius, where it is the same for all faces.
fn begin(mesh: &Mesh, options: &CurvatureOptions, progress: &dyn Progress) -> Result<Option<f64>, Error> {
    options.check_for(mesh)?;
    progress.begin(Stage::Estimate, mesh.face_count() as u64);
    Ok(options.fixed_radius(mesh))
}

fn finish(mesh: &Mesh, mut values: Vec<FaceCurvature>, progress: &dyn Progress) -> Vec<FaceCurvature> {
    for &(copy, original) in mesh.duplicates() {
        values[copy.index()] = values[original.index()];
    }
    progress.end();
    values
}

/// Estimates all faces of a mesh but its duplicates by many sections at a time, where the options ask for sections.
fn by_sections(
    mesh: &Mesh,
    options: &CurvatureOptions,
    fixed: Option<f64>,
    progress: &dyn Progress,
) -> Option<Vec<FaceCurvature>> {
    let mut values = match options.estimator {
        Estimator::Osculating | Estimator::Osculating3 => sections::estimate(mesh, options, fixed, progress)?,
        Estimator::Auto | Estimator::Tangent => return None,
    };
    values.par_iter_mut().for_each(|value| *value = value.within_32_bits());
    Some(values)
}

/// Estimates all faces of a mesh but its duplicates, in an order that is good for caches.
fn in_order(
    mesh: Mesh,
    options: &CurvatureOptions,
    fixed: Option<f64>,
    progress: &dyn Progress,
) -> (Mesh, FileOrder, Vec<FaceCurvature>) {
    let (ordered, order) = mesh.into_order();
    // By all threads: to bring so much memory into use takes time.
    let none = (0..ordered.face_count()).into_par_iter().map(|_| FaceCurvature::NOT_ESTIMATED);
    let mut values: Vec<FaceCurvature> = none.collect();
    estimate_in_order(&ordered, options, fixed, progress, &mut values);
    (ordered, order, values)
}

/// Estimates all faces of a mesh but its duplicates.
fn estimate_in_order(
    mesh: &Mesh,
    options: &CurvatureOptions,
    fixed: Option<f64>,
    progress: &dyn Progress,
    out: &mut [FaceCurvature],
) {
    if options.estimator == Estimator::Auto {
        fit::estimate(mesh, options, |f| options.radius_of(mesh, f, fixed), progress, out);
        if options.perimeter {
            add_perimeters(mesh, options, fixed, &Uncounted(progress), out);
        }
        return;
    }
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(Disk::new, |disk, (chunk, out)| {
        let first = (chunk * CHUNK) as u32;
        estimate_range(mesh, options, fixed, first..first + out.len() as u32, disk, out);
        progress.advance(out.len() as u64);
    });
}

/// Adds the perimeter estimate of every face that has an estimate.
fn add_perimeters(
    mesh: &Mesh,
    options: &CurvatureOptions,
    fixed: Option<f64>,
    progress: &dyn Progress,
    values: &mut [FaceCurvature],
) {
    if let Some(sections) = sections::estimate(mesh, options, fixed, progress) {
        for (value, section) in values.iter_mut().zip(sections).filter(|(value, _)| value.is_estimated()) {
            value.gauss_perimeter = section.gauss_perimeter;
        }
        return;
    }
    values.par_chunks_mut(CHUNK).enumerate().for_each_init(Disk::new, |disk, (chunk, values)| {
        progress.advance(0);
        let faces = (chunk * CHUNK..).map(|f| Face(f as u32)).zip(values);
        for (face, value) in faces.filter(|(_, value)| value.is_estimated()) {
            if let Some(frame) = Frame::at_barycentre(mesh, face) {
                value.gauss_perimeter = curvature_at(mesh, face, &frame, options, fixed, disk).gauss_perimeter;
            }
        }
    });
}

/// Estimates a range of faces; they may walk over any face of the mesh.
fn estimate_range(
    mesh: &Mesh,
    options: &CurvatureOptions,
    fixed_radius: Option<f64>,
    faces: Range<u32>,
    disk: &mut Disk,
    out: &mut [FaceCurvature],
) {
    for (face, value) in faces.map(Face).zip(out) {
        if !mesh.is_sound(face) {
            continue;
        }
        if let Some(frame) = Frame::at_barycentre(mesh, face) {
            *value = curvature_at(mesh, face, &frame, options, fixed_radius, disk);
        }
    }
}

/// Lays a disk around a frame's centre and reads the curvature off it. The disk is left in `disk`.
pub(crate) fn curvature_at(
    mesh: &Mesh,
    face: Face,
    frame: &Frame,
    options: &CurvatureOptions,
    fixed_radius: Option<f64>,
    disk: &mut Disk,
) -> FaceCurvature {
    let (mut search, mut radius) = RadiusSearch::new(mesh, face, options, fixed_radius);
    loop {
        disk.walk(mesh, face, frame, radius, options.diameters);
        let principal = principal(disk, options);
        let turn = radius * principal.largest();
        let is_blind = || disk.legs().iter().all(|leg| leg.length <= leg.first);
        match search.next(radius, turn, is_blind) {
            Some(next) => radius = next,
            None => return value_of(disk, frame, principal, options),
        }
    }
}

/// What a diameter shows, if anything. Lengths are taken in a unit near the diameter's own length.
fn sample(diameter: &Diameter<'_>, estimator: Estimator, unit: f64) -> Option<Sample> {
    let section = || Section::of(diameter, unit);
    let found = match estimator {
        Estimator::Auto | Estimator::Osculating => osculating::exact_arc(&section()),
        Estimator::Osculating3 => osculating::third_order(&section()),
        Estimator::Tangent => return tangent::turning(diameter),
    };
    (found.weight > 0.0).then_some(Sample { curvature: found.curvature / unit, ..found })
}

/// The signed normal curvature that a single diameter shows; `None` where it stays inside the plane
/// of its face and says nothing.
pub fn normal_curvature(diameter: &Diameter<'_>, estimator: Estimator) -> Option<f64> {
    let unit = diameter.forward.length + diameter.backward.length;
    sample(diameter, estimator, unit).map(|sample| sample.curvature)
}

/// Reads the curvature of a face off its disk.
///
/// A disk none of whose legs leaves the plane of its face is flat: so is a lone triangle, all of
/// whose legs end at its own edges.
pub fn from_disk(disk: &Disk, frame: &Frame, options: &CurvatureOptions) -> FaceCurvature {
    if disk.legs().is_empty() {
        return FaceCurvature::NOT_ESTIMATED;
    }
    value_of(disk, frame, principal(disk, options), options)
}

/// Principal curvatures and their directions, by a fit over all diameters.
fn principal(disk: &Disk, options: &CurvatureOptions) -> PlanarPrincipal {
    let mut fit = EulerFit::new();
    for diameter in disk.diameters() {
        if let Some(sample) = sample(&diameter, options.estimator, disk.radius()) {
            fit.add(&euler::terms(diameter.angle), sample);
        }
    }
    fit.solve()
}

/// Everything a face gets from its disk.
fn value_of(disk: &Disk, frame: &Frame, principal: PlanarPrincipal, options: &CurvatureOptions) -> FaceCurvature {
    let gauss_perimeter = perimeter::gauss(disk).unwrap_or(f64::NAN);
    value_from(frame, &principal, disk.radius(), gauss_perimeter, disk.coverage(), options)
}

fn value_from(
    frame: &Frame,
    principal: &PlanarPrincipal,
    radius: f64,
    gauss_perimeter: f64,
    coverage: f64,
    options: &CurvatureOptions,
) -> FaceCurvature {
    let PlanarPrincipal { k_max, k_min, direction: [cos, sin] } = *principal;
    let direction = cos * frame.x + sin * frame.y;
    FaceCurvature {
        k_max: k_max as f32,
        k_min: k_min as f32,
        dir_max: direction.as_vec3(),
        dir_min: frame.normal.cross(direction).as_vec3(),
        gauss_perimeter: gauss_perimeter as f32,
        radius: radius as f32,
        coverage: coverage as f32,
        // Sections are a few percent off where the disk is whole, and the more the less of it there is.
        confidence: (0.5 * coverage) as f32,
        method: Method::Sections,
        class: FaceClass::of(k_max, k_min, radius, options.class_tolerance),
    }
    .within_32_bits()
}

/// The disk around a place of the surface, its frame and the curvature read off it.
///
/// # Errors
/// [`Error::Usage`] for options out of range, or a face that is not there or has no area.
pub fn disk_at(mesh: &Mesh, place: Place, options: &CurvatureOptions) -> Result<(Disk, Frame, FaceCurvature), Error> {
    options.check_for(mesh)?;
    place.check(mesh)?;
    let frame = Frame::at(mesh, place)
        .ok_or_else(|| Error::Usage(format!("face {} has no area, so no disk can be laid on it", place.face.0)))?;
    let mut disk = Disk::new();
    let value = curvature_at(mesh, place.face, &frame, options, options.fixed_radius(mesh), &mut disk);
    Ok((disk, frame, value))
}
