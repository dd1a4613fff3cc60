//! A mesh with its curvature and everything a writer needs to know.

use crate::color::{ColorScale, NOT_ESTIMATED_INDEX, class_index, scale_index};
use crate::curvature::FaceCurvature;
use crate::io::OutputFormat;
use crate::mesh::Mesh;
use crate::numbers::Numbers;
use crate::quantity::{Quantity, Selection};
use crate::soup::Note;
use crate::space::Space;
use crate::vertex_values::VertexValues;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::sync::Arc;

/// How a glTF file shows colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorCarrier {
    /// A palette texture and one texture coordinate per vertex: right in every client.
    #[default]
    Texture,
    /// `COLOR_0` in linear light, as the specification says; MeshLab shows it too dark.
    Vertex,
    /// `COLOR_0` with sRGB bytes, for MeshLab; other clients show it too bright.
    VertexSrgb,
    /// No colours.
    None,
}

/// How a glTF file attaches values to faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Layout {
    /// Vertices of its own for every face, whose values are vertex attributes: right in every client.
    #[default]
    Faces,
    /// Vertices that faces share, as the input has them; values in an extension of the primitive
    /// (docs/file-format.md). Less than half as large, no colours, and for readers that know it.
    Indexed,
}

/// A mesh with its curvature and everything a writer needs to know.
#[derive(Clone, Debug)]
pub struct Annotation<'m> {
    /// The mesh.
    pub mesh: &'m Mesh,
    /// One value per face.
    pub values: &'m [FaceCurvature],
    /// The faces that are written, in ascending order; `None`: all.
    pub selected: Option<Arc<[u32]>>,
    /// The object's name in the output.
    pub name: String,
    /// Values of vertices, where they are to be written too.
    pub vertex_values: Option<VertexValues>,
    /// Quantities asked for.
    pub selection: Selection,
    /// Colour scales: the first is the one shown, all are variants in a glTF file. May be empty.
    pub colors: Vec<ColorScale>,
    /// How a glTF file carries them.
    pub carrier: ColorCarrier,
    /// How a glTF file attaches values to faces.
    pub layout: Layout,
    /// Whether attributes of a glTF input that have a name of ours but are not are replaced.
    pub force: bool,
    /// Whether a glTF file also carries the values as a table of `EXT_structural_metadata`.
    pub metadata: bool,
    /// Whether a glTF file is compressed with `EXT_meshopt_compression`.
    pub compress: bool,
    /// Axes and units of a glTF file.
    pub space: Space,
    /// Settings and version: all that is needed to repeat the run.
    pub provenance: Value,
}

/// Face numbers up to here are exact in a 32-bit float.
pub(crate) const LARGEST_EXACT_FACE: usize = 1 << 24;

