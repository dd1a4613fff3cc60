//! Flat faces among surfaces that run out into them, as on CAD parts with fillets.
//!
//! A flat that is meshed from rim to rim has no vertices but those on its rims, which belong to the surfaces beyond as
//! well, so no window around it is flat. But the folds tell. Where facets with chords w1 and w2 lie on an arc of
//! curvature k, the surface turns by k (w1 + w2) / 2 from one to the other. Where it turns by k w1 / 2 only, the half
//! that belongs to the facet on the arc, the other one is tangent to the arc and does not bend.

use super::first::Quality;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::quantum::Quantum;
use crate::curvature::{FaceClass, FaceCurvature, Method};
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::DVec3;

/// Vertices of a flat lie in its plane to this many times the rounding of coordinates.
const ROUNDING: f64 = 4.0;
/// Normals of faces that turn by less belong to one flat.
const PARALLEL: f64 = 1e-5;
/// How far a fold may be from half the turn of the facet beyond, in shares of that.
const CLOSE: f64 = 0.1;
/// The same where the flat is so many times as large as the facets beyond: on one arc with them it would turn by far
/// more than the half. Triangles that halve cells which are not flat turn by a sixth more or less.
const LARGE: (f64, f64) = (4.0, 0.4);
/// A surface that touches a plane along a line does not bend along it; most curvature there, in shares of that across.
const STRAIGHT: f64 = 0.25;
/// Share of the folds around a flat, by length, that must be so.
const MOST: f64 = 0.6;
/// No flat's number: each has that of its first face.
const NONE: u32 = u32::MAX;

/// Gives faces no window explains the curvature of their plane, zero, where the folds around it say so.
pub(in crate::curvature::fit) fn settle(
    ground: &Ground<'_>,
    quantum: &Quantum,
    quality: &[Quality],
    out: &mut [FaceCurvature],
) {
    let mesh = ground.mesh;
    let is_open = |f: Face, out: &[FaceCurvature]| {
        quality[f.index()].is_open() && !is_sliver(mesh, f, quantum) && !matches!(out[f.index()].method, Method::Strip)
    };
    let mut flat_of = vec![NONE; mesh.face_count()];
    let (mut flat, mut folds, mut settled) = (Vec::new(), Vec::new(), Vec::<Face>::new());
    for seed in (0..mesh.face_count() as u32).map(Face) {
        if flat_of[seed.index()] != NONE || !is_open(seed, out) {
            continue;
        }
        collect(mesh, seed, quantum, &mut flat_of, &mut flat, &mut folds);
        if is_tangent_to_neighbours(mesh, &flat, &folds, quality, out) {
            settled.extend(flat.iter().filter(|&&face| is_open(face, out)));
        }
    }
    // Only now: what is told of one flat does not depend on others.
    for face in settled {
        out[face.index()] = flat_value(mesh, face, out[face.index()].coverage);
    }
}

/// All faces that hang together with the seed in one plane, slivers among them, and the half-edges at which they end in
/// a fold.
fn collect(
    mesh: &Mesh,
    seed: Face,
    quantum: &Quantum,
    flat_of: &mut [u32],
    flat: &mut Vec<Face>,
    folds: &mut Vec<HalfEdge>,
) {
    flat.clear();
    folds.clear();
    flat.push(seed);
    let (origin, normal, size) = (mesh.barycentre(seed), mesh.normal(seed), mesh.least_height(seed));
    // Small turns add up: a finely meshed surface is not one flat.
    let is_near = |p: DVec3| {
        let distance = p.distance(origin);
        let rounding = ROUNDING * quantum.around(origin, distance);
        (p - origin).dot(normal).abs() <= rounding * (1.0 + distance / size) + PARALLEL * distance
    };
    flat_of[seed.index()] = seed.0;
    let mut next = 0;
    while let Some(&face) = flat.get(next) {
        next += 1;
        for h in face.half_edges() {
            if mesh.edge_kind(h) != EdgeKind::Inner {
                continue;
            }
            let Some(twin) = mesh.topology().twin(h) else { continue };
            let other = twin.face();
            let is_sliver = [face, other].into_iter().any(|f| is_sliver(mesh, f, quantum));
            let is_level = is_sliver || is_coplanar(mesh, h, twin, quantum);
            if !is_level || !is_near(mesh.position(mesh.topology().apex(twin))) {
                folds.push(h);
            } else if flat_of[other.index()] == NONE {
                flat_of[other.index()] = seed.0;
                flat.push(other);
            } else if flat_of[other.index()] != seed.0 {
                // A sliver at a fold hangs together with the flats on both sides of it.
                folds.push(h);
            }
        }
    }
}

