//! Inputs: where the bytes come from and which reader they are for.

use super::folders::Folders;
use super::{foreign, gltf, gzip, obj, off, ply, stl, text, threemf};
use crate::error::{Error, ParseError};
use crate::progress::{Progress, Stage};
use crate::soup::{Original, Soup};
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mesh file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum InputFormat {
    /// STL, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY, ASCII or binary.
    Ply,
    /// glTF 2.0, `.gltf` or `.glb`.
    Gltf,
    /// Object File Format, ASCII or binary.
    Off,
    /// 3D Manufacturing Format.
    #[serde(rename = "3mf")]
    ThreeMf,
}

impl InputFormat {
    /// The format's name for people.
    pub fn name(self) -> &'static str {
        match self {
            InputFormat::Stl => "STL",
            InputFormat::Obj => "OBJ",
            InputFormat::Ply => "PLY",
            InputFormat::Gltf => "glTF",
            InputFormat::Off => "OFF",
            InputFormat::ThreeMf => "3MF",
        }
    }

    /// True where +Z is usually up; glTF wants +Y.
    pub fn is_z_up(self) -> bool {
        matches!(self, InputFormat::Stl | InputFormat::ThreeMf)
    }

    /// The format that a file's extension stands for, also before `.gz`; its content may be another.
    pub fn of_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_ascii_lowercase();
        Some(match extension.to_str()? {
            "stl" => InputFormat::Stl,
            "obj" => InputFormat::Obj,
            "ply" => InputFormat::Ply,
            "gltf" | "glb" => InputFormat::Gltf,
            "off" => InputFormat::Off,
            "3mf" => InputFormat::ThreeMf,
            "gz" => return Self::of_extension(Path::new(path.file_stem()?)),
            _ => return None,
        })
    }

    /// Tells the format by the content first, by the extension second.
    fn of(path: &Path, bytes: &[u8]) -> Result<Self, ParseError> {
        let content = bytes.trim_ascii_start();
        match content {
            [] => return Err(ParseError::file("the file is empty")),
            // The size says it all: whatever such a file's header begins with is a comment.
            _ if stl::is_binary(bytes) => return Ok(InputFormat::Stl),
            [b'g', b'l', b'T', b'F', ..] | [b'{', ..] => return Ok(InputFormat::Gltf),
            [b'P', b'K', 3, 4, ..] => return Ok(InputFormat::ThreeMf),
            _ if ply::looks_like(content) => return Ok(InputFormat::Ply),
            _ if off::looks_like(content) => return Ok(InputFormat::Off),
            _ if stl::is_ascii(content) => return Ok(InputFormat::Stl),
            _ if obj::looks_like(content) => return Ok(InputFormat::Obj),
            _ => {}
        }
        let extension = InputFormat::of_extension(path);
        // A binary STL may begin with anything.
        let is_told = extension != Some(InputFormat::Stl) || text::is_text(content);
        if let Some(sentence) = foreign::sentence(content).filter(|_| is_told) {
            return Err(ParseError::file(sentence));
        }
        match extension {
            Some(format @ (InputFormat::Stl | InputFormat::Obj)) => Ok(format),
            Some(format) => Err(ParseError::file(format!("the content is not {}", format.name()))),
            None => Err(ParseError::file("the content is none of STL, OBJ, PLY, OFF, 3MF and glTF")),
        }
    }
}

/// How to read an input.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The format; `None`, the default, to tell it by the content.
    pub format: Option<InputFormat>,
    /// Folders besides the input's own in which files may lie that the input names, such as a
    /// glTF's buffers. Default: none.
    pub allowed_folders: Vec<PathBuf>,
}

