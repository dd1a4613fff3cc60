//! The streams that a glTF file consists of: what each holds, its length, and its bytes.

use super::accessor::Raw;
use super::vertices::{Owners, Vertices};
use crate::annotation::{Annotation, ColorCarrier, Layout};
use crate::color::{ColorScale, NOT_ESTIMATED_INDEX, PALETTE, Rgb, linear};
use crate::error::Error;
use crate::io::blocks::in_blocks;
use crate::mesh::{Face, HalfEdge};
use crate::numbers::Numbers;
use crate::progress::Progress;
use crate::quantity::{self, Quantity};
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
        match self {
            Stream::Corners { faces } => {
                let remainder = annotation.translation_remainder();
                in_blocks(faces.len(), out, progress, |block, bytes| {
                    bytes.resize(36 * block.len(), 0);
                    let (words, _) = bytes.as_chunks_mut::<4>();
                    for (words, f) in words.as_chunks_mut::<9>().0.iter_mut().zip(block) {
                        let corners = annotation.finite_triangle(Face(faces.at(f)));
                        let stored = corners.map(|p| stored_point(annotation, remainder, p));
                        words.iter_mut().zip(stored.as_flattened()).for_each(|(word, c)| *word = c.to_le_bytes());
                    }
                })
            }
            Stream::Positions { vertices } => {
                let remainder = annotation.translation_remainder();
                let positions = annotation.mesh.positions();
                in_blocks(vertices.len(), out, progress, |block, bytes| {
                    for v in block {
                        let p = positions[vertices.at(v) as usize];
                        extend(bytes, stored_point(annotation, remainder, finite(p)));
                    }
                })
            }
            Stream::Copied { raw, stride, vertices } => in_blocks(vertices.len(), out, progress, |block, bytes| {
                for v in block {
                    let element = raw.get(vertices.source(v));
                    bytes.extend_from_slice(element);
                    bytes.extend(std::iter::repeat_n(0, stride - element.len()));
                }
            }),
            Stream::Indices { corners, wide } => in_blocks(corners.len(), out, progress, |block, bytes| {
                for corner in corners[block.start as usize..block.end as usize].as_flattened() {
                    match wide {
                        true => bytes.extend(corner.to_le_bytes()),
                        false => bytes.extend((*corner as u16).to_le_bytes()),
                    }
                }
            }),
            Stream::Value { owners, quantity, component } => {
                let stored = stored_value(annotation, *quantity, *component);
                per_element(owners, out, progress, |face| stored(face).to_le_bytes())
            }
            Stream::Row { owners, faces } => per_element(owners, out, progress, |face| {
                let row = face.map_or(0, |face| faces.place(face.0));
                (row as f32).to_le_bytes()
            }),
            Stream::Column { faces, quantity } => {
                let stored: Vec<_> =
                    (0..quantity.columns().len()).map(|c| stored_value(annotation, *quantity, c)).collect();
                in_blocks(faces.len(), out, progress, |block, bytes| {
                    for face in block.map(|f| Face(faces.at(f))) {
                        match quantity {
                            Quantity::Face => bytes.extend(face.0.to_le_bytes()),
                            Quantity::Class => {
                                bytes.extend(annotation.values[face.index()].class.code().to_le_bytes());
                            }
                            _ => stored.iter().for_each(|stored| bytes.extend(stored(Some(face)).to_le_bytes())),
                        }
                    }
                })
            }
            Stream::VertexValue { owners, quantity } => {
                let values = annotation.vertex_values.as_ref().and_then(|values| values.get(*quantity));
                let factor = annotation.space.factor(quantity.dimension());
                let at = |corner: Option<HalfEdge>| {
                    let vertex = corner.map(|corner| annotation.mesh.topology().origin(corner));
                    let value = vertex.and_then(|vertex| values.map(|values| values[vertex.index()]));
                    quantity::finite(f64::from(value.unwrap_or(0.0)) * factor).to_le_bytes()
                };
                in_blocks(owners.len(), out, progress, |block, bytes| {
                    for v in block {
                        bytes.extend_from_slice(&at(owners.corner(v)));
                    }
                })
            }
            Stream::PaletteCoordinate { owners, u, v } => {
                let along = |scale: usize, face| texel_of(annotation.colors.get(scale), annotation, face);
                per_element(owners, out, progress, |face| {
                    let [a, b, c, d] = along(*u, face).to_le_bytes();
                    let [e, f, g, h] = v.map_or(texel(None), |v| along(v, face)).to_le_bytes();
                    [a, b, c, d, e, f, g, h]
                })
            }
            Stream::VertexColor { owners } => {
                let Some(colors) = annotation.colors.first() else { return Ok(()) };
                let mut palette = colors.map.palette();
                if annotation.carrier == ColorCarrier::Vertex {
                    palette = palette.map(|rgb: Rgb| rgb.map(linear));
                }
                per_element(owners, out, progress, |face| {
                    let index = face.map_or(NOT_ESTIMATED_INDEX, |f| colors.color_index(&annotation.values[f.index()]));
                    let [r, g, b] = palette[index];
                    [r, g, b, 255]
                })
            }
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

/// Writes `N` bytes for each element, worked out once for each face where faces have their own vertices.
fn per_element<const N: usize>(
    owners: &Owners,
    out: &mut dyn Write,
    progress: &dyn Progress,
    of: impl Fn(Option<Face>) -> [u8; N] + Sync,
) -> io::Result<()> {
    match owners {
        Owners::Corners(faces) => in_blocks(faces.len(), out, progress, |block, bytes| {
            for f in block {
                bytes.extend_from_slice([of(Some(Face(faces.at(f)))); 3].as_flattened());
            }
        }),
        Owners::Faces(faces) => in_blocks(faces.len(), out, progress, |block, bytes| {
            for f in block {
                bytes.extend_from_slice(&of(Some(Face(faces.at(f)))));
            }
        }),
        Owners::Vertices(vertices) => in_blocks(vertices.len(), out, progress, |block, bytes| {
            for v in block {
                bytes.extend_from_slice(&of(vertices.owner(v)));
            }
        }),
    }
}

fn extend(bytes: &mut Vec<u8>, point: [f32; 3]) {
    for c in point {
        bytes.extend(c.to_le_bytes());
    }
}

/// A point in the output's space, as stored. `remainder` is what the node's translation leaves over.
fn stored_point(annotation: &Annotation<'_>, remainder: DVec3, p: DVec3) -> [f32; 3] {
    single(annotation.space.point(p) + remainder)
}

/// Coordinates as 32-bit floats: those beyond them as the largest.
pub(super) fn single(p: DVec3) -> [f32; 3] {
    p.to_array().map(|c| c.clamp(f32::MIN.into(), f32::MAX.into()) as f32)
}

/// A vertex of faces that are left out for it still needs a place.
fn finite(p: DVec3) -> DVec3 {
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
