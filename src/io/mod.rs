//! Reading and writing files. Readers hand over what a file says; they weld and repair nothing.

mod blocks;
mod csv;
mod destination;
mod gltf;
mod npz;
mod obj;
mod output;
mod plain;
mod ply;
pub(crate) mod png;
mod stl;
mod svg;
mod text;

pub use destination::{Destination, check_outputs, real_path};
pub use gltf::{LineScene, write_lines};
pub use output::{Output, remove_unfinished_outputs};
pub use plain::write_mesh;
pub use svg::write_svg;

use crate::annotation::{Annotation, ColorCarrier, Layout};
use crate::error::{Error, ParseError};
use crate::progress::{Progress, Stage};
use crate::quantity::Selection;
use crate::soup::{Note, Original, Scene, Soup};
use crate::stored::StoredValues;
use std::path::Path;
use std::sync::Arc;

/// A mesh file format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InputFormat {
    /// STL, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY, ASCII or binary.
    Ply,
    /// glTF 2.0, `.gltf` or `.glb`.
    Gltf,
}

impl InputFormat {
    /// The format's name for people.
    pub fn name(self) -> &'static str {
        match self {
            InputFormat::Stl => "STL",
            InputFormat::Obj => "OBJ",
            InputFormat::Ply => "PLY",
            InputFormat::Gltf => "glTF",
        }
    }

    /// True where +Z is usually up; glTF wants +Y.
    pub fn is_z_up(self) -> bool {
        self == InputFormat::Stl
    }

    fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_ascii_lowercase();
        Some(match extension.to_str()? {
            "stl" => InputFormat::Stl,
            "obj" => InputFormat::Obj,
            "ply" => InputFormat::Ply,
            "gltf" | "glb" => InputFormat::Gltf,
            _ => return None,
        })
    }

    /// Tells the format by the content first, by the extension second.
    fn of(path: &Path, bytes: &[u8]) -> Result<Self, ParseError> {
        let content = bytes.trim_ascii_start();
        match content {
            [] => return Err(ParseError::file("the file is empty")),
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] if !stl::is_binary(bytes) => {
                return Err(ParseError::file("the file is UTF-16 text; convert it to UTF-8 first"));
            }
            // The size says it all: whatever such a file's header begins with is a comment.
            _ if stl::is_binary(bytes) => return Ok(InputFormat::Stl),
            [b'g', b'l', b'T', b'F', ..] | [b'{', ..] => return Ok(InputFormat::Gltf),
            [0x1f, 0x8b, ..] => return Err(ParseError::file("the file is compressed with gzip; decompress it first")),
            [b'P', b'K', 3, 4, ..] => {
                return Err(ParseError::file("the file is a ZIP archive (3MF?); export it as STL, OBJ, PLY or glTF"));
            }
            _ if ply::looks_like(content) => return Ok(InputFormat::Ply),
            _ if stl::is_ascii(content) => return Ok(InputFormat::Stl),
            _ if obj::looks_like(content) => return Ok(InputFormat::Obj),
            _ => {}
        }
        match InputFormat::from_extension(path) {
            Some(format @ (InputFormat::Stl | InputFormat::Obj)) => Ok(format),
            Some(format) => Err(ParseError::file(format!("the content is not {}", format.name()))),
            None => Err(ParseError::file("the content is none of STL, OBJ, PLY and glTF")),
        }
    }
}

/// Reads a mesh file of any supported format.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read, [`Error::Parse`] when its content is not a mesh.
pub fn read(path: &Path, progress: &dyn Progress) -> Result<(Soup, InputFormat), Error> {
    let metadata = std::fs::metadata(path).map_err(|e| Error::io(path, "read", e))?;
    if metadata.is_dir() {
        return Err(Error::Usage(format!("{}: is a folder; name a mesh file in it", path.display())));
    }
    progress.begin(Stage::Read, metadata.len());
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, "read", e))?;
    let folder = path.parent().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p });
    let content = without_byte_order_mark(&bytes);
    let result = InputFormat::of(path, content).and_then(|format| Ok((parse(content, format, folder)?, format)));
    progress.advance(bytes.len() as u64);
    progress.end();
    let (mut soup, format) = result.map_err(|e| Error::parse(path, e))?;
    if let Some(scene) = &mut soup.scene {
        let original = Original { path: path.to_path_buf(), folder: folder.map(Path::to_path_buf), bytes };
        scene.original = Some(Arc::new(original));
    }
    Ok((soup, format))
}

/// Reads a mesh of a known format. `folder` is where files that a glTF names may be found.
///
/// # Errors
/// Place and reason where the content is not what the format promises.
pub fn read_bytes(bytes: &[u8], format: InputFormat, folder: Option<&Path>) -> Result<Soup, ParseError> {
    let mut soup = parse(without_byte_order_mark(bytes), format, folder)?;
    if let Some(scene) = &mut soup.scene {
        let original =
            Original { path: "the input".into(), folder: folder.map(Path::to_path_buf), bytes: bytes.to_vec() };
        scene.original = Some(Arc::new(original));
    }
    Ok(soup)
}

fn parse(bytes: &[u8], format: InputFormat, folder: Option<&Path>) -> Result<Soup, ParseError> {
    match format {
        InputFormat::Stl => stl::read(bytes),
        InputFormat::Obj => obj::read(bytes),
        InputFormat::Ply => ply::read(bytes),
        InputFormat::Gltf => gltf::read(bytes, folder),
    }
}

