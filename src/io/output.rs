//! Outputs that appear whole or not at all.

use super::destination::{Named, followed};
use crate::error::Error;
use std::fs::{File, TryLockError};
use std::io::{self, BufWriter, IoSlice, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Bytes gathered before a write. The blocks of large outputs are not gathered, but written as they are.
const BUFFER: usize = 64 * 1024;

/// A file being written beside its final place, where only [`Output::finish`] puts it, or a stream that cannot be taken
/// back.
#[must_use = "a file that is not finished is dropped"]
pub struct Output {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    /// Renamed to `path` when done; removed when dropped before.
    Temporary(BufWriter<NamedTempFile>),
    /// A device or pipe, or standard output.
    Stream(Box<dyn Write>),
}

impl Output {
    /// Opens an output file. The file at `path`, if there is one, stays as it is until
    /// [`Output::finish`]; a device or a named pipe is written to as it is.
    ///
    /// # Errors
    /// [`Error::Io`] where the folder does not exist or cannot be written to.
    pub fn create(path: &Path) -> Result<Self, Error> {
        // tempfile names its own file in its errors; the user knows only of the output.
        let failed = |e: io::Error| Error::io(path, "create", io::Error::from(e.kind()));
        // A link is followed, so that the file it points to is replaced and not the link.
        let target = match followed(path) {
            Named::File(target) => target,
            Named::Descriptor(1) => return Ok(Output::stdout()),
            Named::Descriptor(_) => {
                let file = File::options().append(true).open(path).map_err(failed)?;
                return Ok(Output { path: path.to_path_buf(), sink: Sink::Stream(Box::new(file)) });
            }
        };
        let sink = match target.metadata() {
            Ok(metadata) if metadata.is_dir() => return Err(failed(io::ErrorKind::IsADirectory.into())),
            Ok(metadata) if !metadata.is_file() => {
                let file = File::options().write(true).open(&target).map_err(failed)?;
                Sink::Stream(Box::new(BufWriter::with_capacity(BUFFER, file)))
            }
            existing => {
                let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
                let mut builder = tempfile::Builder::new();
                #[cfg(unix)]
                {
                    use std::os::unix::fs::PermissionsExt;
                    // As any new file: the user's umask decides.
                    builder.permissions(std::fs::Permissions::from_mode(0o666));
                }
                builder.prefix(PREFIX).suffix(SUFFIX);
                // Made and noted at once, so that an interrupt finds either no file or its name.
                let mut paths = unfinished();
                let file = locked(|| builder.tempfile_in(folder)).map_err(failed)?;
                // Those of outputs that were dropped are gone.
                paths.retain(|path| path.try_exists().unwrap_or(true));
                paths.push(file.path().to_path_buf());
                drop(paths);
                if let Ok(existing) = existing {
                    // Whoever may not read what is replaced is not to read what replaces it.
                    set_mode(file.as_file(), &existing);
                }
                Sink::Temporary(BufWriter::with_capacity(BUFFER, file))
            }
        };
        Ok(Output { path: target, sink })
    }

    /// Standard output. When its reader goes away, what is written from there on is dropped, and no error: there may be
    /// other outputs.
    pub fn stdout() -> Self {
        let stream = BufWriter::with_capacity(BUFFER, Listened { to: io::stdout(), is_gone: false });
        Output { path: "standard output".into(), sink: Sink::Stream(Box::new(stream)) }
    }

    /// The file's path, for messages.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Names this output in an I/O error.
    pub fn error(&self, source: io::Error) -> Error {
        Error::io(&self.path, "write", source)
    }

    /// Asks the system for the room of so many bytes, so that a full disk is known of before they are made; writing
    /// into room that is there already also takes less time. Systems that cannot say are not asked.
    ///
    /// # Errors
    /// [`Error::Io`] where there is too little.
    pub(super) fn reserve(&self, bytes: u64) -> Result<(), Error> {
        #[cfg(target_os = "linux")]
        if let Sink::Temporary(writer) = &self.sink {
            use rustix::{fs, io::Errno};
            // The file is no longer than what is written, whatever was asked for.
            let room = fs::fallocate(writer.get_ref(), fs::FallocateFlags::KEEP_SIZE, 0, bytes);
            if let Err(error @ (Errno::NOSPC | Errno::DQUOT | Errno::FBIG)) = room {
                return Err(self.error(error.into()));
            }
        }
        Ok(())
    }

    /// Writes what is still buffered, so that [`Output::finish`] has only to put the file in its place.
    ///
    /// # Errors
    /// [`Error::Io`].
    pub fn settle(&mut self) -> Result<(), Error> {
        self.flush().map_err(|e| self.error(e))
    }

    /// Writes what is still buffered and puts the file in its place.
    ///
    /// # Errors
    /// [`Error::Io`]; the temporary file is then gone and what was at `path` before is still there.
    pub fn finish(self) -> Result<(), Error> {
        Self::finish_all(vec![self])
    }

    /// Writes what is still buffered of all outputs, then puts one after the other in its place. An
    /// interrupt comes before the first or after the last.
    ///
    /// # Errors
    /// [`Error::Io`]; nothing is in its place then, unless the system refuses a later one only.
    pub(crate) fn finish_all(outputs: Vec<Output>) -> Result<(), Error> {
        let mut written = Vec::new();
        for Output { path, sink } in outputs {
            let failed = |e| Error::io(&path, "write", e);
            match sink {
                Sink::Stream(mut stream) => stream.flush().map_err(failed)?,
                Sink::Temporary(writer) => {
                    let file = writer.into_inner().map_err(|e| failed(e.into_error()))?;
                    written.push((path, file));
                }
            }
        }
        let mut paths = unfinished();
        for (path, file) in written {
            let temporary = file.path().to_path_buf();
            file.persist(&path).map_err(|e| Error::io(&path, "write", e.error))?;
            paths.retain(|p| *p != temporary);
        }
        Ok(())
    }
}

/// A new temporary file, locked, which tells other programs that it is not abandoned. One that another program took for
/// such before it was is made again. File systems without locks are left with more than they need, not less.
fn locked(make: impl Fn() -> io::Result<NamedTempFile>) -> io::Result<NamedTempFile> {
    /// Files made before one is taken as it is.
    const TRIES: usize = 8;
    for _ in 0..TRIES {
        let file = make()?;
        let is_taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !is_taken && file.path().try_exists().unwrap_or(true) {
            return Ok(file);
        }
    }
    make()
}

/// Gives a file the permissions of what it replaces, but no more than those of reading, writing and executing.
fn set_mode(file: &File, existing: &std::fs::Metadata) {
    let mut permissions = existing.permissions();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        permissions.set_mode(permissions.mode() & 0o777);
    }
    // A system that refuses leaves the file as any new one.
    let _ = file.set_permissions(permissions);
}