impl Annotation<'_> {
    /// The faces that are written.
    pub(crate) fn faces(&self) -> Numbers {
        match &self.selected {
            Some(selected) => Numbers::List(Arc::clone(selected)),
            None => Numbers::Run(0..self.values.len() as u32),
        }
    }

    /// The welded vertices that are written.
    pub(crate) fn vertices(&self) -> Numbers {
        match &self.selected {
            Some(_) => self.vertices_of(&self.faces()),
            None => Numbers::Run(0..self.mesh.positions().len() as u32),
        }
    }

    /// The welded vertices of some faces. Those of a run of faces that makes up a body stand together,
    /// since vertices are numbered by first use.
    pub(crate) fn vertices_of(&self, faces: &Numbers) -> Numbers {
        let corners = || faces.iter().flat_map(|f| self.mesh.topology().corners(crate::Face(f))).map(|v| v.0);
        if self.selected.is_none() {
            let first = corners().min().unwrap_or(0);
            return Numbers::Run(first..corners().max().map_or(0, |last| last + 1));
        }
        let mut used: Vec<u32> = corners().collect();
        used.sort_unstable();
        used.dedup();
        Numbers::List(used.into())
    }

    /// The quantities of a glTF file; face numbers only where a 32-bit float can hold them all.
    pub fn gltf_quantities(&self) -> Vec<Quantity> {
        let mut quantities = self.selection.for_gltf();
        if self.values.len() > LARGEST_EXACT_FACE {
            quantities.retain(|&q| q != Quantity::Face);
        }
        quantities
    }

    /// Says so where face numbers are wanted but are too large for a 32-bit float.
    pub(crate) fn note_of_missing_face_numbers(&self, format: OutputFormat) -> Option<Note> {
        let wanted = format.is_gltf() && self.selection.for_gltf().contains(&Quantity::Face);
        (wanted && self.values.len() > LARGEST_EXACT_FACE).then(|| {
            Note::info(format!(
                "_FACE_ID is left out: 32-bit floats are exact to {LARGEST_EXACT_FACE} and there are {} faces; their order is that of the input",
                self.values.len()
            ))
        })
    }

    /// The values of vertices, column by column; none where they are not asked for.
    pub(crate) fn vertex_columns(&self) -> impl Iterator<Item = (Quantity, &[f32])> {
        let values = self.vertex_values.as_ref();
        values.into_iter().flat_map(|values| values.quantities().filter_map(|q| Some((q, values.get(q)?))))
    }

    /// The translation of a glTF output's node: the mesh's origin in the output's axes and units, in
    /// 32 bits, as glTF keeps it.
    pub(crate) fn node_translation(&self) -> DVec3 {
        self.space.point(self.mesh.origin()).as_vec3().as_dvec3()
    }

    /// What 32 bits cut off the origin; positions make up for it.
    pub(crate) fn translation_remainder(&self) -> DVec3 {
        self.space.point(self.mesh.origin()) - self.node_translation()
    }

    /// A direction of a face in the output's axes; `None` for other quantities and for a face
    /// without estimate.
    pub(crate) fn turned(&self, quantity: Quantity, value: &FaceCurvature) -> Option<Vec3> {
        let direction = match quantity {
            Quantity::DirMax => value.dir_max,
            Quantity::DirMin => value.dir_min,
            _ => return None,
        };
        value.is_estimated().then(|| self.space.direction(direction))
    }

    /// What a legend of the colours shown needs: quantity, unit, map, range and a few colours with their
    /// values, in the output's units. `None` where there are no colours.
    pub fn legend(&self) -> Option<Value> {
        self.colors.first().map(|colors| legend_of(colors, self.space))
    }

    /// Everything needed to read and to repeat the result, for the `extras` of what is written in a space.
    pub(crate) fn extras(&self, space: Space) -> Value {
        let legends: Vec<Value> = self.colors.iter().map(|colors| legend_of(colors, space)).collect();
        let report = self.mesh.report();
        let origin = self.mesh.origin();
        let mut extras = json!({ "osculate": {
            "schema": 1,
            "version": env!("CARGO_PKG_VERSION"),
            "settings": self.provenance,
            "units": space.units(),
            "sign": "k is positive where the surface bends away from its normal",
            "not_estimated": "0 everywhere, class -1",
            "classes": crate::FaceClass::ALL.iter().map(|c| (c.code().to_string(), c.name())).collect::<std::collections::BTreeMap<_, _>>(),
            "faces": report.faces,
            "origin": origin.to_array(),
            "legend": legends.first(),
        } });
        if self.colors.len() > 1 {
            extras["osculate"]["legends"] = legends.into();
        }
        extras
    }

    /// The corners of a face in the input's axes and units, relative to the mesh's origin; finite
    /// whatever the file holds: a coordinate that is not finite becomes that of a corner that is, or
    /// zero.
    pub(crate) fn finite_triangle(&self, face: crate::Face) -> [DVec3; 3] {
        let corners = self.mesh.triangle(face);
        if corners.iter().all(|c| c.is_finite()) {
            return corners;
        }
        let stand_in = corners.iter().copied().find(|c| c.is_finite()).unwrap_or(DVec3::ZERO);
        corners.map(|c| if c.is_finite() { c } else { stand_in })
    }
}

/// What the legend of a colour scale needs, in the units of an output.
fn legend_of(colors: &ColorScale, space: Space) -> Value {
    let factor = space.factor(colors.quantity.dimension());
    let palette = colors.map.palette();
    let hex = |i: usize| format!("#{:02x}{:02x}{:02x}", palette[i][0], palette[i][1], palette[i][2]);
    if colors.quantity == Quantity::Class {
        let classes: Vec<Value> = crate::FaceClass::ALL
            .iter()
            .map(|class| json!({ "value": class.code(), "name": class.name(), "color": hex(class_index(*class)) }))
            .collect();
        return json!({ "quantity": "class", "colormap": colors.map.name(), "stops": classes });
    }
    const STOPS: usize = 8;
    let stops: Vec<Value> = (0..=STOPS)
        .map(|i| {
            let share = i as f64 / STOPS as f64;
            let value = factor * (colors.low * (1.0 - share) + colors.high * share);
            json!({ "value": value, "color": hex(scale_index(share)) })
        })
        .collect();
    json!({
        "quantity": colors.quantity.token(),
        "unit": space.unit_of(colors.quantity),
        "colormap": colors.map.name(),
        "range": [factor * colors.low, factor * colors.high],
        "clipped_faces": colors.clipped,
        "not_estimated": hex(NOT_ESTIMATED_INDEX),
        "stops": stops,
    })
}
