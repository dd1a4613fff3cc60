//! The vertices nearest to a place, as far as they face the same way.

use super::marks::Marks;
use super::rings::Rings;
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::fans::Fans;
use crate::curvature::fit::ground::sites::Sites;
use crate::curvature::fit::surface::frame::LocalFrame;
use crate::mesh::Face;
use glam::{DVec3, Vec3};

/// Gathers samples; reused from place to place.
pub(in crate::curvature::fit) struct Sampler<'g, S> {
    sites: &'g S,
    rings: Rings,
    /// The side the samples face.
    facing: Vec3,
    /// The sites that face it, as far as the rings reach, with the squares of their distances; the nearest first, as
    /// many as were taken last.
    order: Vec<(f64, u32)>,
    /// Vertices that several sites stand for and one of them has been taken for.
    taken: Marks,
    /// Sites of the rings that have been looked at.
    known: usize,
    /// What was taken last.
    pub(in crate::curvature::fit) points: Vec<DVec3>,
    /// Roots of the samples' weights.
    pub(in crate::curvature::fit) roots: Vec<f64>,
}

impl<'g, S: Sites> Sampler<'g, S> {
    pub(in crate::curvature::fit) fn new(sites: &'g S) -> Self {
        Sampler {
            sites,
            rings: Rings::new(sites.count()),
            facing: Vec3::ZERO,
            order: Vec::new(),
            taken: Marks::new(),
            known: 0,
            points: Vec::new(),
            roots: Vec::new(),
        }
    }

    pub(in crate::curvature::fit) fn ground(&self) -> &'g Ground<'g> {
        self.sites.fans().ground
    }

    /// Begins anew at a face.
    pub(in crate::curvature::fit) fn start(&mut self, seed: Face) {
        self.begin(self.sites.fans().corners(seed));
    }

    /// Begins anew at a vertex.
    pub(in crate::curvature::fit) fn start_at(&mut self, vertex: u32) {
        self.begin(self.sites.fans().of(vertex));
    }

    fn begin(&mut self, fans: impl IntoIterator<Item = u32> + Clone) {
        self.facing = fans.clone().into_iter().map(|fan| self.sites.fans().normal(fan)).sum();
        self.rings.start(fans.into_iter().map(|fan| self.sites.of_fan(fan)));
        self.order.clear();
        self.taken.clear();
        self.known = 0;
    }

    /// Takes the `count` vertices nearest to `centre` among the rings that hold half as many more, and
    /// returns their frame, with the largest distance as its unit. The centre must stay the same from one start to the
    /// next.
    pub(in crate::curvature::fit) fn take_nearest(&mut self, centre: DVec3, count: usize) -> Option<LocalFrame> {
        self.gather(count + count / 2);
        self.take(centre, |_| count)
    }

    /// Takes all vertices within `radius` of `centre`, and at least `least` where there are so many.
    pub(in crate::curvature::fit) fn take_within(
        &mut self,
        centre: DVec3,
        radius: f64,
        least: usize,
    ) -> Option<LocalFrame> {
        let square = radius * radius;
        self.gather_within(centre, radius, least);
        self.take(centre, |order| order.iter().filter(|n| n.0 <= square).count().max(least))
    }

    /// Adds rings until there are `least` vertices, or no more.
    fn gather(&mut self, least: usize) {
        while self.rings.vertices().len() < least && !self.rings.is_exhausted() {
            self.rings.grow_to(|site| Some(self.sites.neighbours(site)));
        }
    }

    /// Adds rings until there are `least` vertices and the last ring has none within `radius` of `centre`.
    pub(in crate::curvature::fit) fn gather_within(&mut self, centre: DVec3, radius: f64, least: usize) {
        let near = |&site: &u32| self.sites.position(site).distance_squared(centre) <= radius * radius;
        while !self.rings.is_exhausted() {
            let last = &self.rings.vertices()[self.rings.inner..];
            if self.rings.vertices().len() >= least && !last.iter().any(near) {
                break;
            }
            self.rings.grow_to(|site| Some(self.sites.neighbours(site)));
        }
    }

    fn take(&mut self, centre: DVec3, count: impl Fn(&[(f64, u32)]) -> usize) -> Option<LocalFrame> {
        let sites = self.sites;
        for &site in &self.rings.vertices()[self.known..] {
            if sites.normal(site).dot(self.facing) <= 0.0 {
                continue;
            }
            let square = sites.position(site).distance_squared(centre);
            // Each vertex once, whichever fan of it comes first.
            if sites.shared_vertex(site).is_none_or(|vertex| self.taken.insert(vertex)) {
                self.order.push((square, site));
            }
        }
        self.known = self.rings.vertices().len();
        let count = count(&self.order).min(self.order.len());
        if count < 8 {
            return None;
        }
        // Squares are not below zero: their bits are in the order of what they stand for.
        let (_, farthest, _) =
            self.order.select_nth_unstable_by_key(count - 1, |&(square, site)| (square.to_bits(), site));
        let radius = farthest.0.sqrt();
        let taken = &self.order[..count];
        self.points.clear();
        self.points.extend(taken.iter().map(|&(_, site)| sites.position(site)));
        let normal: Vec3 = taken.iter().map(|&(_, site)| sites.normal(site)).sum();
        LocalFrame::upright(centre, normal.as_dvec3(), radius)
    }

    /// True where fewer than `least` vertices hang together with a face.
    pub(in crate::curvature::fit) fn is_cut_off(&mut self, face: Face, least: usize) -> bool {
        self.start(face);
        self.gather(least);
        self.rings.vertices().len() < least
    }

    /// The share of gathered vertices that lie neither on a border nor on a sharp edge.
    pub(in crate::curvature::fit) fn coverage(&self) -> f64 {
        self.sites.coverage(self.rings.vertices())
    }

    /// Sets weights for the samples taken last that fall towards the rim and for vertices that face aside, so
    /// that none of them enters or leaves at once as the mesh moves.
    pub(in crate::curvature::fit) fn weigh(&mut self, frame: &LocalFrame) {
        let normal = frame.axes.z_axis.as_vec3();
        let square = frame.unit * frame.unit;
        self.roots.clear();
        self.roots.extend(self.order[..self.points.len()].iter().map(|&(distance, site)| {
            let facing = f64::from(self.sites.direction(site).dot(normal)).max(0.0);
            ((1.0 - 0.999 * distance / square).max(0.0) * facing * self.sites.weight(site)).sqrt()
        }));
    }
}

impl<'g> Sampler<'g, Fans<'g>> {
    /// The gathered faces whose barycentres and at least one corner lie within a distance of `centre`.
    pub(in crate::curvature::fit) fn faces_within(&self, centre: DVec3, radius: f64) -> impl Iterator<Item = u32> {
        let square = radius * radius;
        let (fans, mesh) = (self.sites, self.sites.ground.mesh);
        let is_within = move |f: &u32| {
            let is_near = |p: DVec3| p.distance_squared(centre) <= square;
            is_near(mesh.barycentre(Face(*f))) && mesh.triangle(Face(*f)).into_iter().any(is_near)
        };
        let near = self.rings.vertices().iter().filter(move |&&fan| fans.may_have_faces_within(fan, centre, radius));
        near.flat_map(|&fan| fans.faces(fan)).copied().filter(is_within)
    }
}