/// A stream to which someone may cease to listen.
struct Listened<W> {
    to: W,
    is_gone: bool,
}

impl<W: Write> Listened<W> {
    fn unless_gone<T>(&mut self, instead: T, act: impl FnOnce(&mut W) -> io::Result<T>) -> io::Result<T> {
        if self.is_gone {
            return Ok(instead);
        }
        match act(&mut self.to) {
            Err(e) if e.kind() == io::ErrorKind::BrokenPipe => {
                self.is_gone = true;
                Ok(instead)
            }
            done => done,
        }
    }
}

impl<W: Write> Write for Listened<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.unless_gone(bytes.len(), |to| to.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.unless_gone((), Write::flush)
    }
}

const PREFIX: &str = ".osculate-";
const SUFFIX: &str = ".part";

/// Temporary files that an interrupted program would leave behind. Whoever holds the guard is alone in
/// making temporary files and in putting them in their places.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of all outputs that are not finished, for a program that is about to
/// end without unwinding, such as on a signal: whoever would make or finish an output from here on
/// waits for that end.
pub fn abandon_outputs_at_exit() {
    let mut paths = unfinished();
    for path in paths.drain(..) {
        // One that is gone already needs no removing.
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(paths);
}

/// Removes temporary files of outputs that programs left in a folder when they were killed. Those of
/// programs that are still writing stay.
pub fn remove_abandoned_outputs(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let is_ours = name.starts_with(PREFIX) && name.ends_with(SUFFIX);
        let is_file = || entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_ours || !is_file() {
            continue;
        }
        let Ok(file) = File::open(entry.path()) else { continue };
        if file.try_lock().is_ok() {
            // Under the lock: who has just made it and waits for the lock sees that it is gone.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Temporary(writer) => writer.write(bytes),
            Sink::Stream(stream) => stream.write(bytes),
        }
    }

    fn write_vectored(&mut self, slices: &[IoSlice<'_>]) -> io::Result<usize> {
        match &mut self.sink {
            // Neither the temporary file nor what buffers it would hand over more than one slice.
            Sink::Temporary(writer) if slices.iter().map(|slice| slice.len()).sum::<usize>() >= BUFFER => {
                writer.flush()?;
                writer.get_ref().as_file().write_vectored(slices)
            }
            Sink::Temporary(writer) => writer.write_vectored(slices),
            Sink::Stream(stream) => stream.write_vectored(slices),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Temporary(writer) => writer.flush(),
            Sink::Stream(stream) => stream.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_old_file_stays_until_the_new_one_is_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.csv");
        std::fs::write(&path, "old").expect("writable");
        let mut output = Output::create(&path).expect("creatable");
        output.write_all(b"new").expect("writable");
        assert_eq!(std::fs::read(&path).expect("there"), b"old");
        drop(output);
        assert_eq!(std::fs::read(&path).expect("there"), b"old");
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left behind");
        let mut output = Output::create(&path).expect("creatable");
        output.write_all(b"new").expect("writable");
        output.finish().expect("renamed");
        assert_eq!(std::fs::read(&path).expect("there"), b"new");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_also_to_what_is_not_there_yet() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        symlink("real.csv", at("link.csv")).expect("a link");
        symlink("link.csv", at("other.csv")).expect("a link");
        let mut output = Output::create(&at("other.csv")).expect("creatable");
        output.write_all(b"new").expect("writable");
        output.finish().expect("renamed");
        assert_eq!(std::fs::read(at("real.csv")).expect("there"), b"new");
        assert!(at("link.csv").is_symlink() && at("other.csv").is_symlink());
        symlink("loop.csv", at("loop.csv")).expect("a link");
        assert!(matches!(followed(&at("loop.csv")), Named::File(_)));
        // What stands for a descriptor is no file to replace.
        symlink("/proc/self/fd/1", at("stdout")).expect("a link");
        assert!(matches!(followed(&at("stdout")), Named::Descriptor(1)));
        assert!(matches!(followed(Path::new("/dev/fd/7")), Named::Descriptor(7)));
    }

    #[test]
    fn who_ceases_to_listen_is_no_error() {
        struct Gone(usize);
        impl Write for Gone {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                self.0 += 1;
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
        }
        let mut stream = Listened { to: Gone(0), is_gone: false };
        assert!(stream.write_all(b"one").is_ok() && stream.write_all(b"two").is_ok() && stream.flush().is_ok());
        assert_eq!(stream.to.0, 1);
    }

    #[test]
    fn only_files_that_nobody_writes_are_abandoned() {
        let folder = tempfile::tempdir().expect("a folder");
        let names = || std::fs::read_dir(&folder).expect("a folder").count();
        let output = Output::create(&folder.path().join("out.csv")).expect("creatable");
        for other in [".osculate-x.part", ".osculate-x", "x.part"] {
            std::fs::write(folder.path().join(other), "left").expect("writable");
        }
        remove_abandoned_outputs(folder.path());
        assert_eq!(names(), 3);
        output.finish().expect("still there");
        remove_abandoned_outputs(&folder.path().join("none"));
    }

    #[test]
    fn a_temporary_file_that_somebody_takes_away_is_made_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let made = std::cell::Cell::new(0);
        let file = locked(|| {
            let file = tempfile::Builder::new().prefix(PREFIX).suffix(SUFFIX).tempfile_in(&folder)?;
            made.set(made.get() + 1);
            if made.get() == 1 {
                remove_abandoned_outputs(folder.path());
            }
            Ok(file)
        });
        let file = file.expect("a file");
        assert!(made.get() == 2 && file.path().exists());
        remove_abandoned_outputs(folder.path());
        assert!(file.path().exists());
    }

    #[test]
    fn a_missing_folder_is_an_error() {
        assert!(Output::create(Path::new("/no/such/folder/out.glb")).is_err());
    }
}
