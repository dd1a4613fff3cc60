//! glTF in, glTF out: everything of a scene comes out as it went in, with values and looks beside it.

mod compress;
mod document;
mod looks;
mod metadata;
mod odd;
mod refusals;
mod select;
mod tables;
mod values;
mod whole;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

pub(crate) fn fixture(name: &str) -> PathBuf {
    Path::new(ROOT).join("fixtures").join(name)
}

pub(crate) fn run(input: &Path, output: &Path, extra: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_osculate"))
        .arg("annotate")
        .arg(input)
        .arg("-o")
        .arg(output)
        .args(extra)
        .output()
        .expect("the program starts")
}

pub(crate) fn annotate(input: &Path, output: &Path, extra: &[&str]) -> String {
    let run = run(input, output, extra);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(matches!(run.status.code(), Some(0 | 3)), "{said}");
    said
}

/// The numbers of a CSV column; an empty field is 0, as in glTF.
pub(crate) fn column(csv: &str, name: &str) -> Vec<f32> {
    let at = csv.lines().next().expect("a header").split(',').position(|n| n == name).expect("the column");
    let fields = csv.lines().skip(1).map(|line| line.split(',').nth(at).expect("a field"));
    fields.map(|field| if field.is_empty() { 0.0 } else { field.parse().expect("a number") }).collect()
}
