//! How far every estimator is off: `cargo run --release --example accuracy [-- --json]`.
//!
//! Meshes are the program's own, with exact curvature (`osculate synth`). The error of a face is that
//! of k_max or k_min, whichever is worse, relative to the larger of them in magnitude (at least a
//! hundredth of the largest on the mesh); a face without an estimate counts as infinitely wrong. The
//! direction's error is the angle between dir_max and the exact one, where k_max and k_min differ by
//! more than 5 %. Every estimator runs with its default settings, one for all meshes.
//!
//! The order of convergence is that of the 95th percentile over the finest two of three sizes: mean
//! edges halve from one to the next, so an error that falls to a quarter is of order 2. There is none
//! where values are exact to their 32 bits.

#![expect(clippy::print_stdout, reason = "the board is the result")]

use glam::DVec3;
use osculate::synth::{Exact, Grid, RoundedBox, ScanNoise, Surface, Synthetic};
use osculate::{CurvatureOptions, Estimator, FaceCurvature, Mesh, MeshOptions, NoProgress, Positions, Soup, estimate};

const ESTIMATORS: [Estimator; 4] = [Estimator::Auto, Estimator::Osculating, Estimator::Osculating3, Estimator::Tangent];

/// Faces; four times as many halve the edges.
const SIZES: [usize; 3] = [1_250, 5_000, 20_000];

/// Shares of a cell by which parameters move: irregular, but not broken.
const JITTER: f64 = 0.3;

const SEED: u64 = 1;

/// Percent. Values are 32-bit numbers, which round by up to 6e-6: errors of about that size have no order.
const ROUNDING: f64 = 2e-5;

/// Errors of one mesh by one estimator.
#[derive(Clone, Copy)]
struct Errors {
    /// Of the curvatures, in percent.
    median: f64,
    p95: f64,
    /// Of dir_max, in degrees; `None` where no face has a direction.
    direction: Option<[f64; 2]>,
    /// Share of faces whose curvature is off by more than 10 %.
    wrong: f64,
}

/// A line of the board: a mesh, or one surface at several sizes, by one estimator.
struct Line {
    part: &'static str,
    mesh: String,
    estimator: Estimator,
    /// Faces, and their errors.
    errors: Vec<(usize, Errors)>,
}

impl Line {
    /// Power of the mean edge with which the 95th percentile falls between the last two sizes.
    fn order(&self) -> Option<f64> {
        let [.., (coarse, before), (fine, after)] = self.errors[..] else { return None };
        let edges = (fine as f64 / coarse as f64).sqrt();
        let order = (before.p95 / after.p95).ln() / edges.ln();
        (order.is_finite() && after.p95 > ROUNDING).then_some(order)
    }
}

fn main() {
    let json = std::env::args().any(|arg| arg == "--json");
    let mut board = Vec::new();
    for (part, mesh, sizes) in meshes() {
        for estimator in ESTIMATORS {
            let errors = sizes.iter().map(|mesh| (mesh.soup.face_count(), errors(mesh, estimator))).collect();
            let line = Line { part, mesh: mesh.clone(), estimator, errors };
            if !json {
                print_line(&line, board.last());
            }
            board.push(line);
        }
    }
    if json {
        println!("{}", serde_json::Value::from(board.iter().map(json_of).collect::<Vec<_>>()));
    }
}

/// Parts of the board: their names, the meshes' names, and each mesh at its sizes.
fn meshes() -> Vec<(&'static str, String, Vec<Synthetic>)> {
    let torus = Surface::Torus { major: 3.0, minor: 1.0 };
    let ellipsoid = Surface::Ellipsoid { axes: DVec3::new(1.0, 1.5, 2.2) };
    let irregular = |surface, faces| Grid { jitter: JITTER, seed: SEED, ..Grid::with_faces(surface, faces, 1.0) };
    let mut meshes = Vec::new();
    let surfaces = [
        ("sphere", Surface::Sphere { radius: 1.0 }),
        ("cylinder", Surface::Cylinder { radius: 1.0, height: 2.0 }),
        ("torus", torus),
        ("ellipsoid", ellipsoid),
        ("saddle", Surface::Saddle),
        ("monkey saddle", Surface::MonkeySaddle),
        ("wave", Surface::Wave),
    ];
    for (name, surface) in surfaces {
        let sizes = SIZES.map(|faces| irregular(surface, faces).build());
        meshes.push(("irregular meshes", name.to_owned(), sizes.into()));
    }
    let shaken = [("torus", torus), ("ellipsoid", ellipsoid), ("wave", Surface::Wave)];
    for (name, surface) in shaken {
        for noise in [0.01, 0.1] {
            let mesh = Grid { noise, ..irregular(surface, 10_000) }.build();
            meshes.push(("noise, in mean edges", format!("{name} {noise}"), vec![mesh]));
        }
    }
    for (name, surface) in shaken {
        for deviation in [0.02, 0.05, 0.1] {
            let scan = ScanNoise { deviation, view: DVec3::new(1.0, 2.0, 3.0), seed: SEED };
            let mesh = scan.apply(irregular(surface, 10_000).build());
            meshes.push(("scan noise, in mean edges", format!("{name} {deviation}"), vec![mesh]));
        }
    }
    let rims = Surface::Cylinder { radius: 10.0, height: 10.0 };
    meshes.push(("engineering parts", "cylinder, rim to rim".to_owned(), vec![Grid::new(rims, 24, 1).build()]));
    for (name, flat_cells, fillet_cells) in [("coarse", 10, 3), ("fine", 25, 8)] {
        let size = DVec3::new(3.0, 2.0, 1.6);
        let part = RoundedBox { size, fillet: 0.25, flat_cells, fillet_cells, noise: 0.0, seed: 0 }.build();
        meshes.push(("engineering parts", format!("fillet box, {name}, 32-bit"), vec![as_32_bit(&part)]));
        meshes.push(("engineering parts", format!("fillet box, {name}"), vec![part]));
    }
    meshes
}

