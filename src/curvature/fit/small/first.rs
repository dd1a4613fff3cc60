//! The first look at every face: fits that serve a face and its neighbours.

use super::exact::{Fit, Fits, Fitter, Outcome};
use super::groups::{Group, Groups};
use crate::curvature::fit::around::batch::Batch;
use crate::curvature::fit::around::window::StripWindow;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::quantum::Quantum;
use crate::curvature::fit::ground::stars::Mark;
use crate::curvature::fit::surface::polynomial::{PARABOLOID, Polynomial, QUADRIC};
use crate::curvature::fit::surface::shape::Principal;
use crate::curvature::vectors::four::{F4, Kernel, LANES, Real, V3, run};
use crate::mesh::{Face, Mesh};
use glam::DVec3;
use std::ops::Range;

/// A fit whose tensor is expected to be off by less than this share of the curvature needs no help.
const GOOD: f64 = 2e-3;
/// One whose tensor is expected to be off by more than this share tells little.
const VAGUE: f64 = 0.1;
/// Misfits up to this many times the rounding of coordinates are none.
const ROUNDING: f64 = 20.0;
/// Rounding within a fit, in radii of its window.
const ARITHMETIC: f64 = 1e-12;
/// A fit serves a neighbour this far from its middle, in units of its window.
const NEAR: f64 = 0.7;

/// How well a face's fit explains its window.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Quality {
    /// The face whose fit it is.
    pub(super) seed: Face,
    /// Misfit in units of curvature; infinite where there is no fit.
    pub(in crate::curvature::fit) misfit: f32,
    /// True where rounding does not explain the misfit.
    pub(in crate::curvature::fit) is_uneven: bool,
    /// True where rounding does not explain the misfit and the values may be off.
    pub(in crate::curvature::fit) is_doubtful: bool,
    /// True where they may be far off, whatever explains the misfit: many surfaces pass through the window.
    pub(super) is_vague: bool,
    /// True where it takes more than a quadric to explain the window.
    pub(super) has_many_terms: bool,
}

impl Quality {
    pub(in crate::curvature::fit) const NO_FIT: Quality = Quality {
        seed: Face(u32::MAX),
        misfit: f32::INFINITY,
        is_uneven: false,
        is_doubtful: false,
        is_vague: true,
        has_many_terms: false,
    };

    /// True where no surface explains the window of the face, or too many do.
    pub(in crate::curvature::fit) fn is_open(&self) -> bool {
        self.is_uneven || self.is_vague
    }
}

/// What a fit says about a face.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Reading {
    pub(in crate::curvature::fit) principal: Principal,
    pub(in crate::curvature::fit) radius: f64,
    pub(in crate::curvature::fit) coverage: f64,
    /// Standard error of the shape tensor, 1/length.
    pub(in crate::curvature::fit) error: f64,
    pub(in crate::curvature::fit) quality: Quality,
}

/// Fits windows of single faces; one per thread.
pub(in crate::curvature::fit) struct Surveyor<'g> {
    ground: &'g Ground<'g>,
    quantum: Quantum,
    batch: Batch,
    fitter: Fitter,
    groups: Groups,
}

/// Faces that are still to be read.
#[derive(Default)]
struct Unread {
    /// Those that need a fit of their own.
    alone: Vec<Face>,
    /// Those whose fit needs rulings.
    ruled: Vec<Face>,
}

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
        let f = self.f.splat();
        let foot = f.foot(self.points);
        let gradient = f.gradient(foot);
        let length = gradient.dot(gradient).sqrt();
        let p = Principal::of(gradient.scaled(F4::ONE / length), &f.hessian(foot));
        let share = F4::ONE / (length * self.unit);
        Principal { k_max: p.k_max * share, k_min: p.k_min * share, ..p }
    }
}

impl<'g> Surveyor<'g> {
    /// `quantum` is the rounding of the mesh's coordinates.
    pub(in crate::curvature::fit) fn new(ground: &'g Ground<'g>, quantum: Quantum) -> Self {
        Surveyor { ground, quantum, batch: Batch::new(ground), fitter: Fitter::new(quantum), groups: Groups::new() }
    }

