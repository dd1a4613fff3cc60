//! Inputs in every wrapping: compressed, piped, in other encodings, with files beside them.

mod common;

use common::{differing, mesh_of, values_of};
use flate2::Compression;
use flate2::write::GzEncoder;
use osculate::{
    CurvatureOptions, Estimator, InputFormat, NoProgress, Positions, ReadOptions, Soup, read, read_bytes, read_with,
};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn soup_of(path: &Path) -> Soup {
    read(path, &NoProgress).unwrap_or_else(|e| panic!("{e}")).0
}

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(content).expect("a vector takes all");
    encoder.finish().expect("a vector takes all")
}

/// Runs the program with `input` on its standard input.
fn piped(args: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // A program that refuses its arguments does not read to the end.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    child.wait_with_output().expect("the program ends")
}

const ONE_OF_EACH: [(&str, InputFormat, &str); 8] = [
    ("suzanne.stl", InputFormat::Stl, "stl"),
    ("suzanne_meshlab_ascii.stl", InputFormat::Stl, "stl"),
    ("suzanne.obj", InputFormat::Obj, "obj"),
    ("suzanne.ply", InputFormat::Ply, "ply"),
    ("two_meshes.glb", InputFormat::Gltf, "gltf"),
    ("two_meshes_embedded.gltf", InputFormat::Gltf, "gltf"),
    ("sphere.off", InputFormat::Off, "off"),
    ("two_bodies.3mf", InputFormat::ThreeMf, "3mf"),
];

#[test]
fn gzip_makes_no_difference_in_any_format() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, format, _) in ONE_OF_EACH {
        let plain = soup_of(&fixture(name));
        let path = folder.path().join(format!("{name}.gz"));
        fs::write(&path, gzip(&fs::read(fixture(name)).expect("a fixture"))).expect("writable");
        let (unpacked, found) = read(&path, &NoProgress).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(found, format, "{name}");
        assert_eq!((unpacked.triangles, unpacked.positions), (plain.triangles, plain.positions), "{name}");
    }
}

#[test]
fn standard_input_is_read_in_every_format() {
    for (name, _, token) in ONE_OF_EACH {
        let bytes = fs::read(fixture(name)).expect("a fixture");
        let path = fixture(name);
        let args = ["annotate", path.to_str().expect("a name"), "-o", "-", "--format", "csv", "-q"];
        let expected = piped(&args, b"").stdout;
        assert!(expected.len() > 10_000, "{name}");
        for input in [&bytes, &gzip(&bytes)] {
            for extra in [&[][..], &["--input-format", token]] {
                let run = piped(&[&["annotate", "-", "-o", "-", "--format", "csv", "-q"], extra].concat(), input);
                assert_eq!(run.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&run.stderr));
                assert!(run.stdout == expected, "{name} {extra:?}");
            }
        }
    }
    let run = piped(&["inspect", "-", "--format", "json"], &fs::read(fixture("suzanne.stl")).expect("a fixture"));
    assert!(String::from_utf8_lossy(&run.stdout).contains("\"faces\": 968"));
}

#[test]
fn a_stream_that_is_not_what_it_is_said_to_be_is_an_error() {
    let stl = fs::read(fixture("suzanne_meshlab_ascii.stl")).expect("a fixture");
    for (args, input, message) in [
        (&["--input-format", "ply"][..], &stl[..], "standard input: line 1"),
        (&["--input-format", "3mf"], &stl, "ZIP"),
        (&["--input-format", "off"], &stl, "standard input: line 1"),
        (&[], b"", "standard input: the file is empty"),
        (&[], &gzip(b""), "empty"),
        (&[], &gzip(&stl)[..500], "cut short"),
    ] {
        let run = piped(&[&["annotate", "-", "-o", "-", "--format", "csv"], args].concat(), input);
        let error = String::from_utf8_lossy(&run.stderr).into_owned();
        assert_eq!(run.status.code(), Some(1), "{error}");
        assert!(error.contains(message) && error.lines().count() == 1 && run.stdout.is_empty(), "{error}");
    }
}