/// The mesh as most files hold it.
fn as_32_bit(mesh: &Synthetic) -> Synthetic {
    let positions = &mesh.soup.positions;
    let points = (0..positions.len()).map(|v| positions.get(v).as_vec3().to_array()).collect();
    Synthetic { soup: Soup::new(Positions::F32(points), mesh.soup.triangles.clone()), exact: mesh.exact.clone() }
}

fn errors(synthetic: &Synthetic, estimator: Estimator) -> Errors {
    let mesh = Mesh::from_soup(&synthetic.soup, &MeshOptions::default()).expect("a mesh");
    let options = CurvatureOptions { estimator, ..CurvatureOptions::default() };
    let values = estimate(&mesh, &options, &NoProgress).expect("valid options");
    let largest = |e: &Exact| e.k_max.abs().max(e.k_min.abs());
    let floor = 0.01 * synthetic.exact.iter().map(largest).fold(0.0, f64::max);
    let faces = || values.iter().zip(&synthetic.exact);

    let curvature = |(value, exact): (&FaceCurvature, &Exact)| {
        let error = (f64::from(value.k_max) - exact.k_max).abs().max((f64::from(value.k_min) - exact.k_min).abs());
        let error = 100.0 * error / largest(exact).max(floor);
        if value.is_estimated() && error.is_finite() { error } else { f64::INFINITY }
    };
    let mut curvatures: Vec<f64> = faces().map(curvature).collect();
    let wrong = curvatures.iter().filter(|&&error| error > 10.0).count() as f64 / curvatures.len() as f64;

    let has_direction = |e: &Exact| e.k_max - e.k_min > 0.05 * largest(e).max(floor);
    let angle = |(value, exact): (&FaceCurvature, &Exact)| {
        let direction = value.dir_max.as_dvec3();
        let tangent = direction - direction.dot(exact.normal) * exact.normal;
        let angle = tangent.cross(exact.dir_max).length().atan2(tangent.dot(exact.dir_max).abs()).to_degrees();
        // A face without estimate has no direction at all.
        if tangent.length() > 1e-9 { angle } else { 90.0 }
    };
    let mut angles: Vec<f64> = faces().filter(|(_, exact)| has_direction(exact)).map(angle).collect();
    Errors {
        median: percentile(&mut curvatures, 0.5),
        p95: percentile(&mut curvatures, 0.95),
        direction: (!angles.is_empty()).then(|| [percentile(&mut angles, 0.5), percentile(&mut angles, 0.95)]),
        wrong,
    }
}

/// The least value that at least this share of them does not exceed.
fn percentile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let rank = (share * values.len() as f64).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1]
}

fn print_line(line: &Line, before: Option<&Line>) {
    if before.is_none_or(|before| before.part != line.part) {
        println!("\n{}: median / 95th percentile of the curvatures in %, of dir_max in degrees", line.part);
    }
    let name = if before.is_none_or(|before| before.mesh != line.mesh) { line.mesh.as_str() } else { "" };
    let cells: Vec<String> = line
        .errors
        .iter()
        .map(|(faces, errors)| {
            let curvature = format!("{} / {}", short(errors.median), short(errors.p95));
            let direction = errors.direction.map_or("-".into(), |[m, p]| format!("{} / {}", short(m), short(p)));
            format!("{faces:>7} faces {curvature:>16} {direction:>16}")
        })
        .collect();
    let last = match line.order() {
        Some(order) => format!("order {order:.1}"),
        None if line.errors.len() > 1 => "no order".to_owned(),
        None => format!("off by > 10 %: {:.1} % of faces", 100.0 * line.errors[0].1.wrong),
    };
    println!("{name:28} {:12} {}  {last}", line.estimator.name(), cells.join(" "));
}

/// Three significant digits, without the tails of tiny numbers.
fn short(value: f64) -> String {
    match value {
        v if !v.is_finite() => "inf".to_owned(),
        0.0 => "0".to_owned(),
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 0.001 => format!("{v:.*}", (2 - v.log10().floor() as i32).max(0) as usize),
        v => format!("{v:.0e}"),
    }
}

fn json_of(line: &Line) -> serde_json::Value {
    let sizes: Vec<serde_json::Value> = line
        .errors
        .iter()
        .map(|(faces, errors)| {
            serde_json::json!({
                "faces": faces,
                "curvature_percent": { "median": errors.median, "p95": errors.p95 },
                "direction_degrees": errors.direction.map(|[median, p95]| serde_json::json!({ "median": median, "p95": p95 })),
                "share_off_by_10_percent": errors.wrong,
            })
        })
        .collect();
    serde_json::json!({
        "part": line.part, "mesh": line.mesh, "estimator": line.estimator.name(), "sizes": sizes, "order": line.order(),
    })
}
