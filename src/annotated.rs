//! A mesh whose values are known, on its way into files: the second half of annotating.

use crate::annotation::{Annotation, ColorCarrier};
use crate::color::ColorScale;
use crate::condition::Condition;
use crate::curvature::FaceCurvature;
use crate::edge_lines::edge_layers;
use crate::error::Error;
use crate::io::{self, Destination, InputFormat, LineScene, Output, OutputFormat};
use crate::legend;
use crate::mesh::{Face, Mesh};
use crate::options::{AnnotateOptions, keep_settings};
use crate::progress::Progress;
use crate::quantity::Quantity;
use crate::soup::{Note, Scene};
use crate::space::Space;
use crate::value_notes::{note_of_lone_faces, note_of_lost_values, note_of_weak_values};
use crate::vertex_values::VertexValues;
use rayon::prelude::*;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A mesh and its values, wherever they come from.
#[derive(Clone, Copy, Debug)]
pub struct Annotated<'m> {
    /// The mesh.
    pub mesh: &'m Mesh,
    /// One value per face.
    pub values: &'m [FaceCurvature],
    /// The file that the mesh is from, which no output may replace. Its name is that of the object in the output.
    pub source: &'m Path,
    /// Files that this one names; they may not be replaced either.
    pub files: &'m [PathBuf],
    /// The file's format, which tells what axis is up; `None` for a mesh from elsewhere, taken as Y-up.
    pub format: Option<InputFormat>,
}

/// What there is to say of what was written.
#[derive(Clone, Debug, serde::Serialize)]
#[non_exhaustive]
pub struct Written {
    /// How many faces were written, where a condition chose them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub selected_faces: Option<usize>,
    /// What is worth knowing.
    pub notes: Vec<Note>,
    /// All settings.
    pub settings: Value,
    /// Colour scale, if any, in the units of the output.
    pub legend: Option<Value>,
    /// Units of the mesh and of the output.
    pub units: Value,
}

impl Annotated<'_> {
    /// Writes the mesh with its values as [`annotate`](crate::annotate()) does. Of the options, those of reading, of
    /// the mesh and of estimation are not used: `settings` are what the values were estimated with, as
    /// [`AnnotateOptions::settings_of_estimation`] has them.
    ///
    /// # Errors
    /// [`Error::Usage`] where there is not one value for each face, or the perimeter estimate is asked for and the
    /// values lack it, and the errors of [`annotate`](crate::annotate()). Nothing is then written, and what stood at
    /// the destination is still there.
    pub fn write(
        &self,
        settings: &Value,
        destination: &Destination,
        format: OutputFormat,
        options: &AnnotateOptions,
        progress: &dyn Progress,
    ) -> Result<Written, Error> {
        let (faces, values) = (self.mesh.face_count(), self.values.len());
        if faces != values {
            return Err(Error::Usage(format!("the curvature is of {values} faces, but the mesh has {faces}")));
        }
        let outputs = Outputs { destination, format, options: &self.without_what_is_missing(options)? };
        outputs.check()?;
        outputs.check_for(self.source, self.files, faces, self.format())?;
        let notes = if format.is_gltf() { outputs.check_original(self.mesh.scene())? } else { Vec::new() };
        let besides = Besides::open(options)?;
        let mut provenance = options.provenance();
        keep_settings(&mut provenance, settings);
        let mut written = self.write_with(outputs, besides, provenance, progress)?;
        written.notes.splice(0..0, notes);
        Ok(written)
    }

    /// Most formats are Y-up.
    fn format(&self) -> InputFormat {
        self.format.unwrap_or(InputFormat::Ply)
    }

    /// The perimeter estimate is there only where it was asked for.
    fn without_what_is_missing(&self, options: &AnnotateOptions) -> Result<AnnotateOptions, Error> {
        let quantity = Quantity::GaussPerimeter;
        let is_there = || self.values.par_iter().any(|value| value.gauss_perimeter.is_finite());
        let is_used = options.selection.names(quantity)
            || options.shown().contains(&quantity)
            || options.select.as_ref().is_some_and(|select| select.uses(quantity));
        let mut options = options.clone();
        if !is_there() {
            if is_used {
                let what =
                    "the values are without gauss_perimeter; name it among the --attributes when they are estimated";
                return Err(Error::Usage(what.into()));
            }
            options.selection = options.selection.without(quantity);
        }
        Ok(options)
    }

    /// Writes all outputs; those besides the main one are open already.
    pub(crate) fn write_with(
        &self,
        outputs: Outputs<'_>,
        mut besides: Besides,
        provenance: Value,
        progress: &dyn Progress,
    ) -> Result<Written, Error> {
        let (mesh, values) = (self.mesh, self.values);
        let Outputs { destination, format, options } = outputs;
        let selected = options.select.as_ref().map(|select| chosen(select, values, self.source)).transpose()?;
        if let Some(selected) = &selected {
            options.check_size(format, selected.len())?;
        }
        let colors = (options.shown().into_iter().enumerate())
            .map(|(i, quantity)| ColorScale::new(quantity, options.colormap, options.range_of(i), values))
            .collect::<Result<Vec<_>, _>>()?;
        let annotation = Annotation {
            mesh,
            values,
            selected: selected.clone(),
            name: io::mesh_name(self.source),
            vertex_values: options.vertex_values.then(|| {
                let written = if format.is_gltf() { options.selection.for_gltf() } else { options.selection.for_csv() };
                VertexValues::of(mesh, values, &[written, options.shown()].concat())
            }),
            selection: options.selection.clone(),
            colors,
            carrier: options.carrier,
            layout: options.layout,
            force: options.force,
            metadata: options.metadata,
            compress: options.compress,
            space: options.space(self.format(), format)?,
            provenance,
        };
        let mut notes: Vec<Note> = mesh.report().remarks().into_iter().map(Note::info).collect();
        let lost = annotation.provenance.get("reused").is_none().then(|| note_of_lost_values(mesh, values));
        notes.extend(lost.flatten());
        notes.extend(note_of_lone_faces(mesh));
        notes.extend(note_of_weak_values(values));
        notes.extend(annotation.note_of_missing_face_numbers(format));
        if let Some(out) = &mut besides.edges {
            let layers = edge_layers(mesh, options.view);
            let space = Space::to_gltf(self.format(), options.up, options.unit)?;
            let scene = LineScene { layers: &layers, origin: mesh.origin(), space, extras: annotation.extras(space) };
            io::write_lines(&scene, out)?;
            out.settle()?;
        }
        if let Some(out) = &mut besides.legend {
            legend::write(&annotation, out)?;
            out.settle()?;
        }
        io::write(&annotation, format, destination, progress)?;
        besides.legend.map_or(Ok(()), Output::finish)?;
        besides.edges.map_or(Ok(()), Output::finish)?;
        Ok(Written {
            selected_faces: selected.map(|selected| selected.len()),
            notes,
            legend: annotation.legend(),
            units: annotation.space.units(),
            settings: annotation.provenance,
        })
    }
}