#[test]
fn utf_16_and_byte_order_marks_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in
        ["groups.obj", "sphere_ascii.ply", "suzanne_meshlab_ascii.stl", "two_meshes_embedded.gltf", "sphere.off"]
    {
        let text = fs::read_to_string(fixture(name)).expect("text");
        // Material libraries are looked for beside the file, and the copy has none.
        let text = text.replace("mtllib", "#");
        let plain = folder.path().join(name);
        fs::write(&plain, &text).expect("writable");
        let soup_of = |path: &Path| {
            let mut soup = soup_of(path);
            // Knows the file's name.
            soup.scene.iter_mut().for_each(|scene| scene.original = None);
            soup
        };
        let plain = soup_of(&plain);
        let units = || std::iter::once(0xfeff).chain(text.encode_utf16());
        let with_mark = format!("\u{feff}{text}").into_bytes();
        for (how, bytes) in [
            ("little", units().flat_map(u16::to_le_bytes).collect()),
            ("big", units().flat_map(u16::to_be_bytes).collect()),
            ("mark", with_mark),
        ] {
            let path = folder.path().join(format!("{how}-{name}"));
            fs::write(&path, bytes).expect("writable");
            assert_eq!(soup_of(&path), Soup { files: Vec::new(), ..plain.clone() }, "{how} {name}");
        }
    }
}

/// The same values from gltfpack's compressed files as from one another, in both of the extension's
/// versions, and positions as exact as their 14 bits allow.
#[test]
fn meshopt_compressed_files_are_decoded() {
    let original = osculate::inspect(&fixture("two_meshes.glb"), &osculate::MeshOptions::default(), None, &NoProgress);
    let expected = original.expect("a scene").scene.expect("a scene").bounds.expect("bounds");
    for (ext, khr) in
        [("two_meshes_ext.glb", "two_meshes_khr.glb"), ("two_meshes_ext_float.glb", "two_meshes_khr_float.glb")]
    {
        let [ext, khr] = [ext, khr].map(fixture);
        let soup = soup_of(&ext);
        assert_eq!(soup.face_count(), 896);
        assert!(soup.notes.is_empty(), "{:?}", soup.notes);
        let other = soup_of(&khr);
        assert_eq!((&soup.triangles, &soup.positions), (&other.triangles, &other.positions));
        let found = osculate::inspect(&ext, &osculate::MeshOptions::default(), None, &NoProgress).expect("a scene");
        assert!(found.report.closed && !found.report.has_defects(), "{:?}", found.report);
        let bounds = found.scene.expect("a scene").bounds.expect("bounds");
        assert!(bounds.min.distance(expected.min) < 2e-3 && bounds.max.distance(expected.max) < 2e-3, "{bounds:?}");
    }
}

#[test]
fn files_outside_the_folder_need_leave() {
    let outer = tempfile::tempdir().expect("a folder");
    let [model, data] = ["model", "data"].map(|name| outer.path().join(name));
    fs::create_dir(&model).expect("a folder");
    fs::create_dir(&data).expect("a folder");
    fs::copy(fixture("two_meshes.bin"), data.join("two_meshes.bin")).expect("a copy");
    let document = fs::read_to_string(fixture("two_meshes.gltf")).expect("text");
    std::os::unix::fs::symlink(data.join("two_meshes.bin"), model.join("link.bin")).expect("a link");
    let absolute = data.join("two_meshes.bin").to_string_lossy().into_owned();
    for (name, refusal) in [("../data/two_meshes.bin", "`..`"), ("link.bin", "a link"), (&absolute, "relative")] {
        let path = model.join("scene.gltf");
        fs::write(&path, document.replace("two_meshes.bin", name)).expect("writable");
        let error = read(&path, &NoProgress).expect_err(name).to_string();
        assert!(error.contains(refusal) && error.contains("buffers[0].uri"), "{error}");
        let options = ReadOptions { allowed_folders: vec![data.clone()], ..ReadOptions::default() };
        let (soup, _) = read_with(&path, &options, &NoProgress).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(soup.face_count(), 896);
        for command in [&["inspect"][..], &["annotate", "-o", "-", "--format", "csv", "-q"]] {
            let path = path.to_str().expect("a name");
            let refused = piped(&[command, &[path]].concat(), b"");
            assert_eq!(refused.status.code(), Some(1));
            let allowed = piped(&[command, &[path, "--allow-folder", data.to_str().expect("a name")]].concat(), b"");
            assert_eq!(allowed.status.code(), Some(0), "{}", String::from_utf8_lossy(&allowed.stderr));
        }
    }
    // A document on standard input finds its files in the allowed folder only.
    let run = piped(&["inspect", "-"], document.as_bytes());
    assert!(String::from_utf8_lossy(&run.stderr).contains("stream"));
    let run = piped(&["inspect", "-", "--allow-folder", data.to_str().expect("a name")], document.as_bytes());
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
    let run = piped(&["inspect", "-", "--allow-folder", "no/such/folder"], document.as_bytes());
    assert_eq!(run.status.code(), Some(2));
}

