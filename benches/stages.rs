//! How long each stage takes on a torus of 100,000 faces: `cargo bench`, or `cargo bench -- weld`.
//!
//! All on one thread, except where the name says so. Throughput is in faces.

#![allow(missing_docs, reason = "criterion's macros make undocumented functions")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use osculate::synth::{Grid, Surface};
use osculate::{
    AnnotateOptions, Annotation, ColorCarrier, ColorRange, ColorScale, CurvatureOptions, Destination, Estimator,
    InputFormat, Layout, Mesh, MeshOptions, NoProgress, OutputFormat, Positions, Quantity, Radius, Selection, Soup,
    Space, estimate, read_bytes, write, write_mesh,
};
use std::fmt::Write;
use std::path::Path;

const FACES: usize = 100_000;

fn torus(faces: usize) -> Soup {
    let mut grid = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, faces, 1.0);
    grid.jitter = 0.2;
    grid.build().soup
}

/// The same triangles with three positions of their own each, as STL has them.
fn loose(soup: &Soup) -> Soup {
    let corner = |&c: &u32| soup.positions.get(c as usize).as_vec3().to_array();
    let positions: Vec<[f32; 3]> = soup.triangles.as_flattened().iter().map(corner).collect();
    let triangles = (0..soup.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    Soup::new(Positions::F32(positions), triangles)
}

/// Faces in an order without any locality, always the same.
fn shuffled(soup: &Soup) -> Soup {
    let mut triangles = soup.triangles.clone();
    let mut random = 1_u64;
    for last in (1..triangles.len()).rev() {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        triangles.swap(last, (random >> 33) as usize % (last + 1));
    }
    Soup::new(soup.positions.clone(), triangles)
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

fn meshing(criterion: &mut Criterion) {
    let shared = torus(FACES);
    let soups = [("loose", loose(&shared)), ("shuffled", loose(&shuffled(&shared))), ("shared", shared)];
    let mut group = criterion.benchmark_group("mesh");
    for (name, soup) in &soups {
        group.throughput(Throughput::Elements(soup.face_count() as u64));
        let (positions, faces) = osculate::stages::weld(soup);
        let pool = pool(1);
        group.bench_function(BenchmarkId::new("weld", name), |b| {
            b.iter(|| pool.install(|| osculate::stages::weld(soup)));
        });
        group.bench_function(BenchmarkId::new("adjacency", name), |b| {
            b.iter(|| pool.install(|| osculate::stages::connect(faces.clone(), positions.len())));
        });
        group.bench_function(BenchmarkId::new("all", name), |b| {
            b.iter(|| pool.install(|| Mesh::from_soup(soup, &MeshOptions::default())));
        });
    }
    group.finish();
}

/// A file's bytes in each format.
fn files(soup: &Soup, annotation: &Annotation<'_>) -> Vec<(&'static str, InputFormat, Vec<u8>)> {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = |name: &str| {
        let path = folder.path().join(name);
        write_mesh(soup, &path).expect("written");
        std::fs::read(path).expect("readable")
    };
    let annotated = |name: &str, format| {
        let path = folder.path().join(name);
        write(annotation, format, &Destination::File(path.clone()), &NoProgress).expect("written");
        std::fs::read(path).expect("readable")
    };
    let mut ascii = String::from("solid torus\n");
    let mut off = format!("OFF\n{} {} 0\n", soup.positions.len(), soup.face_count());
    let corner = |c: u32| soup.positions.get(c as usize).as_vec3();
    for v in 0..soup.positions.len() as u32 {
        let p = corner(v);
        writeln!(off, "{} {} {}", p.x, p.y, p.z).expect("a string");
    }
    for triangle in &soup.triangles {
        writeln!(off, "3 {} {} {}", triangle[0], triangle[1], triangle[2]).expect("a string");
        ascii.push_str("facet normal 0 0 0\nouter loop\n");
        for p in triangle.map(corner) {
            writeln!(ascii, "vertex {:e} {:e} {:e}", p.x, p.y, p.z).expect("a string");
        }
        ascii.push_str("endloop\nendfacet\n");
    }
    ascii.push_str("endsolid torus\n");
    vec![
        ("stl", InputFormat::Stl, mesh("a.stl")),
        ("stl-ascii", InputFormat::Stl, ascii.into_bytes()),
        ("ply", InputFormat::Ply, mesh("a.ply")),
        ("obj", InputFormat::Obj, mesh("a.obj")),
        ("off", InputFormat::Off, off.into_bytes()),
        ("glb", InputFormat::Gltf, annotated("a.glb", OutputFormat::Glb)),
    ]
}

fn reading_and_writing(criterion: &mut Criterion) {
    let soup = torus(FACES);
    let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
    // Values do not matter here, only that every face has some.
    let options =
        CurvatureOptions { estimator: Estimator::Osculating, radius: Radius::FaceFactor(1.5), ..Default::default() };
    let values = estimate(&mesh, &options, &NoProgress).expect("valid options");
    let annotation = |layout| Annotation {
        mesh: &mesh,
        values: &values,
        name: "torus".into(),
        selected: None,
        vertex_values: None,
        selection: Selection::default(),
        colors: vec![ColorScale::new(Quantity::Mean, None, ColorRange::Auto, &values).expect("a scale")],
        carrier: ColorCarrier::Texture,
        layout,
        force: false,
        metadata: false,
        compress: false,
        space: Space::default(),
        provenance: serde_json::Value::Null,
    };
    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Elements(soup.face_count() as u64));
    for (name, format, bytes) in files(&soup, &annotation(Layout::Indexed)) {
        let pool = pool(1);
        group.bench_function(name, |b| {
            b.iter(|| pool.install(|| read_bytes(&bytes, format, None).expect("readable")));
        });
    }
    group.finish();

    let mut group = criterion.benchmark_group("write");
    group.throughput(Throughput::Elements(soup.face_count() as u64));
    let nowhere = Destination::File(Path::new("/dev/null").into());
    for (name, format, layout) in [
        ("glb", OutputFormat::Glb, Layout::Faces),
        ("glb-indexed", OutputFormat::Glb, Layout::Indexed),
        ("ply", OutputFormat::Ply, Layout::Faces),
        ("csv", OutputFormat::Csv, Layout::Faces),
        ("npz", OutputFormat::Npz, Layout::Faces),
    ] {
        let annotation = annotation(layout);
        let pool = pool(1);
        group.bench_function(name, |b| {
            b.iter(|| pool.install(|| write(&annotation, format, &nowhere, &NoProgress).expect("written")));
        });
    }
    group.finish();
}

fn estimating(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("estimate");
    group.sample_size(10);
    let clean = torus(FACES / 5);
    let mut grid = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, FACES / 5, 1.0);
    grid.noise = 0.05;
    let noisy = grid.build().soup;
    for (name, soup) in [("clean", &clean), ("noisy", &noisy), ("shuffled", &shuffled(&clean))] {
        let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
        group.throughput(Throughput::Elements(mesh.face_count() as u64));
        for (estimator, radius, threads) in [
            (Estimator::Auto, Radius::Auto, 1),
            (Estimator::Auto, Radius::Auto, 2),
            (Estimator::Osculating, Radius::FaceFactor(3.0), 1),
            (Estimator::Osculating, Radius::FaceFactor(3.0), 2),
            (Estimator::Tangent, Radius::FaceFactor(3.0), 1),
        ] {
            let options = CurvatureOptions { estimator, radius, ..AnnotateOptions::default().curvature };
            let id = BenchmarkId::new(format!("{}-j{threads}", estimator.name()), name);
            let pool = pool(threads);
            group.bench_function(id, |b| {
                b.iter(|| pool.install(|| estimate(&mesh, &options, &NoProgress).expect("valid options")));
            });
        }
    }
    group.finish();
}

/// The walk by the radius: time grows with the edges that legs cross.
fn walking(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("walk");
    group.sample_size(10);
    let mesh = Mesh::from_soup(&torus(FACES / 5), &MeshOptions::default()).expect("a mesh");
    group.throughput(Throughput::Elements(mesh.face_count() as u64));
    for factor in [1.0, 2.0, 4.0, 8.0] {
        let radius = Radius::FaceFactor(factor);
        let options = CurvatureOptions { estimator: Estimator::Osculating, radius, ..CurvatureOptions::default() };
        let pool = pool(1);
        group.bench_function(BenchmarkId::new("osculating", factor), |b| {
            b.iter(|| pool.install(|| estimate(&mesh, &options, &NoProgress).expect("valid options")));
        });
    }
    group.finish();
}

criterion_group!(benches, meshing, reading_and_writing, estimating, walking);
criterion_main!(benches);