/// True where the normal of a face is that of rounding.
fn is_sliver(mesh: &Mesh, face: Face, quantum: &Quantum) -> bool {
    !mesh.is_sound(face) || mesh.least_height(face) <= ROUNDING * quantum.around(mesh.barycentre(face), 0.0)
}

/// True where rounding explains all that a fold turns.
fn is_coplanar(mesh: &Mesh, h: HalfEdge, twin: HalfEdge, quantum: &Quantum) -> bool {
    let normals = [h, twin].map(|h| mesh.normal(h.face()));
    let sine = normals[0].cross(normals[1]).length();
    let rounding = ROUNDING * quantum.around(mesh.barycentre(h.face()), 0.0);
    normals[0].dot(normals[1]) > 0.0
        && sine <= PARALLEL.max(rounding * (1.0 / mesh.height(h) + 1.0 / mesh.height(twin)))
}

/// True when at most of the folds, by length, all the surface turns is due to the facet beyond.
fn is_tangent_to_neighbours(
    mesh: &Mesh,
    flat: &[Face],
    folds: &[HalfEdge],
    quality: &[Quality],
    out: &[FaceCurvature],
) -> bool {
    let topology = mesh.topology();
    let normal = flat.first().map_or(DVec3::ZERO, |&f| mesh.normal(f));
    let area: f64 = flat.iter().map(|&f| mesh.area(f)).sum();
    let beyond: f64 = folds.iter().filter_map(|&h| Some(mesh.area(topology.twin(h)?.face()))).sum();
    let close = if area * folds.len() as f64 > LARGE.0 * beyond { LARGE.1 } else { CLOSE };
    let (mut all, mut tangent) = (0.0, 0.0);
    for &h in folds {
        let Some(twin) = topology.twin(h) else { continue };
        let other = twin.face();
        let [a, b] = [topology.origin(h), topology.target(h)].map(|v| mesh.position(v));
        let length = a.distance(b);
        all += length;
        let value = &out[other.index()];
        let is_known = match value.method {
            Method::OneSided | Method::Strip => true,
            Method::Fit => !quality[other.index()].is_open(),
            _ => false,
        };
        if !is_known {
            continue;
        }
        let normals = [normal, mesh.normal(other)];
        let across = normals[1].cross((b - a) / length);
        let share = across.dot(value.dir_max.as_dvec3()).powi(2).min(1.0);
        let (k_max, k_min) = (f64::from(value.k_max), f64::from(value.k_min));
        let (bend, along) = (k_max * share + k_min * (1.0 - share), k_min * share + k_max * (1.0 - share));
        if along.abs() > STRAIGHT * bend.abs() {
            continue;
        }
        let turn = normals[0].cross(normals[1]).length().atan2(normals[0].dot(normals[1]));
        // Positive where the surface bends away from the normals.
        let turn = turn * -(mesh.position(topology.apex(twin)) - a).dot(normals[0]).signum();
        let half = 0.5 * bend * mesh.height(twin);
        if half != 0.0 && half.is_finite() && (turn - half).abs() <= close * half.abs() {
            tangent += length;
        }
    }
    tangent > MOST * all
}

fn flat_value(mesh: &Mesh, face: Face, coverage: f32) -> FaceCurvature {
    let [a, b, c] = mesh.triangle(face);
    let sides = [b - a, c - b, a - c];
    let longest = sides.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    let along = longest.unwrap_or(DVec3::X).normalize_or_zero();
    let centre = mesh.barycentre(face);
    let radius = [a, b, c].map(|p| p.distance(centre)).into_iter().fold(0.0, f64::max);
    FaceCurvature {
        k_max: 0.0,
        k_min: 0.0,
        dir_max: along.as_vec3(),
        dir_min: mesh.normal(face).cross(along).as_vec3(),
        radius: radius as f32,
        coverage,
        confidence: 1.0,
        method: Method::Flat,
        class: FaceClass::Flat,
        ..FaceCurvature::NOT_ESTIMATED
    }
}
