//! The program from the outside: the README's commands, exit codes, and bad input.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn osculate(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_osculate"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command.output().expect("the program starts")
}

/// A folder of its own for a test, with a link to the fixtures.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::os::unix::fs::symlink(Path::new(ROOT).join("fixtures"), folder.path().join("fixtures")).expect("a link");
    folder
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn fixture(name: &str) -> Vec<u8> {
    fs::read(Path::new(ROOT).join("fixtures").join(name)).expect("a fixture")
}

/// Every line of the README that calls the program must work as it is printed.
#[test]
fn the_readmes_commands_work() {
    let readme = fs::read_to_string(Path::new(ROOT).join("README.md")).expect("a README");
    let folder = folder();
    let mut ran = 0;
    let blocks = readme.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    for line in blocks.flat_map(str::lines).filter(|line| line.starts_with("osculate ")) {
        let program = Path::new(env!("CARGO_BIN_EXE_osculate"));
        let path =
            format!("{}:{}", program.parent().expect("a folder").display(), std::env::var("PATH").unwrap_or_default());
        let output = Command::new("sh").args(["-c", line]).env("PATH", path).current_dir(folder.path()).output();
        let output = output.expect("a shell");
        assert_eq!(output.status.code(), Some(0), "{line}\n{}", stderr(&output));
        ran += 1;
    }
    assert!(ran >= 6, "the README shows {ran} commands");
}

#[test]
fn every_format_is_written_and_the_summary_is_json() {
    let folder = folder();
    for output in ["a.glb", "a.gltf", "a.ply", "a.csv"] {
        let run = osculate(
            folder.path(),
            &["annotate", "fixtures/suzanne.stl", "-o", output, "--stats", "stats.json", "--log", "json"],
        );
        assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
        assert!(run.stdout.is_empty(), "results only go to standard output when asked for");
        assert!(stderr(&run).lines().all(|line| serde_json::from_str::<Value>(line).is_ok()), "{}", stderr(&run));
        let stats: Value =
            serde_json::from_slice(&fs::read(folder.path().join("stats.json")).expect("stats")).expect("JSON");
        for key in ["faces", "vertices", "components", "boundary_loops", "degenerate_faces", "duplicate_faces"] {
            assert!(stats[key].is_u64(), "{key}");
        }
        assert_eq!((&stats["schema"], &stats["version"]), (&1.into(), &env!("CARGO_PKG_VERSION").into()));
        for key in ["inner", "boundary", "feature", "non_manifold"] {
            assert!(stats["edges"][key].is_u64(), "{key}");
        }
        for key in ["read", "weld", "estimate", "write", "total"] {
            assert!(stats["seconds"][key].is_f64(), "{key}");
        }
        assert!(stats["bounds"]["min"].is_array() && stats["curvature"]["classes"].is_object());
    }
    let names: Vec<String> = fs::read_dir(folder.path())
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    assert!(names.iter().all(|n| !n.contains("part")), "no temporary file is left: {names:?}");
}

