//! Which files a batch is over, and where the output of each goes.

use super::files::Batch;
use osculate::{Error, InputFormat};
use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;
use walkdir::{DirEntry, WalkDir};

/// A file to annotate.
#[derive(Clone, Debug)]
pub(super) struct Job {
    /// The file, as the arguments lead to it.
    pub(super) input: PathBuf,
    /// Its output, relative to the output folder.
    pub(super) output: PathBuf,
    /// Size of the input in bytes.
    pub(super) bytes: u64,
    /// When the input was changed last.
    pub(super) modified: SystemTime,
}

/// Something that was named, or found, and cannot be annotated.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    pub(super) input: PathBuf,
    pub(super) message: String,
}

/// What the arguments stand for.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// In the order of the arguments, those of a folder by name.
    pub(super) jobs: Vec<Job>,
    pub(super) failures: Vec<Failure>,
}

/// A file below a folder that an argument stands for.
struct Candidate {
    input: PathBuf,
    /// The folder, without links.
    root: PathBuf,
    /// The file's path from there.
    below: PathBuf,
}

/// Finds all files, once each. `folder` is the output folder; the outputs' extension is that of the batch, behind the
/// inputs' own where `keep_extension` is true.
///
/// # Errors
/// [`Error::Usage`] for arguments that cannot be meant.
pub(super) fn find(arguments: &[PathBuf], folder: &Path, batch: &Batch, keep_extension: bool) -> Result<Found, Error> {
    let real_folder = osculate::real_path(folder);
    let mut found = Found::default();
    let mut candidates = Vec::new();
    for argument in arguments {
        if argument == Path::new("-") {
            return Err(Error::Usage("a batch reads files; standard input is for annotate".into()));
        }
        match argument.metadata() {
            Ok(metadata) if metadata.is_dir() => {
                walk(argument, &real_folder, &mut candidates, &mut found.failures)?;
            }
            Ok(_) => candidates.extend(candidate(argument)?),
            Err(_) if literal_part(argument) != *argument => {
                matching(argument, &mut candidates, &mut found.failures)?;
            }
            Err(e) => found.fail(argument, format!("cannot read: {e}")),
        }
    }
    if candidates.is_empty() && found.failures.is_empty() {
        let names: Vec<String> = arguments.iter().map(|a| a.display().to_string()).collect();
        return Err(Error::Usage(format!("no mesh files in {}", names.join(", "))));
    }
    let mut seen = BTreeSet::new();
    candidates.retain(|c| seen.insert(c.root.join(&c.below)));
    let top = common(candidates.iter().map(|c| c.root.as_path()));
    for candidate in &candidates {
        let below = candidate.root.strip_prefix(&top).unwrap_or(Path::new("")).join(&candidate.below);
        match candidate.input.metadata().and_then(|m| Ok((m.len(), m.modified()?))) {
            Ok((bytes, modified)) => found.jobs.push(Job {
                input: candidate.input.clone(),
                output: output_name(&below, batch.extension(), keep_extension),
                bytes,
                modified,
            }),
            Err(e) => found.fail(&candidate.input, format!("cannot read: {e}")),
        }
    }
    found.refuse_clashes(&seen, folder, &real_folder, batch);
    Ok(found)
}

impl Found {
    fn fail(&mut self, input: &Path, message: String) {
        self.failures.push(Failure { input: input.to_path_buf(), message });
    }

    /// Takes out jobs whose outputs would replace one another's, or an input.
    fn refuse_clashes(&mut self, inputs: &BTreeSet<PathBuf>, folder: &Path, real_folder: &Path, batch: &Batch) {
        let mut users: BTreeMap<PathBuf, Vec<usize>> = BTreeMap::new();
        for (number, job) in self.jobs.iter().enumerate() {
            batch.files_of(&job.output).into_iter().for_each(|file| users.entry(file).or_default().push(number));
        }
        let clash = |(number, job): (usize, &Job)| {
            batch.files_of(&job.output).into_iter().find_map(|file| {
                let output = folder.join(&file);
                if let Some(other) = users[&file].iter().find(|other| **other != number) {
                    let other = self.jobs[*other].input.display();
                    let what = format!("{other} would also be written to {}", output.display());
                    return Some(format!("{what}; --keep-extension keeps them apart"));
                }
                let is_input = inputs.contains(&real_folder.join(&file));
                is_input.then(|| format!("{} is an input; choose another output folder", output.display()))
            })
        };
        let clashes: Vec<Option<String>> = self.jobs.iter().enumerate().map(clash).collect();
        for (job, clash) in std::mem::take(&mut self.jobs).into_iter().zip(clashes) {
            match clash {
                Some(message) => self.fail(&job.input, message),
                None => self.jobs.push(job),
            }
        }
    }
}

