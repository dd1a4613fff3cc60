//! Windows of vertices, loaded side by side for a fit.

use super::rings::Rings;
use super::rulings::{Folds, rulings};
use super::window::{StripWindow, Window};
use crate::curvature::fit::ground::Ground;
use crate::curvature::fit::ground::stars::Mark;
use crate::curvature::vectors::four::{F4, LANES, V3};
use crate::mesh::Face;
use glam::DVec3;

/// Vertices for a fit, where the patch has them.
pub(in crate::curvature::fit) const WANTED: usize = 24;

/// The windows of up to four faces. Points beyond the end of a lane's window are zero.
pub(in crate::curvature::fit) struct Batch {
    /// The faces, as many as lanes are in use.
    pub(in crate::curvature::fit) seeds: Vec<Face>,
    /// The places the windows are laid around: barycentres.
    pub(in crate::curvature::fit) centres: [DVec3; LANES],
    /// Vertices, seen from the centres.
    pub(in crate::curvature::fit) points: Vec<V3<F4>>,
    /// Normals of the surface there, of any length; zero where there is none.
    pub(in crate::curvature::fit) normals: Vec<V3<F4>>,
    /// A surface further than this from the centre is not the one the centre belongs to: half the face's width.
    pub(in crate::curvature::fit) reaches: F4,
    /// Along the mean normals.
    pub(in crate::curvature::fit) uprights: V3<F4>,
    pub(in crate::curvature::fit) counts: [usize; LANES],
    /// Share of each window's vertices that lie neither on a border nor on a sharp edge.
    pub(in crate::curvature::fit) coverage: [f64; LANES],
    /// The least of the marks of each window's vertices.
    pub(in crate::curvature::fit) marks: [Mark; LANES],
    /// Places and directions in which the surface is to be straight.
    pub(in crate::curvature::fit) rulings: [Vec<(DVec3, DVec3)>; LANES],
    gathered: Gathered,
    window: Window,
}

/// Memory for one window.
struct Gathered {
    rings: Rings,
    normals: Vec<DVec3>,
}

impl Batch {
    pub(in crate::curvature::fit) fn new(ground: &Ground<'_>) -> Self {
        Batch {
            seeds: Vec::with_capacity(LANES),
            centres: [DVec3::ZERO; LANES],
            points: Vec::new(),
            normals: Vec::new(),
            reaches: F4::ZERO,
            uprights: V3::ZERO,
            counts: [0; LANES],
            coverage: [0.0; LANES],
            marks: [Mark::Deep; LANES],
            rulings: Default::default(),
            gathered: Gathered { rings: Rings::new(ground.mesh.positions().len()), normals: Vec::new() },
            window: Window::new(),
        }
    }

    pub(in crate::curvature::fit) fn clear(&mut self) {
        self.seeds.clear();
        self.points.clear();
        self.normals.clear();
        self.counts = [0; LANES];
        self.rulings.iter_mut().for_each(Vec::clear);
    }

    pub(in crate::curvature::fit) fn is_full(&self) -> bool {
        self.seeds.len() == LANES
    }

    /// Loads the window of a face into the next lane: whole rings until there are [`WANTED`] vertices.
    pub(in crate::curvature::fit) fn load(&mut self, ground: &Ground<'_>, seed: Face) {
        if self.gathered.rings(ground, seed) {
            let normal = |&v: &u32| match ground.stars.is_divided(v) {
                true => DVec3::ZERO,
                false => ground.normals[v as usize].as_dvec3(),
            };
            self.gathered.normals.clear();
            self.gathered.normals.extend(self.gathered.rings.vertices().iter().map(normal));
            // Beyond them, not all faces of a vertex belong to the window.
            self.uprights.set(self.seeds.len(), self.gathered.normals[..self.gathered.rings.inner].iter().sum());
        } else {
            let window = &mut self.window;
            window.start(ground.mesh, seed);
            window.grow_to(ground, WANTED);
            window.add_normals(ground.mesh, &mut self.gathered.normals);
            self.uprights.set(self.seeds.len(), self.gathered.normals.iter().sum());
            self.gathered.rings.take(&window.vertices);
        }
        self.place(ground, seed);
    }

