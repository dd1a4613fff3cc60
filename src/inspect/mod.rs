//! What a user needs to know about a file before choosing settings.

mod hints;
mod places;

pub use places::{Defect, DefectPlace};

use crate::error::Error;
use crate::io::{self, InputFormat, ReadOptions};
use crate::mesh::{Bounds, Face, HalfEdge, Mesh, MeshOptions, MeshReport};
use crate::progress::Progress;
use crate::soup::{Note, Scene, Soup, Transform};
use glam::{DMat4, DQuat, DVec3};
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// Lengths of all edges, in file units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EdgeLengths {
    /// Shortest.
    pub min: f64,
    /// 5th percentile.
    pub p5: f64,
    /// Median.
    pub p50: f64,
    /// Mean.
    pub mean: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Longest.
    pub max: f64,
}

/// The scene of a glTF or 3MF file, instances counted each.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SceneSummary {
    /// Nodes that show a mesh.
    pub instances: usize,
    /// Faces of all instances together.
    pub faces: usize,
    /// Extent of all instances. Of a mesh that is placed very many times, the further ones count
    /// with the box around it, which is larger than itself where it is turned.
    pub bounds: Option<Bounds>,
}

/// Corners that are placed one by one; from there on it is boxes, so that time does not go with
/// instances times faces.
const MOST_PLACED: usize = 1 << 24;

/// What [`inspect`] finds. Serialises to the object that `inspect --format json` prints.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// The file.
    pub input: String,
    /// Its format.
    pub format: InputFormat,
    /// The mesh and its defects.
    #[serde(flatten)]
    pub report: MeshReport,
    /// True when every component has one consistent winding.
    pub oriented: bool,
    /// True when no edge has three or more faces.
    pub manifold: bool,
    /// Every kind of defect there is, with its first few places.
    pub defects: Vec<Defect>,
    /// Lengths of all edges.
    pub edge_lengths: Option<EdgeLengths>,
    /// Sum of the areas of all faces, in file units squared.
    pub area: f64,
    /// Silhouette edges for the view direction, where one was given.
    pub silhouette_edges: Option<usize>,
    /// Named groups of faces in the file.
    pub groups: usize,
    /// The placed meshes, for glTF and 3MF.
    pub scene: Option<SceneSummary>,
    /// Metres in one unit of the coordinates, where the file says so.
    pub metres_per_unit: Option<f64>,
    /// Degrees above which an edge counted as a feature.
    pub feature_angle: f64,
    /// What the reader repaired, skipped or wants to mention.
    pub notes: Vec<Note>,
    /// Settings that this file seems to need, each a sentence.
    pub suggestions: Vec<String>,
}

/// Reads a file and says what is in it, as [`inspect_with`] does by default.
///
/// # Errors
/// Those of [`inspect_with`].
pub fn inspect(
    input: &Path,
    options: &MeshOptions,
    view: Option<DVec3>,
    progress: &dyn Progress,
) -> Result<Inspection, Error> {
    inspect_with(input, &ReadOptions::default(), options, view, progress)
}

/// Reads a file and says what is in it. `view` is a direction from the viewer to the mesh for which
/// silhouette edges are counted.
///
/// # Errors
/// Any [`Error`] of reading or of building the mesh.
pub fn inspect_with(
    input: &Path,
    reading: &ReadOptions,
    options: &MeshOptions,
    view: Option<DVec3>,
    progress: &dyn Progress,
) -> Result<Inspection, Error> {
    options.check()?;
    let (soup, format) = io::read_with(input, reading, progress)?;
    let mesh = Mesh::from_soup(&soup, options).map_err(|e| e.in_file(input))?;
    let found = Inspection::of(input, &soup, format, &mesh, options);
    Ok(Inspection { silhouette_edges: view.map(|view| count_silhouette(&mesh, view)), ..found })
}

