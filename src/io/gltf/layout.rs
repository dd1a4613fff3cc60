//! The streams that a glTF file consists of: what each holds, its length, and values as they are stored.

use super::accessor::Raw;
use super::stream_writer::StreamWriter;
use super::vertices::{Owners, Vertices};
use crate::annotation::{Annotation, Layout};
use crate::color::{ColorScale, NOT_ESTIMATED_INDEX, PALETTE};
use crate::error::Error;
use crate::mesh::Face;
use crate::numbers::Numbers;
use crate::progress::Progress;
use crate::quantity::Quantity;
use glam::DVec3;
use rayon::prelude::*;
use std::io::{self, Write};
use std::sync::Arc;

/// The most that the 32-bit length of a GLB can say.
const GLB_LIMIT: u64 = u32::MAX as u64;

/// What one accessor holds.
pub(super) enum Stream<'a> {
    /// Three positions for each face.
    Corners { faces: Numbers },
    /// The positions of welded vertices.
    Positions { vertices: Numbers },
    /// A vertex attribute of the original, copies included.
    Copied { raw: Raw<'a>, stride: usize, vertices: Arc<Vertices> },
    /// Corners of faces as vertex numbers; `wide` takes 32 bits for each.
    Indices { corners: Vec<[u32; 3]>, wide: bool },
    /// A quantity.
    Value { owners: Owners, quantity: Quantity, component: usize },
    /// The row of each vertex's face in a table of faces.
    Row { owners: Owners, faces: Numbers },
    /// A column of a table of faces, in the type that fits: 32-bit floats, face numbers in 32 bits, classes
    /// in 8.
    Column { faces: Numbers, quantity: Quantity },
    /// The value of the welded vertex at which each vertex is.
    VertexValue { owners: Owners, quantity: Quantity },
    /// Where in the palettes a face's colours are: of the colour scale `u` along the first axis, of `v`
    /// along the second.
    PaletteCoordinate { owners: Owners, u: usize, v: Option<usize> },
    /// The colour of the first colour scale.
    VertexColor { owners: Owners },
}

impl Stream<'_> {
    /// Number of bytes.
    pub(super) fn byte_length(&self) -> u64 {
        let elements = match self {
            Stream::Corners { faces } => 3 * faces.len(),
            Stream::Positions { vertices } => vertices.len(),
            Stream::Copied { vertices, .. } => vertices.len(),
            Stream::Indices { corners, .. } => 3 * corners.len(),
            Stream::Column { faces, .. } => faces.len(),
            Stream::Value { owners, .. }
            | Stream::Row { owners, .. }
            | Stream::VertexValue { owners, .. }
            | Stream::PaletteCoordinate { owners, .. }
            | Stream::VertexColor { owners } => owners.len(),
        };
        self.stride() as u64 * elements as u64
    }

    /// Bytes of an element.
    pub(super) fn stride(&self) -> usize {
        match self {
            Stream::Corners { .. } | Stream::Positions { .. } => 12,
            Stream::Copied { stride, .. } => *stride,
            Stream::Indices { wide, .. } => {
                if *wide {
                    4
                } else {
                    2
                }
            }
            Stream::PaletteCoordinate { .. } => 8,
            Stream::Column { quantity: Quantity::Class, .. } => 1,
            Stream::Column { quantity, .. } => 4 * quantity.columns().len(),
            Stream::Value { .. } | Stream::Row { .. } | Stream::VertexValue { .. } | Stream::VertexColor { .. } => 4,
        }
    }

    /// Writes all bytes.
    pub(super) fn write(
        &self,
        annotation: &Annotation<'_>,
        out: &mut dyn Write,
        progress: &dyn Progress,
    ) -> io::Result<()> {
        let to = StreamWriter { annotation, out, progress };
        match self {
            Stream::Corners { faces } => to.corners(faces),
            Stream::Positions { vertices } => to.positions(vertices),
            Stream::Copied { raw, stride, vertices } => to.copied(raw, *stride, vertices),
            Stream::Indices { corners, wide } => to.indices(corners, *wide),
            Stream::Value { owners, quantity, component } => to.value(owners, *quantity, *component),
            Stream::Row { owners, faces } => to.row(owners, faces),
            Stream::Column { faces, quantity } => to.column(faces, *quantity),
            Stream::VertexValue { owners, quantity } => to.vertex_value(owners, *quantity),
            Stream::PaletteCoordinate { owners, u, v } => to.palette_coordinate(owners, *u, *v),
            Stream::VertexColor { owners } => to.vertex_color(owners),
        }
    }
}

/// A quantity as files hold it, for each face and for vertices without one.
pub(super) fn stored_value<'v>(
    annotation: &'v Annotation<'_>,
    quantity: Quantity,
    component: usize,
) -> impl Fn(Option<Face>) -> f32 + Sync + 'v {
    let factor = annotation.space.factor(quantity.dimension());
    move |face| {
        let Some(face) = face else { return if quantity == Quantity::Class { -1.0 } else { 0.0 } };
        let value = &annotation.values[face.index()];
        match annotation.turned(quantity, value) {
            Some(direction) => direction[component],
            None => quantity.stored(face, value, component, factor),
        }
    }
}

