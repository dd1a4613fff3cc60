//! The vertices nearest to a place, as far as they face the same way.

use super::frame::Frame;
use super::ground::Ground;
use super::least_squares::Rows;
use super::window::Window;
use crate::mesh::Face;
use glam::{DVec3, Vec3};

/// Gathers samples; reused from place to place.
pub(super) struct Sampler<'g> {
    pub(super) ground: &'g Ground<'g>,
    pub(super) window: Window,
    pub(super) rows: Rows,
    pub(super) points: Vec<DVec3>,
    order: Vec<(f64, u32)>,
    pub(super) weights: Vec<f64>,
}

impl<'g> Sampler<'g> {
    pub(super) fn new(ground: &'g Ground<'g>) -> Self {
        Sampler {
            ground,
            window: Window::new(),
            rows: Rows::new(),
            points: Vec::new(),
            order: Vec::new(),
            weights: Vec::new(),
        }
    }

    /// Begins anew at a face.
    pub(super) fn start(&mut self, seed: Face) {
        self.window.start(self.ground.mesh, seed);
    }

    /// Begins anew at a vertex.
    pub(super) fn start_at(&mut self, vertex: u32) {
        self.window.start_at(self.ground.mesh, &self.ground.stars, vertex);
    }

    /// Takes the `count` vertices nearest to `centre` among the rings that hold half as many more, and
    /// returns their frame, with the largest distance as its unit.
    pub(super) fn take_nearest(&mut self, centre: DVec3, count: usize) -> Option<Frame> {
        let ground = self.ground;
        self.window.grow_to(ground.mesh, &ground.stars, ground.over_features, count + count / 2);
        self.take(centre, |_| count)
    }

    /// Takes all vertices within `radius` of `centre`, and at least `least` where there are so many.
    pub(super) fn take_within(&mut self, centre: DVec3, radius: f64, least: usize) -> Option<Frame> {
        let ground = self.ground;
        let square = radius * radius;
        loop {
            let before = self.window.vertices.len();
            self.window.add_ring(ground.mesh, &ground.stars, ground.over_features);
            let near = |&v: &u32| ground.position(v).distance_squared(centre) <= square;
            let added = &self.window.vertices[before..];
            if self.window.exhausted || before >= least && !added.iter().any(near) {
                break;
            }
        }
        self.take(centre, |order| order.iter().filter(|n| n.0 <= square).count().max(least))
    }

    fn take(&mut self, centre: DVec3, count: impl Fn(&[(f64, u32)]) -> usize) -> Option<Frame> {
        let ground = self.ground;
        let seed = Face(*self.window.faces.first()?);
        let corners = ground.mesh.topology().corners(seed);
        let facing: Vec3 = corners.iter().map(|v| ground.normals[v.index()]).sum();
        self.order.clear();
        let alike = self.window.vertices.iter().filter(|&&v| ground.normals[v as usize].dot(facing) > 0.0);
        self.order.extend(alike.map(|&v| (ground.position(v).distance_squared(centre), v)));
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
