//! Where outputs go, and what they must not replace.

use super::{OutputFormat, gltf};
use crate::color::Colormap;
use crate::error::Error;
use std::path::{Path, PathBuf};

/// Where an output goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Destination {
    /// A file; it appears whole or not at all.
    File(PathBuf),
    /// Standard output.
    Stdout,
}

impl Destination {
    /// All files that an output of so many faces may replace.
    fn most_files(&self, format: OutputFormat, faces: usize, scales: usize) -> Vec<PathBuf> {
        match self {
            Destination::Stdout => Vec::new(),
            Destination::File(path) if format == OutputFormat::Gltf => gltf::most_files(path, faces, scales),
            Destination::File(path) => vec![path.clone()],
        }
    }

    /// The files of an output with palettes of colour maps, but for the further buffers that a large one has.
    pub(crate) fn usual_files(&self, format: OutputFormat, maps: &[Colormap]) -> Vec<PathBuf> {
        match self {
            Destination::File(path) if format == OutputFormat::Gltf => gltf::files_of(path, 1, gltf::palettes(maps)),
            Destination::File(path) => vec![path.clone()],
            Destination::Stdout => Vec::new(),
        }
    }

    /// Refuses an output of `faces` faces and `scales` colour scales that would replace the input, a file that the
    /// input names or one of `others`.
    ///
    /// # Errors
    /// [`Error::Usage`] or [`Error::Io`], with the file in question.
    pub(crate) fn check(
        &self,
        format: OutputFormat,
        others: &[PathBuf],
        input: &Path,
        files: &[PathBuf],
        [faces, scales]: [usize; 2],
    ) -> Result<(), Error> {
        let mut outputs = self.most_files(format, faces, scales);
        if let [document, beside @ ..] = outputs.as_slice()
            && beside.contains(document)
        {
            return Err(Error::Usage(format!("{}: a glTF document ends in .gltf", document.display())));
        }
        outputs.extend_from_slice(others);
        check_outputs(&outputs, input, files)
    }

    /// Refuses an output in a folder that does not exist.
    ///
    /// # Errors
    /// [`Error::Io`] with the folder.
    pub(crate) fn check_folder(&self) -> Result<(), Error> {
        match self {
            Destination::File(path) => check_folder(path),
            Destination::Stdout => Ok(()),
        }
    }
}

/// Refuses an output in a folder that does not exist, before anything is read.
///
/// # Errors
/// [`Error::Io`] with the output.
pub fn check_folder(output: &Path) -> Result<(), Error> {
    match output.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            let missing = std::io::Error::new(std::io::ErrorKind::NotFound, "the folder does not exist");
            Err(Error::io(output, "create", missing))
        }
        _ => Ok(()),
    }
}

/// Refuses outputs that would replace the input, one of `files`, which the input names, or one another.
///
/// # Errors
/// [`Error::Usage`] with the output in question.
pub fn check_outputs(outputs: &[PathBuf], input: &Path, files: &[PathBuf]) -> Result<(), Error> {
    let inputs: Vec<PathBuf> =
        std::iter::once(input).chain(files.iter().map(PathBuf::as_path)).map(real_path).collect();
    let mut seen: Vec<PathBuf> = Vec::new();
    for output in outputs {
        let real = real_path(output);
        if inputs.contains(&real) {
            return Err(Error::Usage(format!("{} belongs to the input; choose another output", output.display())));
        }
        if seen.contains(&real) {
            return Err(Error::Usage(format!("{} is named for two outputs", output.display())));
        }
        seen.push(real);
    }
    Ok(())
}

/// A path by which two names of one file are equal, also for a file that is not there yet.
pub fn real_path(path: &Path) -> PathBuf {
    match followed(path) {
        Named::File(real) => real,
        Named::Descriptor(_) => path.to_path_buf(),
    }
}

/// What a path leads to.
pub(super) enum Named {
    /// A file, a device or a pipe, or a place where there is nothing yet.
    File(PathBuf),
    /// An open file of this process, such as `/dev/stdout`. To replace what it leads to would replace what a shell has
    /// put there.
    Descriptor(u32),
}

/// Follows links, also to what is not there yet.
pub(super) fn followed(path: &Path) -> Named {
    /// As many as systems follow.
    const MOST_LINKS: usize = 40;
    let mut at = path.to_path_buf();
    for _ in 0..MOST_LINKS {
        let folder = at.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let Ok(folder) = folder.canonicalize() else { break };
        let Some(name) = at.file_name() else { break };
        if folder.starts_with("/proc") && folder.ends_with("fd") {
            return match name.to_str().and_then(|name| name.parse().ok()) {
                Some(number) => Named::Descriptor(number),
                None => Named::File(at),
            };
        }
        let here = folder.join(name);
        match here.read_link() {
            Ok(target) => at = folder.join(target),
            Err(_) => return Named::File(here),
        }
    }
    Named::File(path.canonicalize().unwrap_or_else(|_| path.to_path_buf()))
}