/// Where a run writes to, and what.
#[derive(Clone, Copy)]
pub(crate) struct Outputs<'o> {
    pub(crate) destination: &'o Destination,
    pub(crate) format: OutputFormat,
    pub(crate) options: &'o AnnotateOptions,
}

impl Outputs<'_> {
    /// Checks all that can be checked before there is a mesh.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let options = self.options;
        options.check_for(self.format)?;
        self.destination.check_folder()?;
        options.edges.iter().chain(&options.legend).try_for_each(|path| io::check_folder(path))
    }

    /// Checks what there is to check of a file that was read, or of a mesh that came from it.
    pub(crate) fn check_for(
        &self,
        source: &Path,
        files: &[PathBuf],
        faces: usize,
        format: InputFormat,
    ) -> Result<(), Error> {
        let options = self.options;
        options.space(format, self.format)?;
        let others: Vec<PathBuf> =
            options.edges.iter().chain(&options.legend).chain(&options.reserved).cloned().collect();
        self.destination.check(self.format, &others, source, files, [faces, options.shown().len()])?;
        if options.select.is_none() {
            options.check_size(self.format, faces)?;
        }
        Ok(())
    }

    /// Checks the document from which a glTF output takes all that is not geometry, where there is one; says what of it
    /// will stay as it is.
    pub(crate) fn check_original(&self, scene: Option<&Scene>) -> Result<Vec<Note>, Error> {
        let Some(scene) = scene.filter(|scene| scene.original.is_some()) else { return Ok(Vec::new()) };
        if matches!(self.options.carrier, ColorCarrier::Vertex | ColorCarrier::VertexSrgb) {
            let what = "vertex colours would change the look that the glTF input has; leave --color out";
            return Err(Error::Usage(what.into()));
        }
        io::check_original(scene, self.destination, self.options.force, self.options.metadata)
    }
}

/// Outputs besides the main one.
pub(crate) struct Besides {
    edges: Option<Output>,
    legend: Option<Output>,
}

impl Besides {
    /// Opens those that are asked for.
    pub(crate) fn open(options: &AnnotateOptions) -> Result<Self, Error> {
        let open = |path: &Option<PathBuf>| path.as_deref().map(Output::create).transpose();
        Ok(Besides { edges: open(&options.edges)?, legend: open(&options.legend)? })
    }
}

/// The faces that fulfil a condition.
fn chosen(select: &Condition, values: &[FaceCurvature], source: &Path) -> Result<Arc<[u32]>, Error> {
    let faces: Vec<u32> =
        (0..values.len() as u32).into_par_iter().filter(|&f| select.holds(Face(f), &values[f as usize])).collect();
    if faces.is_empty() {
        let what =
            format!("none of its {} faces fulfils --select \"{select}\", so there is nothing to write", values.len());
        return Err(Error::EmptyMesh(format!("{}: {what}", source.display())));
    }
    Ok(faces.into())
}
