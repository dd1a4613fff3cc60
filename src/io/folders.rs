//! Where files that a model names may lie: in the model's own folder, below it, and in folders that
//! the user has allowed. A model may not make us read anything else.

use std::path::{Component, Path, PathBuf};

/// The folders that names in a model may lead to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Folders<'a> {
    /// The model's own folder; `None` when the model comes from a stream.
    own: Option<&'a Path>,
    /// Folders that the user has allowed besides.
    allowed: &'a [PathBuf],
}

impl<'a> From<Option<&'a Path>> for Folders<'a> {
    fn from(own: Option<&'a Path>) -> Self {
        Folders { own, allowed: &[] }
    }
}

impl<'a> Folders<'a> {
    pub(super) fn new(own: Option<&'a Path>, allowed: &'a [PathBuf]) -> Self {
        Folders { own, allowed }
    }

    /// Where relative names begin: in the model's folder, or for a stream in the first allowed one.
    pub(super) fn base(&self) -> Option<&'a Path> {
        let base = self.own.or(self.allowed.first().map(PathBuf::as_path));
        base.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
    }

    /// The file of a name, which may be relative, or why it is not read. Nothing outside the allowed
    /// folders is touched, not even to see whether it is there.
    pub(super) fn find(&self, name: &str) -> Result<PathBuf, String> {
        let Some(base) = self.base() else {
            return Err(
                "is a file of its own, which cannot be found from a stream; give the model's path, or a GLB".into()
            );
        };
        let cannot = |error: std::io::Error| format!("cannot be read: {error}");
        let base = base.canonicalize().map_err(cannot)?;
        let mut allowed = Vec::with_capacity(1 + self.allowed.len());
        allowed.extend(self.own.map(|_| base.clone()));
        // A folder that is not there allows nothing.
        allowed.extend(self.allowed.iter().filter_map(|folder| folder.canonicalize().ok()));
        let is_allowed = |path: &Path| allowed.iter().any(|folder| path.starts_with(folder));

        let path = without_dots(&base.join(name));
        if !is_allowed(&path) {
            let how = if Path::new(name).is_absolute() {
                "only paths relative to the model's folder are"
            } else {
                "`..` leads out of the model's folder"
            };
            return Err(format!("is not read: {how} (--allow-folder allows another folder)"));
        }
        let file = path.canonicalize().map_err(cannot)?;
        if !is_allowed(&file) {
            return Err(
                "is not read: it is a link that leads out of the model's folder (--allow-folder allows another folder)"
                    .into(),
            );
        }
        // A pipe or a device in the folder would block or never end.
        if !file.metadata().map_err(cannot)?.is_file() {
            return Err("cannot be read: it is not a file".into());
        }
        Ok(file)
    }
}

/// An absolute path with `.` and `..` worked out by the letter.
fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => drop(plain.pop()),
            other => plain.push(other),
        }
    }
    plain
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::fs;
    use std::os::unix::fs::symlink;

    #[test]
    fn only_the_own_folder_and_allowed_ones_are_looked_into() {
        let outer = tempfile::tempdir().expect("a folder");
        let [model, shared, secret] = ["model", "shared", "secret"].map(|name| outer.path().join(name));
        for folder in [&model, &shared, &secret] {
            fs::create_dir(folder).expect("a folder");
            fs::write(folder.join("a.bin"), "a").expect("a file");
        }
        symlink("../shared/a.bin", model.join("shared.bin")).expect("a link");
        symlink("../secret/a.bin", model.join("secret.bin")).expect("a link");
        symlink("../secret", shared.join("way")).expect("a link");
        let absolute = shared.join("a.bin").to_string_lossy().into_owned();

        let own = Folders::from(Some(model.as_path()));
        assert!(own.find("a.bin").is_ok() && own.find("x/../a.bin").is_ok());
        for name in ["../shared/a.bin", "shared.bin", "secret.bin", &absolute, "../model/../secret/a.bin"] {
            assert!(own.find(name).expect_err(name).contains("--allow-folder"), "{name}");
        }
        let allowed = [shared];
        let more = Folders::new(Some(&model), &allowed);
        for name in ["a.bin", "../shared/a.bin", "shared.bin", &absolute] {
            more.find(name).unwrap_or_else(|e| panic!("{name} {e}"));
        }
        for name in ["../secret/a.bin", "secret.bin", "../shared/way/a.bin", "../shared/../secret/a.bin", ".", ""] {
            more.find(name).expect_err(name);
        }
        let stream = Folders::new(None, &allowed);
        assert!(stream.find("a.bin").is_ok() && stream.find("../model/a.bin").is_err());
        assert!(Folders::default().find("a.bin").expect_err("a stream").contains("stream"));
    }
}
