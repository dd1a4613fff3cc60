//! A scene comes out as it went in, whatever it came from, and twice is once.

use crate::document::{Document, assert_same};
use crate::{annotate, fixture, run};
use serde_json::{Value, json};
use std::fs;
use std::process::Command;

#[test]
fn a_scene_comes_out_as_it_went_in() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["character.glb", "scene.glb", "scene.gltf", "suzanne.glb", "two_meshes.gltf"] {
        for (output, extra) in [
            ("out.glb", &[][..]),
            ("out.gltf", &[]),
            ("out.glb", &["--attributes", "class", "--color-by", "class"]),
            ("out.glb", &["--variants", "mean,gauss,k_max,shape_index,class"]),
            ("out.glb", &["--color-by", "none"]),
        ] {
            let output = folder.path().join(output);
            annotate(&fixture(name), &output, extra);
            assert_same(&fixture(name), &output, &format!("{name} {extra:?}"));
        }
    }
}

/// `character_plain.glb` is what glTF-Transform decodes `character_meshopt.glb` to: normals, rotations and
/// floats behind filters among it.
#[test]
fn a_compressed_scene_comes_out_plain() {
    let folder = tempfile::tempdir().expect("a folder");
    for (output, extra) in [("out.glb", &[][..]), ("out.gltf", &[]), ("out.glb", &["--layout", "indexed"])] {
        let output = folder.path().join(output);
        annotate(&fixture("character_meshopt.glb"), &output, extra);
        let found = Document::read(&output);
        assert!(!found.json.to_string().contains("meshopt"), "{extra:?}");
        assert_eq!(found.buffers.len(), 1, "no buffer that only stands for what was decoded");
        if extra.is_empty() {
            assert_same(&fixture("character_plain.glb"), &output, "compressed");
        }
    }
}

/// Damage in a view that no geometry needs is found before any work is done.
#[test]
fn a_damaged_compressed_animation_is_refused_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = fs::read(fixture("character_meshopt.glb")).expect("a file");
    let at = bytes.windows(10).position(|w| w == b"QUATERNION").expect("a filter of rotations");
    bytes[at..at + 10].copy_from_slice(b"SOMETHING!");
    let input = folder.path().join("damaged.glb");
    fs::write(&input, bytes).expect("writable");
    let run = run(&input, &folder.path().join("out.glb"), &[]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("damaged.glb") && said.contains("bufferViews[") && said.contains("SOMETHING!"), "{said}");
    assert!(!folder.path().join("out.glb").exists());
    annotate(&input, &folder.path().join("out.csv"), &[]);
}

/// What comes by standard input, through gzip or from an allowed folder is carried over all the same.
#[test]
fn a_scene_comes_through_from_every_kind_of_input() {
    use std::io::Write;
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let bytes = fs::read(fixture("character.glb")).expect("a file");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&bytes).expect("memory");
    let packed = packed.finish().expect("memory");
    fs::write(path("character.glb.gz"), &packed).expect("writable");
    annotate(&path("character.glb.gz"), &path("packed.glb"), &[]);
    assert_same(&fixture("character.glb"), &path("packed.glb"), "gzip");

    fs::write(path("in"), &packed).expect("writable");
    let status = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(["annotate", "-", "-q", "-o"])
        .arg(path("piped.glb"))
        .stdin(fs::File::open(path("in")).expect("a file"))
        .status()
        .expect("the program starts");
    assert!(status.success());
    assert_same(&fixture("character.glb"), &path("piped.glb"), "standard input");

    // Buffer and image in a folder of their own.
    for name in ["model", "data"] {
        fs::create_dir(path(name)).expect("a folder");
    }
    for name in ["scene.bin", "Tiles.png"] {
        fs::copy(fixture(name), path("data").join(name)).expect("a copy");
    }
    let mut document: Value = serde_json::from_slice(&fs::read(fixture("scene.gltf")).expect("a file")).expect("JSON");
    document["buffers"][0]["uri"] = json!("../data/scene.bin");
    document["images"][0]["uri"] = json!("../data/Tiles.png");
    fs::write(path("model").join("scene.gltf"), document.to_string()).expect("writable");
    let refused = run(&path("model").join("scene.gltf"), &path("refused.glb"), &[]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--allow-folder"));
    let data = path("data");
    for name in ["allowed.glb", "allowed.gltf"] {
        let leave = ["--allow-folder", data.to_str().expect("a name")];
        annotate(&path("model").join("scene.gltf"), &path(name), &leave);
        assert_same(&fixture("scene.gltf"), &path(name), name);
        assert!(!fs::read_to_string(path(name)).unwrap_or_default().contains("../data"), "nothing leads outside");
    }
}

#[test]
fn annotating_twice_equals_annotating_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf", "two_meshes.glb"] {
        annotate(&fixture(name), &path("once.glb"), &[]);
        annotate(&path("once.glb"), &path("twice.glb"), &[]);
        assert!(fs::read(path("once.glb")).expect("a GLB") == fs::read(path("twice.glb")).expect("a GLB"), "{name}");
        // Other settings in between leave nothing behind.
        annotate(&path("once.glb"), &path("other.glb"), &["--variants", "k_max,class", "--attributes", "all"]);
        annotate(&path("other.glb"), &path("back.glb"), &[]);
        assert!(fs::read(path("once.glb")).expect("a GLB") == fs::read(path("back.glb")).expect("a GLB"), "{name}");
        annotate(&path("other.glb"), &path("bare.glb"), &["--color-by", "none", "--attributes", "none"]);
        assert_same(&fixture(name), &path("bare.glb"), name);
    }
    for name in ["character.glb", "scene.gltf", "character_meshopt.glb"] {
        for extra in [
            &["--layout", "indexed"][..],
            &["--variants", "mean,gauss,k_max,shape_index,class"],
            &["--variants", "class,mean", "--color-by", "mean"],
            &["--layout", "indexed", "--vertex-values"],
        ] {
            annotate(&fixture(name), &path("once.glb"), extra);
            annotate(&path("once.glb"), &path("twice.glb"), extra);
            let [once, twice] = ["once.glb", "twice.glb"].map(|name| fs::read(path(name)).expect("a GLB"));
            assert!(once == twice, "{name} {extra:?}");
        }
    }
    // What came from STL has no other look behind ours: ours stays the one shown.
    annotate(&fixture("suzanne.stl"), &path("once.glb"), &["--up", "y"]);
    annotate(&path("once.glb"), &path("twice.glb"), &[]);
    let (once, twice) = (Document::read(&path("once.glb")), Document::read(&path("twice.glb")));
    for key in ["accessors", "bufferViews", "materials", "textures", "images", "nodes"] {
        assert_eq!(once.json[key], twice.json[key], "{key}");
    }
    assert_eq!(once.json["meshes"][0]["primitives"], twice.json["meshes"][0]["primitives"]);
    assert!(once.buffers == twice.buffers);
}
