//! What the fuzzers run. The crate's own tests run the same functions on seeds with a fixed
//! random sequence (`tests/fuzz.rs`).
#![allow(dead_code, reason = "each fuzzer runs one of them")]

use glam::DVec3;
use osculate::{
    CurvatureOptions, Estimator, Face, InputFormat, Mesh, MeshOptions, NoProgress, Plane, Positions, Radius, Soup, cut,
    estimate, read_bytes,
};
use std::io::{Cursor, Write};

/// Faces of which a mesh is built after reading; more would only slow the fuzzer down.
const MOST_FACES: usize = 2000;

pub(crate) fn stl(bytes: &[u8]) {
    reader(InputFormat::Stl, bytes);
}

pub(crate) fn obj(bytes: &[u8]) {
    reader(InputFormat::Obj, bytes);
}

pub(crate) fn ply(bytes: &[u8]) {
    reader(InputFormat::Ply, bytes);
}

pub(crate) fn gltf(bytes: &[u8]) {
    reader(InputFormat::Gltf, bytes);
}

pub(crate) fn off(bytes: &[u8]) {
    reader(InputFormat::Off, bytes);
}

/// The archive; XML that is not packed is packed first, since a fuzzer has no way into what is
/// compressed and checked by a sum.
pub(crate) fn threemf(bytes: &[u8]) {
    if !bytes.trim_ascii_start().starts_with(b"<") {
        return reader(InputFormat::ThreeMf, bytes);
    }
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    let packed = archive.start_file("3D/3dmodel.model", stored).is_ok() && archive.write_all(bytes).is_ok();
    if let Ok(archive) = archive.finish()
        && packed
    {
        reader(InputFormat::ThreeMf, archive.get_ref());
    }
}

/// Input compressed with gzip.
pub(crate) fn gz(bytes: &[u8]) {
    reader(InputFormat::Stl, bytes);
}

/// Reads; what could be read keeps its promises and becomes a mesh.
fn reader(format: InputFormat, bytes: &[u8]) {
    match read_bytes(bytes, format, None) {
        Ok(soup) => {
            keeps_its_promises(&soup);
            if soup.face_count() <= MOST_FACES
                && let Ok(mesh) = Mesh::from_soup(&soup, &MeshOptions::default())
            {
                mesh.sanity_check();
            }
        }
        Err(error) => {
            let text = error.to_string();
            assert!(!text.is_empty() && text.len() < 2000 && !text.contains('\n'), "no sentence: {text}");
        }
    }
}

fn keeps_its_promises(soup: &Soup) {
    let count = soup.positions.len() as u64;
    assert!(soup.triangles.iter().flatten().all(|&v| u64::from(v) < count), "a corner out of range");
    let mut next = 0;
    for body in &soup.bodies {
        assert_eq!(body.faces.start, next, "bodies have no gaps");
        next = body.faces.end;
    }
    assert_eq!(next as usize, soup.face_count(), "bodies cover all faces");
    let mut next = 0;
    for group in &soup.groups {
        assert!(group.faces.start >= next && group.faces.start <= group.faces.end, "groups are in order");
        next = group.faces.end;
    }
    assert!(next as usize <= soup.face_count(), "groups end with the faces");
    if let Some(scene) = &soup.scene {
        let bodies = soup.bodies.len();
        let inside = |list: &[usize]| list.iter().all(|&n| n < scene.nodes.len());
        assert!(inside(&scene.roots) && scene.nodes.iter().all(|n| inside(&n.children)), "a node out of range");
        assert!(scene.nodes.iter().all(|n| n.body.is_none_or(|b| b < bodies)), "a body out of range");
    }
}

/// Builds and estimates an arbitrary soup: three bytes of options, then vertices of a small grid, so
/// that coincidences are frequent, or of any 32-bit floats, and faces over them.
pub(crate) fn mesh(bytes: &[u8]) {
    let Some((&[kind, options, how_many], rest)) = bytes.split_first_chunk() else { return };
    let positions: Vec<[f64; 3]> = match kind % 3 {
        0 => rest.chunks_exact(3).map(|c| [c[0] % 5, c[1] % 5, c[2] % 5].map(f64::from)).collect(),
        1 => rest.chunks_exact(3).map(|c| [c[0], c[1], c[2]].map(|b| f64::from(b as i8) / 16.0)).collect(),
        _ => {
            let (words, _) = rest.as_chunks::<12>();
            let float = |w: &[u8]| f64::from(f32::from_le_bytes([w[0], w[1], w[2], w[3]]));
            words.iter().map(|w| [float(&w[..4]), float(&w[4..8]), float(&w[8..])]).collect()
        }
    };
    let positions: Vec<_> = positions.into_iter().take(1 + how_many as usize % 64).collect();
    if positions.is_empty() {
        return;
    }
    let used = positions.len() * if kind % 3 == 2 { 12 } else { 3 };
    let count = positions.len() as u32;
    let corners = rest[used.min(rest.len())..].chunks_exact(3).take(200);
    let triangles: Vec<[u32; 3]> = corners.map(|c| [c[0], c[1], c[2]].map(|b| u32::from(b) % count)).collect();
    let soup = Soup::new(Positions::F64(positions), triangles);
    let weld = [0.0, 0.0, 1e-3, 0.3][options as usize % 4];
    let feature_angle = [40.0, 0.0, 180.0, 90.0][options as usize / 4 % 4];
    let Ok(mesh) = Mesh::from_soup(&soup, &MeshOptions { weld, feature_angle }) else { return };
    mesh.sanity_check();
    let estimators = [Estimator::default(), Estimator::Osculating, Estimator::Osculating3, Estimator::Tangent];
    let radii = [Radius::Auto, Radius::FaceFactor(3.0), Radius::Length(1.0), Radius::MeshFactor(0.5)];
    let settings = CurvatureOptions {
        estimator: estimators[options as usize / 16 % 4],
        radius: radii[options as usize / 64],
        diameters: 3 + kind as usize % 10,
        ..CurvatureOptions::default()
    };
    if let Ok(values) = estimate(&mesh, &settings, &NoProgress) {
        assert_eq!(values.len(), mesh.face_count());
        for (f, value) in values.iter().enumerate().filter(|(_, v)| v.is_estimated()) {
            assert!(value.k_max >= value.k_min, "face {f}: {value:?}");
            assert!((0.0..=1.0).contains(&value.coverage), "face {f}: {value:?}");
            assert!((0.0..=1.0).contains(&value.confidence), "face {f}: {value:?}");
            assert!(value.k_max.is_finite() && value.k_min.is_finite(), "face {f}: {value:?}");
            assert!(value.mean().is_finite() && value.radius >= 0.0, "face {f}: {value:?}");
            assert!((value.dir_max.length() - 1.0).abs() < 1e-4, "face {f}: {value:?}");
            assert!(value.dir_max.dot(value.dir_min).abs() < 1e-4, "face {f}: {value:?}");
            assert!(mesh.face_state(Face(f as u32)) != osculate::FaceState::NotFinite);
        }
    }
    let plane = Plane { point: mesh.positions()[0], normal: DVec3::new(0.6, 0.0, 0.8) };
    for line in cut(&mesh, &plane, &NoProgress) {
        assert!(line.points.len() > 1);
    }
}
