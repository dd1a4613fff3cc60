//! Meshes without annotation: STL, PLY and OBJ.

use super::Output;
use crate::error::Error;
use crate::soup::Soup;
use std::io::{self, Write};
use std::path::Path;

/// Writes the triangles of a soup as `.stl` (binary, 32-bit), `.ply` (binary, 64-bit) or `.obj`
/// (shortest decimals), by the path's extension.
///
/// # Errors
/// [`Error::Usage`] for another extension, [`Error::Io`] when the system refuses.
pub fn write_mesh(soup: &Soup, path: &Path) -> Result<(), Error> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let write = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("stl") => write_stl,
        Some("ply") => write_ply,
        Some("obj") => write_obj,
        _ => return Err(Error::Usage(format!("{}: the extension must be .stl, .ply or .obj", path.display()))),
    };
    let mut out = Output::create(path)?;
    write(soup, &mut out).map_err(|e| out.error(e))?;
    out.finish()
}

fn write_stl(soup: &Soup, out: &mut Output) -> io::Result<()> {
    let mut header = [0; 80];
    let name = concat!("made by osculate ", env!("CARGO_PKG_VERSION"));
    header[..name.len()].copy_from_slice(name.as_bytes());
    out.write_all(&header)?;
    out.write_all(&(soup.face_count() as u32).to_le_bytes())?;
    for triangle in &soup.triangles {
        let [a, b, c] = triangle.map(|v| soup.positions.get(v as usize));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for p in [normal, a, b, c] {
            for coordinate in p.as_vec3().to_array() {
                out.write_all(&coordinate.to_le_bytes())?;
            }
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

fn write_ply(soup: &Soup, out: &mut Output) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "element vertex {}", soup.positions.len())?;
    writeln!(out, "property double x\nproperty double y\nproperty double z")?;
    writeln!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header", soup.face_count())?;
    for v in 0..soup.positions.len() {
        for coordinate in soup.positions.get(v).to_array() {
            out.write_all(&coordinate.to_le_bytes())?;
        }
    }
    for triangle in &soup.triangles {
        out.write_all(&[3])?;
        for vertex in triangle {
            out.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}

fn write_obj(soup: &Soup, out: &mut Output) -> io::Result<()> {
    let mut number = zmij::Buffer::new();
    for v in 0..soup.positions.len() {
        write!(out, "v")?;
        for coordinate in soup.positions.get(v).to_array() {
            write!(out, " {}", number.format(coordinate))?;
        }
        writeln!(out)?;
    }
    for [a, b, c] in soup.triangles.iter().map(|t| t.map(|v| u64::from(v) + 1)) {
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}