/// The middle of a texel of a palette, or of the palette: right for any filter and however a client rounds.
pub(super) fn texel(index: Option<usize>) -> f32 {
    index.map_or(0.5, |index| (index as f32 + 0.5) / PALETTE as f32)
}

/// Where in a colour scale's palette a face's colour is.
#[inline]
pub(super) fn texel_of(colors: Option<&ColorScale>, annotation: &Annotation<'_>, face: Option<Face>) -> f32 {
    texel(Some(match (colors, face) {
        (Some(colors), Some(face)) => colors.color_index(&annotation.values[face.index()]),
        _ => NOT_ESTIMATED_INDEX,
    }))
}

/// A point in the output's space, as stored. `remainder` is what the node's translation leaves over.
pub(super) fn stored_point(annotation: &Annotation<'_>, remainder: DVec3, p: DVec3) -> [f32; 3] {
    single(annotation.space.point(p) + remainder)
}

/// Coordinates as 32-bit floats: those beyond them as the largest.
pub(super) fn single(p: DVec3) -> [f32; 3] {
    p.to_array().map(|c| c.clamp(f32::MIN.into(), f32::MAX.into()) as f32)
}

/// A vertex of faces that are left out for it still needs a place.
pub(super) fn finite(p: DVec3) -> DVec3 {
    if p.is_finite() { p } else { DVec3::ZERO }
}

type Bounds = [[f32; 3]; 2];

fn empty() -> Bounds {
    [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]]
}

fn join([min, max]: Bounds, [low, high]: Bounds) -> Bounds {
    [[0, 1, 2].map(|i| min[i].min(low[i])), [0, 1, 2].map(|i| max[i].max(high[i]))]
}

/// Least and greatest coordinates of welded vertices as they are stored.
pub(super) fn stored_points_bounds(annotation: &Annotation<'_>, vertices: &Numbers) -> Bounds {
    let remainder = annotation.translation_remainder();
    let positions = annotation.mesh.positions();
    (0..vertices.len() as u32)
        .into_par_iter()
        .map(|v| [stored_point(annotation, remainder, finite(positions[vertices.at(v) as usize])); 2])
        .reduce(empty, join)
}

/// Least and greatest coordinates of the corners as they are stored.
pub(super) fn stored_bounds(annotation: &Annotation<'_>, faces: &Numbers) -> Bounds {
    let is_finite = annotation.mesh.report().non_finite_faces == 0;
    if is_finite && *faces == Numbers::Run(0..annotation.values.len() as u32) {
        // Every vertex is that of some face.
        return stored_points_bounds(annotation, &annotation.vertices());
    }
    let remainder = annotation.translation_remainder();
    (0..faces.len() as u32)
        .into_par_iter()
        .map(|f| {
            let corners = annotation.finite_triangle(Face(faces.at(f))).map(|p| stored_point(annotation, remainder, p));
            corners.into_iter().fold(empty(), |bounds, c| join(bounds, [c, c]))
        })
        .reduce(empty, join)
}

/// Bytes that a mesh of so many faces takes in a GLB at least, apart from the document.
pub(in crate::io) fn expected_bytes(layout: Layout, faces: usize, quantities: &[Quantity], colors: u64) -> u64 {
    let values: u64 = quantities.iter().map(|q| 4 * q.columns().len() as u64).sum();
    let per_face = match layout {
        Layout::Faces => 3 * (12 + values + colors),
        // Six half-edges meet in a vertex, about, so that there are half as many vertices as faces.
        Layout::Indexed => 6 + 6 + values,
    };
    faces as u64 * per_face
}

/// Refuses a GLB of more bytes than it can hold, with the ways out.
pub(in crate::io) fn check_glb_length(length: u64) -> Result<(), Error> {
    if length <= GLB_LIMIT {
        return Ok(());
    }
    Err(Error::TooLarge(format!(
        "the output would have {:.1} GB, but a .glb holds at most 4.3: write .gltf (with its bytes in .bin files) or .ply, use --layout indexed, or fewer quantities with --attributes",
        length as f64 / 1e9
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Selection;

    #[test]
    fn a_file_over_the_limit_is_refused_with_the_ways_out() {
        assert!(check_glb_length(GLB_LIMIT).is_ok());
        let error = check_glb_length(GLB_LIMIT + 1).expect_err("too long").to_string();
        assert!([".gltf", ".bin", "--layout indexed", "4.3 GB"].iter().all(|way| error.contains(way)), "{error}");
        // By the number of faces, before any work.
        let check = |faces, layout| {
            crate::io::check_size(crate::io::OutputFormat::Glb, layout, faces, &Selection::default(), 8)
        };
        assert!(check(20_000_000, Layout::Faces).is_ok() && check(40_000_000, Layout::Indexed).is_ok());
        assert!(matches!(check(30_000_000, Layout::Faces), Err(Error::TooLarge(_))));
    }
}
