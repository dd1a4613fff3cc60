//! One mesh of a report: read, estimated, and everything that is told about it.

use super::ReportOptions;
use crate::curvature::{self, Estimator, FaceCurvature};
use crate::error::Error;
use crate::inspect::Inspection;
use crate::io::{self, InputFormat};
use crate::mesh::Mesh;
use crate::options::{AnnotateOptions, OF_ESTIMATION, keep_settings};
use crate::progress::Progress;
use crate::quantity::Quantity;
use crate::soup::{Group, Note};
use crate::space::{Space, Unit};
use crate::stored::StoredValues;
use crate::value_notes::{note_of_lone_faces, note_of_lost_values, note_of_weak_values};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A mesh with its values and what is known of both.
pub(super) struct Subject {
    pub(super) name: String,
    pub(super) mesh: Mesh,
    pub(super) values: Vec<FaceCurvature>,
    pub(super) inspection: Inspection,
    /// The settings that decided the values.
    pub(super) settings: Value,
    /// Notes of the reader and of the estimation.
    pub(super) notes: Vec<Note>,
    /// Named runs of faces.
    pub(super) groups: Vec<Group>,
    pub(super) space: Space,
    /// The unit of lengths, where it is known.
    pub(super) unit: Option<Unit>,
    /// Seconds of each stage.
    pub(super) seconds: [(&'static str, f64); 3],
}

impl Subject {
    /// Reads a file and estimates its curvature, or takes the values that it carries.
    pub(super) fn load(
        input: &Path,
        outputs: &[PathBuf],
        options: &ReportOptions,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let start = Instant::now();
        let (soup, format) = io::read_with(input, &options.read, progress)?;
        io::check_outputs(outputs, input, &soup.files)?;
        let space = Space::to_gltf(format, options.up, options.unit.filter(|_| format != InputFormat::Gltf))?;
        let stored = if options.reuse { io::stored_values(&soup).transpose() } else { None };
        let read = start.elapsed().as_secs_f64();

        let mut mesh = Mesh::from_soup(&soup, &options.mesh).map_err(|e| e.in_file(input))?;
        let inspection = Inspection::of(input, &soup, format, &mesh, &options.mesh);
        let weld = start.elapsed().as_secs_f64();

        let mut settings = settings(options);
        let mut notes = inspection.notes.clone();
        let usable = |stored: StoredValues| Ok((stored.curvature(&mesh)?, stored.settings));
        let reused = stored.and_then(|stored| match stored.and_then(usable) {
            Ok((values, own)) => {
                keep_settings(&mut settings, &own);
                settings["reused"] = true.into();
                notes.push(Note::info("the values are those that the file carries from an earlier run"));
                Some(values)
            }
            Err(_) => {
                notes.push(Note::info(
                    "the file does not carry all values of an earlier run as they were written, so they were estimated again",
                ));
                None
            }
        });
        let values = match reused {
            Some(values) => values,
            None => {
                let mut curvature = options.curvature;
                curvature.perimeter |=
                    curvature.estimator == Estimator::Auto && options.color_by == Quantity::GaussPerimeter;
                let values;
                (mesh, values) = curvature::estimate_owned(mesh, &curvature, progress)?;
                notes.extend(note_of_lost_values(&mesh, &values));
                values
            }
        };
        notes.extend(note_of_lone_faces(&mesh));
        notes.extend(note_of_weak_values(&values));
        let estimate = start.elapsed().as_secs_f64();
        Ok(Subject {
            name: io::mesh_name(input),
            groups: soup.groups,
            mesh,
            values,
            inspection,
            settings,
            notes,
            unit: if format == InputFormat::Gltf { Some(Unit::Metre) } else { options.unit },
            space,
            seconds: [("read", read), ("weld", weld - read), ("estimate", estimate - weld)],
        })
    }

    /// True when something was repaired or skipped, or the mesh has defects (exit code 3).
    pub(super) fn has_defects(&self) -> bool {
        self.inspection.has_defects() || self.notes.iter().any(|note| note.repaired)
    }
}

/// The settings that decide the values, as statistics have them.
fn settings(options: &ReportOptions) -> Value {
    let all = AnnotateOptions { mesh: options.mesh, curvature: options.curvature, ..AnnotateOptions::default() };
    let all = all.provenance();
    json!(OF_ESTIMATION.iter().map(|&name| (name, all[name].clone())).collect::<std::collections::BTreeMap<_, _>>())
}
