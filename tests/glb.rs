//! The bytes of a written glTF file, read back without this crate's own reader.

use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

struct Glb {
    json: Value,
    bin: Vec<u8>,
}

impl Glb {
    fn parse(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes")) as usize;
        assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
        let json = word(12);
        assert_eq!((&bytes[16..20], json % 4), (&b"JSON"[..], 0));
        let bin = 20 + json;
        assert_eq!((&bytes[bin + 4..bin + 8], word(bin) + bin + 8), (&b"BIN\0"[..], bytes.len()));
        Glb { json: serde_json::from_slice(&bytes[20..bin]).expect("JSON"), bin: bytes[bin + 8..].to_vec() }
    }

    /// An accessor's numbers, all of which are 32-bit floats here.
    fn floats(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.json["accessors"][accessor.as_u64().expect("an index") as usize];
        assert_eq!(accessor["componentType"], 5126);
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        assert_eq!(view["target"], 34962);
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let length = view["byteLength"].as_u64().expect("a length") as usize;
        assert_eq!(start % 4, 0);
        self.bin[start..start + length]
            .chunks_exact(4)
            .map(|b| f32::from_le_bytes(b.try_into().expect("4 bytes")))
            .collect()
    }
}

fn annotate(input: &str, output: &Path, extra: &[&str]) {
    let run = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(["annotate", input, "-q", "-o"])
        .arg(output)
        .args(extra)
        .current_dir(Path::new(ROOT).join("fixtures"))
        .output()
        .expect("the program starts");
    assert!(matches!(run.status.code(), Some(0 | 3)), "{}", String::from_utf8_lossy(&run.stderr));
}

/// The columns of a CSV by name; an empty field is 0, as in the glTF.
fn csv(path: &Path) -> HashMap<String, Vec<f32>> {
    let text = fs::read_to_string(path).expect("a CSV");
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut columns: HashMap<String, Vec<f32>> = HashMap::new();
    for line in lines {
        for (name, field) in names.iter().zip(line.split(',')) {
            if *name == "method" {
                continue;
            }
            let value = if field.is_empty() { 0.0 } else { field.parse().expect("a number") };
            columns.entry((*name).into()).or_default().push(value);
        }
    }
    columns
}

const NAMES: [(&str, &str); 18] = [
    ("_FACE_ID", "face"),
    ("_CURVATURE_CLASS", "class"),
    ("_CURVATURE_MAX", "k_max"),
    ("_CURVATURE_MIN", "k_min"),
    ("_CURVATURE_MEAN", "mean"),
    ("_CURVATURE_GAUSS", "gauss"),
    ("_CURVATURE_GAUSS_PERIMETER", "gauss_perimeter"),
    ("_SHAPE_INDEX", "shape_index"),
    ("_CURVEDNESS", "curvedness"),
    ("_DIRECTION_MAX_X", "dir_max_x"),
    ("_DIRECTION_MAX_Y", "dir_max_y"),
    ("_DIRECTION_MAX_Z", "dir_max_z"),
    ("_DIRECTION_MIN_X", "dir_min_x"),
    ("_DIRECTION_MIN_Y", "dir_min_y"),
    ("_DIRECTION_MIN_Z", "dir_min_z"),
    ("_RADIUS", "radius"),
    ("_COVERAGE", "coverage"),
    ("_CONFIDENCE", "confidence"),
];

