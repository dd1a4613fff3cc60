//! glTF files of an annotation: one binary file, a document with files beside it, or one that holds all.
//!
//! Every choice of what is in them is one that Blender, MeshLab and web viewers were seen to take
//! (docs/decisions.md): all attributes SCALAR FLOAT, the colours in a palette texture; a mesh that does
//! not come from glTF has three vertices of its own for each face, no normals and no indices.

use super::accessor::Accessors;
use super::columns::Columns;
use super::document::{Document, build, note_of_lost_images, prepare};
use super::draft::{Packed, Piece};
use super::layout::check_glb_length;
use super::opened::Opened;
use crate::annotation::Annotation;
use crate::error::Error;
use crate::io::output::Output;
use crate::progress::Progress;
use crate::soup::{Note, Scene};
use base64::Engine;
use serde_json::Value;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A buffer of a `.gltf` ends before this many bytes: browsers hold no more in one piece.
const LARGEST_BUFFER: u64 = 1 << 31;

/// Looks at an original before any work is done: what stands in the way of carrying it over is an
/// error, what is to be said of it a note. The output will lie in `folder`, unless it is a stream.
///
/// # Errors
/// [`Error::Parse`] with the place.
pub(in crate::io) fn check_original(
    scene: &Scene,
    folder: Option<&Path>,
    force: bool,
    metadata: bool,
) -> Result<Vec<Note>, Error> {
    let mut notes = Vec::new();
    if let Some(opened) = Opened::new(scene)? {
        let accessors = opened.accessors();
        let (draft, ..) = prepare(&opened, &accessors, opened.primitives, force, &mut notes)?;
        if !folder.is_some_and(|folder| opened.is_in(folder)) {
            notes.extend(note_of_lost_images(&draft, &opened));
        }
        if metadata {
            super::metadata::check(&draft.root).map_err(|e| opened.error(e))?;
        }
        for buffer in 0..opened.document.buffers.len() {
            accessors.buffers().whole(buffer).map_err(|e| opened.error(e))?;
        }
        for view in 0..opened.document.buffer_views.len() {
            accessors.buffers().unpacked(view).map_err(|e| opened.error(e))?;
        }
    }
    Ok(notes)
}

/// Calls `write` with the original of an annotation, where it has one.
fn with_original<T>(
    annotation: &Annotation<'_>,
    write: impl FnOnce(Option<(&Opened<'_>, &Accessors<'_>)>) -> Result<T, Error>,
) -> Result<T, Error> {
    match annotation.mesh.scene().map(Opened::new).transpose()?.flatten() {
        Some(opened) => {
            let accessors = opened.accessors();
            write(Some((&opened, &accessors)))
        }
        None => write(None),
    }
}

fn pack<'a>(
    annotation: &Annotation<'_>,
    mut document: Document<'a>,
    original: Option<(&'a Opened<'_>, &'a Accessors<'_>)>,
    limit: u64,
) -> Result<Packed<'a>, Error> {
    if annotation.compress {
        document.draft.compress(annotation).map_err(|e| Error::io(Path::new("memory"), "write", e))?;
    }
    let packed = document.draft.pack(original.map(|(_, accessors)| accessors.buffers()), limit);
    packed.map_err(|e| match original {
        Some((opened, _)) => opened.error(e),
        None => Error::parse(Path::new("the input"), e),
    })
}

/// Writes a binary glTF file.
///
/// # Errors
/// [`Error::Io`]; [`Error::TooLarge`] past 4 GiB, the most that a GLB can hold; [`Error::Parse`] where an
/// original cannot be carried over.
pub(in crate::io) fn write_glb(
    annotation: &Annotation<'_>,
    out: &mut Output,
    progress: &dyn Progress,
) -> Result<(), Error> {
    with_original(annotation, |original| {
        let packed = pack(annotation, build(annotation, original, false, &|_| None)?, original, u64::MAX)?;
        let length = packed.byte_length(0);
        write_chunks(to_json(&packed.root), length, out, |out| packed.write(0, annotation, out, progress))
    })
}

