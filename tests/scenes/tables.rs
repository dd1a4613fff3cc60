//! NumPy archives, and values of vertices in every format.

use crate::document::{Document, assert_same};
use crate::{annotate, column, fixture};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A NumPy array of an archive: kind, shape as it is written, bytes.
pub(crate) fn array(npz: &[u8], name: &str) -> (String, String, Vec<u8>) {
    use std::io::Read;
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(npz)).expect("an archive");
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).expect("an array").read_to_end(&mut bytes).expect("readable");
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = String::from_utf8(bytes[10..start].to_vec()).expect("text");
    let part = |from: &str, to: &str| {
        header.split(from).nth(1).and_then(|rest| rest.split(to).next()).expect("a part").to_owned()
    };
    (part("'descr': '", "'"), part("'shape': (", ")"), bytes[start..].to_vec())
}

pub(crate) fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("4 bytes"))).collect()
}

#[test]
fn npz_holds_what_the_csv_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("suzanne.stl"), &path("out.npz"), &["--attributes", "all", "--vertex-values"]);
    annotate(&fixture("suzanne.stl"), &path("out.csv"), &["--attributes", "all"]);
    let npz = fs::read(path("out.npz")).expect("an archive");
    let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
    for name in ["k_max", "gauss", "shape_index", "coverage"] {
        let (kind, shape, bytes) = array(&npz, name);
        assert_eq!((kind.as_str(), shape.as_str()), ("<f4", "968,"));
        let values: Vec<f32> = f32s(&bytes).into_iter().map(|v| if v.is_nan() { 0.0 } else { v }).collect();
        assert_eq!(values, column(&csv, name), "{name}");
    }
    let (kind, shape, bytes) = array(&npz, "dir_max");
    assert_eq!((kind.as_str(), shape.as_str()), ("<f4", "968, 3,"));
    assert_eq!(f32s(&bytes).into_iter().skip(1).step_by(3).collect::<Vec<_>>(), column(&csv, "dir_max_y"));
    let (kind, _, bytes) = array(&npz, "class");
    assert_eq!(kind, "|i1");
    assert_eq!(bytes.iter().map(|&b| f32::from(b as i8)).collect::<Vec<_>>(), column(&csv, "class"));
    assert_eq!(array(&npz, "positions").1, "505, 3,");
    let (kind, shape, faces) = array(&npz, "faces");
    assert_eq!((kind.as_str(), shape.as_str(), faces.len()), ("<u4", "968, 3,", 12 * 968));
    assert_eq!(array(&npz, "vertex_mean").1, "505,");
    let (kind, _, settings) = array(&npz, "settings");
    let text: String = settings.chunks_exact(4).map(|b| char::from(b[0])).collect();
    assert!(kind.starts_with("<U") && serde_json::from_str::<Value>(&text).is_ok_and(|s| s["diameters"].is_u64()));
}

/// The properties of the faces of a binary PLY by name, a class as a number.
fn ply_columns(ply: &[u8]) -> BTreeMap<String, Vec<f32>> {
    let end = ply.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8_lossy(&ply[..end]).into_owned();
    let width = |kind: &str| if kind.ends_with("char") { 1 } else { 4 };
    let (mut is_face, mut at, mut start) = (false, 0, end);
    let mut columns = Vec::new();
    for line in header.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            ["element", "face", _] => (is_face, at) = (true, 0),
            ["element", "vertex", count] => start += 12 * count.parse::<usize>().expect("a number"),
            ["property", "list", ..] => at += 13,
            ["property", kind, name] if is_face => {
                columns.push((name.to_owned(), at, kind.to_owned()));
                at += width(kind);
            }
            _ => {}
        }
    }
    let value = |bytes: &[u8], kind: &str| match kind {
        "char" => f32::from(bytes[0] as i8),
        "uchar" => f32::from(bytes[0]),
        _ => f32::from_le_bytes(bytes[..4].try_into().expect("4 bytes")),
    };
    let rows = || ply[start..].chunks_exact(at);
    columns.into_iter().map(|(name, at, kind)| (name, rows().map(|row| value(&row[at..], &kind)).collect())).collect()
}

#[test]
fn ply_holds_what_the_csv_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for extra in [["--color-by", "k_min"], ["--select", "k_min<0"]] {
        let extra = [&extra[..], &["--attributes", "all"]].concat();
        annotate(&fixture("suzanne.stl"), &path("out.ply"), &extra);
        annotate(&fixture("suzanne.stl"), &path("out.csv"), &extra);
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let ply = ply_columns(&fs::read(path("out.ply")).expect("a PLY"));
        for name in ["class", "k_max", "k_min", "mean", "gauss", "shape_index", "dir_min_z", "radius", "confidence"] {
            assert_eq!(ply[name], column(&csv, name), "{name}");
        }
        let shown = if extra.contains(&"--select") { "mean" } else { "k_min" };
        assert_eq!(ply["quality"], ply[shown]);
    }
}

/// The mean of the faces around a vertex is the same in every file, and in every copy of the vertex.
#[test]
fn vertices_have_the_mean_of_the_faces_around() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let vertex_values = |input: &Path, extra: &[&str]| {
        annotate(input, &path("out.glb"), &[&["--vertex-values", "--up", "y"], extra].concat());
        let out = Document::read(&path("out.glb"));
        let primitive = out.json["meshes"][0]["primitives"][0].clone();
        let at: Vec<Vec<u8>> = out.elements(&primitive["attributes"]["POSITION"]);
        let values = f32s(&out.elements(&primitive["attributes"]["_CURVATURE_MEAN_VERTEX"]).concat());
        at.into_iter().zip(values).collect::<BTreeMap<_, _>>()
    };
    annotate(&fixture("suzanne.stl"), &path("out.npz"), &["--vertex-values", "--up", "y"]);
    let npz = fs::read(path("out.npz")).expect("an archive");
    let means = f32s(&array(&npz, "vertex_mean").2);
    let positions = array(&npz, "positions").2;
    let positions = positions.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes")) as f32);
    let positions: Vec<Vec<u8>> = positions
        .collect::<Vec<_>>()
        .chunks_exact(3)
        .map(|p| p.iter().flat_map(|c| c.to_le_bytes()).collect())
        .collect();
    let npz: BTreeMap<_, _> = positions.into_iter().zip(means).collect();
    for extra in [&[][..], &["--layout", "indexed"]] {
        assert_eq!(vertex_values(&fixture("suzanne.stl"), extra), npz, "{extra:?}");
    }
    let faces = vertex_values(&fixture("character.glb"), &[]);
    assert_eq!(faces, vertex_values(&fixture("character.glb"), &["--layout", "indexed"]));
    annotate(&path("out.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
    assert_same(&fixture("character.glb"), &path("bare.glb"), "character");
    annotate(&fixture("suzanne.stl"), &path("out.ply"), &["--vertex-values"]);
    let ply = fs::read(path("out.ply")).expect("a PLY");
    let header = String::from_utf8_lossy(&ply[..1500]).into_owned();
    assert!(header.contains("property float z\nproperty float quality\nproperty float k_max\n"), "{header}");
    // And it can be read again.
    annotate(&path("out.ply"), &path("again.csv"), &[]);
}
