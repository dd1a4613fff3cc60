//! PLY for MeshLab: shared vertices, and per face the quality, the colour and all quantities.
//!
//! MeshLab takes numbers per face from nowhere else: it reads the face properties `quality` and
//! `red green blue alpha` and steps over the others.

use crate::annotation::Annotation;
use crate::io::blocks::in_blocks;
use crate::mesh::Face;
use crate::progress::Progress;
use crate::quantity::Quantity;
use std::io::{self, Write};

/// Writes binary little-endian PLY in the input's own axes and units. Coordinates are doubles where
/// the mesh has an origin, floats otherwise. A face without estimate carries 0 and class -1.
pub(in crate::io) fn write(
    annotation: &Annotation<'_>,
    out: &mut dyn Write,
    progress: &dyn Progress,
) -> io::Result<()> {
    let mesh = annotation.mesh;
    // Each face is a row by its place: a column of face numbers says more only where some are left out.
    let numbered = annotation.selected.is_some();
    let quantities: Vec<Quantity> =
        annotation.selection.for_tables().into_iter().filter(|&q| numbered || q != Quantity::Face).collect();
    let (faces, vertices) = (annotation.faces(), annotation.vertices());
    let origin = mesh.origin();
    let wide = origin != glam::DVec3::ZERO;
    let coordinate = if wide { "double" } else { "float" };

    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "comment made by osculate {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "comment settings {}", annotation.provenance)?;
    writeln!(out, "element vertex {}", vertices.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property {coordinate} {axis}")?;
    }
    let of_vertices: Vec<(Quantity, &[f32])> = annotation.vertex_columns().collect();
    let shown = annotation.colors.first().and_then(|colors| of_vertices.iter().find(|(q, _)| *q == colors.quantity));
    if shown.is_some() {
        writeln!(out, "property float quality")?;
    }
    for (quantity, _) in &of_vertices {
        writeln!(out, "property float {}", quantity.token())?;
    }
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices", faces.len())?;
    if !annotation.colors.is_empty() {
        writeln!(out, "property float quality")?;
        for channel in ["red", "green", "blue", "alpha"] {
            writeln!(out, "property uchar {channel}")?;
        }
    }
    for column in quantities.iter().flat_map(|q| q.columns().iter().map(move |c| (q, c))) {
        let kind = match column.0 {
            Quantity::Class => "char",
            Quantity::Face => "uint",
            _ => "float",
        };
        writeln!(out, "property {kind} {}", column.1)?;
    }
    writeln!(out, "end_header")?;

    in_blocks(vertices.len(), out, progress, |rows, bytes| {
        for v in rows.map(|row| vertices.at(row) as usize) {
            for c in (mesh.positions()[v] + origin).to_array() {
                if wide {
                    bytes.extend(c.to_le_bytes());
                } else {
                    bytes.extend((c as f32).to_le_bytes());
                }
            }
            for (_, values) in shown.into_iter().chain(&of_vertices) {
                bytes.extend(if values[v].is_nan() { 0.0 } else { values[v] }.to_le_bytes());
            }
        }
    })?;
    let palette = annotation.colors.first().map(|colors| (colors, colors.map.palette()));
    in_blocks(faces.len(), out, progress, |rows, bytes| {
        for f in rows.map(|row| Face(faces.at(row))) {
            let value = &annotation.values[f.index()];
            bytes.push(3);
            for vertex in mesh.topology().corners(f) {
                bytes.extend(vertices.place(vertex.0).to_le_bytes());
            }
            if let Some((colors, palette)) = &palette {
                bytes.extend(colors.quantity.stored(f, value, 0, 1.0).to_le_bytes());
                let [r, g, b] = palette[colors.color_index(value)];
                bytes.extend([r, g, b, 255]);
            }
            for &quantity in &quantities {
                for component in 0..quantity.columns().len() {
                    match quantity {
                        Quantity::Class => bytes.extend(value.class.code().to_le_bytes()),
                        Quantity::Face => bytes.extend(f.0.to_le_bytes()),
                        _ => bytes.extend(quantity.stored(f, value, component, 1.0).to_le_bytes()),
                    }
                }
            }
        }
    })
}