/// Writes the header, the document and the binary chunk of a GLB.
///
/// # Errors
/// [`Error::Io`]; [`Error::TooLarge`] past 4 GiB.
pub(super) fn write_chunks(
    mut json: Vec<u8>,
    length: u64,
    out: &mut Output,
    body: impl FnOnce(&mut Output) -> io::Result<()>,
) -> Result<(), Error> {
    json.resize(json.len().next_multiple_of(4), b' ');
    let padded = length.next_multiple_of(4);
    // A binary chunk without bytes is left out.
    let chunk = if length > 0 { 8 + padded } else { 0 };
    let total = 12 + 8 + json.len() as u64 + chunk;
    check_glb_length(total)?;
    out.reserve(total)?;
    let write = |out: &mut Output| -> io::Result<()> {
        for word in [0x4654_6c67, 2, total as u32, json.len() as u32, 0x4e4f_534a] {
            out.write_all(&u32::to_le_bytes(word))?;
        }
        out.write_all(&json)?;
        if length == 0 {
            return Ok(());
        }
        for word in [padded as u32, 0x004e_4942] {
            out.write_all(&u32::to_le_bytes(word))?;
        }
        body(out)?;
        out.write_all(&[0; 3][..(padded - length) as usize])
    };
    write(out).map_err(|e| out.error(e))
}

/// The files that a `.gltf` of so many faces and colour scales may consist of.
pub(in crate::io) fn most_files(path: &Path, faces: usize, scales: usize) -> Vec<PathBuf> {
    // No face takes more than 400 bytes: 17 values and colours in three corners. What an original has
    // besides would have to be huge to fill one buffer more.
    files_of(path, 2 + (400 * faces as u64 / LARGEST_BUFFER) as usize, scales)
}

/// A `.gltf` with so many buffers and palettes.
pub(in crate::io) fn files_of(path: &Path, buffers: usize, scales: usize) -> Vec<PathBuf> {
    let beside = (0..buffers).map(External::Buffer).chain((0..scales).map(External::Image));
    std::iter::once(path.to_path_buf()).chain(beside.map(|file| path.with_file_name(file.name(path)))).collect()
}

/// Writes a `.gltf` file, its buffer `name.bin` and its palette `name.png` beside it.
///
/// # Errors
/// [`Error::Io`]; [`Error::Parse`] where an original cannot be carried over. All files are complete before
/// the first is put in its place; the `.gltf` itself comes last, so that it never names a file that is
/// not there.
pub(in crate::io) fn write_gltf(
    annotation: &Annotation<'_>,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), Error> {
    with_original(annotation, |original| {
        let folder = path.parent().unwrap_or(Path::new("."));
        let keep = original.is_some_and(|(opened, _)| opened.is_in(folder));
        // Palettes are files of their own: MeshLab can then save them again.
        let uri = |file: External| percent_encode(&file.name(path));
        let document = build(annotation, original, keep, &|image| Some(uri(External::Image(image))))?;
        let mut finished = Vec::new();
        for n in 0..document.looks.image_count() {
            let mut file = Output::create(&path.with_file_name(External::Image(n).name(path)))?;
            file.write_all(&document.looks.png(n)).map_err(|e| file.error(e))?;
            finished.push(file);
        }
        let mut packed = pack(annotation, document, original, LARGEST_BUFFER)?;
        for n in 0..packed.buffers.len() {
            let mut buffer = Output::create(&path.with_file_name(External::Buffer(n).name(path)))?;
            buffer.reserve(packed.byte_length(n))?;
            packed.write(n, annotation, &mut buffer, progress).map_err(|e| buffer.error(e))?;
            packed.name_buffer(n, uri(External::Buffer(n)));
            finished.push(buffer);
        }
        let mut document = Output::create(path)?;
        document.write_all(&to_json(&packed.root)).map_err(|e| document.error(e))?;
        finished.push(document);
        Output::finish_all(finished)
    })
}

