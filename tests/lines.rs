//! The commands that draw lines: disk, trace, section, edges; and synth, which makes their meshes.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn run(folder: &Path, line: &str) -> Output {
    let args: Vec<&str> = line.split(' ').collect();
    Command::new(env!("CARGO_BIN_EXE_osculate")).args(args).current_dir(folder).output().expect("the program starts")
}

fn works(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{line}: {message}");
    message
}

fn folder_with_torus() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    works(folder.path(), "synth torus --cells 120,48 -o torus.ply --exact exact.csv");
    folder
}

fn document(path: &Path) -> Value {
    let bytes = fs::read(path).expect("a GLB");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("4 bytes")) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).expect("JSON")
}

/// The numbers of a CSV column.
fn column(path: &Path, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(path).expect("a CSV");
    let at = text.lines().next().expect("a header").split(',').position(|n| n == name).expect("the column");
    text.lines().skip(1).map(|l| l.split(',').nth(at).expect("a field").parse().expect("a number")).collect()
}

#[test]
fn a_disk_is_legs_rim_and_two_directions() {
    let folder = folder_with_torus();
    let path = folder.path();
    for place in ["--face 77", "--face 77 --at 0.1,0.8", "--face 77 --at 0,0", "--point 4,0,0.05"] {
        works(path, &format!("disk torus.ply {place} --radius 0.5 --diameters 24 -o disk.glb --values values.csv"));
        let json = document(&path.join("disk.glb"));
        let names: Vec<&str> =
            json["meshes"].as_array().expect("meshes").iter().map(|m| m["name"].as_str().expect("a name")).collect();
        assert_eq!(names, ["legs", "rim", "dir_max", "dir_min"]);
        let legs = json["meshes"][0]["primitives"].as_array().expect("legs");
        assert!(legs.len() == 48 && legs.iter().all(|leg| leg["mode"] == 3), "48 line strips");
        assert_eq!(json["meshes"][1]["primitives"][0]["mode"], 2, "the rim is a loop");
        // Everything is within the radius of the centre, the ends of legs nearly at it.
        let bounds = json["accessors"].as_array().expect("accessors");
        assert!(bounds.iter().all(|a| (0..3).all(|i| a["max"][i].as_f64() <= a["min"][i].as_f64().map(|m| m + 1.001))));
        let curvature = column(&path.join("values.csv"), "curvature");
        let largest = curvature.iter().copied().fold(f64::MIN, f64::max);
        assert!(curvature.len() == 24 && (largest - 1.0).abs() < 0.1, "{place}: {largest}");
        assert!(column(&path.join("values.csv"), "length_forward").iter().all(|l| (l - 0.5).abs() < 1e-9));
    }
}

#[test]
fn a_trace_of_k_max_goes_round_the_tube() {
    let folder = folder_with_torus();
    let path = folder.path();
    works(path, "trace torus.ply --face 3000 --steps 20 --radius 0.4 -o trace.csv");
    let (x, y) = (column(&path.join("trace.csv"), "x"), column(&path.join("trace.csv"), "y"));
    assert_eq!(x.len(), 21);
    let angle: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y.atan2(*x).to_degrees()).collect();
    assert!(angle.iter().all(|a| (a - angle[0]).abs() < 1.0), "{angle:?}");
    for face in column(&path.join("trace.csv"), "face") {
        assert!(face < 11_520.0);
    }
    let message = works(path, "trace torus.ply --seeds 12 --both --steps 5 --along min -o lines.glb");
    assert!(message.contains("12 traces, 132 centres"), "{message}");
    assert_eq!(document(&path.join("lines.glb"))["meshes"][0]["primitives"].as_array().map(Vec::len), Some(12));
}

#[test]
fn a_section_has_the_length_of_the_curve() {
    let folder = folder_with_torus();
    let path = folder.path();
    let message = works(path, "section torus.ply --plane 0,0,1,0 -o cut.glb");
    assert!(message.contains("2 closed and 0 open"), "{message}");
    let lengths = &document(&path.join("cut.glb"))["meshes"][0]["extras"]["osculate"]["lengths"];
    let lengths: Vec<f64> = lengths.as_array().expect("lengths").iter().filter_map(Value::as_f64).collect();
    // A regular polygon of 120 corners around each of the circles of radius 4 and 2.
    let polygon = |radius: f64| 240.0 * radius * (std::f64::consts::PI / 120.0).sin();
    assert!((lengths.iter().sum::<f64>() - polygon(4.0) - polygon(2.0)).abs() < 1e-9, "{lengths:?}");
    works(path, "section torus.ply --plane 0,1,0,-0.5 -o cut.svg");
    let svg = fs::read_to_string(path.join("cut.svg")).expect("an SVG");
    assert_eq!((svg.matches("<polygon").count(), svg.matches("<polyline").count()), (2, 0));
}

