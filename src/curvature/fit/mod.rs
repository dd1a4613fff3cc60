//! The default estimator: surfaces fitted to windows of vertices.

mod chord;
mod exact;
mod implicit;
mod least_squares;
mod noise;
mod shape;
mod window;

use super::{CurvatureOptions, FaceClass, FaceCurvature};
use crate::disk::{Disk, Frame as DiskFrame};
use crate::mesh::{Face, FaceState, Mesh};
use exact::{Fit, Scratch, WANTED};
use glam::DVec3;
use rayon::prelude::*;
use window::{Stars, Window};

const CHUNK: usize = 1024;

/// A face's value and what later passes need.
#[derive(Clone, Copy)]
struct Outcome {
    value: FaceCurvature,
    /// Misfit of the face's own fit in units of curvature; infinite where there is none.
    misfit: f32,
    /// Misfit in file units.
    deviation: f64,
    /// Standard error of the tensor.
    error: f64,
}

struct Worker<'m> {
    mesh: &'m Mesh,
    stars: &'m Stars,
    quantum: f64,
    window: Window,
    scratch: Scratch,
    disk: Disk,
}

impl<'m> Worker<'m> {
    fn fit(&mut self, seed: Face) -> Option<Fit> {
        self.window.start(self.mesh, seed);
        self.window.grow_to(self.mesh, self.stars, false, WANTED);
        exact::fit(self.mesh, seed, &self.window, self.quantum, &mut self.scratch)
    }
}

/// The rounding of the mesh's coordinates, in file units.
fn quantum(mesh: &Mesh) -> f64 {
    let origin = mesh.origin();
    let (largest, single) = mesh
        .positions()
        .par_iter()
        .map(|&p| {
            let p = p + origin;
            (p.abs().max_element(), p.as_vec3().as_dvec3() == p)
        })
        .filter(|(size, _)| size.is_finite())
        .reduce(|| (0.0, true), |a, b| (a.0.max(b.0), a.1 && b.1));
    largest * if single { 6e-8 } else { 1e-16 }
}

/// Estimates all faces.
pub(super) fn estimate(mesh: &Mesh, options: &CurvatureOptions, out: &mut [FaceCurvature]) {
    let stars = Stars::new(mesh, false);
    let quantum = quantum(mesh);
    let worker = || Worker { mesh, stars: &stars, quantum, window: Window::new(), scratch: Scratch::new(), disk: Disk::new() };
    let mut outcomes = vec![Outcome { value: FaceCurvature::NOT_ESTIMATED, misfit: f32::INFINITY, deviation: f64::INFINITY, error: f64::INFINITY }; out.len()];
    outcomes.par_chunks_mut(CHUNK).enumerate().for_each_init(worker, |worker, (chunk, out)| {
        for (i, out) in out.iter_mut().enumerate() {
            let face = Face((chunk * CHUNK + i) as u32);
            if mesh.face_state(face) != FaceState::Sound {
                continue;
            }
            if let Some(fit) = worker.fit(face) {
                if let Some(value) = value_of(mesh, face, &fit, options) {
                    *out = Outcome { value, misfit: (fit.misfit / fit.surface.frame.unit.powi(2)) as f32, deviation: fit.misfit, error: fit.error };
                    continue;
                }
            }
            if let Some(frame) = DiskFrame::at_barycentre(mesh, face) {
                out.value = super::curvature_at(mesh, face, &frame, options, None, &mut worker.disk);
            }
        }
    });
    for (out, outcome) in out.iter_mut().zip(&outcomes) {
        *out = outcome.value;
    }
    let mut wanted = vec![false; out.len()];
    out.par_chunks_mut(CHUNK).zip(wanted.par_chunks_mut(CHUNK)).enumerate().for_each_init(worker, |worker, (chunk, (out, wanted))| {
        for (i, (out, wanted)) in out.iter_mut().zip(wanted).enumerate() {
            let face = Face((chunk * CHUNK + i) as u32);
            if mesh.face_state(face) != FaceState::Sound { continue; }
            if let Some(value) = one_sided(worker, face, &outcomes, options) {
                *out = value;
                continue;
            }
            let o = &outcomes[face.index()];
            let bend = f64::from(out.k_max.abs().max(out.k_min.abs()));
            *wanted = o.deviation > 20.0 * quantum && !(o.error < 2e-3 * bend);
        }
    });
    let uncertain = wanted.iter().filter(|&&w| w).count();
    if std::env::var_os("DBG2").is_some() { eprintln!("uncertain {uncertain} of {}", out.len()); }
    if uncertain == 0 || std::env::var_os("NONOISE").is_some() {
        return;
    }
    let mut normals = vec![glam::Vec3::ZERO; mesh.positions().len()];
    for f in (0..mesh.face_count() as u32).map(Face) {
        if mesh.face_state(f) == FaceState::Sound {
            let area = window::oriented_area(mesh, f).as_vec3();
            for v in mesh.topology().corners(f) { normals[v.index()] += area; }
        }
    }
    let fixed: Option<Vec<f64>> = std::env::var("FIX").ok().map(|v| v.split(',').map(|x| x.parse().unwrap_or(0.0)).collect());
    let loose = fixed.is_some().then(|| Stars::new(mesh, true));
    let noisy = noise::Noisy { mesh, stars: loose.as_ref().unwrap_or(&stars), ignore_features: fixed.is_some(), normals };
    let blended = match fixed {
        Some(fix) if fix.len() > 2 => noisy.at_vertices(fix[0] as usize, fix[1] as usize),
        Some(fix) => noisy.at_scale(&vec![true; out.len()], if fix[0] < 0.0 { fix[0] } else { fix[0] * mesh.mean_edge_of_mesh() }, fix[1] as usize),
        None => noisy.estimate(&wanted),
    };
    for (out, b) in out.iter_mut().zip(&blended) {
        let Some(b) = b else { continue };
        let p = b.shape.principal();
        *out = FaceCurvature {
            k_max: p.k_max as f32, k_min: p.k_min as f32, dir_max: p.dir_max.as_vec3(), dir_min: p.dir_min.as_vec3(),
            gauss_perimeter: f32::NAN, radius: b.radius as f32, coverage: 1.0,
            class: FaceClass::of(p.k_max, p.k_min, b.radius, options.class_tolerance),
        };
    }
}

