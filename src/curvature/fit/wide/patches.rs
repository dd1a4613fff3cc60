//! Surface patches around scattered seeds, blended over the faces they reach.
//!
//! The bias of second derivatives changes sign across a patch, so that the mean of several patches at a
//! face is better than one around it, and steadier.

use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::lists::Lists;
use crate::curvature::fit::surface::chord::Chord;
use crate::curvature::fit::surface::foot::{Below, Sides};
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::fit::surface::implicit::Implicit;
use crate::curvature::fit::surface::polynomial::Symmetric;
use crate::curvature::fit::surface::shape::Shape;
use crate::curvature::vectors::four::{F4, Kernel, LANES, V3, run};
use crate::mesh::Face;
use glam::DVec3;
use rayon::prelude::*;

/// A fitted surface of either kind.
#[derive(Clone, Copy)]
pub(super) enum Surface {
    Chord(Chord),
    Implicit(Implicit),
}

pub(super) struct Patch {
    /// Of the seed's face.
    pub(super) centre: DVec3,
    pub(super) surface: Surface,
    /// How far from the centre it is evaluated.
    pub(super) reach: f64,
    /// Expected error of its shape tensor, 1/length.
    pub(super) error: f64,
    /// What it has little weight for: the expected error. Under noise that is alike at neighbouring samples, that by
    /// independent samples: the true one is known from few fits, and patches that seem good by chance would prevail.
    pub(super) doubt: f64,
    /// Standard deviation of its samples, in file units.
    pub(super) noise: f64,
    /// The faces it reaches, chunk by chunk: see [`by_chunk`].
    pub(super) faces: Vec<u32>,
}

/// What patches or windows say about a face.
#[derive(Clone, Copy, Debug)]
pub(in crate::curvature::fit) struct Blended {
    pub(in crate::curvature::fit) shape: Shape,
    pub(in crate::curvature::fit) radius: f64,
    pub(in crate::curvature::fit) error: f64,
}

impl Surface {
    /// Of the window.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Surface::Chord(chord) => chord.frame.unit,
            Surface::Implicit(implicit) => implicit.frame.unit,
        }
    }
}

/// Faces that are blended at once.
const CHUNK: usize = 1024;

/// Faces in the order in which patches keep those they reach.
pub(super) fn by_chunk(mut faces: Vec<u32>) -> Vec<u32> {
    faces.sort_unstable_by_key(|&f| chunk_of(f));
    faces
}

impl Patch {
    /// The chunks in which it reaches faces.
    fn chunks(&self) -> impl Iterator<Item = u32> {
        self.faces.chunk_by(|&a, &b| chunk_of(a) == chunk_of(b)).map(|faces| chunk_of(faces[0]))
    }

    /// Its faces in a chunk.
    fn faces_of(&self, chunk: u32) -> &[u32] {
        let start = self.faces.partition_point(|&f| chunk_of(f) < chunk);
        let count = self.faces[start..].partition_point(|&f| chunk_of(f) == chunk);
        &self.faces[start..start + count]
    }
}

fn chunk_of(face: u32) -> u32 {
    face / CHUNK as u32
}

/// Blends patches over the faces that they reach; `None` where none does, of `count` faces.
pub(super) fn blend(ground: &Ground<'_>, patches: &[Patch], count: usize) -> Vec<Option<Blended>> {
    let by_chunk = Lists::of_pairs(count.div_ceil(CHUNK), || {
        let numbered = patches.iter().enumerate();
        numbered.flat_map(|(i, patch)| patch.chunks().map(move |chunk| (chunk, i as u32)))
    });
    let mut blended = vec![None; count];
    blended.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
        let first = (chunk * CHUNK) as u32;
        let faces: Vec<(DVec3, DVec3)> = (first..)
            .map(Face)
            .take(out.len())
            .map(|face| (ground.mesh.barycentre(face), ground.mesh.normal(face)))
            .collect();
        let mut sums = vec![Mean::new(); out.len()];
        for &i in by_chunk.of(chunk as u32) {
            let patch = &patches[i as usize];
            run(AddPatch { patch, reached: patch.faces_of(chunk as u32), first, faces: &faces, sums: &mut sums });
        }
        out.iter_mut().zip(&sums).for_each(|(out, sum)| *out = sum.value());
    });
    blended
}