#[test]
fn every_attribute_is_a_finite_float_per_corner_and_equals_the_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    for input in ["suzanne.ply", "fillet_degenerate.stl", "groups.obj", "sphere_be.ply"] {
        let (glb, csv_path) = (folder.path().join("a.glb"), folder.path().join("a.csv"));
        annotate(input, &glb, &["--attributes", "all", "--up", "y"]);
        annotate(input, &csv_path, &["--attributes", "all", "--up", "y"]);
        let glb = Glb::parse(&fs::read(&glb).expect("a GLB"));
        let csv = csv(&csv_path);
        let mut face = 0;
        for mesh in glb.json["meshes"].as_array().expect("meshes") {
            let primitive = &mesh["primitives"][0];
            assert!(primitive.get("indices").is_none() && primitive["attributes"].get("NORMAL").is_none());
            let attributes = primitive["attributes"].as_object().expect("attributes");
            let positions = &glb.json["accessors"][attributes["POSITION"].as_u64().expect("an index") as usize];
            let count = positions["count"].as_u64().expect("a count") as usize;
            let faces = count / 3;
            for (name, index) in attributes {
                let accessor = &glb.json["accessors"][index.as_u64().expect("an index") as usize];
                assert_eq!(accessor["count"], count, "{input} {name}");
                let numbers = glb.floats(index);
                assert!(numbers.iter().all(|n| n.is_finite()), "{input} {name}");
                match name.as_str() {
                    "POSITION" => check_bounds(accessor, &numbers),
                    "TEXCOORD_0" => assert!(numbers.iter().all(|n| (0.0..=1.0).contains(n))),
                    _ => {
                        assert_eq!(accessor["type"], "SCALAR", "{input} {name}");
                        let column = NAMES.iter().find(|(attribute, _)| attribute == name).expect("a known name").1;
                        for (f, corners) in numbers.chunks_exact(3).enumerate() {
                            assert_eq!(corners, [csv[column][face + f]; 3], "{input} {name} of face {}", face + f);
                        }
                    }
                }
            }
            assert_eq!(attributes.len(), 18 + 2, "{input}");
            face += faces;
        }
        assert_eq!(face, csv["face"].len(), "{input}");
        assert!(glb.json["meshes"][0]["extras"]["osculate"]["legend"]["stops"].is_array());
        assert_eq!(
            glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"],
            serde_json::json!([1.0, 1.0, 1.0, 1.0])
        );
    }
}

fn check_bounds(accessor: &Value, numbers: &[f32]) {
    for axis in 0..3 {
        let along = || numbers.iter().skip(axis).step_by(3).copied();
        let bound = |key: &str| accessor[key][axis].as_f64().expect("a bound") as f32;
        assert_eq!(bound("min"), along().fold(f32::INFINITY, f32::min));
        assert_eq!(bound("max"), along().fold(f32::NEG_INFINITY, f32::max));
    }
}

/// STL is Z-up by default: glTF has +Y up, and directions turn along with the positions.
#[test]
fn axes_and_units_are_baked_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate("fillet_part.stl", &path("z.glb"), &["--unit", "mm"]);
    annotate("fillet_part.stl", &path("y.glb"), &["--up", "y"]);
    let read = |name: &str| Glb::parse(&fs::read(path(name)).expect("a GLB"));
    let (z, y) = (read("z.glb"), read("y.glb"));
    let get = |glb: &Glb, name: &str| glb.floats(&glb.json["meshes"][0]["primitives"][0]["attributes"][name]);
    assert_eq!(z.json["nodes"][0].as_object().expect("a node").keys().collect::<Vec<_>>(), ["mesh", "name"]);
    let (turned, plain) = (get(&z, "POSITION"), get(&y, "POSITION"));
    for (t, p) in turned.chunks_exact(3).zip(plain.chunks_exact(3)) {
        for (a, b) in t.iter().zip([p[0], p[2], -p[1]]) {
            assert!((a - 0.001 * b).abs() <= 1e-6 * a.abs());
        }
    }
    let directions =
        |glb: &Glb| ["_DIRECTION_MAX_X", "_DIRECTION_MAX_Y", "_DIRECTION_MAX_Z"].map(|name| get(glb, name));
    let ([tx, ty, tz], [px, py, pz]) = (directions(&z), directions(&y));
    for i in 0..tx.len() {
        assert_eq!([tx[i], ty[i], tz[i]], [px[i], pz[i], -py[i]]);
    }
    for (name, factor) in [("_CURVATURE_MAX", 1e3), ("_CURVATURE_GAUSS", 1e6)] {
        for (a, b) in get(&z, name).into_iter().zip(get(&y, name)) {
            assert!((a - factor * b).abs() <= 1e-6 * a.abs(), "{name}: {a} and {b}");
        }
    }
}

