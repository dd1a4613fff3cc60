//! Reading and writing files. Readers hand over what a file says; they weld and repair nothing.

mod blocks;
mod corners;
mod csv;
mod destination;
mod folders;
mod foreign;
mod gltf;
mod gzip;
mod input;
mod npz;
mod obj;
mod off;
mod output;
mod plain;
mod ply;
pub(crate) mod png;
mod polygons;
mod stl;
mod svg;
mod text;
mod threemf;

pub use destination::{Destination, check_folder, check_outputs, real_path};
use destination::{Named, followed};
pub use gltf::{LineScene, write_lines};
pub(crate) use input::mesh_name;
pub use input::{InputFormat, ReadOptions, read, read_bytes, read_with};
pub use output::{Output, abandon_outputs_at_exit, remove_abandoned_outputs};
pub use plain::write_mesh;
pub use svg::write_svg;

use crate::annotation::{Annotation, ColorCarrier, Layout};
use crate::error::Error;
use crate::progress::{Progress, Stage};
use crate::quantity::Selection;
use crate::soup::{Note, Scene, Soup};
use crate::stored::StoredValues;
use std::path::Path;

/// The values of faces that a glTF file carries because Osculate wrote them; `None` where it does not.
///
/// # Errors
/// [`Error::Parse`] where they are damaged.
pub fn stored_values(soup: &Soup) -> Result<Option<StoredValues>, Error> {
    soup.scene.as_ref().map_or(Ok(None), gltf::read_values)
}

/// True where a file has all the values that [`stored_values`] needs, by their names and types.
pub(crate) fn carries_values(soup: &Soup) -> bool {
    soup.scene.as_ref().is_some_and(gltf::are_there)
}

/// A file format that annotated meshes are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
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

    /// Its usual file extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            OutputFormat::Glb => "glb",
            OutputFormat::Gltf => "gltf",
            OutputFormat::Ply => "ply",
            OutputFormat::Csv => "csv",
            OutputFormat::Npz => "npz",
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
pub(crate) fn check_size(
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
pub(crate) fn check_original(
    scene: &Scene,
    destination: &Destination,
    force: bool,
    metadata: bool,
) -> Result<Vec<Note>, Error> {
    let folder = match destination {
        Destination::File(path) => path.parent(),
        Destination::Stdout => None,
    };
    gltf::check_original(scene, folder, force, metadata)
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
    if let (OutputFormat::Gltf, Destination::File(path)) = (format, destination)
        && let Named::File(path) = followed(path)
    {
        // A link is followed here, so that buffer and palette come to lie beside the document. A
        // device or a descriptor has no beside: the document then holds everything.
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
    let faces = annotation.faces().len();
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
