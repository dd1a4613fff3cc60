//! The default estimator: surfaces fitted to windows of vertices. Here is the way of a mesh through it, and what
//! becomes of a face's fit; [`noise`] goes on where fits leave errors that count.
//!
//! Each folder uses those before it only:
//! - [`surface`]: what can be fitted, [`solve`]: how it is fitted. They know of no mesh.
//! - [`ground`]: the mesh prepared, [`around`]: the vertices of a window gathered from it.
//! - [`small`]: clean surfaces. [`first`](small::first): around every face, the smallest implicit surface that explains
//!   its window ([`exact`](small::exact)), shared among neighbours where it is good. Exact on planes, quadrics and tori
//!   on any triangulation, of high order elsewhere. Windows that carry no fit are left to the paper's sections.
//!   [`one_sided`]: faces beside a jump of curvature take the fit from their own side of it; [`strips`]: long facets
//!   that lie side by side are fitted in a row; [`flats`]: what folds only because its neighbours bend is flat.
//! - [`wide`]: noisy surfaces. [`rough`] judges in what way they are: [`scale`](wide::scale) and
//!   `lepski` choose larger windows from the data and [`patches`](wide::patches) blends what they show;
//!   a surface that is rough at every scale gets one window for all, from [`steady`](wide::steady), as does a radius
//!   that the user has given, from there and from [`shared`].
//!
//! `docs/estimator.md` has the derivation, the rules in words, and measured errors.

mod around;
mod ground;
mod noise;
mod small;
mod solve;
mod surface;
mod wide;

use super::{CurvatureOptions, FaceClass, FaceCurvature, Method, Radius};
use crate::curvature::vectors::four::LANES;
use crate::disk::{Disk, Frame};
use crate::mesh::{Face, Mesh};
use crate::progress::Progress;
use around::batch::WANTED;
use around::window::Window;
use glam::Vec3;
use ground::Ground;
use ground::fans::Fans;
use ground::quantum::{Quantum, quantum};
use ground::work::Work;
use rayon::prelude::*;
use small::first::{Quality, Reading, Surveyor};
use small::{flats, one_sided, strips};
use std::f64::consts::PI;
use std::ops::Range;
use surface::polynomial::PLANE;
use surface::shape::Principal;
use wide::patches::Blended;
use wide::steady::Steady;
use wide::{rough, shared};

/// Faces estimated between two reports of progress; also the unit of work of a thread.
const CHUNK: usize = 1024;
/// Share of doubtful faces from which a surface is noisy all over: rows of facets and flats tell nothing then. CAD
/// parts have up to eight tenths.
const NOISY: f64 = 0.9;

/// What values of single faces need; one per thread.
struct Worker<'g> {
    ground: &'g Ground<'g>,
    options: &'g CurvatureOptions,
    surveyor: Surveyor<'g>,
    window: Window,
    disk: Disk,
}

/// Estimates all faces; `radius` gives that of a face where the user has chosen one.
pub(super) fn estimate(
    mesh: &Mesh,
    options: &CurvatureOptions,
    radius: impl Fn(Face) -> Option<f64> + Sync,
    progress: &dyn Progress,
    out: &mut [FaceCurvature],
) {
    let work = Work::new(progress, out.len());
    if radius(Face(0)).is_none() {
        return freely(mesh, options, &work, out);
    }
    let values = within(mesh, options, radius, &work);
    let is_open = |(f, value): (usize, &Option<_>)| value.is_none() && mesh.is_sound(Face(f as u32));
    if values.par_iter().enumerate().any(is_open) {
        // What the radius says nothing of has the value it has without one.
        freely(mesh, &CurvatureOptions { radius: Radius::Auto, ..*options }, &work, out);
    }
    out.par_iter_mut().zip(values).for_each(|(out, value)| {
        if let Some((value, coverage)) = value {
            *out = blended_value(coverage, &value, Method::Window, options);
        }
    });
    work.finish();
}

/// The values of all faces within the radius that the user has given for each, with their coverages; `None` for faces
/// that no such window tells of: those of a size that the radius is small against, and those whose vertices do not
/// determine how the surface bends.
fn within(
    mesh: &Mesh,
    options: &CurvatureOptions,
    radius: impl Fn(Face) -> Option<f64> + Sync,
    work: &Work<'_>,
) -> Vec<Option<(Blended, f64)>> {
    let mut ground = Ground::new(mesh, false, work);
    let quantum = quantum(mesh, ground.width);
    // Where all is noise, it has made the sharp edges too.
    if rough::is_fine(mesh) && noise::is_everywhere(mesh, &mut Worker::new(&ground, options, quantum)) {
        ground = Ground::new(mesh, true, work);
    }
    let fans = Fans::new(&ground);
    if shared::pays(&ground, &radius) {
        return shared::estimate(&fans, &quantum, radius);
    }
    let mut values = vec![None; mesh.face_count()];
    values.par_chunks_mut(CHUNK).enumerate().for_each_init(
        || Steady::new(&fans),
        |steady, (chunk, values)| {
            let start = chunk * CHUNK;
            let faces = (start..start + values.len()).map(|f| Face(f as u32));
            let sound = faces.filter(|&face| mesh.is_sound(face));
            let wanted: Vec<(Face, f64)> = sound.filter_map(|face| Some((face, radius(face)?))).collect();
            for four in wanted.chunks(LANES) {
                for ((face, _), fitted) in four.iter().zip(steady.within(four, &quantum)) {
                    values[face.index() - start] =
                        fitted.and_then(|(fitted, coverage)| Some((fitted.value()?, coverage)));
                }
            }
            work.advance(values.len() as u64);
        },
    );
    values
}

