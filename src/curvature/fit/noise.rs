//! Noisy surfaces: patches in windows of a size that balances noise against detail, blended.

use super::chord::{Chord, ChordFit};
use super::exact::frame_for;
use super::least_squares::Rows;
use super::shape::Shape;
use super::window::{Stars, Window};
use crate::mesh::{Face, FaceState, Mesh};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Vertices per window, by level.
const LEVELS: [usize; 6] = [28, 48, 81, 138, 234, 398];
const DEGREES: [usize; 2] = [3, 4];
/// Two chord polynomials and a cyclide per level.
const MODELS: usize = DEGREES.len() + 1;
const CANDIDATES: usize = LEVELS.len() * MODELS;
/// Terms of a Darboux cyclide.
const CYCLIDE: usize = 13;
/// A patch is evaluated up to this share of its window's radius.
const REACH: f64 = 0.85;
/// Growth of the residual from one level to the next (squared) from which it is detail, not noise.
const SMOOTH: f64 = 6.8;
const ROUGH: f64 = 1.5;
/// A surface that shows detail at every scale is trusted to this share of an edge only.
const ROUGH_NOISE: f64 = 0.04;
const CHUNK: usize = 64;

/// What a blend of patches says about a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blended {
    pub(super) shape: Shape,
    pub(super) radius: f64,
    /// Standard error of the tensor.
    pub(super) error: f64,
}

/// A seed's fits at every level.
struct Probe {
    seed: Face,
    /// Upper triangles of shape tensors; NaN where there is no fit.
    tensors: [[f64; 6]; CANDIDATES],
    /// Variances of the tensors for samples of unit variance.
    variances: [f64; CANDIDATES],
    /// Variance of samples about each candidate; infinite where there is no fit.
    misfits: [f64; CANDIDATES],
    /// The least of them by level.
    deviations: [f64; LEVELS.len()],
    /// Edge length, roughly.
    spacing: f64,
    neighbours: Vec<u32>,
}

#[derive(Clone, Copy)]
enum Surface {
    Chord(Chord),
    Implicit(super::implicit::Implicit),
}

impl Surface {
    fn radius(&self) -> f64 {
        match self {
            Surface::Chord(c) => c.frame.unit,
            Surface::Implicit(i) => i.frame.unit,
        }
    }

    fn shape_at(&self, point: DVec3) -> Option<(f64, Shape)> {
        match self {
            Surface::Chord(c) => c.shape_at(point),
            Surface::Implicit(i) => Some((i.distance(point), i.shape_at(point)?)),
        }
    }
}

struct Patch {
    surface: Surface,
    error: f64,
    noise: f64,
}

struct Worker {
    window: Window,
    rows: Rows,
    order: Vec<(f64, u32)>,
    samples: Vec<DVec3>,
}

impl Worker {
    fn new() -> Self {
        Worker { window: Window::new(), rows: Rows::new(), order: Vec::new(), samples: Vec::new() }
    }
}

pub(super) struct Noisy<'m> {
    pub(super) mesh: &'m Mesh,
    pub(super) stars: &'m Stars,
    pub(super) ignore_features: bool,
    pub(super) normals: Vec<glam::Vec3>,
}