    /// Reads all sound faces of a range; `None` is told for those without a fit.
    ///
    /// Each fit serves the faces around it too: its neighbours over inner edges, and theirs as well while fits explain
    /// their windows to the last digit. Those the fit is not good enough for, or that lie apart, get fits of their own.
    pub(in crate::curvature::fit) fn survey(&mut self, faces: Range<u32>, mut tell: impl FnMut(Face, Option<Reading>)) {
        self.groups.open(self.ground.mesh, faces);
        let mut left = Unread::default();
        let mut served: Vec<Group> = Vec::with_capacity(LANES);
        let mut steps = 1;
        self.batch.clear();
        while let Some(seed) = self.groups.seed(steps) {
            self.batch.load(self.ground, seed);
            // Windows that reach an edge of the surface are not alike.
            let most = match self.batch.marks[served.len()] {
                Mark::Deep => 2,
                Mark::NearEdge => 1,
                _ => 0,
            };
            served.push(self.groups.take(seed, steps.min(most)));
            if self.batch.is_full() {
                let is_even = self.read(&mut served, &mut left, &mut tell);
                steps = if is_even { 2 } else { 1 };
            }
        }
        self.read(&mut served, &mut left, &mut tell);
        let Unread { alone, mut ruled } = left;
        let mut left = Unread::default();
        for seeds in alone.chunks(LANES) {
            for &seed in seeds {
                served.push(Group::alone(seed));
                self.batch.load(self.ground, seed);
            }
            self.read(&mut served, &mut left, &mut tell);
        }
        ruled.append(&mut left.ruled);
        for seeds in ruled.chunks(LANES) {
            for &seed in seeds {
                served.push(Group::alone(seed));
                self.batch.load_with_rulings(self.ground, seed);
            }
            self.read(&mut served, &mut left, &mut tell);
        }
        left.ruled.into_iter().for_each(|face| tell(face, None));
    }

    /// Fits what is loaded and reads it for all faces it serves. True when all of it is explained to the last digit.
    fn read(
        &mut self,
        served: &mut Vec<Group>,
        left: &mut Unread,
        tell: &mut impl FnMut(Face, Option<Reading>),
    ) -> bool {
        let fits = self.fitter.fit(&self.batch);
        let mut is_even = true;
        for (lane, group) in served.drain(..).enumerate() {
            let seed = self.batch.seeds[lane];
            let fit = match self.outcome(&fits, lane) {
                Outcome::Fitted(fit) => fit,
                outcome => {
                    match outcome {
                        Outcome::NeedsRulings => left.ruled.push(seed),
                        _ => tell(seed, None),
                    }
                    left.alone.extend(&group.faces()[1..]);
                    is_even = false;
                    continue;
                }
            };
            for faces in group.faces().chunks(LANES) {
                let readings = self.readings(seed, &fit, &fit.surface.f, faces);
                for (&face, reading) in faces.iter().zip(readings) {
                    let serves = |r: &Reading| {
                        !r.quality.is_doubtful && self.is_near(&fit, face) && (!fit.is_flat() || self.is_in(&fit, face))
                    };
                    if face == seed || reading.as_ref().is_some_and(serves) {
                        is_even &= reading.as_ref().is_some_and(|r| !r.quality.is_uneven);
                        tell(face, reading);
                    } else {
                        left.alone.push(face);
                    }
                }
            }
        }
        self.batch.clear();
        is_even
    }

    /// What became of a window in a lane. One that lies on a flat is that flat, whatever explains its rim as well: a
    /// surface of two sheets would, and see the wrong one there.
    fn outcome(&self, fits: &Fits, lane: usize) -> Outcome {
        match fits.outcome(&self.batch, lane) {
            Outcome::Fitted(fit) if fit.simple.size > PARABOLOID => {
                Outcome::Fitted(self.flat(lane, &fit).unwrap_or(fit))
            }
            outcome => outcome,
        }
    }

    /// The plane of a lane's face, where it holds most of the window and all that is around a corner of the face. No
    /// smooth surface that bends does that.
    fn flat(&self, lane: usize, fit: &Fit) -> Option<Fit> {
        /// Least share of the window in the plane: less are a few vertices in a row, near enough.
        const LEAST: f64 = 0.6;
        let (ground, batch, seed) = (self.ground, &self.batch, self.batch.seeds[lane]);
        let (normal, centre) = (ground.mesh.normal(seed), batch.centres[lane]);
        let reach = self.rounding(fit);
        let is_in = |&v: &u32| (ground.position(v) - centre).dot(normal).abs() <= reach;
        let is_flat_around = |v: u32| ground.stars.is_inside(v) && ground.stars.neighbours(v).iter().all(is_in);
        if !ground.mesh.topology().corners(seed).into_iter().any(|v| is_flat_around(v.0)) {
            return None;
        }
        let points = &batch.points[..batch.counts[lane]];
        let inside = points.iter().filter(|points| points.get(lane).dot(normal).abs() <= reach).count();
        if inside as f64 <= LEAST * points.len() as f64 {
            return None;
        }
        fit.on_plane(normal, self.quantum.around(centre, fit.surface.frame.unit))
    }

    /// How far off a plane vertices of a fit's window look by rounding.
    fn rounding(&self, fit: &Fit) -> f64 {
        let frame = &fit.surface.frame;
        4.0 * self.quantum.around(frame.origin, frame.unit) + ARITHMETIC * fit.radius
    }