impl Inspection {
    /// What is in a file that was read and welded already.
    pub(crate) fn of(input: &Path, soup: &Soup, format: InputFormat, mesh: &Mesh, options: &MeshOptions) -> Self {
        let edge_lengths = edge_lengths(mesh);
        let report = mesh.report().clone();
        let remarks = report.remarks().into_iter().map(Note::info);
        Inspection {
            input: input.display().to_string(),
            format,
            suggestions: hints::suggest(mesh, soup, format, edge_lengths, options),
            oriented: report.flipped_faces + report.non_orientable_components == 0,
            manifold: report.edges.non_manifold == 0,
            defects: places::defects(mesh),
            edge_lengths,
            area: (0..mesh.face_count() as u32).map(|f| mesh.area(Face(f))).filter(|a| a.is_finite()).sum(),
            silhouette_edges: None,
            groups: soup.groups.len(),
            metres_per_unit: soup.metres_per_unit,
            scene: mesh.scene().map(|scene| summarise(scene, mesh)),
            feature_angle: options.feature_angle,
            notes: soup.notes.iter().cloned().chain(remarks).collect(),
            report,
        }
    }

    /// True when something was repaired or skipped, or the mesh has defects (exit code 3).
    pub fn has_defects(&self) -> bool {
        self.report.has_defects() || self.notes.iter().any(|note| note.repaired)
    }
}

fn count_silhouette(mesh: &Mesh, view: DVec3) -> usize {
    let sides = (0..3 * mesh.face_count() as u32).into_par_iter().map(HalfEdge);
    sides.filter(|&h| mesh.topology().twin(h).is_some_and(|twin| h < twin) && mesh.is_silhouette(h, view)).count()
}

fn edge_lengths(mesh: &Mesh) -> Option<EdgeLengths> {
    let topology = mesh.topology();
    let mut lengths: Vec<f64> = (0..3 * mesh.face_count() as u32)
        .into_par_iter()
        .map(HalfEdge)
        // An edge with two faces is measured from one of them.
        .filter(|&h| topology.twin(h).is_none_or(|twin| h < twin))
        .filter(|&h| mesh.is_in_surface(h.face()))
        .map(|h| mesh.position(topology.origin(h)).distance(mesh.position(topology.target(h))))
        .filter(|length| length.is_finite())
        .collect();
    lengths.par_sort_unstable_by(f64::total_cmp);
    let last = lengths.len().checked_sub(1)?;
    let at = |share: f64| lengths[(last as f64 * share).round() as usize];
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    Some(EdgeLengths { min: at(0.0), p5: at(0.05), p50: at(0.5), mean, p95: at(0.95), max: at(1.0) })
}

/// Places every mesh of the scene.
fn summarise(scene: &Scene, mesh: &Mesh) -> SceneSummary {
    let mut summary = SceneSummary { instances: 0, faces: 0, bounds: None };
    let mut boxes: Vec<Option<Option<Bounds>>> = vec![None; mesh.bodies().len()];
    let mut open: Vec<(usize, DMat4)> = scene.roots.iter().map(|&root| (root, DMat4::IDENTITY)).collect();
    while let Some((n, parent)) = open.pop() {
        let node = &scene.nodes[n];
        let global = parent * matrix(&node.transform);
        open.extend(node.children.iter().map(|&child| (child, global)));
        if let Some(body) = node.body {
            let faces = mesh.bodies()[body].faces.clone();
            summary.instances += 1;
            summary.faces += faces.len();
            let corners = faces.flat_map(|f| mesh.triangle(Face(f))).filter(|p: &DVec3| p.is_finite());
            let here = if 3 * summary.faces <= MOST_PLACED {
                Bounds::of(corners.map(|p| global.transform_point3(p)))
            } else {
                let around = boxes[body].get_or_insert_with(|| Bounds::of(corners));
                around.and_then(|b| Bounds::of(b.corners().map(|p| global.transform_point3(p))))
            };
            summary.bounds = match (summary.bounds, here) {
                (Some(a), Some(b)) => Some(Bounds { min: a.min.min(b.min), max: a.max.max(b.max) }),
                (a, b) => a.or(b),
            };
        }
    }
    summary
}

/// The matrix of a node's own transform.
pub(crate) fn matrix(transform: &Transform) -> DMat4 {
    match transform {
        Transform::Matrix(columns) => DMat4::from_cols_array(&columns.map(f64::from)),
        Transform::Parts { translation, rotation, scale } => {
            let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            DMat4::from_scale_rotation_translation(
                scale.map_or(DVec3::ONE, vector),
                rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.map(f64::from))),
                translation.map_or(DVec3::ZERO, vector),
            )
        }
    }
}
