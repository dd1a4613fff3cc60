//! The default estimator: surfaces fitted to windows of vertices.
//!
//! 1. [`exact`]: around every face, the smallest implicit surface that explains its window. Exact on
//!    planes, quadrics and tori on any triangulation, of high order elsewhere. Windows that carry no fit
//!    are left to the paper's sections.
//! 2. [`one_sided`]: faces beside a jump of curvature take the fit from their own side of it.
//! 3. Where fits leave errors that count, the surface is noisy: [`scale`] chooses larger windows from the
//!    data and [`patches`] blends what they show; a surface that is rough at every scale gets one window
//!    for all, from [`steady`].
//!
//! `docs/estimator.md` has the derivation, the rules in words, and measured errors.

mod basis;
mod chord;
mod cyclide;
mod exact;
mod frame;
mod implicit;
mod least_squares;
mod one_sided;
mod patches;
mod rulings;
mod samples;
mod scale;
mod shape;
mod steady;
mod window;

use super::{CurvatureOptions, FaceClass, FaceCurvature, Method};
use crate::disk::{Disk, Frame as DiskFrame};
use crate::mesh::{Face, FaceState, Mesh};
use crate::progress::Progress;
use exact::{Fit, Scratch, WANTED};
use patches::Blended;
use rayon::prelude::*;
use samples::{Ground, Sampler};
use shape::Principal;
use window::{Stars, Window};

/// Faces estimated between two reports of progress; also the unit of work of a thread.
const CHUNK: usize = 1024;
/// A fit whose tensor is expected to be off by less than this share of the curvature needs no help.
const GOOD: f64 = 2e-3;
/// Misfits up to this many times the rounding of coordinates are none.
const ROUNDING: f64 = 20.0;
/// Rounding within a fit, in radii of its window.
const ARITHMETIC: f64 = 1e-12;

/// How well a face's own fit explains its window.
#[derive(Clone, Copy)]
struct Quality {
    /// Misfit in units of curvature; infinite where there is no fit.
    misfit: f32,
    /// True where rounding does not explain the misfit.
    is_uneven: bool,
    /// True where the values may be far off.
    is_doubtful: bool,
}

impl Quality {
    const NO_FIT: Quality = Quality { misfit: f32::INFINITY, is_uneven: false, is_doubtful: false };
}

/// What fits of single faces need; one per thread.
struct Worker<'m> {
    mesh: &'m Mesh,
    stars: &'m Stars,
    options: &'m CurvatureOptions,
    quantum: f64,
    window: Window,
    scratch: Scratch,
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
    let stars = Stars::new(mesh, false);
    let quantum = quantum(mesh);
    let worker = || Worker {
        mesh,
        stars: &stars,
        options,
        quantum,
        window: Window::new(),
        scratch: Scratch::new(),
        disk: Disk::new(),
    };
    let is_sound = |f: usize| mesh.face_state(Face(f as u32)) == FaceState::Sound;
    if radius(Face(0)).is_some() {
        let ground = Ground::new(mesh, &stars, false);
        let tools = || (worker(), Sampler::new(&ground));
        out.par_chunks_mut(CHUNK).enumerate().for_each_init(tools, |(worker, sampler), (chunk, out)| {
            for (f, out) in (chunk * CHUNK..).zip(&mut *out).filter(|(f, _)| is_sound(*f)) {
                let face = Face(f as u32);
                let value = radius(face).and_then(|r| steady::within(sampler, face, r, quantum));
                *out = value.map_or_else(
                    || worker.first(face).0,
                    |value| blended_value(sampler.window.coverage(mesh), &value, Method::Window, options),
                );
            }
            progress.advance(out.len() as u64);
        });
        return;
    }

    let mut quality = vec![Quality::NO_FIT; out.len()];
    let both = out.par_chunks_mut(CHUNK).zip(quality.par_chunks_mut(CHUNK));
    both.enumerate().for_each_init(worker, |worker, (chunk, (out, quality))| {
        for ((f, out), quality) in (chunk * CHUNK..).zip(&mut *out).zip(quality).filter(|((f, _), _)| is_sound(*f)) {
            (*out, *quality) = worker.first(Face(f as u32));
        }
        progress.advance(out.len() as u64);
    });
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(worker, |worker, (chunk, out)| {
        for (f, out) in (chunk * CHUNK..).zip(out).filter(|(f, _)| quality[*f].is_uneven) {
            if let Some(value) = worker.one_sided(Face(f as u32), &quality) {
                *out = FaceCurvature { coverage: out.coverage, ..value };
            }
        }
    });
    let doubtful = |(value, quality): (&FaceCurvature, &Quality)| quality.is_doubtful && value.method == Method::Fit;
    let wanted: Vec<bool> = out.iter().zip(&quality).map(doubtful).collect();
    drop(quality);
    if wanted.contains(&true) {
        look_wider(mesh, &stars, options, wanted, out);
    }
}

