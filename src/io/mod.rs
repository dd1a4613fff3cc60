//! Reading and writing files. Readers hand over what a file says; they weld and repair nothing.

mod blocks;
mod csv;
mod destination;
mod folders;
mod gltf;
mod gzip;
mod input;
mod obj;
mod off;
mod output;
mod plain;
mod ply;
mod polygons;
mod stl;
mod svg;
mod text;
mod threemf;

pub use destination::{Destination, check_outputs, real_path};
pub use gltf::{LineScene, write_lines};
pub(crate) use input::mesh_name;
pub use input::{InputFormat, ReadOptions, read, read_bytes, read_with};
pub use output::{Output, remove_unfinished_outputs};
pub use plain::write_mesh;
pub use svg::write_svg;

use crate::annotation::{Annotation, ColorCarrier};
use crate::error::Error;
use crate::progress::{Progress, Stage};
use crate::quantity::Selection;
use std::path::Path;

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
            _ => Err(Error::Usage(format!(
                "{}: the extension must be .glb, .gltf, .ply or .csv, or the format be given with --format",
                path.display()
            ))),
        }
    }

    pub(crate) fn is_gltf(self) -> bool {
        matches!(self, OutputFormat::Glb | OutputFormat::Gltf)
    }
}

/// Refuses, before any work is done, what the format cannot hold. `carrier` is `None` where there
/// are no colours.
///
/// # Errors
/// [`Error::TooLarge`] with the ways out.
pub fn check_size(
    format: OutputFormat,
    faces: usize,
    selection: &Selection,
    carrier: Option<ColorCarrier>,
) -> Result<(), Error> {
    if format == OutputFormat::Glb {
        gltf::check_glb_length(gltf::faces_byte_length(faces, &selection.for_gltf(), carrier))?;
    }
    Ok(())
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
    }
    out.finish()
}

/// Roughly how many bytes will be written, for the progress bar.
fn expected_bytes(annotation: &Annotation<'_>, format: OutputFormat) -> u64 {
    let faces = annotation.values.len();
    let carrier = annotation.colors.as_ref().map(|_| annotation.carrier);
    if format.is_gltf() {
        return gltf::faces_byte_length(faces, &annotation.gltf_quantities(), carrier);
    }
    let columns: usize = annotation.selection.for_csv().iter().map(|q| q.columns().len()).sum();
    faces as u64 * if format == OutputFormat::Csv { 11 * columns as u64 } else { 27 + 4 * columns as u64 }
}
