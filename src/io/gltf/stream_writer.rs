//! The bytes of each kind of stream.

use super::accessor::Raw;
use super::layout::{finite, stored_point, stored_value, texel, texel_of};
use super::vertices::{Owners, Vertices};
use crate::annotation::{Annotation, ColorCarrier};
use crate::color::{NOT_ESTIMATED_INDEX, Rgb, linear};
use crate::io::blocks::in_blocks;
use crate::mesh::{Face, HalfEdge};
use crate::numbers::Numbers;
use crate::progress::Progress;
use crate::quantity::{self, Quantity};
use std::io::{self, Write};
use std::ops::Range;

/// Writes one stream.
pub(super) struct StreamWriter<'w, 'a> {
    pub(super) annotation: &'w Annotation<'a>,
    pub(super) out: &'w mut dyn Write,
    pub(super) progress: &'w dyn Progress,
}

impl StreamWriter<'_, '_> {
    pub(super) fn corners(self, faces: &Numbers) -> io::Result<()> {
        let annotation = self.annotation;
        let remainder = annotation.translation_remainder();
        self.in_blocks(faces.len(), |block, bytes| {
            bytes.resize(36 * block.len(), 0);
            let (words, _) = bytes.as_chunks_mut::<4>();
            for (words, f) in words.as_chunks_mut::<9>().0.iter_mut().zip(block) {
                let corners = annotation.finite_triangle(Face(faces.at(f)));
                let stored = corners.map(|p| stored_point(annotation, remainder, p));
                words.iter_mut().zip(stored.as_flattened()).for_each(|(word, c)| *word = c.to_le_bytes());
            }
        })
    }

    pub(super) fn positions(self, vertices: &Numbers) -> io::Result<()> {
        let annotation = self.annotation;
        let remainder = annotation.translation_remainder();
        let positions = annotation.mesh.positions();
        self.in_blocks(vertices.len(), |block, bytes| {
            for v in block {
                let p = positions[vertices.at(v) as usize];
                let stored = stored_point(annotation, remainder, finite(p));
                stored.into_iter().for_each(|c| bytes.extend(c.to_le_bytes()));
            }
        })
    }

    pub(super) fn copied(self, raw: &Raw<'_>, stride: usize, vertices: &Vertices) -> io::Result<()> {
        self.in_blocks(vertices.len(), |block, bytes| {
            for v in block {
                let element = raw.get(vertices.source(v));
                bytes.extend_from_slice(element);
                bytes.extend(std::iter::repeat_n(0, stride - element.len()));
            }
        })
    }

    pub(super) fn indices(self, corners: &[[u32; 3]], wide: bool) -> io::Result<()> {
        self.in_blocks(corners.len(), |block, bytes| {
            for corner in corners[block.start as usize..block.end as usize].as_flattened() {
                match wide {
                    true => bytes.extend(corner.to_le_bytes()),
                    false => bytes.extend((*corner as u16).to_le_bytes()),
                }
            }
        })
    }

    pub(super) fn value(self, owners: &Owners, quantity: Quantity, component: usize) -> io::Result<()> {
        let stored = stored_value(self.annotation, quantity, component);
        self.per_element(owners, |face| stored(face).to_le_bytes())
    }

    pub(super) fn row(self, owners: &Owners, faces: &Numbers) -> io::Result<()> {
        self.per_element(owners, |face| {
            let row = face.map_or(0, |face| faces.place(face.0));
            (row as f32).to_le_bytes()
        })
    }

    pub(super) fn column(self, faces: &Numbers, quantity: Quantity) -> io::Result<()> {
        let annotation = self.annotation;
        let stored: Vec<_> = (0..quantity.columns().len()).map(|c| stored_value(annotation, quantity, c)).collect();
        self.in_blocks(faces.len(), |block, bytes| {
            for face in block.map(|f| Face(faces.at(f))) {
                match quantity {
                    Quantity::Face => bytes.extend(face.0.to_le_bytes()),
                    Quantity::Class => bytes.extend(annotation.values[face.index()].class.code().to_le_bytes()),
                    _ => stored.iter().for_each(|stored| bytes.extend(stored(Some(face)).to_le_bytes())),
                }
            }
        })
    }

    pub(super) fn vertex_value(self, owners: &Owners, quantity: Quantity) -> io::Result<()> {
        let annotation = self.annotation;
        let values = annotation.vertex_values.as_ref().and_then(|values| values.get(quantity));
        let factor = annotation.space.factor(quantity.dimension());
        let at = |corner: Option<HalfEdge>| {
            let vertex = corner.map(|corner| annotation.mesh.topology().origin(corner));
            let value = vertex.and_then(|vertex| values.map(|values| values[vertex.index()]));
            quantity::finite(f64::from(value.unwrap_or(0.0)) * factor).to_le_bytes()
        };
        self.in_blocks(owners.len(), |block, bytes| {
            for v in block {
                bytes.extend_from_slice(&at(owners.corner(v)));
            }
        })
    }

    pub(super) fn palette_coordinate(self, owners: &Owners, u: usize, v: Option<usize>) -> io::Result<()> {
        let annotation = self.annotation;
        let along = |scale: usize, face| texel_of(annotation.colors.get(scale), annotation, face);
        self.per_element(owners, |face| {
            let [a, b, c, d] = along(u, face).to_le_bytes();
            let [e, f, g, h] = v.map_or(texel(None), |v| along(v, face)).to_le_bytes();
            [a, b, c, d, e, f, g, h]
        })
    }

    pub(super) fn vertex_color(self, owners: &Owners) -> io::Result<()> {
        let annotation = self.annotation;
        let Some(colors) = annotation.colors.first() else { return Ok(()) };
        let mut palette = colors.map.palette();
        if annotation.carrier == ColorCarrier::Vertex {
            palette = palette.map(|rgb: Rgb| rgb.map(linear));
        }
        self.per_element(owners, |face| {
            let index = face.map_or(NOT_ESTIMATED_INDEX, |f| colors.color_index(&annotation.values[f.index()]));
            let [r, g, b] = palette[index];
            [r, g, b, 255]
        })
    }

    fn in_blocks(self, count: usize, format: impl Fn(Range<u32>, &mut Vec<u8>) + Sync) -> io::Result<()> {
        in_blocks(count, self.out, self.progress, format)
    }

    /// Writes `N` bytes for each element, worked out once for each face where faces have their own vertices.
    fn per_element<const N: usize>(
        self,
        owners: &Owners,
        of: impl Fn(Option<Face>) -> [u8; N] + Sync,
    ) -> io::Result<()> {
        match owners {
            Owners::Corners(faces) => self.in_blocks(faces.len(), |block, bytes| {
                for f in block {
                    bytes.extend_from_slice([of(Some(Face(faces.at(f)))); 3].as_flattened());
                }
            }),
            Owners::Faces(faces) => self.in_blocks(faces.len(), |block, bytes| {
                for f in block {
                    bytes.extend_from_slice(&of(Some(Face(faces.at(f)))));
                }
            }),
            Owners::Vertices(vertices) => self.in_blocks(vertices.len(), |block, bytes| {
                for v in block {
                    bytes.extend_from_slice(&of(vertices.owner(v)));
                }
            }),
        }
    }
}