/// Text may begin with a byte order mark; what is a binary STL by its size has a header that does.
fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    match bytes.strip_prefix(b"\xef\xbb\xbf") {
        Some(text) if !stl::is_binary(bytes) => text,
        _ => bytes,
    }
}

/// The values of faces that a glTF file carries because Osculate wrote them; `None` where it does not.
///
/// # Errors
/// [`Error::Parse`] where they are damaged.
pub fn stored_values(soup: &Soup) -> Result<Option<StoredValues>, Error> {
    soup.scene.as_ref().map_or(Ok(None), gltf::read_values)
}

/// A file format that annotated meshes are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OutputFormat {
    /// Binary glTF, one file.
    Glb,
    /// glTF as a document, with its buffer and palette in files beside it.
    Gltf,
    /// PLY with face properties, for MeshLab.
    Ply,
    /// One row of numbers per face.
    Csv,
    /// NumPy arrays.
    Npz,
}

impl OutputFormat {
    /// The format of an output file, by its extension.
    ///
    /// # Errors
    /// [`Error::Usage`] that lists the extensions there are.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        match extension.as_ref().and_then(|e| e.to_str()) {
            Some("glb") => Ok(OutputFormat::Glb),
            Some("gltf") => Ok(OutputFormat::Gltf),
            Some("ply") => Ok(OutputFormat::Ply),
            Some("csv") => Ok(OutputFormat::Csv),
            Some("npz") => Ok(OutputFormat::Npz),
            _ => Err(Error::Usage(format!(
                "{}: the extension must be .glb, .gltf, .ply, .csv or .npz, or the format be given with --format",
                path.display()
            ))),
        }
    }

    pub(crate) fn is_gltf(self) -> bool {
        matches!(self, OutputFormat::Glb | OutputFormat::Gltf)
    }
}

/// Refuses, before any work is done, what the format cannot hold. `color_bytes` is what colours take
/// in each vertex: 8 for a palette texture, 4 for vertex colours.
///
/// # Errors
/// [`Error::TooLarge`] with the ways out.
pub fn check_size(
    format: OutputFormat,
    layout: Layout,
    faces: usize,
    selection: &Selection,
    color_bytes: u64,
) -> Result<(), Error> {
    if format == OutputFormat::Glb {
        gltf::check_glb_length(gltf::expected_bytes(layout, faces, &selection.for_gltf(), color_bytes))?;
    }
    Ok(())
}

/// Refuses, before any work is done, a glTF input that cannot be carried over to a glTF output, and
/// says what of it will stay as it is.
///
/// # Errors
/// [`Error::Parse`] with the place.
pub(crate) fn check_original(scene: &Scene, force: bool) -> Result<Vec<Note>, Error> {
    gltf::check_original(scene, force)
}

/// Writes an annotated mesh.
///
/// # Errors
/// [`Error::Io`] when the system refuses; [`Error::TooLarge`] when the format cannot hold it. The
/// output is then as it was before.
pub fn write(
    annotation: &Annotation<'_>,
    format: OutputFormat,
    destination: &Destination,
    progress: &dyn Progress,
) -> Result<(), Error> {
    progress.begin(Stage::Write, expected_bytes(annotation, format));
    let result = write_to(annotation, format, destination, progress);
    progress.end();
    result
}

fn write_to(
    annotation: &Annotation<'_>,
    format: OutputFormat,
    destination: &Destination,
    progress: &dyn Progress,
) -> Result<(), Error> {
    if let (OutputFormat::Gltf, Destination::File(path)) = (format, destination) {
        // A link is followed here, so that buffer and palette come to lie beside the document. A
        // device has no beside: the document then holds everything.
        let path = real_path(path);
        if !path.exists() || path.is_file() {
            return gltf::write_gltf(annotation, &path, progress);
        }
    }
    let mut out = match destination {
        Destination::File(path) => Output::create(path)?,
        Destination::Stdout => Output::stdout(),
    };
    match format {
        OutputFormat::Glb => gltf::write_glb(annotation, &mut out, progress)?,
        OutputFormat::Gltf => gltf::write_embedded(annotation, &mut out, progress)?,
        OutputFormat::Ply => ply::write(annotation, &mut out, progress).map_err(|e| out.error(e))?,
        OutputFormat::Csv => csv::write(annotation, &mut out, progress).map_err(|e| out.error(e))?,
        OutputFormat::Npz => npz::write(annotation, &mut out, progress).map_err(|e| out.error(e))?,
    }
    out.finish()
}

/// Roughly how many bytes will be written, for the progress bar.
fn expected_bytes(annotation: &Annotation<'_>, format: OutputFormat) -> u64 {
    let faces = annotation.values.len();
    if format.is_gltf() {
        let color_bytes = match annotation.carrier {
            ColorCarrier::Texture => 8 * annotation.colors.len() as u64,
            _ => 4,
        };
        return gltf::expected_bytes(annotation.layout, faces, &annotation.gltf_quantities(), color_bytes);
    }
    let columns: usize = annotation.selection.for_csv().iter().map(|q| q.columns().len()).sum();
    faces as u64 * if format == OutputFormat::Csv { 11 * columns as u64 } else { 27 + 4 * columns as u64 }
}