/// Estimates all faces with windows as the surface lets them be.
fn freely(mesh: &Mesh, options: &CurvatureOptions, work: &Work<'_>, out: &mut [FaceCurvature]) {
    let ground = Ground::new(mesh, false, work);
    let quantum = quantum(mesh, ground.width);
    let worker = || Worker::new(&ground, options, quantum);
    if mesh.face_count() >= noise::MANY && noise::is_everywhere(mesh, &mut worker()) {
        return noise::estimate(&ground, options, worker, out);
    }
    let mut quality = vec![Quality::NO_FIT; out.len()];
    let both = out.par_chunks_mut(CHUNK).zip(quality.par_chunks_mut(CHUNK));
    both.enumerate().for_each_init(worker, |worker, (chunk, (out, quality))| {
        let start = (chunk * CHUNK) as u32;
        worker.first(start..start + out.len() as u32, out, quality);
        work.advance(out.len() as u64);
    });
    let is_open = |(f, quality): (usize, &Quality)| quality.is_open() && mesh.is_sound(Face(f as u32));
    if quality.par_iter().enumerate().any(is_open) {
        look_aside(&ground, quantum, worker, &mut quality, out);
    }
    let doubtful: Vec<bool> = out.par_iter().zip(&quality).map(noise::is_doubtful).collect();
    drop(quality);
    noise::settle(&ground, options, doubtful, out);
}

/// Values for faces whose windows no surface explains, from the part of the surroundings that goes on as the face does.
fn look_aside<'g>(
    ground: &Ground<'g>,
    quantum: Quantum,
    worker: impl Fn() -> Worker<'g> + Sync,
    quality: &mut [Quality],
    out: &mut [FaceCurvature],
) {
    let mesh = ground.mesh;
    let least = one_sided::least_around(ground, quality);
    let is_beside_better = |f: usize| {
        let around = mesh.topology().faces()[f].map(|v| least[v as usize]);
        quality[f].is_uneven && around.into_iter().any(|m| one_sided::is_better(m, quality[f].misfit))
    };
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(&worker, |worker, (chunk, out)| {
        ground.work.advance(0);
        for (f, out) in (chunk * CHUNK..).zip(out).filter(|(f, _)| is_beside_better(*f)) {
            if let Some(value) = worker.one_sided(Face(f as u32), quality) {
                *out = FaceCurvature { coverage: out.coverage, ..value };
            }
        }
    });
    let doubtful = quality.iter().filter(|q| q.is_doubtful).count();
    let fitted = quality.iter().filter(|q| q.misfit.is_finite()).count();
    if doubtful as f64 > NOISY * fitted as f64 {
        return;
    }
    let both = out.par_chunks_mut(CHUNK).zip(quality.par_chunks_mut(CHUNK));
    both.enumerate().for_each_init(&worker, |worker, (chunk, (out, quality))| {
        ground.work.advance(0);
        let faces = (chunk * CHUNK..).map(|f| Face(f as u32)).zip(out.iter_mut().zip(quality));
        let is_open = |face: Face, out: &FaceCurvature, quality: &Quality| {
            let is_unexplained = quality.is_open() && strips::is_in_row(mesh, face);
            out.method != Method::OneSided && (is_unexplained || strips::is_explained_by_chance(mesh, face, quality))
        };
        for (face, (out, quality)) in faces.filter(|(face, (out, quality))| is_open(*face, out, quality)) {
            if let Some(reading) = strips::reading(&mut worker.surveyor, face, quality) {
                *out = value_of(&reading, Method::Strip, worker.options);
                *quality = reading.quality;
            }
        }
    });
    flats::settle(ground, &quantum, quality, out);
}

impl<'g> Worker<'g> {
    fn new(ground: &'g Ground<'g>, options: &'g CurvatureOptions, quantum: Quantum) -> Self {
        let surveyor = Surveyor::new(ground, quantum);
        Worker { ground, options, surveyor, window: Window::new(), disk: Disk::new() }
    }

    /// The fit of one face, or its sections where there is none.
    fn first_of(&mut self, face: Face, out: &mut FaceCurvature) -> Quality {
        let mut quality = Quality::NO_FIT;
        self.first(face.0..face.0 + 1, std::slice::from_mut(out), std::slice::from_mut(&mut quality));
        quality
    }

