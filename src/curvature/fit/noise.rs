//! What is done where noise keeps small windows from being explained.

use super::fans::Fans;
use super::first::Quality;
use super::ground::Ground;
use super::patches::Blended;
use super::rough::{self, Noise};
use super::samples::Sampler;
use super::{CHUNK, Worker, blended_value, scale, seeds, steady};
use crate::curvature::{CurvatureOptions, FaceCurvature, Method};
use crate::mesh::{Face, FaceState, Mesh};
use rayon::prelude::*;

/// True where the values of a face may be off because no surface explains its window.
pub(super) fn is_doubtful((value, quality): (&FaceCurvature, &Quality)) -> bool {
    quality.is_doubtful && value.method == Method::Fit
}

/// True for large surfaces of which nearly all windows are noisy.
pub(super) fn is_all_over(mesh: &Mesh, worker: &mut Worker<'_>) -> bool {
    /// Fewer faces are looked at one by one.
    const LEAST: usize = 20_000;
    mesh.face_count() >= LEAST && is_everywhere(mesh, worker)
}

/// True where nearly all windows are noisy, as faces here and there tell.
pub(super) fn is_everywhere(mesh: &Mesh, worker: &mut Worker<'_>) -> bool {
    /// Faces of a first and a second look, and how many of them must be doubtful.
    const LOOKS: [(usize, f64); 2] = [(64, 0.9), (1024, 0.95)];
    LOOKS.into_iter().all(|(count, least)| {
        let faces = (0..mesh.face_count()).step_by((mesh.face_count() / count).max(1)).map(|f| f as u32);
        let (mut fitted, mut doubtful) = (0, 0);
        for f in faces.filter(|&f| mesh.face_state(Face(f)) == FaceState::Sound) {
            let mut value = FaceCurvature::NOT_ESTIMATED;
            let quality = worker.first_of(Face(f), &mut value);
            fitted += usize::from(value.method == Method::Fit);
            doubtful += usize::from(is_doubtful((&value, &quality)));
        }
        fitted > count / 2 && doubtful as f64 > least * fitted as f64
    })
}

/// The values of all faces of a surface that is noisy all over.
pub(super) fn estimate<'g>(
    ground: &Ground<'g>,
    options: &CurvatureOptions,
    worker: impl Fn() -> Worker<'g> + Sync,
    out: &mut [FaceCurvature],
) {
    let mesh = ground.mesh;
    let is_sound = |face: Face| mesh.face_state(face) == FaceState::Sound;
    // To fit small windows around every face would be in vain: only how much of them is there is told.
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(&worker, |worker, (chunk, out)| {
        let faces = (chunk * CHUNK..).map(|f| Face(f as u32)).zip(&mut *out);
        let sound = faces.filter(|(face, _)| is_sound(*face));
        sound.for_each(|(face, out)| out.coverage = worker.surveyor.coverage(face));
        ground.work.advance_by(0.1, out.len(), mesh.face_count());
    });
    let wanted: Vec<bool> = (0..out.len() as u32).map(|f| is_sound(Face(f))).collect();
    look_wider(ground, options, &wanted, true, out);
    out.par_chunks_mut(CHUNK).enumerate().for_each_init(&worker, |worker, (chunk, out)| {
        ground.work.advance(0);
        let faces = (chunk * CHUNK..).map(|f| Face(f as u32)).zip(out);
        for (face, out) in faces.filter(|(face, out)| is_sound(*face) && !out.is_estimated()) {
            worker.first_of(face, out);
            doubt_the_lone(out);
        }
    });
    ground.work.finish();
}

/// Replaces the values of doubtful faces.
pub(super) fn settle(ground: &Ground<'_>, options: &CurvatureOptions, doubtful: Vec<bool>, out: &mut [FaceCurvature]) {
    let count = doubtful.iter().filter(|doubtful| **doubtful).count();
    if count == 0 {
        return;
    }
    let mut wanted = doubtful;
    let is_everywhere = 2 * count > out.iter().filter(|value| value.is_estimated()).count();
    if is_everywhere {
        // Noise makes some edges sharp, and leaves faces between them that nothing can be fitted to.
        let is_fine = scale::is_fine(ground.mesh);
        for (wanted, value) in wanted.iter_mut().zip(&mut *out) {
            *wanted |= is_fine && value.method == Method::Sections;
            doubt_the_lone(value);
        }
    }
    look_wider(ground, options, &wanted, is_everywhere, out);
}

/// A face alone between edges that noise has made sharp: its plane says nothing.
fn doubt_the_lone(value: &mut FaceCurvature) {
    if value.coverage == 0.0 {
        value.confidence = 0.0;
    }
}

/// Replaces the values that are `wanted` by what larger windows say, where they say anything. Where a fine mesh is noisy
/// everywhere, sharp edges are noise too if they leave no room for a window.
fn look_wider(
    ground: &Ground<'_>,
    options: &CurvatureOptions,
    wanted: &[bool],
    is_everywhere: bool,
    out: &mut [FaceCurvature],
) {
    /// Vertices without which there is no window.
    const LEAST: usize = 13;
    let seeds = seeds::seeds(ground, wanted);
    let fans = Fans::new(ground);
    let kind = rough::judge(&fans, &seeds, is_everywhere);
    let is_rough = kind == Noise::Rough;
    let values = if is_rough { Vec::new() } else { scale::estimate(&fans, &seeds, wanted, kind) };
    let mut left = wanted.to_vec();
    let replace = |values: Vec<Option<Blended>>, method: Method, left: &mut [bool], out: &mut [FaceCurvature]| {
        for ((out, value), left) in out.iter_mut().zip(values).zip(left) {
            if let Some(value) = value.filter(|_| std::mem::replace(left, false)) {
                *out = blended_value(out.coverage.into(), &value, method, options);
            }
        }
    };
    replace(values, Method::Patches, &mut left, out);
    if is_rough && is_everywhere {
        // Faces that fit by chance would stand out among the others.
        left.iter_mut().zip(&*out).for_each(|(left, value)| *left |= value.is_estimated());
    } else if !is_rough {
        if !is_everywhere || !scale::is_fine(ground.mesh) {
            return;
        }
        let mut sampler = Sampler::new(&fans);
        let mut is_cut_off = |f: usize| sampler.is_cut_off(Face(f as u32), LEAST);
        left.iter_mut().enumerate().for_each(|(f, left)| *left = *left && is_cut_off(f));
        if !left.contains(&true) {
            return;
        }
    }
    drop(fans);
    let ground = Ground::new(ground.mesh, true, ground.work);
    let fans = Fans::new(&ground);
    if is_rough {
        replace(steady::around_vertices(&fans, rough::window(&fans)), Method::Window, &mut left, out);
    } else {
        let values = scale::estimate(&fans, &seeds::seeds(&ground, &left), &left, kind);
        replace(values, Method::Patches, &mut left, out);
    }
}