/// Adds what a patch says about faces it reaches, four at a time.
struct AddPatch<'a> {
    patch: &'a Patch,
    reached: &'a [u32],
    /// Of the faces whose barycentres, normals and sums these are.
    first: u32,
    faces: &'a [(DVec3, DVec3)],
    sums: &'a mut [Mean],
}

impl Kernel for AddPatch<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        match &self.patch.surface {
            Surface::Chord(chord) => self.add(&chord.frame, &chord.side_by_side()),
            Surface::Implicit(implicit) => self.add(&implicit.frame, &implicit.side_by_side()),
        }
    }
}

impl AddPatch<'_> {
    #[inline(always)]
    fn add(self, frame: &LocalFrame, surface: &impl Below) {
        let AddPatch { patch, reached, first, faces, sums } = self;
        let sides = Sides::of(frame);
        let Patch { centre, reach, error, doubt, noise, .. } = *patch;
        let radius = frame.unit;
        // At this height over the surface, for its noise, a face has half the weight.
        let far_height = noise * 4.0 + radius * 0.05;
        let certain = 1e-9 / radius;
        for some in reached.chunks(LANES) {
            let at = |lane: usize| (some[lane.min(some.len() - 1)] - first) as usize;
            let (mut way, mut normal) = (V3::ZERO, V3::ZERO);
            for lane in 0..LANES {
                let (barycentre, upright) = faces[at(lane)];
                way.set(lane, barycentre - centre);
                normal.set(lane, upright);
            }
            let foot = sides.in_space(&surface.foot(sides.to_local(way, centre)));
            let inside = F4::ONE - way.dot(way) * (1.0 / (reach * reach));
            let facing = foot.normal.dot(normal);
            // A face far from the surface is no part of it.
            let far = foot.height * (1.0 / far_height);
            let far = far * far * (far * far);
            let weight =
                inside * inside * facing * facing * (1.0 / (doubt * doubt + certain * certain)) / (F4::ONE + far);
            for (lane, &face) in some.iter().enumerate() {
                let is_there = foot.upright.0[lane] > 0.0 && inside.0[lane] > 0.0 && facing.0[lane] > 0.0;
                let tensor = foot.tensor.lane(lane);
                if is_there && tensor.is_finite() && weight.0[lane].is_finite() {
                    let sum = &mut sums[(face - first) as usize];
                    sum.add(tensor, foot.normal.get(lane), radius, error, weight.0[lane]);
                }
            }
        }
    }
}

/// A weighted mean of shapes.
#[derive(Clone)]
pub(super) struct Mean {
    tensor: Symmetric<f64>,
    normal: DVec3,
    radius: f64,
    error: f64,
    weight: f64,
}

impl Mean {
    pub(super) fn new() -> Self {
        Mean { tensor: Symmetric::ZERO, normal: DVec3::ZERO, radius: 0.0, error: 0.0, weight: 0.0 }
    }

    #[inline(always)]
    pub(super) fn add(&mut self, tensor: Symmetric<f64>, normal: DVec3, radius: f64, error: f64, weight: f64) {
        self.tensor = self.tensor.plus(tensor.scaled(weight));
        self.normal += normal * weight;
        self.radius += radius * weight;
        self.error += error * weight;
        self.weight += weight;
    }

    pub(super) fn value(&self) -> Option<Blended> {
        let normal = self.normal.try_normalize()?;
        let share = 1.0 / self.weight;
        let tensor = self.tensor.scaled(share).projected(normal.into());
        let is_value = tensor.is_finite() && self.weight > 0.0;
        is_value.then(|| Blended {
            shape: Shape { normal, tensor: tensor.into() },
            radius: self.radius * share,
            error: self.error * share,
        })
    }
}
