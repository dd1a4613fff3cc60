//! The numbers of a page: per-face and per-vertex arrays as deflated byte planes in base64 (docs/report.md).

use super::display::Display;
use crate::curvature::{FaceCurvature, Method};
use crate::mesh::{EdgeKind, Face, Mesh};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::{Compression, write::ZlibEncoder};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::io::Write;

/// An array of whole numbers, or of floats as their bits.
pub(super) struct Array {
    pub(super) name: &'static str,
    /// Numbers in it.
    pub(super) count: usize,
    /// Low bytes of each number that are there; the others are zero.
    pub(super) planes: usize,
    /// Plane after plane, deflated, in base64.
    pub(super) text: String,
}

/// Everything that the page draws of one mesh.
pub(super) struct Packed {
    /// Where the quantised coordinates have their zero.
    pub(super) low: DVec3,
    /// Length of one step of the quantised coordinates.
    pub(super) step: f64,
    /// Longest side of the box around the drawn faces.
    pub(super) size: f64,
    pub(super) vertices: usize,
    pub(super) arrays: Vec<Array>,
}

/// Mantissa bits of radii and perimeter curvatures, which are only read as text: four digits.
const COARSE_BITS: u32 = 13;
/// Steps of the quantised coordinates in a short edge: shading by the faces' normals stays smooth.
const STEPS_PER_EDGE: f64 = 256.0;

/// Packs the drawn faces. One value for each of them stands in every per-face array.
pub(super) fn pack(mesh: &Mesh, values: &[FaceCurvature], display: &Display) -> Packed {
    let (order, codes) = by_first_use(display);
    let (low, size, step) = grid(display, &order);
    let count = display.corners.len();
    let of_face = |name, bits: &(dyn Fn(Face, &FaceCurvature) -> u32 + Sync)| {
        let bits = |i: usize| bits(display.number(i), &values[display.number(i).index()]);
        array(name, &(0..count).into_par_iter().map(bits).collect::<Vec<_>>())
    };
    // A few faces have it whatever the estimator: those that fell back on sections.
    let with_perimeter = values.iter().filter(|v| v.gauss_perimeter.is_finite()).count();
    let has_perimeter = with_perimeter > values.len() / 2;
    let arrays: Vec<Array> = (0..11)
        .into_par_iter()
        .filter_map(|which| {
            Some(match which {
                0 => of_face("k_max", &|_, v| v.k_max.to_bits()),
                1 => of_face("k_min", &|_, v| v.k_min.to_bits()),
                2 => array("corners", &codes),
                3 => array("positions", &steps(display, &order, low, step)),
                4 => of_face("direction", &|f, v| direction(v.dir_max, display, f)),
                5 => of_face("radius", &|_, v| coarse(v.radius)),
                6 => of_face("confidence", &|_, v| share(v.confidence)),
                7 => of_face("coverage", &|_, v| share(v.coverage)),
                8 => of_face("kind", &|_, v| (v.class.code() + 1) as u32 | method(v.method) << 3),
                9 => of_face("edges", &|f, _| edges(mesh, f, display)),
                _ if has_perimeter => of_face("gauss_perimeter", &|_, v| coarse(v.gauss_perimeter)),
                _ => return None,
            })
        })
        .chain(display.numbers.as_ref().map(|numbers| {
            let mut before = 0;
            let steps: Vec<u32> = numbers.iter().map(|&n| n - std::mem::replace(&mut before, n)).collect();
            array("numbers", &steps)
        }))
        .collect();
    Packed { low, step, size, vertices: order.len(), arrays }
}

/// The vertices in the order of their first use, and for every corner how far its vertex lies behind the
/// newest one: 0 for a new vertex. Neighbours in the file stay neighbours, so most codes are small.
fn by_first_use(display: &Display) -> (Vec<u32>, Vec<u32>) {
    const UNUSED: u32 = u32::MAX;
    let mut place = vec![UNUSED; display.positions.len()];
    let mut order = Vec::with_capacity(display.positions.len());
    let codes = (display.corners.as_flattened().iter())
        .map(|&v| {
            let place = &mut place[v as usize];
            if *place == UNUSED {
                *place = order.len() as u32;
                order.push(v);
                return 0;
            }
            order.len() as u32 - *place
        })
        .collect();
    (order, codes)
}

/// The least corner of the box, its longest side and the length of a step: fine enough for short edges, at most 2^21
/// steps.
fn grid(display: &Display, order: &[u32]) -> (DVec3, f64, f64) {
    let used = order.iter().map(|&v| display.positions[v as usize]);
    let (low, high) = used.fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
    let size = (high - low).max_element().min(f64::MAX);
    // Every so many faces tell enough of the edges' lengths.
    let every = (display.corners.len() / 10_000).max(1);
    let mut edges: Vec<f64> = (0..display.corners.len())
        .step_by(every)
        .map(|i| display.triangle(i))
        .map(|[a, b, c]| a.distance(b).min(b.distance(c)).min(c.distance(a)))
        .filter(|&length| length > 0.0)
        .collect();
    edges.sort_unstable_by(f64::total_cmp);
    let short = edges.get(edges.len() / 4).copied().unwrap_or(size);
    let finest = size / f64::from(1 << 21);
    let step = (short / STEPS_PER_EDGE).clamp(finest, size / f64::from(1 << 14));
    if step > 0.0 { (low, size, step) } else { (low, 1.0, 1.0) }
}