impl Noisy<'_> {
    /// Values from windows of one radius for all faces.
    pub(super) fn at_scale(&self, wanted: &[bool], radius: f64, degree: usize) -> Vec<Option<Blended>> {
        let seeds = self.seeds(wanted);
        let patches: Vec<Option<Patch>> = seeds
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                let mut worker = Worker::new();
                chunk.iter().map(move |&seed| self.patch_at_scale(seed, radius, degree, &mut worker)).collect::<Vec<_>>()
            })
            .collect();
        self.blend(&seeds, &patches, wanted)
    }

    fn patch_at_scale(&self, seed: Face, radius: f64, degree: usize, worker: &mut Worker) -> Option<Patch> {
        if radius < 0.0 {
            worker.window.start(self.mesh, seed);
            let reached = self.gather(seed, -radius as usize, worker);
            let normal: glam::Vec3 = worker.order[..worker.samples.len()].iter().map(|&(_, v)| self.normals[v as usize]).sum();
            let frame = frame_for(self.mesh.barycentre(seed), normal.as_dvec3(), worker.samples.iter().copied())?;
            let frame = super::implicit::Frame { unit: reached, ..frame };
            let normal = normal.normalize_or_zero();
            let weights: Vec<f64> = worker.order[..worker.samples.len()].iter().map(|&(d, v)| {
                let facing = f64::from(self.normals[v as usize].normalize_or_zero().dot(normal)).max(0.0);
                (1.0 - 0.999 * d / (reached * reached)).max(0.0) * facing
            }).collect();
            let fit = ChordFit::weighted(frame, &worker.samples, &weights, 2, &mut worker.rows)?;
            let degree = degree.min(fit.highest());
            return Some(Patch { surface: Surface::Chord(fit.surface(degree)), error: 1.0, noise: fit.deviation_squared(degree).sqrt() });
        }
        let centre = self.mesh.barycentre(seed);
        worker.window.start(self.mesh, seed);
        loop {
            let before = worker.window.vertices.len();
            worker.window.add_ring(self.mesh, self.stars, self.ignore_features);
            let near = |v: u32| self.mesh.positions()[v as usize].distance_squared(centre) <= radius * radius;
            if worker.window.exhausted || !worker.window.vertices[before..].iter().any(|&v| near(v)) {
                break;
            }
        }
        let count = worker.window.vertices.iter().filter(|&&v| self.mesh.positions()[v as usize].distance_squared(centre) <= radius * radius).count();
        let known = worker.window.vertices.len();
        let reached = self.nearest(seed, count.max(12).min(known), worker);
        let normal: glam::Vec3 = worker.order[..worker.samples.len()].iter().map(|&(_, v)| self.normals[v as usize]).sum();
        let frame = frame_for(centre, normal.as_dvec3(), worker.samples.iter().copied())?;
        let frame = super::implicit::Frame { unit: reached.max(radius), ..frame };
        let fit = ChordFit::new(frame, &worker.samples, 2, &mut worker.rows)?;
        let degree = degree.min(fit.highest());
        Some(Patch { surface: Surface::Chord(fit.surface(degree)), error: 1.0, noise: fit.deviation_squared(degree).sqrt() })
    }

    /// Values from a window around every vertex, averaged over each face's corners.
    pub(super) fn at_vertices(&self, count: usize, degree: usize) -> Vec<Option<Blended>> {
        let mesh = self.mesh;
        let shapes: Vec<Option<(Shape, f64)>> = (0..mesh.positions().len() as u32)
            .into_par_iter()
            .map_init(Worker::new, |worker, v| {
                if self.stars.of(v).is_empty() {
                    return None;
                }
                worker.window.start_at(mesh, self.stars, v);
                worker.window.grow_to(mesh, self.stars, self.ignore_features, count + count / 2);
                let centre = mesh.positions()[v as usize];
                worker.order.clear();
                worker.order.extend(worker.window.vertices.iter().map(|&v| (mesh.positions()[v as usize].distance_squared(centre), v)));
                let count = count.min(worker.order.len());
                worker.order.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                let order = &worker.order[..count];
                let reached = order[count - 1].0;
                let normal: glam::Vec3 = order.iter().map(|&(_, v)| self.normals[v as usize]).sum();
                let unit_normal = normal.normalize_or_zero();
                worker.samples.clear();
                worker.samples.extend(order.iter().map(|&(_, v)| mesh.positions()[v as usize]));
                let weights: Vec<f64> = order.iter().map(|&(d, v)| {
                    let facing = f64::from(self.normals[v as usize].normalize_or_zero().dot(unit_normal)).max(0.0);
                    (1.0 - 0.999 * d / reached).max(0.0) * facing
                }).collect();
                let frame = frame_for(centre, normal.as_dvec3(), worker.samples.iter().copied())?;
                let frame = super::implicit::Frame { unit: reached.sqrt(), ..frame };
                let fit = ChordFit::weighted(frame, &worker.samples, &weights, 2, &mut worker.rows)?;
                let (_, shape) = fit.surface(degree.min(fit.highest())).shape_at(centre)?;
                Some((shape, reached.sqrt()))
            })
            .collect();
        (0..mesh.face_count() as u32).into_par_iter().map(|f| {
            let (mut tensor, mut direction, mut radius, mut total) = (DMat3::ZERO, DVec3::ZERO, 0.0, 0.0);
            for v in mesh.topology().corners(Face(f)) {
                if let Some((shape, r)) = &shapes[v.index()] {
                    tensor += shape.tensor;
                    direction += shape.normal;
                    radius += r;
                    total += 1.0;
                }
            }
            let normal = direction.try_normalize()?;
            let projection = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
            Some(Blended { shape: Shape { normal, tensor: projection * (tensor * (1.0 / total)) * projection }, radius: radius / total, error: 1.0 })
        }).collect()
    }

    /// Values for the faces that are `wanted`; `None` where the surface turns out smooth or no patch
    /// reaches.
    pub(super) fn estimate(&self, wanted: &[bool]) -> Vec<Option<Blended>> {
        let mesh = self.mesh;
        let seeds = self.seeds(wanted);
        let mut seed_of = vec![u32::MAX; mesh.face_count()];
        for (i, s) in seeds.iter().enumerate() {
            seed_of[s.index()] = i as u32;
        }
        let probes: Vec<Probe> = seeds
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                let mut worker = Worker::new();
                let seed_of = &seed_of;
                chunk.iter().map(move |&seed| self.probe(seed, seed_of, &mut worker)).collect::<Vec<_>>()
            })
            .collect();
        let patches: Vec<Option<Patch>> = probes
            .par_chunks(CHUNK)
            .flat_map_iter(|chunk| {
                let mut worker = Worker::new();
                let probes = &probes;
                chunk.iter().map(move |probe| self.choose(probe, probes, &mut worker)).collect::<Vec<_>>()
            })
            .collect();
        drop(probes);
        self.blend(&seeds, &patches, wanted)
    }

    /// Faces of which none shares a vertex with another: those whose number is the greatest around,
    /// where numbers are drawn from positions, so that the order of faces plays no part.
    fn seeds(&self, wanted: &[bool]) -> Vec<Face> {
        let mesh = self.mesh;
        let mix = |mut x: u64| {
            x = (x ^ (x >> 31)).wrapping_mul(0x7FB5_D329_728E_A185);
            x = (x ^ (x >> 27)).wrapping_mul(0x81DA_DEF4_BC2D_D44D);
            x ^ (x >> 33)
        };
        let draw = |f: u32| {
            let corners = mesh.triangle(Face(f));
            let sum = corners.iter().fold(0_u64, |sum, p| {
                sum.wrapping_add(p.to_array().iter().fold(0, |h, c| mix(h ^ c.to_bits())))
            });
            (mix(sum), f)
        };
        let takes_part = |f: u32| wanted[f as usize] && mesh.face_state(Face(f)) == FaceState::Sound;
        (0..mesh.face_count() as u32)
            .into_par_iter()
            .filter(|&f| takes_part(f))
            .filter(|&f| {
                let own = draw(f);
                let corners = mesh.topology().corners(Face(f));
                corners.iter().all(|v| self.stars.of(v.0).iter().all(|&g| !takes_part(g) || draw(g) <= own))
            })
            .map(Face)
            .collect()
    }

    /// Gathers the `count` nearest vertices of the seed's patch. Returns the radius of the window.
    fn gather(&self, seed: Face, count: usize, worker: &mut Worker) -> f64 {
        let mesh = self.mesh;
        if worker.window.faces.first() != Some(&seed.0) {
            worker.window.start(mesh, seed);
        }
        worker.window.grow_to(mesh, self.stars, self.ignore_features, count + count / 2);
        self.nearest(seed, count, worker)
    }

    /// Takes the `count` nearest of the window's vertices that face as the seed does.
    fn nearest(&self, seed: Face, count: usize, worker: &mut Worker) -> f64 {
        let mesh = self.mesh;
        let centre = mesh.barycentre(seed);
        let normal = mesh.normal(seed).as_vec3();
        let mean = {
            let corners = mesh.topology().corners(seed);
            let sum: glam::Vec3 = corners.iter().map(|v| self.normals[v.index()]).sum();
            if sum.length_squared() > 0.0 { sum } else { normal }
        };
        worker.order.clear();
        let facing = worker.window.vertices.iter().filter(|&&v| self.normals[v as usize].dot(mean) > 0.0);
        worker.order.extend(facing.map(|&v| (mesh.positions()[v as usize].distance_squared(centre), v)));
        let count = count.min(worker.order.len());
        if count == 0 {
            return 0.0;
        }
        let by_distance = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        worker.order.select_nth_unstable_by(count - 1, by_distance);
        worker.samples.clear();
        worker.samples.extend(worker.order[..count].iter().map(|&(_, v)| mesh.positions()[v as usize]));
        worker.order[count - 1].0.sqrt()
    }

    fn fit(&self, seed: Face, level: usize, worker: &mut Worker, known: Option<super::implicit::Frame>) -> Option<ChordFit> {
        let radius = self.gather(seed, LEVELS[level], worker);
        let (frame, rounds) = match known {
            Some(frame) => (super::implicit::Frame { unit: radius, ..frame }, 1),
            None => {
                let normal: glam::Vec3 = worker.order[..worker.samples.len()].iter().map(|&(_, v)| self.normals[v as usize]).sum();
                let frame = frame_for(self.mesh.barycentre(seed), normal.as_dvec3(), worker.samples.iter().copied())?;
                (super::implicit::Frame { unit: radius, ..frame }, 2)
            }
        };
        ChordFit::new(frame, &worker.samples, rounds, &mut worker.rows)
    }

    fn probe(&self, seed: Face, seed_of: &[u32], worker: &mut Worker) -> Probe {
        let mut probe = Probe {
            seed,
            tensors: [[f64::NAN; 6]; CANDIDATES],
            variances: [f64::INFINITY; CANDIDATES],
            misfits: [f64::INFINITY; CANDIDATES],
            deviations: [f64::INFINITY; LEVELS.len()],
            spacing: 0.0,
            neighbours: Vec::new(),
        };
        let centre = self.mesh.barycentre(seed);
        let mut frame = None;
        let mut least = f64::INFINITY;
        worker.window.start(self.mesh, seed);
        for level in 0..LEVELS.len() {
            let Some(fit) = self.fit(seed, level, worker, frame) else { break };
            frame = Some(fit.frame);
            if level == 0 {
                probe.spacing = fit.frame.unit * (3.63 / worker.samples.len() as f64).sqrt();
            }
            for (i, degree) in DEGREES.into_iter().enumerate() {
                if degree > fit.highest() {
                    continue;
                }
                let at = level * MODELS + i;
                if let Some((_, shape)) = fit.surface(degree).shape_at(centre) {
                    probe.tensors[at] = upper(shape.tensor);
                    probe.variances[at] = fit.tensor_variance(degree);
                    probe.misfits[at] = fit.deviation_squared(degree);
                }
            }
            let mut deviation = fit.deviation_squared(fit.highest());
            if level > 0
                && let Some((surface, factor, residual)) = cyclide(fit.frame, &worker.samples, deviation.sqrt(), &mut worker.rows)
                && let Some(shape) = surface.shape_at(centre)
            {
                let at = level * MODELS + DEGREES.len();
                probe.tensors[at] = upper(shape.tensor);
                let of = |at: usize| factor.variance(&std::array::from_fn(|i| f64::from(i == at)), CYCLIDE);
                probe.variances[at] = (4.0 * of(3) + 2.0 * of(4) + 4.0 * of(5)) / fit.frame.unit.powi(4);
                probe.misfits[at] = residual;
                if level >= 3 {
                    deviation = deviation.min(residual);
                }
            }
            probe.deviations[level] = deviation;
            least = least.min(deviation);
            if level < 2 {
                let reach = fit.frame.unit.powi(2) * if level == 0 { 4.0 } else { 2.0 };
                let mut near: Vec<(f64, u32)> = worker.window.faces.iter()
                    .filter(|&&f| seed_of[f as usize] != u32::MAX)
                    .map(|&f| (self.mesh.barycentre(Face(f)).distance_squared(centre), seed_of[f as usize]))
                    .filter(|n| n.0 <= reach)
                    .collect();
                near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                probe.neighbours = near.into_iter().take(16).map(|n| n.1).collect();
            }
            if worker.samples.len() < LEVELS[level] || deviation > 9.0 * least {
                break;
            }
        }
        probe
    }

    /// The window and degree for a seed, by Lepski's rule over it and its neighbours.
    fn choose(&self, probe: &Probe, probes: &[Probe], worker: &mut Worker) -> Option<Patch> {
        let around = || probe.neighbours.iter().map(|&i| &probes[i as usize]);
        let count = probe.neighbours.len() as f64;
        let mean = |f: &dyn Fn(&Probe) -> f64| {
            let (sum, n) = around().map(f).filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
            if n > 0.0 { sum / n } else { f64::NAN }
        };
        if count == 0.0 {
            return None;
        }
        let quartic = |p: &Probe, level: usize| p.misfits[level * MODELS + 1];
        let growth = mean(&|p| (quartic(p, 1) / quartic(p, 0)).ln()).exp();
        if growth > SMOOTH {
            return None;
        }
        let mut noise = mean(&|p| p.deviations.iter().copied().fold(f64::INFINITY, f64::min));
        if growth > ROUGH {
            noise = noise.max((ROUGH_NOISE * mean(&|p| p.spacing)).powi(2));
        }
        let variance: [f64; CANDIDATES] = std::array::from_fn(|j| {
            let level = j / MODELS;
            let s = if std::env::var_os("OWN").is_some() { mean(&|p| p.deviations[level]).max(noise) } else { noise };
            if probe.variances[j].is_finite() { s * mean(&|p| p.variances[j]) } else { f64::INFINITY }
        });
        let mut best = (f64::INFINITY, usize::MAX);
        // A cyclide is believed where it explains a large window better than a polynomial does.
        let believed = |j: usize| {
            let (level, model) = (j / MODELS, j % MODELS);
            model < DEGREES.len()
                || level >= 2 && mean(&|p| p.misfits[j]) < mean(&|p| p.misfits[level * MODELS + DEGREES.len() - 1])
        };
        let excess = |j: usize| {
            let samples = LEVELS[j / MODELS] as f64;
            (mean(&|p| p.misfits[j]) - noise * (1.0 + 2.0 * (2.0 / samples).sqrt())).max(0.0)
        };
        let witness: [bool; CANDIDATES] =
            std::array::from_fn(|i| i % MODELS < DEGREES.len() && variance[i].is_finite() && (i < 2 * MODELS || excess(i) == 0.0));
        for j in (0..CANDIDATES).filter(|&j| variance[j].is_finite() && believed(j)) {
            let mut bias = 0.0_f64;
            for i in (0..CANDIDATES).filter(|&i| witness[i] && variance[i] >= 1.15 * variance[j] && variance[i] <= 16.0 * variance[j]) {
                let between = mean(&|p| distance_squared(&p.tensors[i], &p.tensors[j]));
                bias = bias.max(between - (variance[i] - variance[j]));
            }
            // What a window does not explain is detail; it bends the fit as a whole.
            let samples = LEVELS[j / MODELS] as f64;
            let share = excess(j) / noise * samples / 13.0;
            let risk = variance[j] * (1.0 + share) + bias;
            if risk < best.0 {
                best = (risk, j);
            }
        }
        let (risk, at) = best;
        if at == usize::MAX {
            return None;
        }
        let (level, model) = (at / MODELS, at % MODELS);
        worker.window.start(self.mesh, probe.seed);
        let fit = self.fit(probe.seed, level, worker, None)?;
        if model == DEGREES.len() {
            let (surface, _, residual) = cyclide(fit.frame, &worker.samples, noise.sqrt(), &mut worker.rows)?;
            return Some(Patch { surface: Surface::Implicit(surface), error: risk.sqrt(), noise: residual.sqrt() });
        }
        let degree = DEGREES[model];
        Some(Patch { surface: Surface::Chord(fit.surface(degree.min(fit.highest()))), error: risk.sqrt(), noise: fit.deviation_squared(degree.min(fit.highest())).sqrt() })
    }

    fn blend(&self, seeds: &[Face], patches: &[Option<Patch>], wanted: &[bool]) -> Vec<Option<Blended>> {
        let mesh = self.mesh;
        // Which patches reach which faces, by seed.
        let reached: Vec<(u32, u32)> = seeds
            .par_iter()
            .zip(patches)
            .enumerate()
            .map_init(Worker::new, |worker, (i, (&seed, patch))| {
                let Some(patch) = patch else { return Vec::new() };
                let radius = REACH * patch.surface.radius();
                let centre = mesh.barycentre(seed);
                let near = |f: u32| mesh.barycentre(Face(f)).distance(centre) <= radius;
                worker.window.start(mesh, seed);
                loop {
                    let before = worker.window.faces.len();
                    worker.window.add_ring(mesh, self.stars, self.ignore_features);
                    if worker.window.exhausted || !worker.window.faces[before..].iter().any(|&f| near(f)) {
                        break;
                    }
                }
                let faces = worker.window.faces.iter().copied();
                faces.filter(|&f| wanted[f as usize] && near(f)).map(|f| (f, i as u32)).collect()
            })
            .collect::<Vec<_>>()
            .concat();
        let mut ends = vec![0_u32; mesh.face_count() + 1];
        for &(f, _) in &reached {
            ends[f as usize + 1] += 1;
        }
        for f in 1..ends.len() {
            ends[f] += ends[f - 1];
        }
        let mut by_face = vec![0_u32; reached.len()];
        let mut next = ends.clone();
        for &(f, seed) in &reached {
            by_face[next[f as usize] as usize] = seed;
            next[f as usize] += 1;
        }
        drop(reached);
        (0..mesh.face_count())
            .into_par_iter()
            .map(|f| {
                let mine = &by_face[ends[f] as usize..ends[f + 1] as usize];
                self.blend_face(Face(f as u32), mine, seeds, patches)
            })
            .collect()
    }

    fn blend_face(&self, face: Face, mine: &[u32], seeds: &[Face], patches: &[Option<Patch>]) -> Option<Blended> {
        let centre = self.mesh.barycentre(face);
        let normal = self.mesh.normal(face);
        let (mut tensor, mut direction, mut total) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        let (mut radius, mut error) = (0.0, 0.0);
        for &i in mine {
            let Some(patch) = &patches[i as usize] else { continue };
            let size = patch.surface.radius();
            let x = self.mesh.barycentre(seeds[i as usize]).distance_squared(centre) / (REACH * size).powi(2);
            let Some((height, shape)) = patch.surface.shape_at(centre) else { continue };
            let facing = shape.normal.dot(normal);
            if x >= 1.0 || facing < 0.0 {
                continue;
            }
            let far = height / (4.0 * patch.noise + 0.05 * size);
            let weight = (1.0 - x).powi(2) * facing * facing / (1.0 + far.powi(4)) / (patch.error * patch.error + 1e-300);
            tensor += shape.tensor * weight;
            direction += shape.normal * weight;
            radius += size * weight;
            error += patch.error * weight;
            total += weight;
        }
        let normal = direction.try_normalize()?;
        let projection = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        let tensor = projection * (tensor * (1.0 / total)) * projection;
        Some(Blended { shape: Shape { normal, tensor }, radius: radius / total, error: error / total })
    }
}

