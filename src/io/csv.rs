//! CSV: one row per face, in the input's own axes and units.

use super::blocks::in_blocks;
use crate::annotation::Annotation;
use crate::mesh::Face;
use crate::progress::Progress;
use crate::quantity::Quantity;
use std::io::{self, Write};

/// Writes a header line and one line per face. Numbers are the shortest that read back as the same
/// 32-bit float; a field is empty where the face has no such value.
pub(super) fn write(annotation: &Annotation<'_>, out: &mut dyn Write, progress: &dyn Progress) -> io::Result<()> {
    let quantities = annotation.selection.for_csv();
    let names: Vec<&str> = quantities.iter().flat_map(|q| q.columns()).copied().collect();
    writeln!(out, "{}", names.join(","))?;
    let written = annotation.faces();
    in_blocks(written.len(), out, progress, |rows, text| {
        let mut buffer = zmij::Buffer::new();
        for f in rows.map(|row| written.at(row)) {
            let value = &annotation.values[f as usize];
            let mut separate = false;
            for &quantity in &quantities {
                for component in 0..quantity.columns().len() {
                    if std::mem::replace(&mut separate, true) {
                        text.push(b',');
                    }
                    match quantity {
                        // Exact beyond 2^24, unlike a 32-bit float.
                        Quantity::Face => text.extend_from_slice(f.to_string().as_bytes()),
                        Quantity::Class => text.extend_from_slice(value.class.code().to_string().as_bytes()),
                        Quantity::Method => text.extend_from_slice(value.method.name().as_bytes()),
                        _ => {
                            let number = quantity.value(Face(f), value, component);
                            if number.is_finite() {
                                text.extend_from_slice(shortest(buffer.format_finite(number)).as_bytes());
                            }
                        }
                    }
                }
            }
            text.push(b'\n');
        }
    })
}

/// `1.0` says no more than `1`.
fn shortest(number: &str) -> &str {
    number.strip_suffix(".0").unwrap_or(number)
}
