//! Surface patches around scattered seeds, blended over the faces they reach.
//!
//! The bias of second derivatives changes sign across a patch, so that the mean of several patches at a
//! face is better than one around it, and steadier.

use super::chord::Chord;
use super::ground::Ground;
use super::implicit::Implicit;
use super::shape::Shape;
use super::stars::Lists;
use crate::mesh::Face;
use glam::{DMat3, DVec3};
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
    pub(super) seed: Face,
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

impl Patch {
    fn radius(&self) -> f64 {
        self.surface.radius()
    }
}

impl Surface {
    /// Of the window.
    pub(super) fn radius(&self) -> f64 {
        match self {
            Surface::Chord(chord) => chord.frame.unit,
            Surface::Implicit(implicit) => implicit.frame.unit,
        }
    }

    /// Height of a point over the surface and the shape there.
    fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        match self {
            Surface::Chord(chord) => chord.shape_at(point),
            Surface::Implicit(implicit) => Some((implicit.distance(point), implicit.shape_at(point)?)),
        }
    }
}

/// Blends patches over the faces that are `wanted`; `None` where none reaches.
pub(super) fn blend(ground: &Ground<'_>, patches: &[Patch], wanted: &[bool]) -> Vec<Option<Blended>> {
    let by_face = Lists::of_pairs(wanted.len(), || {
        let numbered = patches.iter().enumerate();
        numbered.flat_map(|(i, patch)| patch.faces.iter().map(move |&f| (f, i as u32)))
    });
    let blended = |f: u32| {
        let reaching = by_face.of(f).iter().map(|&i| &patches[i as usize]);
        wanted[f as usize].then(|| blend_face(ground, Face(f), reaching)).flatten()
    };
    (0..wanted.len() as u32).into_par_iter().map(blended).collect()
}

fn blend_face<'p>(ground: &Ground<'_>, face: Face, patches: impl Iterator<Item = &'p Patch>) -> Option<Blended> {
    let mesh = ground.mesh;
    let (centre, normal) = (mesh.barycentre(face), mesh.normal(face));
    let mut sum = Mean::new();
    for patch in patches {
        let radius = patch.radius();
        let x = mesh.barycentre(patch.seed).distance_squared(centre) / (REACH * radius).powi(2);
        let Some((height, shape)) = patch.surface.shape_at(centre) else { continue };
        let facing = shape.normal.dot(normal);
        if x >= 1.0 || facing <= 0.0 {
            continue;
        }
        // A face far from the surface, for its noise, is no part of it.
        let far = height / (4.0 * patch.noise + 0.05 * radius);
        let weight = (1.0 - x).powi(2) * facing * facing / (1.0 + far.powi(4)) / (patch.error * patch.error + 1e-300);
        sum.add(&Blended { shape, radius, error: patch.error }, weight);
    }
    sum.value()
}

/// A weighted mean of shapes.
pub(super) struct Mean {
    tensor: DMat3,
    normal: DVec3,
    radius: f64,
    error: f64,
    weight: f64,
}

impl Mean {
    pub(super) fn new() -> Self {
        Mean { tensor: DMat3::ZERO, normal: DVec3::ZERO, radius: 0.0, error: 0.0, weight: 0.0 }
    }

    pub(super) fn add(&mut self, value: &Blended, weight: f64) {
        self.tensor += value.shape.tensor * weight;
        self.normal += value.shape.normal * weight;
        self.radius += value.radius * weight;
        self.error += value.error * weight;
        self.weight += weight;
    }

    pub(super) fn value(&self) -> Option<Blended> {
        let normal = self.normal.try_normalize()?;
        let projection = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let share = 1.0 / self.weight;
        let tensor = projection * (self.tensor * share) * projection;
        let finite = tensor.is_finite() && self.weight > 0.0;
        finite.then_some(Blended {
            shape: Shape { normal, tensor },
            radius: self.radius * share,
            error: self.error * share,
        })
    }
}