    /// The fits of a range of faces, or their sections where there is none.
    fn first(&mut self, faces: Range<u32>, out: &mut [FaceCurvature], quality: &mut [Quality]) {
        let Worker { ground, options, surveyor, disk, .. } = self;
        let mesh = ground.mesh;
        surveyor.survey(faces.clone(), |face, reading| {
            let at = (face.0 - faces.start) as usize;
            if let Some(reading) = reading {
                out[at] = value_of(&reading, Method::Fit, options);
                if mesh.is_lone(face) {
                    // It is flat for all that is known, which is nothing.
                    out[at].confidence = 0.0;
                }
                quality[at] = reading.quality;
            } else if let Some(frame) = Frame::at_barycentre(mesh, face) {
                out[at] = super::curvature_at(mesh, face, &frame, options, None, disk);
            }
        });
    }

    /// The fit of a neighbour that lies with the face on one side of a jump of curvature.
    fn one_sided(&mut self, face: Face, quality: &[Quality]) -> Option<FaceCurvature> {
        let (ground, mesh) = (self.ground, self.ground.mesh);
        self.window.start(mesh, face);
        self.window.grow_to(ground, WANTED);
        self.window.add_ring(ground);
        let own = quality[face.index()].misfit;
        let others = one_sided::candidates(mesh, mesh.barycentre(face), own, &self.window.faces, quality);
        others.chunks(LANES).find_map(|others| {
            let fits = self.surveyor.fits(others);
            fits.iter().zip(others).find_map(|(fit, &g)| {
                let fit = fit.as_ref()?;
                let is_honest = fit.simple.size == PLANE || !one_sided::is_mostly_plane(mesh, g, &self.window, fit);
                let is_near = mesh.barycentre(face).distance(fit.surface.frame.origin) <= fit.radius;
                if !is_honest || !is_near || !one_sided::lies_on(fit, mesh.triangle(face)) {
                    return None;
                }
                let [reading, ..] = self.surveyor.readings(g, fit, &fit.simple, &[face]);
                // Windows of long facets lie apart at both ends, and some surface nearly passes through any two parts.
                let reading = reading.filter(|r| !r.quality.is_uneven || !strips::is_slender(mesh, g))?;
                if !one_sided::turns_as_mesh(mesh, face, &reading.principal) {
                    return None;
                }
                Some(value_of(&reading, Method::OneSided, self.options))
            })
        })
    }
}

fn value_of(reading: &Reading, method: Method, options: &CurvatureOptions) -> FaceCurvature {
    let confidence = confidence(&reading.principal, reading.error, reading.radius) as f32;
    let value = value_from(&reading.principal, reading.radius, options);
    FaceCurvature { coverage: reading.coverage as f32, confidence, method, ..value }
}

/// A value from patches or windows.
fn blended_value(coverage: f64, b: &Blended, method: Method, options: &CurvatureOptions) -> FaceCurvature {
    let principal = b.shape.principal();
    let error = match method {
        Method::Window => b.error + unseen(&principal, b.radius),
        _ => b.error,
    };
    let confidence = confidence(&principal, error, b.radius) as f32;
    let value = value_from(&principal, b.radius, options);
    FaceCurvature { coverage: coverage as f32, confidence, method, ..value }
}

fn value_from(p: &Principal, radius: f64, options: &CurvatureOptions) -> FaceCurvature {
    FaceCurvature {
        k_max: p.k_max as f32,
        k_min: p.k_min as f32,
        dir_max: Vec3::from(p.dir_max),
        dir_min: Vec3::from(p.dir_min),
        radius: radius as f32,
        class: FaceClass::of(p.k_max, p.k_min, radius, options.class_tolerance),
        ..FaceCurvature::NOT_ESTIMATED
    }
}

/// What is added to the expected error of a window's shape tensor, however well the window is explained: as much as the
/// curvature itself where the surface turns by half a circle from the middle to the rim.
fn unseen(principal: &Principal, radius: f64) -> f64 {
    let bend = principal.size();
    bend * (bend * radius / PI).powi(8)
}

/// One half where the expected error is a twentieth of the curvature; for faces that hardly bend, of the
/// curvature that turns by a fiftieth of a radian over the window.
fn confidence(principal: &Principal, error: f64, radius: f64) -> f64 {
    let bend = principal.size().max(0.02 / radius);
    1.0 / (1.0 + error / (0.05 * bend))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DVec3};

    #[test]
    fn a_window_that_the_surface_turns_too_much_in_has_no_confidence() {
        let confidence = |turn: f64| {
            let tensor = DMat3::from_diagonal(DVec3::new(0.5 * turn, 0.5 * turn, 0.0));
            let shape = surface::shape::Shape { normal: DVec3::Z, tensor };
            let blended = Blended { shape, radius: 2.0, error: 0.0 };
            blended_value(1.0, &blended, Method::Window, &CurvatureOptions::default()).confidence
        };
        assert!(confidence(1.0) > 0.99 && confidence(3.0) < 0.2 && confidence(5.0) < 0.01);
    }
}
