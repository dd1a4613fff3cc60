//! What cannot be done is said in one sentence, and nothing is left behind.

use crate::{fixture, run};
use std::fs;
use std::path::Path;
#[cfg(unix)]
use std::process::Command;

#[test]
fn what_cannot_be_done_is_said_before_any_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for (input, extra, code, why) in [
        ("scene.glb", &["--color", "vertex"][..], 2, "vertex colours"),
        ("scene.glb", &["--unit", "mm"], 2, "--unit does not apply to glTF"),
        ("suzanne.stl", &["--variants", "mean,sharpness"], 2, "sharpness"),
        ("suzanne.stl", &["--variants", "mean,k_max", "--color", "vertex"], 2, "--color texture"),
        ("suzanne.stl", &["--variants", "mean", "--layout", "indexed"], 2, "no colours"),
        ("suzanne.stl", &["--range", "2:1"], 2, "empty or reversed"),
        ("suzanne.stl", &["--range", "1:1"], 2, "empty or reversed"),
        ("suzanne.stl", &["--attributes", "k_mux"], 2, "k_mux"),
        ("suzanne.stl", &["--colormap", "rainbow"], 2, "rainbow"),
    ] {
        let refused = run(&fixture(input), &path("out.glb"), extra);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(code), "{extra:?}: {said}");
        assert!(said.contains(why), "{said}");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0, "{extra:?}");
    }
    // Folders that are not there, of the output and of what comes beside it.
    let missing = path("no/such").display().to_string();
    for (output, extra) in [
        (path("no/out.glb"), &[][..]),
        (path("out.glb"), &["--edges", &format!("{missing}/edges.glb")]),
        (path("out.glb"), &["--legend", &format!("{missing}/legend.svg")]),
        (path("out.glb"), &["--stats", &format!("{missing}/stats.json")]),
    ] {
        let refused = run(Path::new("no such input.stl"), &output, extra);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!((refused.status.code(), said.lines().count()), (Some(1), 1), "{said}");
        assert!(said.contains(&path("no").display().to_string()), "before the input is opened: {said}");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0, "{extra:?}");
    }
}

/// What a shell line writes into a folder that has one older file: exit code, and what it says.
#[cfg(unix)]
fn shell(folder: &Path, line: &str) -> (Option<i32>, String) {
    let run = Command::new("bash").args(["-c", line]).current_dir(folder).output().expect("a shell");
    (run.status.code(), String::from_utf8_lossy(&run.stderr).into_owned())
}

/// A limit on the size of files stands for a disk that is full.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_what_was_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = env!("CARGO_BIN_EXE_osculate");
    let input = fixture("suzanne.stl").display().to_string();
    for name in ["out.glb", "out.gltf", "out.ply", "out.csv", "out.npz"] {
        fs::write(folder.path().join(name), "old").expect("writable");
        for extra in ["", "--edges e.glb --legend l.png --stats s.json"] {
            let line = format!("trap '' XFSZ; ulimit -f 8; exec {program} annotate {input} -o {name} -q {extra}");
            let (code, said) = shell(folder.path(), &line);
            assert_eq!((code, said.lines().count()), (Some(1), 1), "{name}: {said}");
            assert!(said.contains("cannot write"), "{said}");
            assert_eq!(fs::read(folder.path().join(name)).expect("there"), b"old", "{name}");
            assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1, "{name} {extra}: nothing beside it");
        }
        fs::remove_file(folder.path().join(name)).expect("removable");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_device_is_told_in_one_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = env!("CARGO_BIN_EXE_osculate");
    let input = fixture("suzanne.stl").display().to_string();
    for format in ["glb", "gltf", "ply", "csv", "npz"] {
        for output in ["/dev/full", "- >/dev/full"] {
            let line = format!("exec {program} annotate {input} --format {format} -q -o {output}");
            let (code, said) = shell(folder.path(), &line);
            assert_eq!((code, said.lines().count()), (Some(1), 1), "{format} {output}: {said}");
            assert!(said.contains("No space left"), "{said}");
        }
    }
}