    /// Whether a face lies in the plane that a fit found.
    fn is_in(&self, fit: &Fit, face: Face) -> bool {
        let (surface, reach) = (&fit.surface, 2.0 * self.rounding(fit));
        let height = |p: DVec3| surface.value(surface.frame.to_local(p)).abs() * surface.frame.unit;
        self.ground.mesh.triangle(face).into_iter().all(|p| height(p) <= reach)
    }

    fn is_near(&self, fit: &Fit, face: Face) -> bool {
        let frame = &fit.surface.frame;
        self.ground.mesh.barycentre(face).distance_squared(frame.origin) <= (NEAR * frame.unit).powi(2)
    }

    /// What a fit with the function `f` says about faces; `None` where Newton's steps fail.
    pub(in crate::curvature::fit) fn readings(
        &self,
        seed: Face,
        fit: &Fit,
        f: &Polynomial<f64>,
        faces: &[Face],
    ) -> [Option<Reading>; LANES] {
        let frame = fit.surface.frame;
        let mut points = V3::ZERO;
        for (lane, &face) in faces.iter().enumerate() {
            points.set(lane, frame.to_local(self.ground.mesh.barycentre(face)));
        }
        let principal = run(ReadLanes { f, points, unit: frame.unit });
        let is_uneven = fit.misfit > ROUNDING * self.quantum.around(frame.origin, frame.unit) + ARITHMETIC * fit.radius;
        let misfit = (fit.misfit / (frame.unit * frame.unit)) as f32;
        std::array::from_fn(|lane| {
            let principal = Principal {
                k_max: principal.k_max.0[lane],
                k_min: principal.k_min.0[lane],
                dir_max: (frame.axes * principal.dir_max.get(lane)).into(),
                dir_min: (frame.axes * principal.dir_min.get(lane)).into(),
            };
            let bend = principal.size();
            let is_doubtful = is_uneven && fit.error >= GOOD * bend;
            // A plane is what it is, as far as rounding tells.
            let is_vague = fit.error >= VAGUE * bend && bend > 0.0;
            bend.is_finite().then_some(Reading {
                principal,
                radius: fit.radius,
                coverage: fit.coverage,
                error: fit.error,
                quality: Quality { seed, misfit, is_uneven, is_doubtful, is_vague, has_many_terms: f.size > QUADRIC },
            })
        })
    }

    /// Fits the only window that is loaded.
    fn fit_loaded(&mut self) -> Outcome {
        let fits = self.fitter.fit(&self.batch);
        self.outcome(&fits, 0)
    }

    /// The fit around a face, with rulings where it needs them.
    pub(super) fn fit(&mut self, seed: Face) -> Option<Fit> {
        self.batch.clear();
        self.batch.load(self.ground, seed);
        let mut outcome = self.fit_loaded();
        if matches!(outcome, Outcome::NeedsRulings) {
            self.batch.clear();
            self.batch.load_with_rulings(self.ground, seed);
            outcome = self.fit_loaded();
        }
        match outcome {
            Outcome::Fitted(fit) => Some(fit),
            Outcome::NeedsRulings | Outcome::None => None,
        }
    }

    /// The share of the vertices around a face that lie neither on a border nor on a sharp edge.
    pub(in crate::curvature::fit) fn coverage(&mut self, face: Face) -> f32 {
        self.batch.coverage_of(self.ground, face) as f32
    }

    pub(super) fn mesh(&self) -> &'g Mesh {
        self.ground.mesh
    }

    /// What fits to up to four parts of the strip around a face say about it.
    pub(super) fn read_strips(&mut self, face: Face, windows: Vec<StripWindow>) -> [Option<Reading>; LANES] {
        self.batch.clear();
        windows.into_iter().for_each(|window| self.batch.load_strip(self.ground, face, window));
        let fits = self.fitter.fit(&self.batch);
        std::array::from_fn(|lane| match self.outcome(&fits, lane) {
            Outcome::Fitted(fit) => self.readings(face, &fit, &fit.surface.f, &[face])[0],
            Outcome::NeedsRulings | Outcome::None => None,
        })
    }

    /// The fits of up to four faces, each its own; none where one needs rulings.
    pub(in crate::curvature::fit) fn fits(&mut self, seeds: &[Face]) -> [Option<Fit>; LANES] {
        self.batch.clear();
        seeds.iter().for_each(|&seed| self.batch.load(self.ground, seed));
        let fits = self.fitter.fit(&self.batch);
        std::array::from_fn(|lane| match self.outcome(&fits, lane) {
            Outcome::Fitted(fit) => Some(fit),
            Outcome::NeedsRulings | Outcome::None => None,
        })
    }
}
