//! Windows of one size for a whole mesh: the same linear measurement everywhere.
//!
//! For surfaces that are rough at every scale, and for a radius that the user has given (see [`shared`](super::shared)
//! for large ones).

use super::patches::{Blended, Mean};
use crate::curvature::fit::around::samples::Sampler;
use crate::curvature::fit::ground::cells::Cells;
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::ground::quantum::Quantum;
use crate::curvature::fit::ground::sites::Sites;
use crate::curvature::fit::solve::abreast::Abreast;
use crate::curvature::fit::solve::chord_fitter::ChordFitter;
use crate::curvature::fit::surface::bivariate::{CUBIC, HIGHEST, QUADRATIC};
use crate::curvature::fit::surface::chord::Chord;
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::curvature::vectors::four::LANES;
use crate::mesh::Face;
use glam::DVec3;
use rayon::prelude::*;

/// Radii from a face's middle to the nearest of its corners, at most: windows of facets as long as that have vertices
/// at their ends only.
const LARGEST: f64 = 0.36;
/// How far rounding may tilt the plane of a face that says whether its window is flat.
const STEEPEST: f64 = 1e-4;

/// Fits windows around four places at a time; one per thread.
pub(in crate::curvature::fit) struct Steady<'g, S> {
    samplers: [Sampler<'g, S>; LANES],
    abreast: Abreast,
    chords: ChordFitter,
}

/// A window that its sampler has taken.
struct Taken {
    frame: LocalFrame,
    /// Where the surface is looked at.
    centre: DVec3,
    /// Of the polynomial, at most.
    degree: usize,
}

/// What the vertices of a window lie on.
#[derive(Clone, Copy)]
pub(in crate::curvature::fit) struct Fitted {
    pub(super) surface: Chord,
    /// Where the window lies around.
    pub(super) centre: DVec3,
    /// Standard deviation of its samples, in file units.
    pub(super) noise: f64,
    /// Expected error of the shape tensor at the centre, 1/length.
    pub(super) error: f64,
    /// Whether its vertices determine how the surface bends.
    is_firm: bool,
}

impl Fitted {
    /// At the centre.
    pub(in crate::curvature::fit) fn value(&self) -> Option<Blended> {
        let (_, shape) = self.surface.shape_at(self.centre)?;
        Some(Blended { shape, radius: self.surface.frame.unit, error: self.error })
    }
}

/// The values of the `wanted` faces of a rough surface: a paraboloid in chord coordinates around every vertex of
/// theirs, averaged over each face's corners.
pub(in crate::curvature::fit) fn around_vertices(
    fans: &Fans<'_>,
    window: usize,
    wanted: &[bool],
) -> Vec<Option<Blended>> {
    /// Cells in a window, at least. With half as many, values follow the meshing more than small windows' do.
    const ENOUGH: f64 = 72.0;
    match Cells::new(fans, window as f64 / ENOUGH) {
        Some(cells) => around_all(&cells, (window as f64 / cells.size).round() as usize, wanted),
        None => around_all(fans, window, wanted),
    }
}

/// The same from so many sites in a window.
fn around_all(sites: &impl Sites, window: usize, wanted: &[bool]) -> Vec<Option<Blended>> {
    const CHUNK: usize = 256;
    let ground = sites.fans().ground;
    let mut around: Vec<Option<Blended>> = vec![None; ground.mesh.positions().len()];
    around.par_chunks_mut(CHUNK).enumerate().for_each_init(
        || Steady::new(sites),
        |steady, (chunk, values)| {
            ground.work.advance_by(0.8, values.len(), ground.mesh.positions().len());
            let is_used = |&v: &usize| ground.stars.of(v as u32).iter().any(|&f| wanted[f as usize]);
            let used: Vec<usize> = (chunk * CHUNK..).take(values.len()).filter(is_used).collect();
            for four in used.chunks(LANES) {
                let found = steady.around(four, window);
                four.iter().zip(found).for_each(|(v, value)| values[v % CHUNK] = value);
            }
        },
    );
    (0..ground.mesh.face_count() as u32)
        .into_par_iter()
        .map(|f| {
            if !wanted[f as usize] {
                return None;
            }
            let mut mean = Mean::new();
            for v in ground.mesh.topology().corners(Face(f)) {
                if let Some(value) = &around[v.index()] {
                    mean.add(value.shape.symmetric(), value.shape.normal, value.radius, value.error, 1.0);
                }
            }
            mean.value()
        })
        .collect()
}

impl<'g, S: Sites> Steady<'g, S> {
    pub(in crate::curvature::fit) fn new(sites: &'g S) -> Self {
        let samplers = std::array::from_fn(|_| Sampler::new(sites));
        Steady { samplers, abreast: Abreast::new(), chords: ChordFitter::new() }
    }