/// A file that was named.
fn candidate(file: &Path) -> Result<Option<Candidate>, Error> {
    let Some(name) = file.file_name() else { return Ok(None) };
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let root = folder.canonicalize().map_err(|e| Error::io(folder, "read", e))?;
    Ok(Some(Candidate { input: file.to_path_buf(), root, below: name.into() }))
}

/// All mesh files in a folder and below it, told by their extension. What begins with a dot is not
/// looked at, nor is the output folder.
fn walk(
    folder: &Path,
    output: &Path,
    candidates: &mut Vec<Candidate>,
    failures: &mut Vec<Failure>,
) -> Result<(), Error> {
    let root = folder.canonicalize().map_err(|e| Error::io(folder, "read", e))?;
    if root == output {
        let what = "is the input folder too, so that outputs would lie among the inputs; choose another with -o";
        return Err(Error::Usage(format!("{}: {what}", folder.display())));
    }
    let is_wanted = |entry: &DirEntry| {
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        let is_output = || entry.file_type().is_dir() && entry.path().canonicalize().is_ok_and(|p| p == output);
        entry.depth() == 0 || !is_hidden && !is_output()
    };
    for entry in WalkDir::new(folder).follow_links(true).sort_by_file_name().into_iter().filter_entry(is_wanted) {
        match entry {
            Ok(entry) if entry.file_type().is_file() && InputFormat::of_extension(entry.path()).is_some() => {
                let below = entry.path().strip_prefix(folder).unwrap_or(entry.path()).to_path_buf();
                candidates.push(Candidate { input: entry.into_path(), root: root.clone(), below });
            }
            Ok(_) => {}
            Err(e) => failures.push(Failure {
                input: e.path().unwrap_or(folder).to_path_buf(),
                message: e.io_error().map_or_else(|| e.to_string(), |io| format!("cannot read: {io}")),
            }),
        }
    }
    Ok(())
}

/// All files that a pattern stands for.
fn matching(pattern: &Path, candidates: &mut Vec<Candidate>, failures: &mut Vec<Failure>) -> Result<(), Error> {
    let options =
        glob::MatchOptions { case_sensitive: true, require_literal_separator: true, require_literal_leading_dot: true };
    let paths = glob::glob_with(&pattern.to_string_lossy(), options)
        .map_err(|e| Error::Usage(format!("{}: is no pattern: {}", pattern.display(), e.msg)))?;
    let literal = literal_part(pattern);
    let folder = if literal.as_os_str().is_empty() { Path::new(".") } else { &literal };
    let before = candidates.len() + failures.len();
    for path in paths {
        match path {
            Ok(path) if path.is_file() => {
                let root = folder.canonicalize().map_err(|e| Error::io(folder, "read", e))?;
                let below = path.strip_prefix(&literal).unwrap_or(&path).to_path_buf();
                candidates.push(Candidate { input: path, root, below });
            }
            Ok(_) => {}
            Err(e) => {
                failures
                    .push(Failure { input: e.path().to_path_buf(), message: format!("cannot read: {}", e.error()) });
            }
        }
    }
    if candidates.len() + failures.len() == before {
        failures.push(Failure { input: pattern.to_path_buf(), message: "no file matches this pattern".into() });
    }
    Ok(())
}

/// The part of a path before the first component with `*`, `?` or `[`: all of it where there is none.
fn literal_part(path: &Path) -> PathBuf {
    let is_literal = |component: &Component<'_>| !component.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    path.components().take_while(is_literal).collect()
}

/// The deepest folder that holds all of these.
fn common<'p>(mut folders: impl Iterator<Item = &'p Path>) -> PathBuf {
    let first = folders.next().unwrap_or(Path::new("")).to_path_buf();
    folders.fold(first, |common, folder| {
        common.components().zip(folder.components()).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    })
}

