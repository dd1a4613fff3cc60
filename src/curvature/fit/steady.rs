//! Windows of one size for a whole mesh: the same linear measurement everywhere.
//!
//! For surfaces that are rough at every scale, and for a radius that the user has given.

use super::chord::ChordFit;
use super::frame::Frame;
use super::ground::Ground;
use super::patches::{Blended, Mean};
use super::samples::Sampler;
use super::shape::Shape;
use crate::mesh::Face;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Vertices in the window of a rough surface: about six edges around.
pub(super) const ROUGH_WINDOW: usize = 120;
/// Least number of vertices in a window of given radius, where the patch has them.
const LEAST: usize = 16;

/// The values of all faces of a rough surface: a paraboloid in chord coordinates around every vertex,
/// averaged over each face's corners.
pub(super) fn around_vertices(ground: &Ground<'_>) -> Vec<Option<Blended>> {
    let mesh = ground.mesh;
    let at_vertices: Vec<Option<Blended>> = (0..mesh.positions().len() as u32)
        .into_par_iter()
        .map_init(
            || Sampler::new(ground),
            |sampler, v| {
                ground.progress.advance(0);
                if ground.stars.neighbours(v).is_empty() {
                    return None;
                }
                let centre = mesh.positions()[v as usize];
                sampler.start_at(v);
                let frame = sampler.take_nearest(centre, ROUGH_WINDOW)?;
                weighted(sampler, frame, centre, 2)
            },
        )
        .collect();
    (0..mesh.face_count() as u32)
        .into_par_iter()
        .map(|f| {
            let mut mean = Mean::new();
            for v in mesh.topology().corners(Face(f)) {
                if let Some(value) = &at_vertices[v.index()] {
                    mean.add(value, 1.0);
                }
            }
            mean.value()
        })
        .collect()
}

/// The value of a face from all vertices within a radius of its barycentre; exactly flat where they all
/// lie in its plane, as well as coordinates rounded by `quantum` tell.
pub(super) fn within(sampler: &mut Sampler<'_>, face: Face, radius: f64, quantum: f64) -> Option<Blended> {
    let mesh = sampler.ground.mesh;
    let (centre, normal) = (mesh.barycentre(face), mesh.normal(face));
    sampler.start(face);
    let frame = sampler.take_within(centre, radius, LEAST)?;
    // The rounding of the face's corners tilts its plane, more at a distance.
    let reach = 4.0 * quantum * (1.0 + frame.unit / mesh.least_height(face)) + 1e-14 * frame.unit;
    if sampler.points.iter().all(|&p| (p - centre).dot(normal).abs() <= reach) {
        let shape = Shape { normal, tensor: DMat3::ZERO };
        return Some(Blended { shape, radius: frame.unit, error: 0.0 });
    }
    weighted(sampler, frame, centre, 4)
}

/// A chord fit with weights that fall towards the rim, of the highest degree up to `degree` that the
/// samples carry several times over.
fn weighted(sampler: &mut Sampler<'_>, frame: Frame, centre: DVec3, degree: usize) -> Option<Blended> {
    sampler.weigh(&frame);
    let carried = match sampler.points.len() {
        0..24 => 2,
        24..45 => 3,
        _ => 4,
    };
    let degree = degree.min(carried);
    let fit = ChordFit::weighted(frame, &sampler.points, &sampler.weights, degree, 2, &mut sampler.rows)?;
    let degree = fit.highest();
    let (_, shape) = fit.surface(degree).shape_at(centre)?;
    let error = (fit.deviation_squared(degree) * fit.tensor_variance(degree)).sqrt();
    Some(Blended { shape, radius: frame.unit, error })
}