/// Writes a `.gltf` document that holds its buffer and images as data URIs, for a stream.
///
/// # Errors
/// [`Error::Io`]; [`Error::Parse`] where an original cannot be carried over.
pub(in crate::io) fn write_embedded(
    annotation: &Annotation<'_>,
    out: &mut Output,
    progress: &dyn Progress,
) -> Result<(), Error> {
    with_original(annotation, |original| {
        let mut packed = pack(annotation, build(annotation, original, false, &|_| None)?, original, u64::MAX)?;
        for n in 0..packed.buffers.len() {
            let mut buffer = Vec::new();
            packed.write(n, annotation, &mut buffer, progress).map_err(|e| out.error(e))?;
            let content = base64::engine::general_purpose::STANDARD.encode(&buffer);
            packed.name_buffer(n, format!("data:application/octet-stream;base64,{content}"));
        }
        out.write_all(&to_json(&packed.root)).map_err(|e| out.error(e))
    })
}

impl Packed<'_> {
    /// Bytes of a buffer, padding between its pieces included.
    fn byte_length(&self, buffer: usize) -> u64 {
        let length = self.root.get("buffers").and_then(|buffers| buffers.get(buffer)?.get("byteLength")?.as_u64());
        length.filter(|_| buffer < self.buffers.len()).unwrap_or(0)
    }

    fn write(
        &self,
        buffer: usize,
        annotation: &Annotation<'_>,
        out: &mut dyn Write,
        progress: &dyn Progress,
    ) -> io::Result<()> {
        let Some(pieces) = self.buffers.get(buffer) else { return Ok(()) };
        let mut written: u64 = 0;
        let mut columns = Columns::default();
        for (at, piece) in pieces.clone().zip(&self.pieces[pieces.clone()]) {
            let gap = written.next_multiple_of(super::draft::ALIGNMENT) - written;
            out.write_all(&[0; super::draft::ALIGNMENT as usize][..gap as usize])?;
            match piece {
                Piece::Given(bytes) => out.write_all(bytes)?,
                Piece::Bytes(bytes) => out.write_all(bytes)?,
                Piece::Stream(stream) => columns
                    .write(&self.pieces[at..pieces.end], annotation, out, progress)
                    .unwrap_or_else(|| stream.write(annotation, out, progress))?,
            }
            written += gap + piece.len();
        }
        Ok(())
    }

    fn name_buffer(&mut self, buffer: usize, uri: String) {
        let buffers = self.root.get_mut("buffers");
        if let Some(buffer) = buffers.and_then(|buffers| buffers.get_mut(buffer)?.as_object_mut()) {
            buffer.insert("uri".into(), uri.into());
        }
    }
}

/// A document as text. Every part of it is a number, a string or a list of them: nothing can fail.
fn to_json(root: &serde_json::Map<String, Value>) -> Vec<u8> {
    serde_json::to_vec(root).unwrap_or_default()
}

/// A file name as a relative URI.
fn percent_encode(name: &str) -> String {
    const UNRESERVED: percent_encoding::AsciiSet =
        percent_encoding::NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');
    percent_encoding::utf8_percent_encode(name, &UNRESERVED).to_string()
}

/// What a document may name outside itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum External {
    /// A buffer, by number.
    Buffer(usize),
    /// A palette image, by number.
    Image(usize),
}

impl External {
    /// Its file name beside a `.gltf`.
    fn name(self, path: &Path) -> String {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
        match self {
            External::Buffer(0) => format!("{stem}.bin"),
            External::Buffer(n) => format!("{stem}-{n}.bin"),
            External::Image(0) => format!("{stem}.png"),
            External::Image(n) => format!("{stem}-{n}.png"),
        }
    }
}