    /// The coverage that a window would have which [`Batch::load`] loads.
    pub(in crate::curvature::fit) fn coverage_of(&mut self, ground: &Ground<'_>, seed: Face) -> f64 {
        if ground.stars.are_all_inside() {
            return 1.0;
        }
        let vertices = match self.gathered.rings(ground, seed) {
            true => self.gathered.rings.vertices(),
            false => {
                self.window.start(ground.mesh, seed);
                self.window.grow_to(ground, WANTED);
                &self.window.vertices
            }
        };
        ground.stars.coverage(vertices.iter().copied())
    }

    /// Loads a window as [`Batch::load`] does, with rulings.
    pub(in crate::curvature::fit) fn load_with_rulings(&mut self, ground: &Ground<'_>, seed: Face) {
        let lane = self.seeds.len();
        self.window.start(ground.mesh, seed);
        self.window.grow_to(ground, WANTED);
        let folds = Folds::within(ground.mesh, &self.window.faces);
        self.rulings[lane] = rulings(ground.mesh, &self.window.faces, folds.has_diagonals.then_some(&folds));
        self.load(ground, seed);
    }

    /// Loads a part of the strip around a face.
    pub(in crate::curvature::fit) fn load_strip(&mut self, ground: &Ground<'_>, seed: Face, window: StripWindow) {
        let lane = self.seeds.len();
        self.make_room(window.points.len());
        let centre = ground.mesh.barycentre(seed);
        for (i, (&point, &normal)) in window.points.iter().zip(&window.normals).enumerate() {
            self.points[i].set(lane, point - centre);
            self.normals[i].set(lane, normal);
        }
        self.uprights.set(lane, window.normals.iter().sum());
        self.rulings[lane] = window.rulings;
        self.marks[lane] = Mark::Border;
        self.coverage[lane] = ground.stars.coverage(window.vertices.iter().copied());
        self.add(ground, seed, window.points.len());
    }

    fn place(&mut self, ground: &Ground<'_>, seed: Face) {
        let lane = self.seeds.len();
        let count = self.gathered.rings.vertices().len();
        self.make_room(count);
        let (positions, centre) = (ground.mesh.positions(), ground.mesh.barycentre(seed));
        let (mut inside, mut least) = (0, Mark::Deep);
        for (i, (&v, &normal)) in self.gathered.rings.vertices().iter().zip(&self.gathered.normals).enumerate() {
            self.points[i].set(lane, positions[v as usize] - centre);
            self.normals[i].set(lane, normal);
            inside += usize::from(ground.stars.is_inside(v));
            least = least.min(ground.stars.mark(v));
        }
        self.marks[lane] = least;
        self.coverage[lane] = inside as f64 / count as f64;
        self.add(ground, seed, count);
    }

    fn make_room(&mut self, count: usize) {
        if self.points.len() < count {
            self.points.resize(count, V3::ZERO);
            self.normals.resize(count, V3::ZERO);
        }
    }

    fn add(&mut self, ground: &Ground<'_>, seed: Face, count: usize) {
        let lane = self.seeds.len();
        self.seeds.push(seed);
        self.reaches.0[lane] = 0.5 * ground.mesh.least_height(seed);
        self.centres[lane] = ground.mesh.barycentre(seed);
        self.counts[lane] = count;
    }
}

impl Gathered {
    /// Gathers the vertices of whole rings around a face. False where one fan of faces has to be told from
    /// another for that.
    fn rings(&mut self, ground: &Ground<'_>, seed: Face) -> bool {
        self.rings.start(ground.mesh.topology().corners(seed).map(|v| v.0));
        while self.rings.vertices().len() < WANTED && !self.rings.is_exhausted() {
            if !self.rings.grow(ground) {
                return false;
            }
        }
        true
    }
}
