//! A picture of the mesh without a browser: the page's first view, its light and its colours.

mod bands;
mod camera;
mod normals;
mod strip;

pub use camera::ViewFrom;

use super::display::Display;
use super::subject::Subject;
use crate::color::{ColorScale, Rgb, linear_factor};
use crate::error::Error;
use crate::io::png;
use crate::mesh::{EdgeKind, Face};
use bands::{Line, Scene};
use camera::Camera;
use glam::{DVec2, Vec3};

/// How a picture of the mesh is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width and height in pixels, each 64 to 8192.
    pub size: [u32; 2],
    /// Where the viewer stands.
    pub view: ViewFrom,
    /// No background: the mesh and the legend stand on nothing.
    pub transparent: bool,
    /// A legend below the mesh.
    pub legend: bool,
}

impl Default for PictureOptions {
    fn default() -> Self {
        PictureOptions { size: [1200, 900], view: ViewFrom::Iso, transparent: false, legend: true }
    }
}

impl PictureOptions {
    pub(super) fn check(&self) -> Result<(), Error> {
        if self.size.iter().any(|side| !(64..=8192).contains(side)) {
            return Err(Error::Usage("--size must be 64x64 to 8192x8192".into()));
        }
        self.view.check()
    }
}

/// The paper that the mesh lies on: the page's, by day.
const PAPER: Rgb = [250, 249, 246];
/// Colours of boundary, feature and non-manifold edges: the page's.
const EDGES: [(EdgeKind, Rgb); 3] =
    [(EdgeKind::Boundary, [176, 112, 0]), (EdgeKind::Feature, [52, 58, 64]), (EdgeKind::NonManifold, [200, 30, 90])];
/// Feature edges are drawn up to this number or this share of all faces; beyond, they would hide the surface.
const FEW: f64 = 5000.0;
const FEW_OF_ALL: f64 = 0.08;
/// Width of a drawn edge in pixels, on a picture a thousand pixels wide.
const EDGE_WIDTH: f64 = 1.4;

/// A PNG of the mesh.
pub(super) fn picture(subject: &Subject, display: &Display, colors: &ColorScale, options: &PictureOptions) -> Vec<u8> {
    let [width, height] = options.size.map(|side| side as usize);
    let strip = if options.legend { strip::HEIGHT.min(height / 3) } else { 0 };
    let camera = Camera::fit(&options.view, subject.space.z_up, display, [width, height - strip]);
    let palette = colors.map.palette();
    let linear = palette.map(|rgb| Vec3::from_array(rgb.map(linear_factor)));
    let scene = Scene {
        corners: &display.corners,
        vertices: display.positions.iter().map(|&p| camera.project(p)).collect(),
        normals: normals::of_corners(display, |n| camera.turn(n)),
        colors: (0..display.corners.len())
            .map(|i| linear[colors.color_index(&subject.values[display.number(i).index()])])
            .collect(),
        lines: lines(subject, display, &camera, EDGE_WIDTH * (width as f64 / 1000.0).max(1.0)),
    };
    let mut image = bands::draw(&scene, width, height - strip);
    if strip > 0 {
        image.resize(width * height, [0; 4]);
        strip::draw(&mut image, width, height - strip, colors, subject.unit, options.transparent);
    }
    if options.transparent {
        return png::rgba(width as u32, height as u32, image.as_flattened());
    }
    let pixels: Vec<u8> = image.iter().flat_map(|&pixel| over(pixel, PAPER)).collect();
    png::rgb(width as u32, height as u32, &pixels)
}

/// A pixel laid on an opaque colour, mixed in linear light as the samples of a pixel are.
fn over([r, g, b, alpha]: [u8; 4], paper: Rgb) -> Rgb {
    let share = f32::from(alpha) / 255.0;
    let mut mixed = [r, g, b];
    for (channel, paper) in mixed.iter_mut().zip(paper) {
        let light = share * linear_factor(*channel) + (1.0 - share) * linear_factor(paper);
        *channel = bands::srgb(light);
    }
    mixed
}

/// The classified edges as they lie on the screen.
fn lines(subject: &Subject, display: &Display, camera: &Camera, width: f64) -> Vec<Line> {
    let mesh = &subject.mesh;
    let too_many = mesh.report().edges.feature as f64 > FEW.max(FEW_OF_ALL * mesh.face_count() as f64);
    let color = |kind: EdgeKind| {
        let wanted = EDGES.iter().find(|(of, _)| *of == kind && !(kind == EdgeKind::Feature && too_many));
        wanted.map(|(_, rgb)| Vec3::from_array(rgb.map(linear_factor)))
    };
    let sound = |f: &Face| mesh.is_in_surface(*f);
    (0..mesh.face_count() as u32)
        .map(Face)
        .filter(sound)
        .flat_map(Face::half_edges)
        .filter(|&h| mesh.topology().twin(h).is_none_or(|twin| h < twin))
        .filter_map(|h| {
            let color = color(mesh.edge_kind(h))?;
            let ends = [mesh.topology().origin(h), mesh.topology().target(h)];
            let [a, b] = ends.map(|v| camera.project(display.positions[v.0 as usize]));
            let along = DVec2::new(b[0] - a[0], b[1] - a[1]).normalize_or_zero();
            Some(Line { ends: [a, b], aside: 0.5 * width * along.perp(), color })
        })
        .collect()
}