/// `sub/part.stl.gz` becomes `sub/part.glb`, or `sub/part.stl.gz.glb`.
fn output_name(below: &Path, extension: &str, keep_extension: bool) -> PathBuf {
    let mut name = PathBuf::from(below.file_name().unwrap_or_default());
    if !keep_extension {
        if name.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz")) {
            name.set_extension("");
        }
        name.set_extension("");
    }
    let mut name = OsString::from(name);
    name.push(".");
    name.push(extension);
    // Links may lead anywhere; outputs stay below the output folder.
    let folders = below.parent().into_iter().flat_map(Path::components);
    folders.filter(|c| matches!(c, Component::Normal(_))).collect::<PathBuf>().join(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Cli, Command};
    use clap::Parser;

    fn tree(files: &[&str]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for file in files {
            let path = folder.path().join(file);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(path, "x").expect("writable");
        }
        std::fs::create_dir_all(folder.path().join("out")).expect("a folder");
        folder
    }

    fn batch(options: &[&str]) -> Batch {
        let line = [&["osculate", "batch", "s", "-o", "out"], options].concat();
        let Ok(Cli { command: Command::Batch(args) }) = Cli::try_parse_from(line) else { panic!("{options:?}") };
        Batch::new(&args).expect("a batch")
    }

    fn outputs(folder: &tempfile::TempDir, arguments: &[&str]) -> (Vec<String>, Vec<String>) {
        outputs_of(folder, arguments, &[])
    }

    fn outputs_of(folder: &tempfile::TempDir, arguments: &[&str], options: &[&str]) -> (Vec<String>, Vec<String>) {
        let arguments: Vec<PathBuf> = arguments.iter().map(|a| folder.path().join(a)).collect();
        let found = find(&arguments, &folder.path().join("out"), &batch(options), false).expect("meant");
        let name = |path: &Path| path.to_string_lossy().into_owned();
        let failures = found.failures.iter().map(|f| f.message.clone()).collect();
        (found.jobs.iter().map(|job| name(&job.output)).collect(), failures)
    }

    #[test]
    fn the_tree_below_the_deepest_common_folder_is_mirrored() {
        let folder = tree(&["s/a.stl", "s/x/b.obj.gz", "s/x/y/c.d.PLY", "s/x/note.txt", "s/.trash/d.stl", "s/._a.stl"]);
        let mirrored = (vec!["a.glb".into(), "x/b.glb".into(), "x/y/c.d.glb".into()], vec![]);
        assert_eq!(outputs(&folder, &["s"]), mirrored);
        assert_eq!(outputs(&folder, &["s", "s/a.stl", "s/x"]), mirrored);
        assert_eq!(outputs(&folder, &["s/x/y"]).0, ["c.d.glb"]);
        assert_eq!(outputs(&folder, &["s/x/y/c.d.PLY", "s/a.stl"]).0, ["x/y/c.d.glb", "a.glb"]);
        assert_eq!(outputs(&folder, &["."]).0, ["s/a.glb", "s/x/b.glb", "s/x/y/c.d.glb"]);
    }

    #[test]
    fn patterns_mirror_the_tree_below_their_literal_part() {
        let folder = tree(&["s/a.stl", "s/x/b.stl", "s/x/y/c.stl", "s/x/y/d.obj", "s/[1].stl"]);
        assert_eq!(outputs(&folder, &["s/**/*.stl"]).0, ["[1].glb", "a.glb", "x/b.glb", "x/y/c.glb"]);
        assert_eq!(outputs(&folder, &["s/x/*/?.*"]).0, ["y/c.glb", "y/d.glb"]);
        assert_eq!(outputs(&folder, &["s/[1].stl"]).0, ["[1].glb"]);
        assert_eq!(outputs(&folder, &["s/*.ply"]), (vec![], vec!["no file matches this pattern".into()]));
        assert_eq!(outputs(&folder, &["s/none.ply", "s/a.stl"]).0, ["a.glb"]);
    }

    #[test]
    fn outputs_never_share_a_name_and_never_replace_an_input() {
        let folder = tree(&["s/a.stl", "s/a.obj", "s/b.stl", "out/c.glb"]);
        let (jobs, failures) = outputs(&folder, &["s"]);
        assert_eq!((jobs.as_slice(), failures.len()), (["b.glb".to_owned()].as_slice(), 2));
        assert!(failures.iter().all(|message| message.contains("--keep-extension")));
        let (jobs, failures) = outputs(&folder, &["out/c.glb"]);
        assert!(jobs.is_empty() && failures[0].contains("is an input"), "{failures:?}");
        let root = folder.path().to_path_buf();
        assert!(find(&[root.join("out")], &root.join("out"), &batch(&[]), false).is_err());
        assert!(find(&["-".into()], &root.join("out"), &batch(&[]), false).is_err());
        // What is written beside an output counts, too.
        let folder = tree(&["s/a.stl", "s/a.edges.stl", "s/b.stl"]);
        assert_eq!(outputs(&folder, &["s"]).0.len(), 3);
        let (jobs, failures) = outputs_of(&folder, &["s"], &["--edges"]);
        assert_eq!((jobs.as_slice(), failures.len()), (["b.glb".to_owned()].as_slice(), 2));
        let folder = tree(&["s/a.stl", "s/a-1.stl"]);
        let two = ["--format", "gltf", "--variants", "mean,curvedness"];
        assert!(outputs_of(&folder, &["s"], &two).0.is_empty() && outputs_of(&folder, &["s"], &two[..2]).1.is_empty());
        assert_eq!(output_name(Path::new("x/part.stl.gz"), "csv", true), Path::new("x/part.stl.gz.csv"));
    }
}
