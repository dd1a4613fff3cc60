//! Triangles and lines into pixels: bands of rows in parallel, a depth buffer, nine samples a pixel.

use glam::{DVec2, Vec3};
use rayon::prelude::*;

/// Samples along a side of a pixel.
const SAMPLES: usize = 3;
/// Rows of pixels in a band.
const ROWS: usize = 16;
/// Share of the light that comes from everywhere; the page's shader has the same.
const AMBIENT: f32 = 0.32;
/// Towards the light, in the viewer's axes.
const LIGHT: Vec3 = Vec3::new(-0.2526, 0.4210, 0.8711);
/// Lines lie on the faces: they win where they are as near to within this share.
const LIFT: f64 = 1.002;

/// What is drawn, in pixels from the left and the top and nearness.
pub(super) struct Scene<'d> {
    pub(super) corners: &'d [[u32; 3]],
    pub(super) vertices: Vec<[f64; 3]>,
    /// Unit normals at the corners, in the viewer's axes.
    pub(super) normals: Vec<[Vec3; 3]>,
    /// Linear light of each face.
    pub(super) colors: Vec<Vec3>,
    pub(super) lines: Vec<Line>,
}

/// A line of some width, drawn without light.
pub(super) struct Line {
    pub(super) ends: [[f64; 3]; 2],
    /// From its middle to its border.
    pub(super) aside: DVec2,
    pub(super) color: Vec3,
}

/// A triangle on the screen; weights of its corners tell what lies between.
struct Flat {
    points: [[f64; 3]; 3],
}

/// The picture: red, green, blue and opacity, row by row.
pub(super) fn draw(scene: &Scene<'_>, width: usize, height: usize) -> Vec<[u8; 4]> {
    let faces: Vec<[f32; 2]> =
        scene.corners.par_iter().map(|face| reach(face.map(|v| scene.vertices[v as usize]))).collect();
    let lines: Vec<[f32; 2]> = (scene.lines.iter())
        .map(|line| {
            let [low, high] = reach([line.ends[0], line.ends[1], line.ends[0]]);
            let aside = line.aside.y.abs() as f32;
            [low - aside, high + aside]
        })
        .collect();
    let bands = (0..height.div_ceil(ROWS)).into_par_iter().map(|band| {
        let rows = band * ROWS..height.min((band + 1) * ROWS);
        let mut samples = Samples::new(width, rows.start, rows.len());
        let is_here = |reach: &[f32; 2]| reach[0] < rows.end as f32 && reach[1] >= rows.start as f32;
        for f in (0..faces.len()).filter(|&f| is_here(&faces[f])) {
            let flat = Flat { points: scene.corners[f].map(|v| scene.vertices[v as usize]) };
            let [a, b, c] = scene.normals[f];
            samples.fill(&flat, 1.0, |u, v, w| lit(scene.colors[f], u * a + v * b + w * c));
        }
        for line in (0..lines.len()).filter(|&l| is_here(&lines[l])).map(|l| &scene.lines[l]) {
            let moved = |end: [f64; 3], side: f64| [end[0] + side * line.aside.x, end[1] + side * line.aside.y, end[2]];
            let [a, b] = line.ends;
            let sides = [moved(a, -1.0), moved(a, 1.0), moved(b, 1.0), moved(b, -1.0)];
            for points in [[sides[0], sides[1], sides[2]], [sides[0], sides[2], sides[3]]] {
                samples.fill(&Flat { points }, LIFT, |_, _, _| line.color);
            }
        }
        samples.resolve()
    });
    bands.flatten_iter().collect()
}

/// First and last row that a triangle reaches.
fn reach(points: [[f64; 3]; 3]) -> [f32; 2] {
    let rows = points.map(|p| p[1] as f32);
    [rows[0].min(rows[1]).min(rows[2]), rows[0].max(rows[1]).max(rows[2])]
}

/// Light on a surface seen from either side.
fn lit(color: Vec3, normal: Vec3) -> Vec3 {
    let normal = normal.normalize_or(Vec3::Z);
    let towards = if normal.z < 0.0 { -normal } else { normal };
    color * (AMBIENT + (1.0 - AMBIENT) * towards.dot(LIGHT).max(0.0))
}

struct Samples {
    width: usize,
    first: usize,
    rows: usize,
    nearness: Vec<f32>,
    colors: Vec<Vec3>,
}

impl Samples {
    fn new(width: usize, first: usize, rows: usize) -> Self {
        let count = width * rows * SAMPLES * SAMPLES;
        Samples { width, first, rows, nearness: vec![0.0; count], colors: vec![Vec3::ZERO; count] }
    }

    /// Colours the samples that a triangle covers and that nothing nearer does.
    fn fill(&mut self, flat: &Flat, lift: f64, color: impl Fn(f32, f32, f32) -> Vec3) {
        let scale = SAMPLES as f64;
        let [a, b, c] = flat.points.map(|p| DVec2::new(p[0] * scale, (p[1] - self.first as f64) * scale));
        let area = (b - a).perp_dot(c - a);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let (columns, rows) = (self.width * SAMPLES, self.rows * SAMPLES);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range = |low: f64, high: f64, count: usize| {
            let first = (low - 0.5).ceil().max(0.0) as usize;
            first..((high - 0.5).floor() + 1.0).clamp(0.0, count as f64) as usize
        };
        for y in range(low.y, high.y, rows) {
            let (left, right) = across([a, b, c], y as f64 + 0.5);
            for x in range(left.max(low.x), right.min(high.x), columns) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let [u, v] = [(c - b).perp_dot(p - b) / area, (a - c).perp_dot(p - c) / area];
                let w = 1.0 - u - v;
                if u < 0.0 || v < 0.0 || w < 0.0 {
                    continue;
                }
                let nearness = lift * (u * flat.points[0][2] + v * flat.points[1][2] + w * flat.points[2][2]);
                let at = y * columns + x;
                if nearness as f32 > self.nearness[at] {
                    self.nearness[at] = nearness as f32;
                    self.colors[at] = color(u as f32, v as f32, w as f32);
                }
            }
        }
    }

    /// The mean of the samples of every pixel, in linear light; opacity is the share that something covers.
    fn resolve(self) -> Vec<[u8; 4]> {
        let columns = self.width * SAMPLES;
        let pixel = |i: usize| {
            let (x, y) = (i % self.width * SAMPLES, i / self.width * SAMPLES);
            let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
            for at in (y..y + SAMPLES).flat_map(|y| (x..x + SAMPLES).map(move |x| y * columns + x)) {
                if self.nearness[at] > 0.0 {
                    sum += self.colors[at];
                    covered += 1.0;
                }
            }
            if covered == 0.0 {
                return [0; 4];
            }
            let [r, g, b] = (sum / covered).to_array().map(srgb);
            [r, g, b, (255.0 * covered / (SAMPLES * SAMPLES) as f32).round() as u8]
        };
        (0..self.width * self.rows).map(pixel).collect()
    }
}

/// Where a line of a height enters and leaves a triangle that it meets, with some slack.
fn across(corners: [DVec2; 3], y: f64) -> (f64, f64) {
    const SLACK: f64 = 1.0;
    let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
    for (p, q) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
        if (p.y - y) * (q.y - y) <= 0.0 && p.y != q.y {
            let x = p.x + (q.x - p.x) * ((y - p.y) / (q.y - p.y));
            (left, right) = (left.min(x), right.max(x));
        }
    }
    (left - SLACK, right + SLACK)
}

/// An sRGB channel of linear light.
pub(super) fn srgb(light: f32) -> u8 {
    let coded = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * coded).round().clamp(0.0, 255.0) as u8
}
