//! Many files in one run: the mirrored tree, the log, exit codes, and what is left after a kill.
#![cfg(unix)]

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const LOG: &str = "osculate-batch.jsonl";

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_osculate"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn osculate(folder: &Path, args: &[&str]) -> Output {
    command(folder, args).output().expect("the program starts")
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

/// A folder with fixtures under these names.
fn folder_of(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, of) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::copy(fixture(of), path).expect("a fixture");
    }
    folder
}

/// The log's records by input, in the order of the lines.
fn records(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join(LOG)).expect("a log");
    text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

/// All files below a folder but the log, with their content.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.file_name().is_some_and(|name| name != LOG) {
                let name = path.strip_prefix(folder).expect("below").to_string_lossy().into_owned();
                found.insert(name, fs::read(&path).expect("readable"));
            }
        }
    }
    found
}

#[test]
fn one_bad_file_does_not_stop_the_rest() {
    let folder = folder_of(&[
        ("in/part.stl", "fillet_part.stl"),
        ("in/sub/head.ply", "suzanne.ply"),
        ("in/sub/scene.glb", "two_meshes.glb"),
        ("in/worn.stl", "fillet_degenerate.stl"),
    ]);
    fs::write(folder.path().join("in/broken.obj"), "v 0 0 0\nf 1 2 3\n").expect("writable");
    let run = osculate(folder.path(), &["batch", "in", "in/none.stl", "-o", "out/deep", "--log", "json"]);
    assert_eq!(run.status.code(), Some(1));
    let out = folder.path().join("out/deep");
    let names: Vec<String> = files(&out).into_keys().collect();
    assert_eq!(names, ["part.glb", "sub/head.glb", "sub/scene.glb", "worn.glb"]);

    let mut by_input = BTreeMap::new();
    for record in records(&out) {
        by_input.insert(record["input"].as_str().expect("a name").to_owned(), record);
    }
    let status = |name: &str| by_input[name]["status"].as_str().expect("a word");
    assert_eq!(by_input.len(), 6);
    assert_eq!(["in/part.stl", "in/sub/head.ply", "in/sub/scene.glb"].map(status), ["done"; 3]);
    assert_eq!(status("in/worn.stl"), "defects");
    assert!(by_input["in/worn.stl"]["message"].as_str().expect("a message").contains("8 faces without area"));
    assert_eq!(by_input["in/worn.stl"]["counts"]["degenerate_faces"], 8);
    assert_eq!(by_input["in/part.stl"]["output"], "part.glb");
    assert!(by_input["in/part.stl"]["seconds"].as_f64().expect("a number") > 0.0);
    assert!(by_input["in/part.stl"]["message"].is_null());
    assert_eq!(["in/broken.obj", "in/none.stl"].map(status), ["failed"; 2]);
    assert!(by_input["in/broken.obj"]["message"].as_str().expect("a message").contains("line 2"));

    // What failed is told, and only that.
    let messages = String::from_utf8(run.stderr).expect("text");
    let messages: Vec<Value> = messages.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let errors = messages.iter().filter(|m| m["level"] == "error").count();
    assert_eq!((messages.len(), errors), (3, 2), "two errors and a summary: {messages:?}");
}

#[test]
fn the_exit_code_is_that_of_the_worst_file_also_when_it_was_done_before() {
    let folder = folder_of(&[("good/a.stl", "suzanne.stl"), ("worn/b.stl", "fillet_degenerate.stl")]);
    let code = |args: &[&str]| osculate(folder.path(), &[&["batch"], args, &["-q"]].concat()).status.code();
    assert_eq!(code(&["good", "-o", "out"]), Some(0));
    assert_eq!(code(&["good", "worn", "-o", "both"]), Some(3));
    assert_eq!(code(&["good", "worn", "-o", "both", "--resume"]), Some(3));
    fs::write(folder.path().join("worn/c.obj"), "nothing").expect("writable");
    assert_eq!(code(&["good", "worn", "-o", "both", "--resume"]), Some(1));
    fs::remove_file(folder.path().join("worn/c.obj")).expect("there");
    assert_eq!(code(&["good", "worn", "-o", "both", "--resume"]), Some(3));
    // What makes no sense is told before anything is written.
    fs::create_dir(folder.path().join("empty")).expect("a folder");
    for args in [
        &["empty", "-o", "none"][..],
        &["good", "-o", "good"],
        &["-", "-o", "none"],
        &["good", "-o", "none", "--radius", "-1"],
        &["good", "-o", "none", "--legend", "png", "--color-by", "none"],
        &["good", "-o", "none", "--view", "0,0,1"],
    ] {
        assert_eq!(code(args), Some(2), "{args:?}");
    }
    assert!(!folder.path().join("none").exists());
}