/// A survey in map coordinates keeps its millimetres: the same as its copy at zero, in all text and
/// 64-bit formats.
#[test]
fn millions_of_metres_keep_millimetres() {
    let far = [4_501_234.0, 5_412_345.0, 321.0];
    let n = 24;
    // Heights in whole millimetres, so that adding the millions is exact in decimals.
    let height = |i: usize, j: usize| (2000.0 * (0.3 * i as f64).sin() * (0.2 * j as f64).cos()).round() / 1000.0;
    let points: Vec<[f64; 3]> =
        (0..n * n).map(|v| [(v % n) as f64 * 0.25, (v / n) as f64 * 0.25, height(v % n, v / n)]).collect();
    let cells = (0..n * n).filter(|v| v % n + 1 < n && v / n + 1 < n);
    let triangles: Vec<[usize; 3]> = cells.flat_map(|v| [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]).collect();
    let write = |shift: [f64; 3], format: InputFormat| -> Vec<u8> {
        let rows = points.iter().map(|p| [0, 1, 2].map(|c| format!("{:.3}", p[c] + shift[c])).join(" "));
        let rows: Vec<String> = rows.collect();
        let text = match format {
            InputFormat::Obj => {
                let faces = triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
                rows.iter().map(|row| format!("v {row}\n")).chain(faces).collect()
            }
            InputFormat::Stl => {
                let facets = triangles.iter().map(|t| {
                    let corners: String = t.iter().map(|&v| format!("vertex {}\n", rows[v])).collect();
                    format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
                });
                format!("solid\n{}endsolid\n", facets.collect::<String>())
            }
            _ => {
                let faces: String = triangles.iter().map(|t| format!("3 {} {} {}\n", t[0], t[1], t[2])).collect();
                let [v, f] = [rows.len(), triangles.len()];
                if format == InputFormat::Off {
                    format!("OFF\n{v} {f} 0\n{}\n{faces}", rows.join("\n"))
                } else {
                    format!(
                        "ply\nformat ascii 1.0\nelement vertex {v}\nproperty double x\nproperty double y\nproperty double z\nelement face {f}\nproperty list uchar int vertex_indices\nend_header\n{}\n{faces}",
                        rows.join("\n")
                    )
                }
            }
        };
        text.into_bytes()
    };
    // One that reads curvature off the mesh alone, whatever it takes the coordinates' rounding to be.
    let options = CurvatureOptions { estimator: Estimator::Osculating, ..CurvatureOptions::default() };
    for format in [InputFormat::Obj, InputFormat::Stl, InputFormat::Ply, InputFormat::Off] {
        let [near, moved] =
            [[0.0; 3], far].map(|shift| read_bytes(&write(shift, format), format, None).expect("readable"));
        assert!(matches!(moved.positions, Positions::F64(_)));
        let mesh = mesh_of(&moved);
        for (v, p) in mesh_of(&near).positions().iter().enumerate() {
            let q = mesh.positions()[v] + mesh.origin();
            let error = (0..3).map(|c| (q[c] - far[c] - p[c]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-6, "{format:?}: vertex {v} is {error} m off");
        }
        let [here, there] = [&near, &moved].map(|soup| values_of(soup, &options));
        let close = |a: f32, b: f32| (a - b).abs() < 1e-4 * (1.0 + a.abs());
        let same = here.iter().zip(&there).filter(|(a, b)| close(a.k_max, b.k_max) && close(a.k_min, b.k_min)).count();
        assert!(same * 100 >= 99 * here.len(), "{format:?}: {same} of {} faces agree", here.len());
    }
}

#[test]
fn off_and_3mf_say_what_their_sources_say() {
    let sphere = soup_of(&fixture("sphere_ascii.ply"));
    for name in ["sphere.off", "sphere_color.off", "sphere_binary.off"] {
        let off = soup_of(&fixture(name));
        assert_eq!(off.triangles, sphere.triangles, "{name}");
        let far = (0..sphere.positions.len()).map(|v| off.positions.get(v).distance(sphere.positions.get(v)));
        assert!(far.fold(0.0, f64::max) < 1e-5, "{name}");
    }
    let options = CurvatureOptions::default();
    assert_eq!(differing(&values_of(&soup_of(&fixture("sphere.off")), &options), &values_of(&sphere, &options)), 0);

    let path = fixture("two_bodies.3mf");
    let found = osculate::inspect(&path, &osculate::MeshOptions::default(), None, &NoProgress).expect("a mesh");
    assert_eq!((found.report.faces, found.report.components, found.report.closed), (640, 2, true));
    assert_eq!(found.metres_per_unit, Some(0.001));
    assert!(found.suggestions.iter().any(|s| s.contains("--unit mm")), "{:?}", found.suggestions);
    let folder = tempfile::tempdir().expect("a folder");
    let output = osculate::Destination::File(folder.path().join("a.glb"));
    let annotate = |unit| {
        let options = osculate::AnnotateOptions { unit, ..Default::default() };
        let done = osculate::annotate(&path, &output, osculate::OutputFormat::Glb, &options, &NoProgress);
        done.expect("annotated").written.notes.iter().any(|note| note.message.contains("--unit mm"))
    };
    assert!(annotate(None) && !annotate(Some(osculate::Unit::Millimetre)));
    // A sphere of radius 2, and its copy of twice the size at x = 10.
    let bounds = found.report.bounds.expect("bounds");
    assert!((bounds.min.x + 2.0).abs() < 1e-5 && (bounds.max.x - 14.0).abs() < 1e-5, "{bounds:?}");
}

/// What inspect says of defects: each kind with its first places, and how the surface hangs together.
#[test]
fn inspect_names_places() {
    let run = piped(
        &["inspect", "-", "--format", "json"],
        b"v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 1 2\nf 5 2 1\n",
    );
    let json: serde_json::Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(run.status.code(), Some(3));
    assert_eq!((&json["closed"], &json["manifold"], &json["oriented"]), (&false.into(), &false.into(), &true.into()));
    let kinds: Vec<_> = json["defects"].as_array().expect("a list").iter().map(|d| d["kind"].as_str()).collect();
    assert_eq!(kinds, [Some("degenerate"), Some("duplicate"), Some("non_manifold")]);
    assert_eq!(json["defects"][1]["places"][0]["face"], 4);
    let at = json["defects"][2]["places"][0]["at"].as_array().expect("a point");
    assert!((at[0].as_f64().expect("a number") - 1.0 / 3.0).abs() < 1e-9, "{at:?}");
    let text = piped(&["inspect", "-"], b"v 0 0 0\nv 0 0 1\nv 1 0 0\nf 1 2 3\nf 1 1 2\n").stdout;
    let text = String::from_utf8_lossy(&text).into_owned();
    assert!(text.contains("1 face without area, not estimated (face 1) at (0 0 0.33333)"), "{text}");
}