#[test]
fn numbers_go_to_standard_output_where_asked_for() {
    let folder = folder();
    let run = osculate(folder.path(), &["annotate", "fixtures/suzanne.stl", "-o", "a.glb", "--stats", "-"]);
    let stats: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(stats["faces"], 968);
    // Standard input and standard output are two things.
    let piped = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .current_dir(folder.path())
        .args(["annotate", "-", "-o", "b.glb", "--stats", "-", "-q"])
        .stdin(fs::File::open(folder.path().join("fixtures/suzanne.stl")).expect("a fixture"))
        .output()
        .expect("the program starts");
    assert!(serde_json::from_slice::<Value>(&piped.stdout).is_ok(), "{}", stderr(&piped));
    // A link to what is not there yet: what lies beside the document lies beside what the link names.
    std::os::unix::fs::symlink("deeper/b.gltf", folder.path().join("link.gltf")).expect("a link");
    fs::create_dir(folder.path().join("deeper")).expect("a folder");
    osculate(folder.path(), &["annotate", "fixtures/suzanne.stl", "-o", "link.gltf", "-q"]);
    assert!(["b.gltf", "b.bin", "b.png"].iter().all(|name| folder.path().join("deeper").join(name).is_file()));
    // A shell's file behind /dev/stdout is written to, not replaced.
    let kept = folder.path().join("kept.csv");
    fs::write(&kept, "before\n").expect("writable");
    let appended = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .current_dir(folder.path())
        .args(["annotate", "fixtures/suzanne.stl", "-o", "/dev/stdout", "--format", "csv", "-q"])
        .stdout(fs::File::options().append(true).open(&kept).expect("a file"))
        .status()
        .expect("the program starts");
    let lines = fs::read_to_string(&kept).expect("text");
    assert!(appended.success() && lines.starts_with("before\nface,") && lines.lines().count() == 970, "{lines}");
    let run = osculate(folder.path(), &["synth", "sphere", "--faces", "80", "-o", "a.ply", "--exact", "-"]);
    assert!(run.stdout.starts_with(b"face,"), "{run:?}");
    let run = osculate(folder.path(), &["disk", "a.ply", "--face", "0", "-o", "a.glb", "--values", "-"]);
    assert!(run.stdout.starts_with(b"angle_degrees,"), "{run:?}");
    assert!(!folder.path().join("-").exists());
}

/// Programs write triangles as quads that name a corner twice.
#[test]
fn quads_that_name_a_corner_twice_are_triangles() {
    let folder = folder();
    let run = osculate(folder.path(), &["synth", "sphere", "--cells", "12,8", "-o", "s.obj"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    let text = fs::read_to_string(folder.path().join("s.obj")).expect("a sphere");
    let triangles = text.lines().filter(|line| line.starts_with("f ")).count();
    let doubled = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => format!("f {corners} {}\n", corners.split(' ').next_back().expect("a corner")),
        None => format!("{line}\n"),
    };
    fs::write(folder.path().join("q.obj"), text.lines().map(doubled).collect::<String>()).expect("writable");
    let run = osculate(folder.path(), &["inspect", "q.obj", "--format", "json"]);
    assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stdout));
    let found: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!((&found["faces"], &found["notes"]), (&triangles.into(), &Value::Array(Vec::new())));
}

/// What is in a CSV and what statistics tell of it.
#[test]
fn units_are_told_as_they_are_in_the_output() {
    let folder = folder();
    let units = |output: &str| {
        let args = ["annotate", "fixtures/suzanne.stl", "-o", output, "--unit", "mm", "--stats", "-"];
        let stats: Value = serde_json::from_slice(&osculate(folder.path(), &args).stdout).expect("JSON");
        (
            stats["units"].clone(),
            stats["legend"]["unit"].clone(),
            stats["legend"]["range"][1].as_f64().expect("a number"),
        )
    };
    let (glb, glb_unit, glb_range) = units("a.glb");
    assert_eq!((glb, glb_unit), (serde_json::json!({"input": "mm", "output": "m", "input_up": "z"}), "1/m".into()));
    let (csv, csv_unit, csv_range) = units("a.csv");
    assert_eq!((csv, csv_unit), (serde_json::json!({"input": "mm", "output": "mm", "input_up": "z"}), "1/mm".into()));
    assert!((glb_range / csv_range - 1000.0).abs() < 1e-6, "{glb_range} {csv_range}");
}

#[test]
fn what_is_replaced_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("a.csv");
    fs::write(&path, "private").expect("writable");
    fs::set_permissions(&path, fs::Permissions::from_mode(0o600)).expect("permitted");
    osculate(folder.path(), &["annotate", "fixtures/suzanne.stl", "-o", "a.csv"]);
    assert_eq!(path.metadata().expect("a file").permissions().mode() & 0o777, 0o600);
}