#[test]
fn edges_are_written_by_kind() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    works(path, "synth box --cells 3,1 -o box.stl");
    works(path, "annotate box.stl -o box.csv --edges edges.glb --view 1,2,3");
    let json = document(&path.join("edges.glb"));
    let names: Vec<&str> =
        json["meshes"].as_array().expect("meshes").iter().filter_map(|m| m["name"].as_str()).collect();
    assert_eq!(names, ["feature", "silhouette"]);
    assert_eq!(json["accessors"][0]["count"], 12 * 3 * 2);
    assert_eq!(json["meshes"][0]["primitives"][0]["mode"], 1);
    let inspected = run(path, "inspect box.stl --format json --view 1,2,3");
    let inspected: Value = serde_json::from_slice(&inspected.stdout).expect("JSON");
    assert_eq!((&inspected["silhouette_edges"], &inspected["edges"]["feature"]), (&18.into(), &36.into()));
}

#[test]
fn synthetic_shapes_come_with_their_curvature() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path();
    for shape in
        ["plane", "sphere", "cylinder", "torus", "ellipsoid", "saddle", "monkey-saddle", "wave", "box", "fillet-box"]
    {
        for format in ["stl", "ply", "obj"] {
            works(path, &format!("synth {shape} --faces 600 -o mesh.{format} --exact exact.csv"));
            let run = run(path, &format!("inspect mesh.{format} --format json"));
            let json: Value = serde_json::from_slice(&run.stdout).expect("JSON");
            let faces = json["faces"].as_u64().expect("a count");
            assert!((300..1200).contains(&faces), "{shape}: {faces} faces");
            assert_eq!((run.status.code(), &json["components"]), (Some(0), &1.into()), "{shape} as {format}");
            let k_max = column(&path.join("exact.csv"), "k_max");
            assert!(k_max.len() as u64 == faces && k_max.iter().all(|k| k.is_finite()), "{shape}");
        }
    }
    // The same seed gives the same mesh, another another.
    let shaken = |seed: u32| {
        works(path, &format!("synth torus --faces 600 --jitter 0.3 --noise 0.1 --seed {seed} -o shaken.ply"));
        fs::read(path.join("shaken.ply")).expect("a mesh")
    };
    assert!(shaken(1) == shaken(1) && shaken(1) != shaken(2));
    // A scanner that looks along z leaves x and y alone.
    let column_of = |line: &str, axis: usize| -> Vec<f64> {
        works(path, line);
        let obj = fs::read_to_string(path.join("seen.obj")).expect("a mesh");
        let vertices = obj.lines().filter_map(|line| line.strip_prefix("v "));
        vertices.map(|v| v.split(' ').nth(axis).and_then(|c| c.parse().ok()).expect("a number")).collect()
    };
    let (clean, seen) = (
        "synth wave --faces 600 -o seen.obj",
        "synth wave --faces 600 --scan-noise 0.1 --scan-view 0,0,-1 -o seen.obj",
    );
    assert_eq!(column_of(clean, 0), column_of(seen, 0));
    assert_ne!(column_of(clean, 2), column_of(seen, 2));
}

#[test]
fn what_cannot_be_drawn_is_told_and_nothing_is_written() {
    let folder = folder_with_torus();
    let path = folder.path();
    for (line, expected) in [
        ("disk torus.ply --face 11520 -o x.glb", "face 11520 is out of range: the faces are 0 to 11519"),
        ("disk torus.ply --face 1 --at 0.7,0.7 -o x.glb", "outside the face"),
        ("disk torus.ply --point 50,0,0 -o x.glb", "away from the mesh"),
        ("disk torus.ply -o x.glb", "--face N"),
        ("disk torus.ply --face 1 --radius 100 -o x.glb", "larger than the mesh"),
        ("disk torus.ply --face 1 -o x.stl", "extension"),
        ("trace torus.ply --face 1 --steps 0 -o x.glb", "steps"),
        ("trace torus.ply --seeds 0 -o x.glb", "1 to 1000000"),
        ("section torus.ply --plane 0,0,1,-9 -o x.glb", "does not cut"),
        ("section torus.ply --plane 0,0,0,1 -o x.glb", "must not all be 0"),
        ("section torus.ply --plane 0,0,1 -o x.glb", "four numbers"),
        ("section torus.ply --plane 0,0,1,0 -o torus.ply", "extension"),
        ("synth torus --tube 5 -o x.glb", "below --radius"),
        ("synth fillet-box --fillet 3 -o x.glb", "half the shortest"),
        ("synth torus --cells 2,2 -o x.glb", "at least 3"),
        ("synth torus --scan-noise nan -o x.stl", "must be 0 or more"),
        ("synth torus --scan-noise 0.1 --scan-view 0,0,0 -o x.stl", "must not be 0,0,0"),
        ("synth torus -o x.glb", "extension"),
        ("annotate torus.ply -o x.glb --radius 100", "larger than the mesh"),
    ] {
        let output = run(path, line);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(matches!(output.status.code(), Some(1 | 2)), "{line}: {message}");
        assert!(message.contains(expected), "{line}: {message}");
        assert!(!path.join("x.glb").exists() && !path.join("x.stl").exists(), "{line}");
    }
}
