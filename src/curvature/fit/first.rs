//! The first look at every face: fits that serve a face and its neighbours.

use super::batch::Batch;
use super::exact::{Fit, Fitter, Outcome};
use super::ground::Ground;
use super::lanes::{F4, Kernel, LANES, Real, V3, run};
use super::polynomial::{MOST, Polynomial};
use super::shape::Principal;
use crate::mesh::{EdgeKind, Face, FaceState};

/// A fit whose tensor is expected to be off by less than this share of the curvature needs no help.
const GOOD: f64 = 2e-3;
/// Misfits up to this many times the rounding of coordinates are none.
const ROUNDING: f64 = 20.0;
/// Rounding within a fit, in radii of its window.
const ARITHMETIC: f64 = 1e-12;
/// A fit serves a neighbour this far from its middle, in units of its window.
const NEAR: f64 = 0.7;

/// How well a face's fit explains its window.
#[derive(Clone, Copy)]
pub(super) struct Quality {
    /// The face whose fit it is.
    pub(super) seed: Face,
    /// Misfit in units of curvature; infinite where there is no fit.
    pub(super) misfit: f32,
    /// True where rounding does not explain the misfit.
    pub(super) is_uneven: bool,
    /// True where the values may be far off.
    pub(super) is_doubtful: bool,
}

impl Quality {
    pub(super) const NO_FIT: Quality =
        Quality { seed: Face(u32::MAX), misfit: f32::INFINITY, is_uneven: false, is_doubtful: false };
}

/// What a fit says about a face.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    pub(super) principal: Principal,
    pub(super) radius: f64,
    pub(super) coverage: f64,
    /// Standard error of the shape tensor, 1/length.
    pub(super) error: f64,
    pub(super) quality: Quality,
}

/// Fits windows of single faces; one per thread.
pub(super) struct Surveyor<'g> {
    ground: &'g Ground<'g>,
    quantum: f64,
    batch: Batch,
    fitter: Fitter,
}

/// A fit is read at its seed and up to three neighbours.
type Served = [Option<Face>; LANES];

/// Reads one surface at several points.
struct ReadLanes<'f> {
    f: &'f Polynomial<f64>,
    points: V3<F4>,
    unit: f64,
}

impl Kernel for ReadLanes<'_> {
    type Output = Principal<F4>;

    #[inline(always)]
    fn run(self) -> Principal<F4> {
        let mut coefficients = [F4::ZERO; MOST];
        coefficients.iter_mut().zip(&self.f.coefficients).for_each(|(to, &from)| *to = F4::splat(from));
        let f = Polynomial { coefficients, size: self.f.size };
        let foot = f.foot(self.points);
        let gradient = f.gradient(foot);
        let length = gradient.dot(gradient).sqrt();
        let p = Principal::of(gradient.scaled(F4::ONE / length), &f.hessian(foot));
        let share = F4::ONE / (length * self.unit);
        Principal { k_max: p.k_max * share, k_min: p.k_min * share, ..p }
    }
}

impl<'g> Surveyor<'g> {
    /// `quantum` is the rounding of the mesh's coordinates, in file units.
    pub(super) fn new(ground: &'g Ground<'g>, quantum: f64) -> Self {
        Surveyor { ground, quantum, batch: Batch::new(), fitter: Fitter::new(quantum) }
    }

    /// Reads all sound faces of a range; `None` is told for those without a fit.
    ///
    /// In the order of faces each one that is not served yet gets a fit, which serves its neighbours over inner edges
    /// too. Those the fit is not good enough for, or that lie apart, get fits of their own.
    pub(super) fn survey(&mut self, faces: std::ops::Range<u32>, mut tell: impl FnMut(Face, Option<Reading>)) {
        let is_sound = |f: u32| self.ground.mesh.face_state(Face(f)) == FaceState::Sound;
        let mut open: Vec<bool> = faces.clone().map(is_sound).collect();
        let (mut alone, mut ruled) = (Vec::new(), Vec::new());
        let mut served: Vec<Served> = Vec::new();
        self.batch.clear();
        for f in faces.clone() {
            if !std::mem::take(&mut open[(f - faces.start) as usize]) {
                continue;
            }
            let seed = Face(f);
            let is_open = |g: Face| faces.contains(&g.0) && std::mem::take(&mut open[(g.0 - faces.start) as usize]);
            served.push(self.neighbours(seed, is_open));
            self.batch.load(self.ground, seed);
            if self.batch.is_full() {
                self.read(&mut served, &mut alone, &mut ruled, &mut tell);
            }
        }
        self.read(&mut served, &mut alone, &mut ruled, &mut tell);
        let mut none_left = Vec::new();
        for seeds in alone.chunks(LANES) {
            for &seed in seeds {
                served.push([Some(seed), None, None, None]);
                self.batch.load(self.ground, seed);
            }
            self.read(&mut served, &mut none_left, &mut ruled, &mut tell);
        }
        let mut unruly = Vec::new();
        for seeds in ruled.chunks(LANES) {
            for &seed in seeds {
                served.push([Some(seed), None, None, None]);
                self.batch.load_with_rulings(self.ground, seed);
            }
            self.read(&mut served, &mut none_left, &mut unruly, &mut tell);
        }
        unruly.into_iter().for_each(|face| tell(face, None));
    }