/// Millimetres survive five million metres away: positions are relative to a node's translation.
#[test]
fn georeferenced_coordinates_keep_their_detail() {
    let folder = tempfile::tempdir().expect("a folder");
    let (near, far) = (folder.path().join("near.obj"), folder.path().join("far.obj"));
    let mesh = |x: f64, y: f64| {
        let mut text = String::new();
        for i in 0..21 {
            for j in 0..21 {
                let (u, v) = (f64::from(i) * 0.05, f64::from(j) * 0.05);
                text += &format!("v {:.3} {:.3} {:.3}\n", x + u, y + v, 0.2 * (3.0 * u).sin() * (2.0 * v).cos());
            }
        }
        for i in 0..20 {
            for j in 0..20 {
                let a = 21 * i + j + 1;
                text += &format!("f {a} {} {} {}\n", a + 21, a + 22, a + 1);
            }
        }
        text
    };
    fs::write(&near, mesh(0.0, 0.0)).expect("writable");
    fs::write(&far, mesh(4_500_000.0, 5_400_000.0)).expect("writable");
    let values = |input: &Path| {
        let output = input.with_extension("csv");
        annotate(input.to_str().expect("text"), &output, &[]);
        csv(&output)
    };
    let (a, b) = (values(&near), values(&far));
    // Coordinates there are 1e-9 apart; where a section hardly bends, its curvature goes with the root
    // of what its length differs by.
    for (a, b) in a["k_max"].iter().zip(&b["k_max"]) {
        assert!((a - b).abs() < 1e-3 * (1.0 + a.abs()), "{a} and {b}");
    }
    let output = far.with_extension("glb");
    annotate(far.to_str().expect("text"), &output, &[]);
    let glb = Glb::parse(&fs::read(&output).expect("a GLB"));
    let translation: Vec<f64> = glb.json["nodes"][0]["translation"]
        .as_array()
        .expect("a translation")
        .iter()
        .map(|c| c.as_f64().expect("a number"))
        .collect();
    let p = glb.floats(&glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
    assert!(p.iter().all(|c| c.abs() < 10.0));
    assert!((translation[0] + f64::from(p[0]) - 4_500_000.0).abs() < 1e-3, "{translation:?}");

    // A face that a program left at zero changes nothing for the others.
    let stray = folder.path().join("stray.obj");
    fs::write(&stray, mesh(4_500_000.0, 5_400_000.0) + "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 442 443 444\n").expect("writable");
    annotate(stray.to_str().expect("text"), &output, &["--force"]);
    let glb = Glb::parse(&fs::read(&output).expect("a GLB"));
    let beside = glb.floats(&glb.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]);
    assert!(beside[..p.len()] == p && beside[p.len()] < -4e6);
}

/// More faces than a thread or a block of the writers takes at a time: order and threads matter here.
#[test]
fn large_files_keep_the_order_of_faces_whatever_the_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let grid = osculate::synth::Grid {
        jitter: 0.3,
        ..osculate::synth::Grid::new(osculate::synth::Surface::Torus { major: 3.0, minor: 1.0 }, 300, 100)
    };
    osculate::write_mesh(&grid.build().soup, &path("torus.ply")).expect("written");
    let input = path("torus.ply");
    let input = input.to_str().expect("text");
    annotate(input, &path("1.glb"), &["-j", "1"]);
    annotate(input, &path("3.glb"), &["-j", "3"]);
    assert!(fs::read(path("1.glb")).expect("a GLB") == fs::read(path("3.glb")).expect("a GLB"));
    annotate(input, &path("1.csv"), &["-j", "1"]);
    annotate(input, &path("3.csv"), &["-j", "3"]);
    assert!(fs::read(path("1.csv")).expect("a CSV") == fs::read(path("3.csv")).expect("a CSV"));
    let glb = Glb::parse(&fs::read(path("3.glb")).expect("a GLB"));
    let csv = csv(&path("3.csv"));
    assert_eq!(csv["face"].len(), 60_000);
    let get = |name: &str| glb.floats(&glb.json["meshes"][0]["primitives"][0]["attributes"][name]);
    let k_max: Vec<f32> = get("_CURVATURE_MAX").into_iter().step_by(3).collect();
    assert!(k_max == csv["k_max"]);

    // The palette: its colour at a face's coordinate is the legend's at the face's value.
    let legend = &glb.json["meshes"][0]["extras"]["osculate"]["legend"];
    let high = legend["range"][1].as_f64().expect("a range");
    for (uv, mean) in get("TEXCOORD_0").chunks_exact(6).zip(&csv["mean"]) {
        let share = (0.5 + 0.5 * f64::from(*mean) / high).clamp(0.0, 1.0);
        assert!((f64::from(uv[0]) * 256.0 - 0.5 - share * 254.0).abs() <= 0.51, "{mean}");
    }

    // PLY: quality and colour of every face.
    annotate(input, &path("out.ply"), &["--color-by", "k_max"]);
    let ply = fs::read(path("out.ply")).expect("a PLY");
    let body = ply.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let header = String::from_utf8_lossy(&ply[..body]).into_owned();
    let faces = body + 30_000 * 12;
    let row = (ply.len() - faces) / 60_000;
    assert!(
        header.contains("element vertex 30000\n") && header.contains("property float quality\nproperty uchar red\n")
    );
    for (f, bytes) in ply[faces..].chunks_exact(row).enumerate() {
        let quality = f32::from_le_bytes(bytes[13..17].try_into().expect("4 bytes"));
        assert_eq!((bytes[0], quality), (3, csv["k_max"][f]), "face {f}");
        assert_eq!((bytes[20], bytes[21] as i8), (255, csv["class"][f] as i8), "face {f}");
    }
}

