//! NPZ: a ZIP archive of NumPy arrays, uncompressed, in the input's own axes and units.

use super::blocks::in_blocks;
use crate::annotation::Annotation;
use crate::mesh::Face;
use crate::progress::Progress;
use crate::quantity::Quantity;
use std::io::{self, Write};
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, ZipWriter};

/// Writes `positions` (vertices x 3, float64), `faces` (faces x 3, uint32), an array of each quantity
/// (float32; `face` uint32, `class` int8, directions faces x 3), `vertex_...` of each where vertices have
/// values, and `settings` (text, JSON). NaN where a face has no such value.
pub(super) fn write(annotation: &Annotation<'_>, out: &mut dyn Write, progress: &dyn Progress) -> io::Result<()> {
    let mesh = annotation.mesh;
    let mut archive = Archive { zip: ZipWriter::new_stream(out), progress };
    let (written, points) = (annotation.faces(), annotation.vertices());
    let (vertices, faces) = (points.len(), written.len());
    archive.array("positions", "<f8", &[vertices, 3], vertices, |v, bytes| {
        for c in (mesh.positions()[points.at(v) as usize] + mesh.origin()).to_array() {
            bytes.extend(c.to_le_bytes());
        }
    })?;
    archive.array("faces", "<u4", &[faces, 3], faces, |f, bytes| {
        for corner in mesh.topology().corners(Face(written.at(f))) {
            bytes.extend(points.place(corner.0).to_le_bytes());
        }
    })?;
    for quantity in annotation.selection.for_tables() {
        let name = quantity.token();
        match quantity {
            Quantity::Face => archive.array(name, "<u4", &[faces], faces, |f, bytes| {
                bytes.extend(written.at(f).to_le_bytes());
            })?,
            Quantity::Class => archive.array(name, "|i1", &[faces], faces, |f, bytes| {
                bytes.extend(annotation.values[written.at(f) as usize].class.code().to_le_bytes());
            })?,
            _ => {
                let components = quantity.columns().len();
                let shape: &[usize] = if components == 1 { &[faces] } else { &[faces, components] };
                archive.array(name, "<f4", shape, faces, |f, bytes| {
                    for component in 0..components {
                        let face = Face(written.at(f));
                        let value = quantity.value(face, &annotation.values[face.index()], component);
                        bytes.extend(value.to_le_bytes());
                    }
                })?;
            }
        }
    }
    for (quantity, values) in annotation.vertex_columns() {
        archive.array(&format!("vertex_{}", quantity.token()), "<f4", &[vertices], vertices, |v, bytes| {
            bytes.extend(values[points.at(v) as usize].to_le_bytes());
        })?;
    }
    // NumPy's text is UTF-32.
    let settings: Vec<char> = annotation.provenance.to_string().chars().collect();
    archive.array("settings", &format!("<U{}", settings.len()), &[], 1, |_, bytes| {
        bytes.extend(settings.iter().flat_map(|&c| u32::from(c).to_le_bytes()));
    })?;
    archive.zip.finish()?;
    Ok(())
}

struct Archive<'a> {
    zip: ZipWriter<StreamWriter<&'a mut dyn Write>>,
    progress: &'a dyn Progress,
}

impl Archive<'_> {
    /// Writes an array of `count` rows; `row` appends the bytes of one.
    fn array(
        &mut self,
        name: &str,
        kind: &str,
        shape: &[usize],
        count: usize,
        row: impl Fn(u32, &mut Vec<u8>) + Sync,
    ) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            // The same bytes whenever it is written.
            .last_modified_time(zip::DateTime::default())
            .large_file(true);
        self.zip.start_file(format!("{name}.npy"), options)?;
        self.zip.write_all(&header(kind, shape))?;
        in_blocks(count, &mut self.zip, self.progress, |rows, bytes| rows.for_each(|r| row(r, bytes)))
    }
}

/// The header of an array (NPY format 1.0).
fn header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let shape: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({}), }}", shape.trim_end());
    // Data begin at a multiple of 64.
    let length = (10 + text.len() + 1).next_multiple_of(64) - 10;
    text.extend(std::iter::repeat_n(' ', length - text.len() - 1));
    text.push('\n');
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(text.as_bytes());
    header
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_as_numpy_writes_them() {
        let header = header("<f4", &[3, 2]);
        assert_eq!(header.len() % 64, 0);
        let text = String::from_utf8_lossy(&header[10..]).into_owned();
        assert_eq!(text.trim_end(), "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2,), }");
        assert!(text.ends_with(" \n"));
    }
}