    /// A face and those of its neighbours over inner edges that are open.
    fn neighbours(&self, seed: Face, mut is_open: impl FnMut(Face) -> bool) -> Served {
        let mesh = self.ground.mesh;
        let [a, b, c] = seed.half_edges().map(|h| {
            let twin = mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner)?;
            is_open(twin.face()).then(|| twin.face())
        });
        [Some(seed), a, b, c]
    }

    /// Fits what is loaded and reads it for all faces it serves.
    fn read(
        &mut self,
        served: &mut Vec<Served>,
        alone: &mut Vec<Face>,
        ruled: &mut Vec<Face>,
        tell: &mut impl FnMut(Face, Option<Reading>),
    ) {
        let fits = self.fitter.fit(&self.batch);
        for (lane, faces) in served.drain(..).enumerate() {
            let others = faces[1..].iter().flatten();
            let seed = self.batch.seeds[lane];
            let fit = match fits.outcome(&self.batch, lane) {
                Outcome::Fitted(fit) => fit,
                Outcome::NeedsRulings => {
                    ruled.push(seed);
                    alone.extend(others);
                    continue;
                }
                Outcome::None => {
                    tell(seed, None);
                    alone.extend(others);
                    continue;
                }
            };
            let readings = self.readings(seed, &fit, &fit.surface.f, faces);
            for (face, reading) in faces.into_iter().zip(readings).filter_map(|(f, r)| Some((f?, r))) {
                let serves = |r: &Reading| fit.coverage == 1.0 && !r.quality.is_doubtful && self.is_near(&fit, face);
                if face == seed || reading.as_ref().is_some_and(serves) {
                    tell(face, reading);
                } else {
                    alone.push(face);
                }
            }
        }
        self.batch.clear();
    }

    fn is_near(&self, fit: &Fit, face: Face) -> bool {
        let frame = &fit.surface.frame;
        self.ground.mesh.barycentre(face).distance_squared(frame.origin) <= (NEAR * frame.unit).powi(2)
    }

    /// What a fit with the function `f` says about faces; `None` where Newton's steps fail.
    pub(super) fn readings(
        &self,
        seed: Face,
        fit: &Fit,
        f: &Polynomial<f64>,
        faces: Served,
    ) -> [Option<Reading>; LANES] {
        let frame = fit.surface.frame;
        let mut points = V3::ZERO;
        for (lane, face) in faces.into_iter().enumerate() {
            if let Some(face) = face {
                points.set(lane, frame.to_local(self.ground.mesh.barycentre(face)));
            }
        }
        let principal = run(ReadLanes { f, points, unit: frame.unit });
        let is_uneven = fit.misfit > ROUNDING * self.quantum + ARITHMETIC * fit.radius;
        let misfit = (fit.misfit / (frame.unit * frame.unit)) as f32;
        std::array::from_fn(|lane| {
            let principal = Principal {
                k_max: principal.k_max.0[lane],
                k_min: principal.k_min.0[lane],
                dir_max: (frame.axes * principal.dir_max.get(lane)).into(),
                dir_min: (frame.axes * principal.dir_min.get(lane)).into(),
            };
            let bend = principal.k_max.abs().max(principal.k_min.abs());
            let is_doubtful = is_uneven && fit.error >= GOOD * bend;
            bend.is_finite().then_some(Reading {
                principal,
                radius: fit.radius,
                coverage: fit.coverage,
                error: fit.error,
                quality: Quality { seed, misfit, is_uneven, is_doubtful },
            })
        })
    }

    /// The fits of up to four faces, each its own; none where one needs rulings.
    pub(super) fn fits(&mut self, seeds: &[Face]) -> [Option<Fit>; LANES] {
        self.batch.clear();
        seeds.iter().for_each(|&seed| self.batch.load(self.ground, seed));
        let fits = self.fitter.fit(&self.batch);
        std::array::from_fn(|lane| match fits.outcome(&self.batch, lane) {
            Outcome::Fitted(fit) => Some(fit),
            Outcome::NeedsRulings | Outcome::None => None,
        })
    }
}