fn value_of(mesh: &Mesh, face: Face, fit: &Fit, options: &CurvatureOptions) -> Option<FaceCurvature> {
    let p = fit.surface.shape_at(mesh.barycentre(face))?.principal();
    let radius = fit.surface.frame.unit;
    Some(FaceCurvature {
        k_max: p.k_max as f32,
        k_min: p.k_min as f32,
        dir_max: p.dir_max.as_vec3(),
        dir_min: p.dir_min.as_vec3(),
        gauss_perimeter: f32::NAN,
        radius: radius as f32,
        coverage: 1.0,
        class: FaceClass::of(p.k_max, p.k_min, radius, options.class_tolerance),
    })
}

/// Faces beside a jump of curvature: a neighbour whose window lies on one side of it.
fn one_sided(worker: &mut Worker<'_>, face: Face, outcomes: &[Outcome], options: &CurvatureOptions) -> Option<FaceCurvature> {
    const BETTER: f32 = 0.02;
    const TRIED: usize = 16;
    let mesh = worker.mesh;
    let own = outcomes[face.index()].misfit;
    if std::env::var_os("NOJUMP").is_some() { return None; }
    if mesh.face_state(face) != FaceState::Sound || own < 1e-12 {
        return None;
    }
    worker.window.start(mesh, face);
    worker.window.grow_to(mesh, worker.stars, false, WANTED);
    worker.window.add_ring(mesh, worker.stars, false);
    let centre = mesh.barycentre(face);
    let mut others: Vec<(f64, u32)> = worker
        .window
        .faces
        .iter()
        .filter(|&&g| outcomes[g as usize].misfit <= BETTER * own)
        .map(|&g| (f64::from((outcomes[g as usize].misfit / own).max(1e-8)).log10().floor() * 1e6 + mesh.barycentre(Face(g)).distance_squared(centre), g))
        .collect();
    others.sort_unstable_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    for &(_, g) in others.iter().take(TRIED) {
        let Some(fit) = worker.fit(Face(g)) else { continue };
        if lies_on(&fit, mesh.triangle(face)) {
            if std::env::var_os("DBG").is_some() { eprintln!("face {} own {own:e} takes {g} misfit {:e} size {} unit {}", face.0, fit.misfit, fit.surface.size, fit.surface.frame.unit); }
            return value_of(mesh, face, &Fit { surface: fit.simple, ..fit }, options);
        }
    }
    None
}

/// True when a triangle is one of the surface that a fit found: its corners within the fit's misfit,
/// and no side of it from one sheet of the surface to another.
fn lies_on(fit: &Fit, triangle: [DVec3; 3]) -> bool {
    // Along a circle the normals at both ends lean against the chord alike.
    const LEAN: f64 = 0.1;
    let surface = &fit.simple;
    let corners = triangle.map(|p| surface.frame.to_local(p));
    let gradients = corners.map(|p| surface.gradient(p));
    let reach = 3.0 * fit.misfit / surface.frame.unit;
    (0..3).all(|i| {
        let j = (i + 1) % 3;
        let lean = (gradients[i].normalize_or_zero() + gradients[j].normalize_or_zero()).dot(corners[j] - corners[i]);
        surface.value(corners[i]).abs() <= reach * gradients[i].length()
            && lean.abs() <= LEAN * corners[j].distance(corners[i])
    })
}