#[test]
fn resume_does_what_is_missing_older_or_made_otherwise() {
    let names = [("in/a.stl", "suzanne.stl"), ("in/b.ply", "suzanne.ply"), ("in/c.off", "sphere.off")];
    let folder = folder_of(&names);
    let out = folder.path().join("out");
    let annotated = |extra: &[&str]| {
        let before = fs::read_to_string(out.join(LOG)).map_or(0, |text| text.lines().count());
        let run = osculate(folder.path(), &[&["batch", "in", "-o", "out", "--resume", "-q"], extra].concat());
        assert_eq!(run.status.code(), Some(0), "{}", String::from_utf8_lossy(&run.stderr));
        records(&out)[before..]
            .iter()
            .map(|record| record["output"].as_str().expect("a name").to_owned())
            .collect::<std::collections::BTreeSet<_>>()
    };
    let all = ["a.glb", "b.glb", "c.glb"].map(String::from).into();
    assert_eq!(annotated(&[]), all, "nothing is there yet");
    assert!(annotated(&[]).is_empty());
    assert!(annotated(&["-j", "1"]).is_empty(), "threads change nothing in the outputs");
    fs::remove_file(out.join("b.glb")).expect("there");
    assert_eq!(annotated(&[]), ["b.glb".to_owned()].into());
    fs::copy(fixture("fillet_part.stl"), folder.path().join("in/a.stl")).expect("writable");
    assert_eq!(annotated(&[]), ["a.glb".to_owned()].into(), "the input is newer");
    let old = fs::File::options().write(true).open(folder.path().join("in/c.off")).expect("there");
    old.set_modified(std::time::UNIX_EPOCH + Duration::from_secs(1_000_000_000)).expect("settable");
    assert_eq!(annotated(&[]), ["c.glb".to_owned()].into(), "another input took its place");
    for settings in [&["--color-by", "gauss"][..], &["--stats"], &["--edges", "--view", "0,0,1"], &["--unit", "mm"]] {
        assert_eq!(annotated(settings), all, "{settings:?}");
        assert!(annotated(settings).is_empty(), "{settings:?}");
    }
    assert_eq!(annotated(&["--unit", "mm", "--legend", "svg"]), all);
    fs::remove_file(out.join("a.legend.svg")).expect("there");
    assert_eq!(annotated(&["--unit", "mm", "--legend", "svg"]), ["a.glb".to_owned()].into());
}

/// A document is nothing without its buffer.
#[test]
fn resume_misses_what_lies_beside_an_output() {
    let folder = folder_of(&[("s/a.stl", "suzanne.stl")]);
    // Two quantities of one colour map share a palette.
    let options = ["--format", "gltf", "--variants", "mean,gauss", "--resume"];
    let batch = || osculate(folder.path(), &[&["batch", "s", "-o", "out"], &options[..]].concat());
    for missing in ["a.bin", "a.png", "a.gltf"] {
        assert_eq!(batch().status.code(), Some(0));
        assert!(String::from_utf8_lossy(&batch().stderr).contains("1 skipped"));
        fs::remove_file(folder.path().join("out").join(missing)).expect("was written");
    }
}

/// Options that make no sense are told before the log of an earlier run is touched.
#[test]
fn a_mistake_costs_no_log() {
    let folder = folder_of(&[("s/a.stl", "suzanne.stl")]);
    let batch =
        |more: &[&str]| osculate(folder.path(), &[&["batch", "s", "-o", "out", "--format", "csv"], more].concat());
    assert_eq!(batch(&[]).status.code(), Some(0));
    let log = fs::read(folder.path().join("out").join(LOG)).expect("a log");
    assert_eq!(batch(&["--metadata"]).status.code(), Some(2));
    assert_eq!(fs::read(folder.path().join("out").join(LOG)).expect("a log"), log);
}

