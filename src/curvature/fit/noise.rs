//! What is done where noise keeps small windows from being explained.

use super::around::samples::Sampler;
use super::ground::Ground;
use super::ground::fans::Fans;
use super::ground::seeds;
use super::small::first::Quality;
use super::wide::kind::Noise;
use super::wide::patches::Blended;
use super::wide::{rough, scale, steady};
use super::{CHUNK, Worker, blended_value};
use crate::curvature::{CurvatureOptions, FaceCurvature, Method};
use crate::mesh::{Face, Mesh};
use rayon::prelude::*;

/// Share of doubtful faces from which on noise is what the surface has in common; below, the rest of it is clean.
const WIDESPREAD: f64 = 0.5;

/// True where the values of a face may be off because no surface explains its window.
pub(super) fn is_doubtful((value, quality): (&FaceCurvature, &Quality)) -> bool {
    quality.is_doubtful && value.method == Method::Fit
}

/// Faces from which on a look at some of them may spare the look at all.
pub(super) const MANY: usize = 20_000;

/// True where nearly all windows are noisy, as faces here and there tell.
pub(super) fn is_everywhere(mesh: &Mesh, worker: &mut Worker<'_>) -> bool {
    /// Faces of a first and a second look, and how many of them must be doubtful.
    const LOOKS: [(usize, f64); 2] = [(64, 0.9), (1024, 0.95)];
    LOOKS.into_iter().all(|(count, least)| {
        let faces = (0..mesh.face_count()).step_by((mesh.face_count() / count).max(1)).map(|f| f as u32);
        let (mut fitted, mut doubtful) = (0, 0);
        for f in faces.filter(|&f| mesh.is_sound(Face(f))) {
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
    let is_sound = |face: Face| mesh.is_sound(face);
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
    let estimated = out.iter().filter(|value| value.is_estimated()).count();
    let is_widespread = count as f64 > WIDESPREAD * estimated as f64;
    if is_widespread {
        // Noise makes some edges sharp, and leaves faces between them that nothing can be fitted to.
        let is_fine = rough::is_fine(ground.mesh);
        for (wanted, value) in wanted.iter_mut().zip(&mut *out) {
            *wanted |= is_fine && value.method == Method::Sections;
            doubt_the_lone(value);
        }
    }
    look_wider(ground, options, &wanted, is_widespread, out);
}

/// A face alone between edges that noise has made sharp: its plane says nothing.
fn doubt_the_lone(value: &mut FaceCurvature) {
    if value.coverage == 0.0 {
        value.confidence = 0.0;
    }
}

/// Replaces the values that are `wanted` by what larger windows say, where they say anything.
fn look_wider(
    ground: &Ground<'_>,
    options: &CurvatureOptions,
    wanted: &[bool],
    is_widespread: bool,
    out: &mut [FaceCurvature],
) {
    let seeds = seeds::seeds(ground, wanted);
    let fans = Fans::new(ground);
    let kind = rough::judge(&fans, &seeds, is_widespread);
    let mut left = Left { wanted: wanted.to_vec(), options };
    if kind == Noise::Rough {
        if is_widespread {
            // Faces that fit by chance would stand out among the others.
            left.wanted.iter_mut().zip(&*out).for_each(|(wanted, value)| *wanted |= value.is_estimated());
        }
        drop(fans);
        // Sharp edges are rough, too.
        let ground = Ground::new(ground.mesh, true, ground.work);
        let fans = Fans::new(&ground);
        let window = rough::window(&fans, &left.wanted);
        return left.replace(steady::around_vertices(&fans, window, &left.wanted), Method::Window, out);
    }
    left.replace(scale::estimate(&fans, &seeds, wanted, kind), Method::Patches, out);
    if is_widespread && rough::is_fine(ground.mesh) {
        // Noise has made edges sharp that leave no room for a window.
        left.keep_cut_off(&fans);
        drop(fans);
        if left.wanted.contains(&true) {
            let ground = Ground::new(ground.mesh, true, ground.work);
            let seeds = seeds::seeds(&ground, &left.wanted);
            left.replace(scale::estimate(&Fans::new(&ground), &seeds, &left.wanted, kind), Method::Patches, out);
        }
    }
}

/// Faces whose values larger windows are to replace.
struct Left<'o> {
    wanted: Vec<bool>,
    options: &'o CurvatureOptions,
}

impl Left<'_> {
    fn replace(&mut self, values: Vec<Option<Blended>>, method: Method, out: &mut [FaceCurvature]) {
        for ((out, value), wanted) in out.iter_mut().zip(values).zip(&mut self.wanted) {
            if let Some(value) = value.filter(|_| std::mem::replace(wanted, false)) {
                *out = blended_value(out.coverage.into(), &value, method, self.options);
            }
        }
    }

    /// Of these only the ones between whose sharp edges and borders there are too few vertices for a window.
    fn keep_cut_off(&mut self, fans: &Fans<'_>) {
        /// Samples of a cubic, with some to spare.
        const LEAST: usize = 13;
        let mut sampler = Sampler::new(fans);
        for (f, wanted) in self.wanted.iter_mut().enumerate().filter(|(_, wanted)| **wanted) {
            *wanted = sampler.is_cut_off(Face(f as u32), LEAST);
        }
    }
}
