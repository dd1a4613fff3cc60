//! glTF 2.0 in layout `faces`: three own vertices per face, so that each can carry its face's values.
//!
//! Every choice here is one that Blender, MeshLab and web viewers were seen to take (docs/decisions.md):
//! all attributes SCALAR FLOAT, no normals, no indices, the colours in a palette texture.

use super::layout::{Layout, Stream, check_glb_length};
use crate::annotation::{Annotation, ColorCarrier};
use crate::color::{PALETTE, Rgb, linear};
use crate::error::Error;
use crate::io::blocks::in_blocks;
use crate::io::output::Output;
use crate::mesh::Face;
use crate::progress::Progress;
use base64::Engine;
use glam::DVec3;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Rows of the palette image: clients that are off by a row still hit the right colour.
const PALETTE_ROWS: usize = 4;

/// A buffer of a `.gltf` ends before this many bytes: browsers hold no more in one piece.
const LARGEST_BUFFER: u64 = 1 << 31;

/// Writes a binary glTF file.
///
/// # Errors
/// [`Error::Io`]; [`Error::TooLarge`] past 4 GiB, the most that a GLB can hold.
pub(in crate::io) fn write_glb(
    annotation: &Annotation<'_>,
    out: &mut Output,
    progress: &dyn Progress,
) -> Result<(), Error> {
    let image = palette_png(annotation);
    let layout = Layout::new(annotation, image.as_deref(), u64::MAX);
    let json = layout.document(annotation, &|_| None);
    write_chunks(json, layout.byte_length(), out, |out| {
        layout
            .buffers()
            .flatten()
            .try_for_each(|stream| write_stream(annotation, stream, image.as_deref(), out, progress))
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

/// The files that a `.gltf` of so many faces consists of, and perhaps a buffer more.
pub(in crate::io) fn files_beside(path: &Path, faces: usize) -> Vec<PathBuf> {
    // No face takes more than 400 bytes: 17 values and colours in three corners.
    let buffers = 1 + (400 * faces as u64 / LARGEST_BUFFER) as usize;
    let beside = (0..buffers).map(External::Buffer).chain([External::Image]);
    std::iter::once(path.to_path_buf()).chain(beside.map(|file| path.with_file_name(file.name(path)))).collect()
}

/// Writes a `.gltf` file, its buffer `name.bin` and its palette `name.png` beside it.
///
/// # Errors
/// [`Error::Io`]. All files are complete before the first is put in its place; the `.gltf` itself comes
/// last, so that it never names a file that is not there.
pub(in crate::io) fn write_gltf(
    annotation: &Annotation<'_>,
    path: &Path,
    progress: &dyn Progress,
) -> Result<(), Error> {
    let image = palette_png(annotation);
    // The image is a file of its own: MeshLab can then save it again.
    let layout = Layout::new(annotation, None, LARGEST_BUFFER);
    let mut finished = Vec::new();
    for (n, streams) in layout.buffers().enumerate() {
        let mut buffer = Output::create(&path.with_file_name(External::Buffer(n).name(path)))?;
        for stream in streams {
            write_stream(annotation, stream, None, &mut buffer, progress).map_err(|e| buffer.error(e))?;
        }
        finished.push(buffer);
    }
    if let Some(image) = &image {
        let mut file = Output::create(&path.with_file_name(External::Image.name(path)))?;
        file.write_all(image).map_err(|e| file.error(e))?;
        finished.push(file);
    }
    let json = layout.document(annotation, &|file| Some(percent_encode(&file.name(path))));
    let mut document = Output::create(path)?;
    document.write_all(&json).map_err(|e| document.error(e))?;
    finished.push(document);
    finished.into_iter().try_for_each(Output::finish)
}

/// Writes a `.gltf` document that holds its buffer and image as data URIs, for a stream.
///
/// # Errors
/// [`Error::Io`].
pub(in crate::io) fn write_embedded(
    annotation: &Annotation<'_>,
    out: &mut Output,
    progress: &dyn Progress,
) -> Result<(), Error> {
    let image = palette_png(annotation);
    let layout = Layout::new(annotation, None, u64::MAX);
    let mut buffer = Vec::new();
    for stream in layout.buffers().flatten() {
        write_stream(annotation, stream, None, &mut buffer, progress).map_err(|e| out.error(e))?;
    }
    let data = |kind: &str, bytes: &[u8]| {
        format!("data:{kind};base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
    };
    let json = layout.document(annotation, &|file| match file {
        External::Buffer(_) => Some(data("application/octet-stream", &buffer)),
        External::Image => image.as_ref().map(|image| data("image/png", image)),
    });
    out.write_all(&json).map_err(|e| out.error(e))
}

/// A file name as a relative URI.
fn percent_encode(name: &str) -> String {
    const UNRESERVED: percent_encoding::AsciiSet =
        percent_encoding::NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');
    percent_encoding::utf8_percent_encode(name, &UNRESERVED).to_string()
}

/// What a document may name outside itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum External {
    /// A buffer, by number.
    Buffer(usize),
    /// The palette image.
    Image,
}

impl External {
    /// Its file name beside a `.gltf`.
    fn name(self, path: &Path) -> String {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
        match self {
            External::Buffer(0) => format!("{stem}.bin"),
            External::Buffer(n) => format!("{stem}-{n}.bin"),
            External::Image => format!("{stem}.png"),
        }
    }
}

/// A corner in the output's space, as stored. `remainder` is what the node's translation leaves over.
pub(super) fn corner(annotation: &Annotation<'_>, remainder: DVec3, p: DVec3) -> [f32; 3] {
    let clamp = |c: f64| c.clamp(f32::MIN.into(), f32::MAX.into()) as f32;
    (annotation.space.point(p) + remainder).to_array().map(clamp)
}

/// Writes what one buffer view holds.
fn write_stream(
    annotation: &Annotation<'_>,
    stream: &Stream,
    image: Option<&[u8]>,
    out: &mut dyn Write,
    progress: &dyn Progress,
) -> io::Result<()> {
    let first = stream.faces().start;
    let per_face = |out: &mut dyn Write, format: &(dyn Fn(Face, &mut Vec<u8>) + Sync)| {
        in_blocks(stream.faces().len(), out, progress, |faces, bytes| {
            for f in faces {
                format(Face(first + f), bytes);
            }
        })
    };
    match stream {
        Stream::Position { .. } => {
            let remainder = annotation.translation_remainder();
            per_face(out, &|face, bytes| {
                for p in annotation.finite_triangle(face) {
                    for c in corner(annotation, remainder, p) {
                        bytes.extend(c.to_le_bytes());
                    }
                }
            })
        }
        Stream::Value { quantity, component, .. } => {
            let factor = annotation.space.factor(quantity.dimension());
            per_face(out, &|face, bytes| {
                let value = &annotation.values[face.index()];
                let stored = match annotation.turned(*quantity, value) {
                    Some(direction) => direction[*component],
                    None => quantity.stored(face, value, *component, factor),
                };
                let stored = stored.to_le_bytes();
                bytes.extend([stored; 3].as_flattened());
            })
        }
        Stream::PaletteCoordinate { .. } => {
            let Some(colors) = &annotation.colors else { return Ok(()) };
            per_face(out, &|face, bytes| {
                let index = colors.color_index(&annotation.values[face.index()]);
                // The middle of a texel: right for any filter and however a client rounds.
                let u = (index as f32 + 0.5) / PALETTE as f32;
                for c in [u, 0.5].repeat(3) {
                    bytes.extend(c.to_le_bytes());
                }
            })
        }
        Stream::VertexColor { .. } => {
            let Some(colors) = &annotation.colors else { return Ok(()) };
            let mut palette = colors.map.palette();
            if annotation.carrier == ColorCarrier::Vertex {
                palette = palette.map(|rgb: Rgb| rgb.map(linear));
            }
            per_face(out, &|face, bytes| {
                let [r, g, b] = palette[colors.color_index(&annotation.values[face.index()])];
                bytes.extend([[r, g, b, 255]; 3].as_flattened());
            })
        }
        Stream::Image { .. } => out.write_all(image.unwrap_or_default()),
    }
}

/// The palette as an sRGB PNG of several equal rows, where the annotation has a texture.
fn palette_png(annotation: &Annotation<'_>) -> Option<Vec<u8>> {
    let colors = annotation.colors.as_ref().filter(|_| annotation.carrier == ColorCarrier::Texture)?;
    let row = colors.map.palette();
    let pixels = [row; PALETTE_ROWS];
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, PALETTE as u32, PALETTE_ROWS as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let encoded = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels.as_flattened().as_flattened())?;
        writer.finish()
    });
    // Writing to memory with fixed dimensions has nothing that could fail.
    encoded.is_ok().then_some(bytes)
}