/// True for `-`, which stands for standard input.
fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// What to call the mesh of an input: the file's name without its extensions.
pub(crate) fn mesh_name(path: &Path) -> String {
    if is_standard_input(path) {
        return String::new();
    }
    let is_gzip = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    let stem = if is_gzip { path.file_stem().map(Path::new).and_then(Path::file_stem) } else { path.file_stem() };
    stem.map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Reads a mesh file of any supported format, as [`read_with`] does by default.
///
/// # Errors
/// Those of [`read_with`].
pub fn read(path: &Path, progress: &dyn Progress) -> Result<(Soup, InputFormat), Error> {
    read_with(path, &ReadOptions::default(), progress)
}

/// Reads a mesh file of any supported format, also compressed with gzip; `-` is standard input.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read, [`Error::Parse`] when its content is not a mesh.
pub fn read_with(path: &Path, options: &ReadOptions, progress: &dyn Progress) -> Result<(Soup, InputFormat), Error> {
    let result = read_from(path, options, progress);
    progress.end();
    result
}

/// What is read from a file at a time: little enough to stay in the processor's cache.
const WINDOW: usize = 1 << 16;

fn read_from(path: &Path, options: &ReadOptions, progress: &dyn Progress) -> Result<(Soup, InputFormat), Error> {
    let failed = |e| Error::io(called(path), "read", e);
    let parse = |bytes| decode(bytes, path, options).map_err(|e| Error::parse(called(path), e));
    let mut bytes = Vec::new();
    if is_standard_input(path) {
        progress.begin(Stage::Read, 0);
        io::stdin().lock().read_to_end(&mut bytes).map_err(failed)?;
        return parse(bytes);
    }
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if metadata.is_dir() {
        return Err(Error::Usage(format!("{}: is a folder; name a mesh file in it", path.display())));
    }
    let length = metadata.len();
    progress.begin(Stage::Read, length);
    let mut stream = BufReader::with_capacity(WINDOW, File::open(path).map_err(failed)?);
    if matches!(options.format, None | Some(InputFormat::Stl)) {
        // The one format that tells by its first bytes and its length what it is and how it goes on.
        let count = stl::binary_count(stream.fill_buf().map_err(failed)?, length);
        if let Some(soup) = count.and_then(|count| stl::read_stream(&mut stream, count)) {
            let soup = soup.map_err(failed)?;
            progress.advance(length);
            return Ok((soup, InputFormat::Stl));
        }
    }
    bytes.try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX)).map_err(|e| failed(e.into()))?;
    stream.read_to_end(&mut bytes).map_err(failed)?;
    progress.advance(bytes.len() as u64);
    parse(bytes)
}

/// The name of an input in messages.
fn called(path: &Path) -> &Path {
    if is_standard_input(path) { Path::new("standard input") } else { path }
}

fn decode(bytes: Vec<u8>, path: &Path, options: &ReadOptions) -> Result<(Soup, InputFormat), ParseError> {
    let own = path.parent().filter(|_| !is_standard_input(path));
    let bytes = if gzip::is_gzip(&bytes) && !stl::is_binary(&bytes) { gzip::decompress(&bytes)? } else { bytes };
    let content = as_utf8(&bytes);
    let format = match options.format {
        Some(format) => format,
        None => InputFormat::of(path, &content)?,
    };
    let mut soup = match (format, options.format) {
        (InputFormat::Stl, None) => stl::read(&content, true)?,
        _ => read_format(&content, format, Folders::new(own, &options.allowed_folders))?,
    };
    let converted = match content {
        Cow::Owned(text) => Some(text),
        Cow::Borrowed(_) => None,
    };
    keep_original(&mut soup, format, || Original {
        path: called(path).to_path_buf(),
        folder: own.map(Path::to_path_buf),
        allowed_folders: options.allowed_folders.clone(),
        bytes: converted.unwrap_or(bytes),
    });
    Ok((soup, format))
}

/// Keeps a glTF's content, as it was read: decompressed, and text as UTF-8.
fn keep_original(soup: &mut Soup, format: InputFormat, original: impl FnOnce() -> Original) {
    if let Some(scene) = soup.scene.as_mut().filter(|_| format == InputFormat::Gltf) {
        scene.original = Some(Arc::new(original()));
    }
}

/// Reads a mesh of a known format. `folder` is where files that a glTF names may be found.
///
/// # Errors
/// Place and reason where the content is not what the format promises.
pub fn read_bytes(bytes: &[u8], format: InputFormat, folder: Option<&Path>) -> Result<Soup, ParseError> {
    let is_compressed = gzip::is_gzip(bytes) && !stl::is_binary(bytes);
    let bytes = if is_compressed { Cow::Owned(gzip::decompress(bytes)?) } else { Cow::Borrowed(bytes) };
    let content = as_utf8(&bytes);
    let mut soup = read_format(&content, format, folder.into())?;
    keep_original(&mut soup, format, || Original {
        path: "the input".into(),
        folder: folder.map(Path::to_path_buf),
        allowed_folders: Vec::new(),
        bytes: content.into_owned(),
    });
    Ok(soup)
}

fn read_format(bytes: &[u8], format: InputFormat, folders: Folders<'_>) -> Result<Soup, ParseError> {
    match format {
        InputFormat::Stl => stl::read(bytes, false),
        InputFormat::Obj => obj::read(bytes, folders),
        InputFormat::Ply => ply::read(bytes),
        InputFormat::Gltf => gltf::read(bytes, folders),
        InputFormat::Off => off::read(bytes),
        InputFormat::ThreeMf => threemf::read(bytes),
    }
}

/// Text may begin with a byte order mark, or be UTF-16; what is a binary STL by its size has a header
/// that only looks so.
fn as_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    if stl::is_binary(bytes) {
        return Cow::Borrowed(bytes);
    }
    match text::from_utf16(bytes) {
        Some(text) => Cow::Owned(text.into_bytes()),
        None => Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)),
    }
}