/// Replaces the values that are `wanted` by what larger windows say.
fn look_wider(
    mesh: &Mesh,
    stars: &Stars,
    options: &CurvatureOptions,
    mut wanted: Vec<bool>,
    out: &mut [FaceCurvature],
) {
    let count = wanted.iter().filter(|w| **w).count();
    let is_everywhere = 2 * count > out.iter().filter(|v| v.is_estimated()).count();
    let ground = Ground::new(mesh, stars, false);
    let seeds = patches::seeds(&ground, &wanted);
    let (values, method) = if scale::is_rough(&ground, &seeds) {
        drop(ground);
        if is_everywhere {
            // Faces that fit by chance would stand out among the others.
            wanted.iter_mut().zip(&*out).for_each(|(wanted, value)| *wanted = value.is_estimated());
        }
        let stars = Stars::new(mesh, true);
        (steady::around_vertices(&Ground::new(mesh, &stars, true)), Method::Window)
    } else {
        (scale::estimate(&ground, &seeds, &wanted), Method::Patches)
    };
    for ((out, value), wanted) in out.iter_mut().zip(values).zip(wanted) {
        if let Some(value) = value.filter(|_| wanted) {
            *out = blended_value(out.coverage.into(), &value, method, options);
        } else if is_everywhere && out.coverage == 0.0 {
            // Alone between edges that noise has made sharp: its plane says nothing.
            out.confidence = 0.0;
        }
    }
}

impl Worker<'_> {
    fn fit(&mut self, seed: Face) -> Option<Fit> {
        self.window.start(self.mesh, seed);
        self.window.grow_to(self.mesh, self.stars, false, WANTED);
        exact::fit(self.mesh, seed, &self.window, self.quantum, &mut self.scratch)
    }

    /// The face's own fit, or its sections where there is none.
    fn first(&mut self, face: Face) -> (FaceCurvature, Quality) {
        let Some((fit, value)) = self.fit(face).and_then(|fit| Some((fit, self.value_of(face, &fit, Method::Fit)?)))
        else {
            let sections = DiskFrame::at_barycentre(self.mesh, face)
                .map(|frame| super::curvature_at(self.mesh, face, &frame, self.options, None, &mut self.disk));
            return (sections.unwrap_or(FaceCurvature::NOT_ESTIMATED), Quality::NO_FIT);
        };
        let bend = f64::from(value.k_max.abs().max(value.k_min.abs()));
        let unit = fit.surface.frame.unit;
        let is_good = fit.error < GOOD * bend;
        let is_uneven = fit.misfit > ROUNDING * self.quantum + ARITHMETIC * fit.radius;
        let misfit = (fit.misfit / (unit * unit)) as f32;
        (value, Quality { misfit, is_uneven, is_doubtful: is_uneven && !is_good })
    }

    /// The fit of a neighbour that lies with the face on one side of a jump of curvature.
    fn one_sided(&mut self, face: Face, quality: &[Quality]) -> Option<FaceCurvature> {
        let mesh = self.mesh;
        self.window.start(mesh, face);
        self.window.grow_to(mesh, self.stars, false, WANTED);
        self.window.add_ring(mesh, self.stars, false);
        let misfit = |g: u32| f64::from(quality[g as usize].misfit);
        let others = one_sided::candidates(mesh, mesh.barycentre(face), misfit(face.0), &self.window.faces, misfit);
        others.into_iter().find_map(|g| {
            let fit = self.fit(Face(g))?;
            let beside = Fit { surface: fit.simple, ..fit };
            let is_honest = fit.simple.size == 3 || !one_sided::is_mostly_plane(mesh, Face(g), &self.window, &fit);
            (is_honest && one_sided::lies_on(&fit, mesh.triangle(face)))
                .then(|| self.value_of(face, &beside, Method::OneSided))?
        })
    }

    fn value_of(&self, face: Face, fit: &Fit, method: Method) -> Option<FaceCurvature> {
        let principal = fit.surface.shape_at(self.mesh.barycentre(face))?.principal();
        let confidence = confidence(&principal, fit.error, fit.radius);
        let mut value = value_from(&principal, fit.radius, self.options);
        (value.coverage, value.confidence, value.method) = (fit.coverage as f32, confidence as f32, method);
        Some(value)
    }
}

/// A value from patches or windows.
fn blended_value(coverage: f64, b: &Blended, method: Method, options: &CurvatureOptions) -> FaceCurvature {
    let principal = b.shape.principal();
    let confidence = confidence(&principal, b.error, b.radius) as f32;
    let value = value_from(&principal, b.radius, options);
    FaceCurvature { coverage: coverage as f32, confidence, method, ..value }
}

fn value_from(p: &Principal, radius: f64, options: &CurvatureOptions) -> FaceCurvature {
    FaceCurvature {
        k_max: p.k_max as f32,
        k_min: p.k_min as f32,
        dir_max: p.dir_max.as_vec3(),
        dir_min: p.dir_min.as_vec3(),
        radius: radius as f32,
        class: FaceClass::of(p.k_max, p.k_min, radius, options.class_tolerance),
        ..FaceCurvature::NOT_ESTIMATED
    }
}

/// One half where the expected error is a twentieth of the curvature; for faces that hardly bend, of the
/// curvature that turns by a fiftieth of a radian over the window.
fn confidence(principal: &Principal, error: f64, radius: f64) -> f64 {
    let bend = principal.k_max.abs().max(principal.k_min.abs()).max(0.02 / radius);
    1.0 / (1.0 + error / (0.05 * bend))
}

/// The rounding of the mesh's coordinates, in file units: that of 32-bit floats where all are such.
fn quantum(mesh: &Mesh) -> f64 {
    let origin = mesh.origin();
    let (largest, single) = mesh
        .positions()
        .par_iter()
        .filter(|p| p.is_finite())
        .map(|&p| {
            let p = p + origin;
            (p.abs().max_element(), p.as_vec3().as_dvec3() == p)
        })
        .reduce(|| (0.0, true), |a, b| (a.0.max(b.0), a.1 && b.1));
    largest * if single { 6e-8 } else { 1e-16 }
}