/// A cyclide through noisy samples: the least sum of squared distances from the surface, not of squared
/// residuals of the equation, in which noise would stand on both sides. Returns also the normal
/// equations and the variance of the samples.
fn cyclide(
    frame: super::implicit::Frame,
    samples: &[DVec3],
    noise: f64,
    rows: &mut Rows,
) -> Option<(super::implicit::Implicit, super::least_squares::Factor, f64)> {
    use super::exact::{factor_with_prior, fill};
    use super::implicit::{Implicit, basis};
    if samples.len() < CYCLIDE + 8 {
        return None;
    }
    let noise = noise / frame.unit;
    let local: Vec<DVec3> = samples.iter().map(|&p| frame.to_local(p)).collect();
    fill(rows, &local, CYCLIDE, 0);
    let mut factor = factor_with_prior(rows, noise);
    let mut surface = Implicit { frame, coefficients: factor.solve(CYCLIDE), size: CYCLIDE };
    for _ in 0..3 {
        for (row, &p) in local.iter().enumerate() {
            // The distance, linear in the coefficients: that of the foot plus that of the sample from it.
            let gradient = surface.gradient(p);
            let foot = p - gradient * (surface.value(p) / gradient.length_squared());
            let gradient = surface.gradient(foot);
            let slope = gradient.length();
            if !(slope > 0.05) || !foot.is_finite() || foot.distance_squared(p) > 0.25 {
                return None;
            }
            let value = foot.z + gradient.dot(p - foot);
            rows.set(row, &basis(foot).map(|f| f / slope)[..CYCLIDE], value / slope);
        }
        factor = factor_with_prior(rows, noise);
        surface.coefficients = factor.solve(CYCLIDE);
    }
    let residual = rows.residual(&surface.coefficients[..CYCLIDE], samples.len());
    let variance = residual * frame.unit.powi(2) / (samples.len() - CYCLIDE) as f64;
    variance.is_finite().then_some((surface, factor, variance))
}

fn upper(m: DMat3) -> [f64; 6] {
    [m.x_axis.x, m.y_axis.x, m.z_axis.x, m.y_axis.y, m.z_axis.y, m.z_axis.z]
}

/// The squared Frobenius norm of the difference of two symmetric matrices.
fn distance_squared(a: &[f64; 6], b: &[f64; 6]) -> f64 {
    const TIMES: [f64; 6] = [1.0, 2.0, 2.0, 1.0, 2.0, 1.0];
    a.iter().zip(b).zip(TIMES).map(|((a, b), t)| t * (a - b) * (a - b)).sum()
}