/// Another program may have put the values of an annotated file into other types, or taken an image away.
#[test]
fn what_others_changed_in_a_gltf_is_told_and_no_reason_to_refuse_it() {
    let folder = folder();
    let run = |args: &[&str], code: i32| {
        let run = osculate(folder.path(), args);
        assert_eq!(run.status.code(), Some(code), "{args:?}: {}", stderr(&run));
        stderr(&run)
    };
    run(&["annotate", "fixtures/suzanne.stl", "-o", "a.gltf"], 0);
    let text = fs::read_to_string(folder.path().join("a.gltf")).expect("a document");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    let k_max = document["meshes"][0]["primitives"][0]["attributes"]["_CURVATURE_MAX"].as_u64().expect("an attribute");
    document["accessors"][k_max as usize]["componentType"] = 5125.into();
    fs::write(folder.path().join("b.gltf"), document.to_string()).expect("writable");
    assert!(run(&["annotate", "a.gltf", "-o", "b.glb"], 0).contains("--reuse"));
    assert!(!run(&["annotate", "b.gltf", "-o", "b.glb"], 0).contains("--reuse"));
    assert!(run(&["annotate", "b.gltf", "-o", "b.glb", "--reuse"], 1).contains("32-bit floats"));
    assert!(run(&["report", "b.gltf", "-o", "b.html"], 0).contains("estimated again"));
    // A buffer that is longer than it is declared to be.
    document["buffers"][0]["byteLength"] = 100.into();
    document["accessors"][k_max as usize]["componentType"] = 5126.into();
    fs::write(folder.path().join("short.gltf"), document.to_string()).expect("writable");
    run(&["annotate", "short.gltf", "-o", "whole.glb", "-q"], 0);
    let inspected = osculate(folder.path(), &["inspect", "whole.glb", "--format", "json"]);
    let inspected: Value = serde_json::from_slice(&inspected.stdout).expect("JSON");
    assert_eq!(inspected["faces"], 968);
    fs::create_dir(folder.path().join("deep")).expect("a folder");
    for file in ["scene.gltf", "scene.bin"] {
        fs::write(folder.path().join(file), fixture(file)).expect("writable");
    }
    let said = run(&["annotate", "scene.gltf", "-o", "deep/c.glb"], 3);
    assert!(said.contains("1 image not carried over") && said.contains("Tiles.png"), "{said}");
    let outside = String::from_utf8(fixture("scene.gltf")).expect("text").replace("Tiles.png", "../Tiles.png");
    fs::write(folder.path().join("scene.gltf"), outside).expect("writable");
    let said = run(&["annotate", "scene.gltf", "-o", "deep/c.glb"], 3);
    assert!(said.contains("--allow-folder"), "{said}");
}

#[test]
fn inspect_prints_the_contract() {
    let folder = folder();
    let run = osculate(folder.path(), &["inspect", "fixtures/cylinder_holes.stl", "--format", "json"]);
    let json: Value = serde_json::from_slice(&run.stdout).expect("JSON");
    assert_eq!(
        (&json["faces"], &json["boundary_loops"], &json["edges"]["boundary"]),
        (&568.into(), &2.into(), &64.into())
    );
    assert_eq!(run.status.code(), Some(0));
    let degenerate = osculate(folder.path(), &["inspect", "fixtures/fillet_degenerate.stl"]);
    assert_eq!(degenerate.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&degenerate.stdout).contains("8 faces without area"));
}

#[test]
fn faces_whose_curvature_is_beyond_the_numbers_are_told() {
    let folder = folder();
    // An octahedron, its edges no features.
    let corners = ["1 0 0", "-1 0 0", "0 1 0", "0 -1 0", "0 0 1", "0 0 -1"];
    let vertices: String = corners.iter().map(|c| format!("v {}\n", c.replace('1', "1e-30"))).collect();
    let faces = "f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n";
    fs::write(folder.path().join("tiny.obj"), vertices + faces).expect("writable");
    let run = osculate(folder.path(), &["annotate", "tiny.obj", "-o", "tiny.csv", "--feature-angle", "180"]);
    assert_eq!(run.status.code(), Some(3), "{}", stderr(&run));
    assert!(stderr(&run).contains("8 of 8 faces got no values although they have an area"), "{}", stderr(&run));
}