    /// Paraboloids around up to four faces, in windows of so many vertices.
    pub(super) fn around_faces(&mut self, faces: &[Face], window: usize) -> [Option<Blended>; LANES] {
        self.nearest(faces.len(), window, |lane, sampler| {
            sampler.start(faces[lane]);
            sampler.ground().mesh.barycentre(faces[lane])
        })
    }

    /// The same around up to four vertices.
    fn around(&mut self, vertices: &[usize], window: usize) -> [Option<Blended>; LANES] {
        self.nearest(vertices.len(), window, |lane, sampler| {
            sampler.start_at(vertices[lane] as u32);
            sampler.ground().position(vertices[lane] as u32)
        })
    }

    /// The same around places at which `start` has a lane's sampler start.
    fn nearest(
        &mut self,
        count: usize,
        window: usize,
        start: impl Fn(usize, &mut Sampler<'g, S>) -> DVec3,
    ) -> [Option<Blended>; LANES] {
        let fitted = self.fit(count, |lane, sampler| {
            let centre = start(lane, sampler);
            Some(Taken { frame: sampler.take_nearest(centre, window)?, centre, degree: QUADRATIC })
        });
        fitted.map(|fitted| fitted?.value())
    }

    /// Surfaces through all vertices within a radius of the barycentres of up to four faces; exactly flat where they
    /// all lie in a face's plane, as well as rounded coordinates tell. With the coverages of the windows. `None` where
    /// the radius holds too few vertices, or those there are do not tell how the surface bends.
    pub(in crate::curvature::fit) fn within(
        &mut self,
        faces: &[(Face, f64)],
        quantum: &Quantum,
    ) -> [Option<(Fitted, f64)>; LANES] {
        let mut flat = [None; LANES];
        let fitted = self.fit(faces.len(), |lane, sampler| {
            let ((face, radius), mesh) = (faces[lane], sampler.ground().mesh);
            let (centre, normal) = (mesh.barycentre(face), mesh.normal(face));
            let is_near = |corner: DVec3| corner.distance(centre) <= LARGEST * radius;
            if !mesh.triangle(face).into_iter().any(is_near) {
                return None;
            }
            sampler.start(face);
            let frame = sampler.take_within(centre, radius, S::LEAST)?;
            if frame.unit > radius {
                return None;
            }
            // The rounding of the face's corners tilts its plane, more at a distance; that of needles says nothing.
            let reach = 4.0 * quantum.around(centre, frame.unit) * (1.0 + frame.unit / mesh.least_height(face))
                + 1e-14 * frame.unit;
            let is_plane = |&p: &DVec3| (p - centre).dot(normal).abs() <= reach;
            if reach < STEEPEST * frame.unit && sampler.points.iter().all(is_plane) {
                let surface = Chord::plane(LocalFrame::upright(centre, normal, frame.unit)?);
                let error = reach / frame.unit.powi(2);
                flat[lane] = Some(Fitted { surface, centre, noise: 0.0, error, is_firm: true });
                return None;
            }
            (sampler.points.len() >= S::LEAST).then_some(Taken { frame, centre, degree: HIGHEST })
        });
        std::array::from_fn(|lane| {
            let found = flat[lane].or(fitted[lane]).filter(|fitted| fitted.is_firm)?;
            Some((found, self.samplers[lane].coverage()))
        })
    }

    /// Chord fits with weights that fall towards the rims, of the highest degrees up to those wanted that the samples
    /// carry several times over.
    fn fit(
        &mut self,
        count: usize,
        mut take: impl FnMut(usize, &mut Sampler<'g, S>) -> Option<Taken>,
    ) -> [Option<Fitted>; LANES] {
        let Steady { samplers, abreast, chords } = self;
        abreast.clear();
        let mut degrees = [0; LANES];
        let taken: [Option<Taken>; LANES] = std::array::from_fn(|lane| {
            let sampler = &mut samplers[lane];
            let taken = if lane < count { take(lane, sampler) } else { None }?;
            let carried = match sampler.points.len() {
                0..24 => QUADRATIC,
                24..45 => CUBIC,
                _ => HIGHEST,
            };
            degrees[lane] = taken.degree.min(carried);
            sampler.weigh(&taken.frame);
            let samples = sampler.points.iter().copied().zip(sampler.roots.iter().copied());
            abreast.load(lane, taken.frame, samples);
            Some(taken)
        });
        if taken.iter().all(Option::is_none) {
            return [None; LANES];
        }
        let fits = chords.fit(abreast, &[QUADRATIC], degrees, 1);
        std::array::from_fn(|lane| {
            let centre = taken[lane].as_ref()?.centre;
            let frame = abreast.frame(lane).filter(|_| fits.is_carried(lane))?;
            let (surface, noise, error) = fits.mean(lane, frame);
            Some(Fitted { surface, centre, noise, error, is_firm: fits.is_firm(lane) })
        })
    }
}
