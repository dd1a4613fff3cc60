//! The main job as a list of verbs: read, weld, estimate, colour, write.

use crate::annotated::{Annotated, Besides, Outputs};
use crate::curvature;
use crate::error::Error;
use crate::io::{self, Destination, OutputFormat};
use crate::mesh::Mesh;
use crate::options::{AnnotateOptions, keep_settings};
use crate::progress::Progress;
use crate::soup::Note;
use crate::space::Unit;
use crate::statistics::{CurvatureSummary, Seconds, Summary};
use std::path::Path;
use std::time::Instant;

/// Annotates one file; `-` is standard input.
///
/// # Errors
/// Any [`Error`]; nothing is then written, and what stood at the destination is still there. (Where the system refuses
/// only to put the legend or the edges in their place, the main output is in its own already.)
pub fn annotate(
    input: &Path,
    destination: &Destination,
    format: OutputFormat,
    options: &AnnotateOptions,
    progress: &dyn Progress,
) -> Result<Summary, Error> {
    let outputs = Outputs { destination, format, options: &options.with_perimeter_if_wanted() };
    outputs.check()?;
    let options = outputs.options;
    let start = Instant::now();
    let (mut soup, input_format) = io::read_with(input, &options.read, progress)?;
    outputs.check_for(input, &soup.files, soup.face_count(), input_format)?;
    let stored = if options.reuse { io::stored_values(&soup)? } else { None };
    if options.reuse && stored.is_none() {
        let what = "has no values of Osculate's to use again; leave --reuse out";
        return Err(Error::Usage(format!("{}: {what}", input.display())));
    }
    if !options.reuse && io::carries_values(&soup) {
        soup.notes.push(Note::info("the input carries values of an earlier run; --reuse takes those"));
    }
    if format.is_gltf() {
        let notes = outputs.check_original(soup.scene.as_ref())?;
        soup.notes.extend(notes);
        let unit = Unit::of_file(&soup, input_format).filter(|_| options.unit.is_none());
        soup.notes.extend(unit.map(|unit| Note::info(unit.hint())));
    } else if let Some(scene) = &mut soup.scene {
        scene.original = None;
    }
    // Opened before any work, put in its place after the main output.
    let besides = Besides::open(options)?;
    let notes = soup.notes.clone();
    let files = std::mem::take(&mut soup.files);
    let read = start.elapsed();

    let mut mesh = Mesh::from_owned_soup(soup, &options.mesh).map_err(|e| e.in_file(input))?;
    let weld = start.elapsed();

    let mut provenance = options.provenance();
    let values = match stored {
        Some(stored) => {
            keep_settings(&mut provenance, &stored.settings);
            provenance["reused"] = true.into();
            stored.curvature(&mesh).map_err(|e| Error::Usage(format!("{}: {e}", input.display())))?
        }
        None => {
            let values;
            let estimated = curvature::estimate_owned(mesh, &options.curvature, progress);
            (mesh, values) = estimated.map_err(|e| e.in_file(input))?;
            values
        }
    };
    let estimate = start.elapsed();

    let annotated =
        Annotated { mesh: &mesh, values: &values, source: input, files: &files, format: Some(input_format) };
    let mut written = annotated.write_with(outputs, besides, provenance, progress)?;
    written.notes.splice(0..0, notes);
    let write = start.elapsed();

    Ok(Summary {
        schema: 1,
        version: env!("CARGO_PKG_VERSION"),
        input: input.display().to_string(),
        format: input_format,
        report: mesh.report().clone(),
        written,
        curvature: options.summarise.then(|| CurvatureSummary::of(&values)),
        seconds: Seconds::from_marks(read, weld, estimate, write),
    })
}