#[test]
fn options_of_annotate_hold_for_every_file() {
    let folder = folder_of(&[("in/a.stl", "fillet_part.stl"), ("in/b.stl", "fillet_part.stl")]);
    let options = ["--radius", "1", "--color-by", "k_max", "--attributes", "k_max,class"];
    for format in ["glb", "gltf", "ply", "csv", "npz"] {
        let batch = [&["batch", "in/*.stl", "-o", format, "--format", format, "-q"], &options[..]].concat();
        assert_eq!(osculate(folder.path(), &batch).status.code(), Some(0));
        let output = format!("a.{format}");
        let single = [&["annotate", "in/a.stl", "-o", &output, "-q"], &options[..]].concat();
        assert_eq!(osculate(folder.path(), &single).status.code(), Some(0));
        let [one, many] = [output.clone(), format!("{format}/{output}")].map(|p| fs::read(folder.path().join(p)));
        assert!(one.expect("there") == many.expect("there"), "{format}");
    }
    let besides = ["batch", "in", "-o", "out", "--legend", "png", "--edges", "--stats", "--keep-extension", "-q"];
    assert_eq!(osculate(folder.path(), &besides).status.code(), Some(0));
    let names: Vec<String> = files(&folder.path().join("out")).into_keys().filter(|n| n.starts_with('a')).collect();
    assert_eq!(names, ["a.stl.edges.glb", "a.stl.glb", "a.stl.legend.png", "a.stl.stats.json"]);
    let kept = osculate(folder.path(), &["batch", "in", "-o", "out", "--keep-extension", "--no-clobber", "-q"]);
    assert_eq!(kept.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&kept.stderr).contains("a.stl.glb exists"));
}

/// So many meshes that a batch is still at work when a signal reaches it, on any machine.
const MANY: usize = 200;

/// Many copies of a mesh, so that a run lasts.
fn many() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = fs::read(fixture("suzanne.stl")).expect("a fixture");
    for i in 0..MANY {
        let path = folder.path().join(format!("in/{}/{i}.stl", i % 7));
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, &mesh).expect("writable");
    }
    folder
}

fn kill(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
}

/// Starts the batch and kills it as soon as there are so many lines in the log.
fn kill_after(folder: &Path, lines: usize, signal: &str, args: &[&str]) -> Output {
    let child = command(folder, args).spawn().expect("the program starts");
    let log = folder.join("out").join(LOG);
    let start = Instant::now();
    while fs::read_to_string(&log).map_or(0, |text| text.lines().count()) < lines {
        assert!(start.elapsed() < Duration::from_secs(60), "the log does not grow");
        std::thread::sleep(Duration::from_millis(1));
    }
    kill(&child, signal);
    child.wait_with_output().expect("it ends")
}

#[test]
fn a_killed_batch_resumes_with_nothing_lost_or_half_written() {
    let folder = many();
    let args = ["batch", "in", "-o", "out", "--format", "gltf", "--resume", "-q"];
    let whole = osculate(folder.path(), &["batch", "in", "-o", "whole", "--format", "gltf", "-q"]);
    assert_eq!(whole.status.code(), Some(0));
    let whole = files(&folder.path().join("whole"));
    assert_eq!(whole.len(), 3 * MANY);
    let mut lines = 0;
    for step in [1, 2, 3, 5, 8, 13] {
        lines += step;
        let run = kill_after(folder.path(), lines, "-KILL", &args);
        assert_eq!(run.status.code(), None, "killed");
        // What is there is whole, but for a document whose buffer is newer than itself.
        for (name, content) in files(&folder.path().join("out")) {
            assert!(name.contains(".osculate-") || whole[&name] == content, "{name} after {lines} lines");
        }
        lines = fs::read_to_string(folder.path().join("out").join(LOG)).expect("a log").lines().count();
        assert!(lines < MANY, "killed too late");
    }
    assert_eq!(osculate(folder.path(), &args).status.code(), Some(0));
    assert!(files(&folder.path().join("out")) == whole, "nothing is lost, nothing is left over");
    // A line that was cut short stands alone; all others are whole and no file was done twice.
    let text = fs::read_to_string(folder.path().join("out").join(LOG)).expect("a log");
    let mut done: Vec<String> = text
        .lines()
        .filter_map(|line| serde_json::from_str::<Value>(line).ok())
        .map(|record| record["output"].as_str().expect("a name").to_owned())
        .collect();
    done.sort();
    assert_eq!(done.len(), MANY);
    done.dedup();
    assert_eq!(done.len(), MANY);
}

#[test]
fn an_interrupted_batch_leaves_no_temporary_file() {
    let folder = many();
    let args = ["batch", "in", "-o", "out"];
    let run = kill_after(folder.path(), 9, "-INT", &args);
    assert_eq!(run.status.code(), Some(130));
    assert!(String::from_utf8_lossy(&run.stderr).contains("--resume"));
    let done = records(&folder.path().join("out")).len();
    let written = files(&folder.path().join("out"));
    assert!(written.keys().all(|name| name.ends_with(".glb")), "{:?}", written.keys());
    assert!((done..MANY).contains(&written.len()), "{done} records, {} files", written.len());
}