#[test]
fn csv_has_a_row_for_every_face_in_order() {
    let folder = folder();
    let run =
        osculate(folder.path(), &["annotate", "fixtures/fillet_degenerate.stl", "-o", "-", "--format", "csv", "-q"]);
    assert_eq!(run.status.code(), Some(3));
    let text = String::from_utf8(run.stdout).expect("text");
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some(
            "face,class,k_max,k_min,mean,gauss,dir_max_x,dir_max_y,dir_max_z,dir_min_x,dir_min_y,dir_min_z,radius,coverage,method,confidence"
        )
    );
    let mut empty = 0;
    for (i, line) in lines.enumerate() {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!((fields.len(), fields[0].parse()), (16, Ok(i)));
        if fields[1] == "-1" {
            empty += 1;
            assert!(fields[2..13].iter().all(|f| f.is_empty()), "{line}");
        } else {
            assert!(fields[2..6].iter().all(|f| f.parse::<f64>().is_ok_and(f64::is_finite)), "{line}");
        }
    }
    assert_eq!(empty, 8);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let folder = folder();
    for extension in ["glb", "csv", "ply"] {
        let run = |threads: &str| {
            let name = format!("{threads}.{extension}");
            osculate(folder.path(), &["annotate", "fixtures/fillet_part.stl", "-o", &name, "-j", threads, "-q"]);
            fs::read(folder.path().join(name)).expect("an output")
        };
        assert!(run("1") == run("4"), "{extension}");
    }
}

/// What an output must survive: it stays as it was when the run fails.
fn fails(folder: &Path, input: &str, expected: &str) {
    fs::write(folder.join("kept.glb"), "before").expect("writable");
    for output in ["new.glb", "new.csv", "kept.glb"] {
        let run = osculate(folder, &["annotate", input, "-o", output, "--stats", "stats.json"]);
        let message = stderr(&run);
        assert_eq!(run.status.code(), Some(1), "{input}: {message}");
        assert_eq!(message.lines().count(), 1, "{input}: one sentence, not {message}");
        assert!(message.contains(expected), "{input}: {message} does not say {expected:?}");
        assert!(message.contains(input), "{input}: the file is not named in {message}");
    }
    assert_eq!(fs::read(folder.join("kept.glb")).expect("there"), b"before", "{input}");
    for name in ["new.glb", "new.csv", "stats.json"] {
        assert!(!folder.join(name).exists(), "{input}: {name} was written");
    }
}

