//! `--compress meshopt`: smaller files whose rounding is what the help says. They are read back by the
//! program itself here, by other decoders in `tests/clients`.

use crate::document::{Document, assert_same};
use crate::{annotate, column, fixture, run};
use std::fs;

const COMPRESS: [&str; 2] = ["--compress", "meshopt"];

#[test]
fn values_come_back_within_the_rounding_that_is_stated() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let wanted = ["--attributes", "default,radius,dir_min,gauss_perimeter"];
    for name in ["suzanne.stl", "scene.gltf", "two_meshes.glb"] {
        annotate(&fixture(name), &path("once.glb"), &wanted);
        annotate(&path("once.glb"), &path("once.csv"), &[&wanted[..], &["--reuse"]].concat());
        let exact = fs::read_to_string(path("once.csv")).expect("a CSV");
        for layout in ["faces", "indexed"] {
            for output in ["out.glb", "out.gltf"] {
                annotate(&fixture(name), &path(output), &[&wanted[..], &COMPRESS, &["--layout", layout]].concat());
                annotate(&path(output), &path("again.csv"), &[&wanted[..], &["--reuse"]].concat());
                let again = fs::read_to_string(path("again.csv")).expect("a CSV");
                for (column_name, share) in [
                    ("face", false),
                    ("class", false),
                    ("k_max", false),
                    ("radius", false),
                    ("coverage", true),
                    ("dir_max_z", true),
                ] {
                    for (a, b) in column(&exact, column_name).into_iter().zip(column(&again, column_name)) {
                        let allowed = if share { 1.0 } else { a.abs() } / 65536.0;
                        assert!((a - b).abs() <= allowed, "{name} {layout} {column_name}: {a} {b}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_compressed_file_is_smaller_and_says_what_it_needs() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("suzanne.stl"), &path("plain.glb"), &["--up", "y"]);
    annotate(&fixture("suzanne.stl"), &path("small.glb"), &[&COMPRESS[..], &["--up", "y", "--metadata"]].concat());
    let sizes = ["plain.glb", "small.glb"].map(|name| fs::metadata(path(name)).expect("a file").len());
    assert!(sizes[1] < sizes[0] / 2, "{sizes:?}");
    let small = Document::read(&path("small.glb"));
    assert_eq!(small.json["extensionsRequired"], serde_json::json!(["EXT_meshopt_compression"]));
    // Positions: as the plain file has them, to a share of the extent. Decompressed by another run.
    annotate(&path("small.glb"), &path("back.glb"), &["--attributes", "none", "--color-by", "none"]);
    let positions = |name: &str| {
        let out = Document::read(&path(name));
        let accessor = out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].clone();
        let bounds = out.json["accessors"][accessor.as_u64().expect("a number") as usize].clone();
        (
            out.elements(&accessor).concat().as_chunks().0.iter().map(|&b| f32::from_le_bytes(b)).collect::<Vec<_>>(),
            bounds,
        )
    };
    let ((exact, _), (rounded, bounds)) = (positions("plain.glb"), positions("back.glb"));
    let far = exact.iter().zip(&rounded).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    let extent = exact.iter().fold(0.0, |most: f32, c| most.max(c.abs()));
    assert!(far <= 2.0 * extent / 65536.0, "{far} of {extent}");
    for (c, (min, max)) in (0..3).map(|c| (c, (&bounds["min"][c], &bounds["max"][c]))) {
        let of_axis = || rounded.iter().skip(c).step_by(3).copied();
        assert_eq!(min.as_f64().map(|m| m as f32), of_axis().reduce(f32::min));
        assert_eq!(max.as_f64().map(|m| m as f32), of_axis().reduce(f32::max));
    }
}

/// What a scene had keeps its bits.
#[test]
fn a_scene_comes_out_of_a_compressed_file_as_it_went_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf"] {
        for extra in [&[][..], &["--layout", "indexed"], &["--metadata"], &["--select", "k_max>-1e9"]] {
            annotate(&fixture(name), &path("small.glb"), &[&COMPRESS[..], extra].concat());
            annotate(&path("small.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
            assert_same(&fixture(name), &path("bare.glb"), &format!("{name} {extra:?}"));
        }
    }
}

#[test]
fn other_formats_have_no_such_compression() {
    let folder = tempfile::tempdir().expect("a folder");
    for extra in [&COMPRESS[..], &["--metadata"]] {
        let refused = run(&fixture("suzanne.stl"), &folder.path().join("out.ply"), extra);
        let said = String::from_utf8_lossy(&refused.stderr);
        assert!(refused.status.code() == Some(2) && said.contains(".glb and .gltf"), "{said}");
    }
    let refused = run(&fixture("suzanne.stl"), &folder.path().join("out.glb"), &["--metadata", "--layout", "indexed"]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("layout indexed"));
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0);
}
