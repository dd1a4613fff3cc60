//! Surface patches around scattered seeds, blended over the faces they reach.
//!
//! The bias of second derivatives changes sign across a patch, so that the mean of several patches at a
//! face is better than one around it, and steadier.

use super::chord::Chord;
use super::ground::Ground;
use super::implicit::Implicit;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::polynomial::Symmetric;
use super::shape::Shape;
use super::stars::Lists;
use crate::mesh::Face;
use glam::DVec3;
use rayon::prelude::*;

/// A patch is evaluated up to this share of its window's radius.
pub(super) const REACH: f64 = 0.85;

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
    /// Expected error of its shape tensor, 1/length.
    pub(super) error: f64,
    /// Standard deviation of its samples, in file units.
    pub(super) noise: f64,
    /// The faces it reaches.
    pub(super) faces: Vec<u32>,
}

/// What patches or windows say about a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blended {
    pub(super) shape: Shape,
    pub(super) radius: f64,
    pub(super) error: f64,
}

impl Surface {
    /// Of the window.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Surface::Chord(chord) => chord.frame.unit,
            Surface::Implicit(implicit) => implicit.frame.unit,
        }
    }

    fn is_chord(&self) -> bool {
        matches!(self, Surface::Chord(_))
    }
}

/// Blends patches over the faces that are `wanted`; `None` where none reaches.
pub(super) fn blend(ground: &Ground<'_>, mut patches: Vec<Patch>, wanted: &[bool]) -> Vec<Option<Blended>> {
    // Patches of one kind are read four at a time.
    patches.sort_by_key(|patch| patch.surface.is_chord());
    let by_face = Lists::of_pairs(wanted.len(), || {
        let numbered = patches.iter().enumerate();
        numbered.flat_map(|(i, patch)| patch.faces.iter().map(move |&f| (f, i as u32)))
    });
    let blended = |f: u32| {
        let (centre, normal) = (ground.mesh.barycentre(Face(f)), ground.mesh.normal(Face(f)));
        let blend = BlendFace { centre, normal, patches: &patches, reaching: by_face.of(f) };
        wanted[f as usize].then(|| run(blend).value()).flatten()
    };
    (0..wanted.len() as u32).into_par_iter().map(blended).collect()
}

/// Blends the patches that reach a face.
struct BlendFace<'p> {
    centre: DVec3,
    normal: DVec3,
    patches: &'p [Patch],
    reaching: &'p [u32],
}

impl Kernel for BlendFace<'_> {
    type Output = Mean;

    #[inline(always)]
    fn run(self) -> Mean {
        let BlendFace { centre, normal, patches, reaching } = self;
        let of = |i: &u32| &patches[*i as usize];
        let (implicit, chords) = reaching.split_at(reaching.partition_point(|i| !of(i).surface.is_chord()));
        let mut sum = Mean::new();
        for some in implicit.chunks(LANES).chain(chords.chunks(LANES)) {
            let lane = |lane: usize| of(&some[lane.min(some.len() - 1)]);
            let four = [lane(0), lane(1), lane(2), lane(3)];
            let foot = match four.map(|patch| &patch.surface) {
                [Surface::Chord(a), Surface::Chord(b), Surface::Chord(c), Surface::Chord(d)] => {
                    Chord::feet([a, b, c, d], centre)
                }
                [Surface::Implicit(a), Surface::Implicit(b), Surface::Implicit(c), Surface::Implicit(d)] => {
                    Implicit::feet([a, b, c, d], centre)
                }
                _ => continue,
            };
            let mut way = V3::ZERO;
            for (lane, patch) in four.iter().enumerate() {
                way.set(lane, patch.centre - centre);
            }
            let radius = F4::of(four, |patch| patch.surface.radius());
            let error = F4::of(four, |patch| patch.error);
            let reach = radius * REACH;
            let inside = F4::ONE - way.dot(way) / (reach * reach);
            let n = foot.normal;
            let facing = n.x * normal.x + n.y * normal.y + n.z * normal.z;
            // A face far from the surface, for its noise, is no part of it.
            let far = foot.height / (F4::of(four, |patch| patch.noise) * 4.0 + radius * 0.05);
            let far = far * far * (far * far);
            let near = inside * inside * facing * facing;
            let weight = near / ((F4::ONE + far) * (error * error + F4::splat(1e-300)));
            for lane in 0..some.len() {
                let is_there = foot.upright.0[lane] > 0.0 && inside.0[lane] > 0.0 && facing.0[lane] > 0.0;
                let tensor = foot.tensor.lane(lane);
                if is_there && tensor.is_finite() && weight.0[lane].is_finite() {
                    sum.add(tensor, foot.normal.get(lane), radius.0[lane], error.0[lane], weight.0[lane]);
                }
            }
        }
        sum
    }
}

/// A weighted mean of shapes.
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