#[test]
fn bad_input_ends_in_one_clear_sentence_and_nothing_written() {
    let folder = folder();
    let file = |name: &str, content: &[u8]| {
        fs::write(folder.path().join(name), content).expect("writable");
        name.to_owned()
    };
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    let ply = |vertices: &str, face: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n{vertices}\n{face}\n"
        )
    };
    let cases: Vec<(String, &str)> = vec![
        (file("empty.stl", b""), "empty"),
        (file("empty.obj", b" \n"), "empty"),
        (file("letter.stl", b"Dear aunt,\nthank you for the mesh.\n"), "text"),
        (file("letter.ply", b"Dear aunt"), "not PLY"),
        (file("letter.mesh", b"Dear aunt"), "none of STL, OBJ, PLY, OFF, 3MF and glTF"),
        (file("noise.bin", &[7; 300]), "none of"),
        (file("cut.stl", &fixture("suzanne.stl")[..100]), "byte"),
        (file("program.stl", &[b"\x7fELF\x02\x01", [0xff; 400].as_slice()].concat()), "this is a program"),
        (file("cut.ply", &fixture("suzanne.ply")[..9000]), "truncated"),
        (file("cut.glb", &fixture("suzanne.glb")[..9000]), "byte"),
        (file("cut.gltf", &fixture("two_meshes.gltf")[..900]), "line"),
        (file("cut.obj", b"v 0 0 0\nv 1 0 0\nv 0 1"), "line 3"),
        (file("range.obj", format!("{triangle}f 1 2 4\n").as_bytes()), "line 4: vertex 4 is out of range"),
        (file("range.ply", ply("0 0 0 1 0 0 0 1 0", "3 0 1 3").as_bytes()), "out of range"),
        (file("cloud.obj", triangle.as_bytes()), "no faces"),
        (file("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "finite"),
        (file("inf.ply", ply("inf 0 0 1 0 0 0 1 0", "3 0 1 2").as_bytes()), "finite"),
        (file("flat.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\nf 1 1 2\n"), "area"),
        (file("missing.gltf", b"{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":36,\"uri\":\"no.bin\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}]}"), "buffers[0].uri"),
        (file("old.gltf", b"{\"asset\":{\"version\":\"1.0\"}}"), "version"),
        ("no_such_file.stl".into(), "cannot read"),
    ];
    for (input, expected) in &cases {
        fails(folder.path(), input, expected);
    }
}

#[test]
fn part_of_a_mesh_is_better_than_none() {
    let folder = folder();
    let cases: [(&str, Vec<u8>, &str); 6] = [
        (
            "wild.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\n".to_vec(),
            "1 face left out for a vertex number out of range (there are 3 vertices), such as vertex 9 in line 5",
        ),
        ("cut.stl", fixture("suzanne.stl")[..20_000].to_vec(), "promises 968"),
        ("cut_ascii.stl", fixture("suzanne_meshlab_ascii.stl")[..20_000].to_vec(), "ends inside a facet"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 2 3 4\n".to_vec(), "1 face with NaN"),
        ("double.obj", b"v 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 3 2 1\n".to_vec(), "earlier face"),
        (
            "fan.obj",
            b"v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n".to_vec(),
            "three or more faces",
        ),
    ];
    for (name, content, expected) in cases {
        fs::write(folder.path().join(name), content).expect("writable");
        for output in ["out.glb", "out.csv", "out.ply"] {
            let run = osculate(folder.path(), &["annotate", name, "-o", output]);
            assert_eq!(run.status.code(), Some(3), "{name}: {}", stderr(&run));
            assert!(stderr(&run).contains(expected), "{name}: {}", stderr(&run));
            assert!(folder.path().join(output).metadata().is_ok_and(|m| m.len() > 0));
        }
    }
}

#[test]
fn bad_usage_is_told_before_any_work() {
    let folder = folder();
    let annotate = |extra: &[&str]| {
        let args = [&["annotate", "fixtures/two_meshes.glb"], extra].concat();
        osculate(folder.path(), &args)
    };
    let cases: [(&[&str], &str); 21] = [
        (&["-o", "a.xyz"], "extension"),
        (&["-o", "-"], "--format"),
        (&["-o", "fixtures/two_meshes.glb"], "belongs to the input"),
        (&["-o", "a.glb", "--unit", "mm"], "--unit"),
        (&["-o", "a.glb", "--up", "z"], "--up"),
        (&["-o", "a.glb", "--attributes", "k_mux"], "k_mux"),
        (&["-o", "a.glb", "--colormap", "rainbow"], "rainbow"),
        (&["-o", "a.glb", "--range", "5:-5"], "empty or reversed"),
        (&["-o", "a.glb", "--range", "5"], "LOW:HIGH"),
        (&["-o", "a.glb", "--radius", "-1"], "above 0"),
        (&["-o", "a.glb", "--radius-factor", "0"], "above 0"),
        (&["-o", "a.glb", "--radius-factor", "3:vertex"], "neither"),
        (&["-o", "a.glb", "--diameters", "2"], "3 to 360"),
        (&["-o", "a.glb", "--feature-angle", "200"], "0 to 180"),
        (&["-o", "a.glb", "--weld", "-1"], "weld"),
        (&["-o", "a.glb", "-j", "0"], "1 to 1024"),
        (&["-o", "a.glb", "--stats", "./a.glb"], "named for two outputs"),
        (&["-o", "-", "--format", "csv", "--stats", "-"], "named for two outputs"),
        (&["-o", "a.glb", "--format", "csv"], "--format csv does not go with the extension .glb"),
        (&["-o", "a.glb", "--reuse", "--radius", "1"], "cannot be used with"),
        (&["-o", "a.glb", "--select", "mean<0 or mean>1"], "joined by and"),
    ];
    for (args, expected) in cases {
        let run = annotate(args);
        assert_eq!(run.status.code(), Some(2), "{args:?}: {}", stderr(&run));
        assert!(stderr(&run).contains(expected), "{args:?}: {}", stderr(&run));
        assert!(!folder.path().join("a.glb").exists(), "{args:?}");
    }
    for (args, expected) in [
        (["plane", "--radius", "2"], "--radius does not apply to plane"),
        (["sphere", "--size", "1,2,3"], "--size does not apply to sphere"),
        (["fillet-box", "--jitter", "0.3"], "--jitter does not apply to fillet-box"),
        (["sphere", "--radius", "inf"], "at most 1e30"),
        (["torus", "--cells", "30000,30000"], "more than 100000000 faces"),
    ] {
        let run = osculate(folder.path(), &[&["synth", "-o", "a.stl"][..], &args].concat());
        assert_eq!(run.status.code(), Some(2), "{args:?}");
        assert!(stderr(&run).contains(expected), "{args:?}: {}", stderr(&run));
    }
    let upper = osculate(folder.path(), &["section", "fixtures/suzanne.stl", "--plane", "0,0,1,0", "-o", "cut.SVG"]);
    assert_eq!(upper.status.code(), Some(0), "{}", stderr(&upper));
    let missing = annotate(&["-o", "no/such/folder/a.glb"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(stderr(&missing).contains("no/such/folder"));
    fs::write(folder.path().join("old.csv"), "old").expect("writable");
    let kept = annotate(&["-o", "old.csv", "--no-clobber"]);
    assert_eq!(
        (kept.status.code(), fs::read(folder.path().join("old.csv")).expect("there")),
        (Some(1), b"old".to_vec())
    );
}

#[test]
fn a_closed_pipe_is_no_failure() {
    let folder = folder();
    let line =
        format!("{} annotate fixtures/fillet_part.stl -o - --format csv | head -1", env!("CARGO_BIN_EXE_osculate"));
    let run = Command::new("bash")
        .args(["-o", "pipefail", "-c", &line])
        .current_dir(folder.path())
        .output()
        .expect("a shell");
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
}

#[test]
fn a_device_is_written_to_and_not_replaced() {
    let folder = folder();
    let run =
        osculate(folder.path(), &["annotate", "fixtures/suzanne.stl", "-o", "/dev/null", "--format", "glb", "-q"]);
    assert_eq!(run.status.code(), Some(0), "{}", stderr(&run));
    assert!(!PathBuf::from("/dev/null").metadata().expect("a device").is_file());
}

#[test]
fn help_names_ranges_and_defaults_and_scripts_can_be_made() {
    let folder = folder();
    let help = osculate(folder.path(), &["annotate", "--help"]);
    let help = String::from_utf8_lossy(&help.stdout).into_owned();
    for text in ["Estimation:", "Mesh:", "Output:", "General:", "[default: 12]", "3 to 360", "[default: 40]", "degrees"]
    {
        assert!(help.contains(text), "{text:?} is missing in\n{help}");
    }
    let version = osculate(folder.path(), &["--version"]);
    assert_eq!(String::from_utf8_lossy(&version.stdout), format!("osculate {}\n", env!("CARGO_PKG_VERSION")));
    for shell in ["bash", "zsh", "fish"] {
        let script = osculate(folder.path(), &["completions", shell]);
        assert!(String::from_utf8_lossy(&script.stdout).contains("radius-factor"), "{shell}");
    }
    let man = osculate(folder.path(), &["man"]);
    assert!(String::from_utf8_lossy(&man.stdout).contains("feature\\-angle"));
}