/// Differences of quantised coordinates from vertex to vertex, all x, all y, all z; the sign in the lowest bit.
fn steps(display: &Display, order: &[u32], low: DVec3, step: f64) -> Vec<u32> {
    let mut all = Vec::with_capacity(3 * order.len());
    for axis in 0..3 {
        let mut before = 0;
        all.extend(order.iter().map(|&v| {
            let at = ((display.positions[v as usize][axis] - low[axis]) / step).round() as i32;
            let difference = at - std::mem::replace(&mut before, at);
            (difference << 1 ^ difference >> 31) as u32
        }));
    }
    all
}

/// A direction, sign free, as two bytes: the octahedral map of the half space with z up.
fn direction(direction: Vec3, display: &Display, face: Face) -> u32 {
    let placed = match display.body(face) {
        Some(body) => body.matrix.transform_vector3(direction.as_dvec3()).as_vec3(),
        None => direction,
    };
    let d = if placed.z < 0.0 { -placed } else { placed };
    let sum = d.x.abs() + d.y.abs() + d.z;
    if !(sum > 0.0 && sum.is_finite()) {
        return 0x7f7f;
    }
    let (x, y) = (d.x / sum, d.y / sum);
    let byte = |c: f32| ((c * 0.5 + 0.5) * 254.0).round() as u32;
    byte(x + y) | byte(x - y) << 8
}

/// A float with fewer bits of mantissa, rounded to nearest: its last byte is zero.
fn coarse(value: f32) -> u32 {
    const CUT: u32 = 23 - COARSE_BITS;
    if !value.is_finite() {
        return f32::NAN.to_bits() >> CUT << CUT;
    }
    (value.to_bits() + (1 << (CUT - 1))) >> CUT << CUT
}

fn share(value: f32) -> u32 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u32
}

fn method(method: Method) -> u32 {
    Method::ALL.iter().position(|&m| m == method).unwrap_or(0) as u32
}

/// The kinds of a face's three edges, two bits each; a thinned mesh has none of its own.
fn edges(mesh: &Mesh, face: Face, display: &Display) -> u32 {
    let counted = mesh.is_in_surface(face);
    if !counted || display.numbers.is_some() {
        return 0;
    }
    let kind = |kind| match kind {
        EdgeKind::Inner => 0,
        EdgeKind::Boundary => 1,
        EdgeKind::Feature => 2,
        EdgeKind::NonManifold => 3,
    };
    let [a, b, c] = face.half_edges().map(|h| kind(mesh.edge_kind(h)));
    a | b << 2 | c << 4
}

/// Splits the numbers into planes of bytes, which deflate finds more in, and deflates them.
fn array(name: &'static str, bits: &[u32]) -> Array {
    let union = bits.iter().fold(0, |all, &b| all | b);
    let planes = (4 - union.leading_zeros() as usize / 8).max(1);
    let mut deflated = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    let mut plane: Vec<u8> = Vec::with_capacity(bits.len());
    for p in 0..planes {
        plane.clear();
        plane.extend(bits.iter().map(|b| (b >> (8 * p)) as u8));
        // Writing to memory cannot fail.
        let _ = deflated.write_all(&plane);
    }
    let deflated = deflated.finish().unwrap_or_default();
    Array { name, count: bits.len(), planes, text: STANDARD.encode(deflated) }
}

/// Of deflate: more work saves less than half a percent.
const LEVEL: u32 = 6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_floats_are_right_to_four_digits() {
        for value in [1.0_f32, -3.7e-12, 65_537.9, 0.1, f32::MIN_POSITIVE, 0.0] {
            let packed = f32::from_bits(coarse(value));
            assert!((packed - value).abs() <= 1e-4 * value.abs(), "{value} became {packed}");
            assert_eq!(coarse(value) & 0xff, 0);
        }
        assert!(f32::from_bits(coarse(f32::NAN)).is_nan() && f32::from_bits(coarse(f32::INFINITY)).is_nan());
    }

    #[test]
    fn directions_are_right_to_a_degree() {
        let display = Display {
            positions: Vec::new(),
            corners: Vec::new(),
            numbers: None,
            bodies: Vec::new(),
            instances_left_out: 0,
        };
        for i in 0..1000_u32 {
            let angle = |n: u32| f64::from(i * n % 1000) * 0.006_283;
            let d = glam::DVec2::from_angle(angle(7)) * angle(3).sin();
            let d = d.extend(angle(3).cos()).as_vec3();
            let code = direction(d, &display, Face(0));
            let [a, b] = [code & 255, code >> 8].map(|byte| byte as f32 / 127.0 - 1.0);
            let (x, y) = ((a + b) / 2.0, (a - b) / 2.0);
            let packed = Vec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize();
            assert!(packed.dot(d).abs() > 0.99985, "{d} became {packed}");
        }
    }
}
