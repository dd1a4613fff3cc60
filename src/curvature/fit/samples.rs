//! The vertices nearest to a place, as far as they face the same way.

use super::frame::Frame;
use super::ground::Ground;
use super::least_squares::Rows;
use super::rings::Rings;
use super::window::Window;
use crate::mesh::Face;
use glam::{DVec3, Vec3};

/// Where a window begins.
#[derive(Clone, Copy)]
enum Start {
    Face(Face),
    Vertex(u32),
}

/// Gathers samples; reused from place to place.
pub(super) struct Sampler<'g> {
    pub(super) ground: &'g Ground<'g>,
    rings: Rings,
    /// Stands in for the rings where fans of faces have to be told apart.
    window: Window,
    is_divided: bool,
    start: Start,
    /// Rings laid since the start.
    laid: usize,
    /// The side the samples face.
    facing: Vec3,
    pub(super) rows: Rows,
    pub(super) points: Vec<DVec3>,
    order: Vec<(f64, u32)>,
    pub(super) weights: Vec<f64>,
}

impl<'g> Sampler<'g> {
    pub(super) fn new(ground: &'g Ground<'g>) -> Self {
        Sampler {
            ground,
            rings: Rings::new(),
            window: Window::new(),
            is_divided: false,
            start: Start::Vertex(0),
            laid: 0,
            facing: Vec3::ZERO,
            rows: Rows::new(),
            points: Vec::new(),
            order: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// Begins anew at a face.
    pub(super) fn start(&mut self, seed: Face) {
        let corners = self.ground.mesh.topology().corners(seed).map(|v| v.0);
        self.begin(Start::Face(seed), &corners);
    }

    /// Begins anew at a vertex.
    pub(super) fn start_at(&mut self, vertex: u32) {
        self.begin(Start::Vertex(vertex), &[vertex]);
    }

    fn begin(&mut self, start: Start, vertices: &[u32]) {
        self.facing = vertices.iter().map(|&v| self.ground.normals[v as usize]).sum();
        self.rings.start(vertices.iter().copied());
        (self.start, self.laid, self.is_divided) = (start, 0, false);
    }

    /// All vertices gathered since the start.
    pub(super) fn vertices(&self) -> &[u32] {
        if self.is_divided { &self.window.vertices } else { &self.rings.vertices }
    }

    fn is_exhausted(&self) -> bool {
        if self.is_divided { self.window.exhausted } else { self.rings.is_exhausted() }
    }

    fn add_ring(&mut self) {
        let ground = self.ground;
        self.laid += 1;
        if !self.is_divided && self.rings.grow(ground) {
            return;
        }
        let mut rings = 1;
        if !std::mem::replace(&mut self.is_divided, true) {
            rings = self.laid;
            match self.start {
                Start::Face(seed) => self.window.start(ground.mesh, seed),
                Start::Vertex(vertex) => {
                    self.window.start_at(ground.mesh, &ground.stars, vertex);
                    rings -= 1;
                }
            }
        }
        for _ in 0..rings {
            self.window.add_ring(ground.mesh, &ground.stars, ground.over_features);
        }
    }

    fn grow_to(&mut self, count: usize) {
        while self.vertices().len() < count && !self.is_exhausted() {
            self.add_ring();
        }
    }

    /// Takes the `count` vertices nearest to `centre` among the rings that hold half as many more, and
    /// returns their frame, with the largest distance as its unit.
    pub(super) fn take_nearest(&mut self, centre: DVec3, count: usize) -> Option<Frame> {
        self.grow_to(count + count / 2);
        self.take(centre, |_| count)
    }

    /// Takes all vertices within `radius` of `centre`, and at least `least` where there are so many.
    pub(super) fn take_within(&mut self, centre: DVec3, radius: f64, least: usize) -> Option<Frame> {
        let square = radius * radius;
        self.grow_over(centre, square, least);
        self.take(centre, |order| order.iter().filter(|n| n.0 <= square).count().max(least))
    }

    /// The faces whose barycentres lie within a distance of a face's, and hang together with it.
    pub(super) fn faces_within(&mut self, seed: Face, radius: f64) -> Vec<u32> {
        let ground = self.ground;
        let (centre, square) = (ground.mesh.barycentre(seed), radius * radius);
        self.start(seed);
        self.grow_over(centre, square, 0);
        let is_near = |f: u32| ground.mesh.barycentre(Face(f)).distance_squared(centre) <= square;
        // Faces with a corner within the distance, each at the first such corner.
        let first = |f: u32| {
            let corners = ground.mesh.topology().faces()[f as usize].into_iter();
            corners.filter(|&v| ground.position(v).distance_squared(centre) <= square).min()
        };
        if self.is_divided {
            let faces = self.window.faces.iter().copied();
            return faces.filter(|&f| is_near(f) && first(f).is_some()).collect();
        }
        let at = |&v: &u32| ground.stars.of(v).iter().copied().filter(move |&f| first(f) == Some(v));
        self.rings.vertices.iter().flat_map(at).filter(|&f| is_near(f)).collect()
    }

    /// Adds rings until there are `least` vertices and no more come that are near `centre`.
    fn grow_over(&mut self, centre: DVec3, square: f64, least: usize) {
        loop {
            let (before, was_divided) = (self.vertices().len(), self.is_divided);
            self.add_ring();
            if self.is_divided != was_divided {
                // The window began anew, with its vertices in another order.
                continue;
            }
            let near = |&v: &u32| self.ground.position(v).distance_squared(centre) <= square;
            let added = &self.vertices()[before..];
            if self.is_exhausted() || before >= least && !added.iter().any(near) {
                break;
            }
        }
    }

    fn take(&mut self, centre: DVec3, count: impl Fn(&[(f64, u32)]) -> usize) -> Option<Frame> {
        let ground = self.ground;
        let (facing, mut order) = (self.facing, std::mem::take(&mut self.order));
        order.clear();
        let alike = self.vertices().iter().filter(|&&v| ground.normals[v as usize].dot(facing) > 0.0);
        order.extend(alike.map(|&v| (ground.position(v).distance_squared(centre), v)));
        self.order = order;
        let count = count(&self.order).min(self.order.len());
        if count < 8 {
            return None;
        }
        let by_distance = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        self.order.select_nth_unstable_by(count - 1, by_distance);
        self.order.truncate(count);
        let radius = self.order[count - 1].0.sqrt();
        self.points.clear();
        self.points.extend(self.order.iter().map(|&(_, v)| ground.position(v)));
        let normal: Vec3 = self.order.iter().map(|&(_, v)| ground.normals[v as usize]).sum();
        let frame = Frame::around(centre, normal.as_dvec3(), self.points.iter().copied())?;
        Some(Frame { unit: radius, ..frame })
    }

    /// Sets weights for the samples taken last that fall towards the rim and for vertices that face aside, so
    /// that none of them enters or leaves at once as the mesh moves.
    pub(super) fn weigh(&mut self, frame: &Frame) {
        let ground = self.ground;
        let normal = frame.axes.z_axis.as_vec3();
        let square = frame.unit * frame.unit;
        self.weights.clear();
        self.weights.extend(self.order.iter().map(|&(distance, v)| {
            let facing = f64::from(ground.normals[v as usize].normalize_or_zero().dot(normal)).max(0.0);
            (1.0 - 0.999 * distance / square).max(0.0) * facing
        }));
    }
}