/// The crate that programs in Rust read glTF with validates all it is given, and finds the same triangles and values.
#[test]
fn the_crate_gltf_reads_what_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "character.glb";
    for (input, extra, is_given) in [
        ("suzanne.stl", &[][..], false),
        ("suzanne.stl", &["--layout", "indexed"], false),
        ("suzanne.stl", &["--color", "vertex", "--vertex-values"], false),
        (scene, &[], true),
        (scene, &["--variants", "mean,k_max"], true),
    ] {
        let what = format!("{input} {extra:?}");
        let path = folder.path().join("out.glb");
        annotate(input, &path, extra);
        let bytes = fs::read(&path).expect("a GLB");
        let gltf = gltf::Gltf::from_slice(&bytes).unwrap_or_else(|e| panic!("{what}: {e}"));
        let mut faces = 0;
        for primitive in gltf.meshes().flat_map(|mesh| mesh.primitives()) {
            let reader = primitive.reader(|_| gltf.blob.as_deref());
            let vertices = reader.read_positions().expect("positions").count();
            faces += reader.read_indices().map_or(vertices, |indices| indices.into_u32().count()) / 3;
            let value = primitive.get(&gltf::Semantic::Extras("CURVATURE_MAX".into()));
            if extra != ["--layout", "indexed"] {
                let value = value.unwrap_or_else(|| panic!("{what}: no values"));
                let kinds = (value.data_type(), value.dimensions());
                assert_eq!(kinds, (gltf::accessor::DataType::F32, gltf::accessor::Dimensions::Scalar), "{what}");
                let values = gltf::accessor::Iter::<f32>::new(value, |_| gltf.blob.as_deref()).expect("floats");
                assert_eq!(values.filter(|k| k.is_finite()).count(), vertices, "{what}");
            }
        }
        assert!(is_given || faces == 968, "{what}: {faces} faces");
        assert!(faces > 0, "{what}");
    }
}

/// Vertex colours: sRGB bytes, or the linear light of them.
#[test]
fn vertex_colours_are_in_the_light_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let colors = |carrier: &str| {
        let path = folder.path().join(format!("{carrier}.glb"));
        annotate("suzanne.stl", &path, &["--color", carrier]);
        let glb = Glb::parse(&fs::read(path).expect("a GLB"));
        let index = glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"].as_u64().expect("colours") as usize;
        let accessor = &glb.json["accessors"][index];
        assert_eq!((&accessor["componentType"], &accessor["normalized"]), (&5121.into(), &true.into()));
        let view = &glb.json["bufferViews"][accessor["bufferView"].as_u64().expect("a view") as usize];
        let start = view["byteOffset"].as_u64().expect("an offset") as usize;
        glb.bin[start..start + view["byteLength"].as_u64().expect("a length") as usize].to_vec()
    };
    let (linear, srgb) = (colors("vertex"), colors("vertex-srgb"));
    assert!(srgb.iter().any(|&c| (60..200).contains(&c)));
    for (i, (l, s)) in linear.iter().zip(&srgb).enumerate() {
        let light = if i % 4 == 3 { 1.0 } else { (f64::from(*s) / 255.0).powf(2.2) };
        assert!((f64::from(*l) / 255.0 - light).abs() < 0.02, "{s} became {l}");
    }
}

#[test]
fn layout_indexed_lists_edges_of_the_surface_only() {
    let folder = tempfile::tempdir().expect("a folder");
    // Closed, with eight faces that repeat a vertex; and a tetrahedron of which one face is there twice.
    let twice = folder.path().join("twice.obj");
    fs::write(&twice, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 2 4\n")
        .expect("a file");
    for (input, features) in [("fillet_degenerate.stl", 64), (twice.to_str().expect("a name"), 6)] {
        let path = folder.path().join("indexed.glb");
        annotate(input, &path, &["--layout", "indexed"]);
        let glb = Glb::parse(&fs::read(&path).expect("a GLB"));
        let edges = &glb.json["meshes"][0]["primitives"][0]["extensions"]["OSCULATE_face_values"]["edges"];
        assert_eq!(edges.get("boundary"), None, "{input}");
        let feature = edges["feature"]["accessor"].as_u64().expect("an accessor") as usize;
        assert_eq!(glb.json["accessors"][feature]["count"], 2 * features, "{input}");
    }
}
