//! Plane polylines as SVG, in the units of the mesh.

use super::Output;
use crate::error::Error;
use crate::lines::Polyline;
use crate::section::Plane;
use glam::{DVec2, DVec3};
use std::fmt::Write;

/// Writes polylines that lie in a plane, seen against its normal. One SVG unit is one unit of the
/// mesh; y points up in the picture. Up is the axis +Z, or +Y where the plane is horizontal.
///
/// Points are relative to `origin`, that of the mesh, and stay so, since viewers hold coordinates in 32 bits: where it
/// is not 0, the picture's description tells it.
///
/// # Errors
/// [`Error::Usage`] where there is nothing to draw; [`Error::Io`] when the system refuses.
pub fn write_svg(lines: &[Polyline], plane: &Plane, origin: DVec3, out: &mut Output) -> Result<(), Error> {
    if lines.iter().all(|line| line.points.is_empty()) {
        return Err(Error::Usage("there are no lines to draw".into()));
    }
    let [across, up] = picture_axes(plane.normal);
    let flat = |p: DVec3| DVec2::new(p.dot(across), -p.dot(up));
    let points = || lines.iter().flat_map(|line| &line.points).map(|&p| flat(p));
    let (low, high) = points().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let size = (high - low).max_element();
    let margin = DVec2::splat(0.02 * size);
    let (corner, extent) = (low - margin, high - low + 2.0 * margin);
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{} {} {} {}\" fill=\"none\" stroke=\"black\" stroke-width=\"{}\" stroke-linejoin=\"round\">",
        corner.x,
        corner.y,
        extent.x,
        extent.y,
        0.003 * size
    );
    if origin != DVec3::ZERO {
        let [x, y, z] = origin.to_array();
        let _ = writeln!(svg, "<desc>relative to the point {x},{y},{z} of the input</desc>");
    }
    for line in lines {
        let element = if line.closed { "polygon" } else { "polyline" };
        let list: Vec<String> = line.points.iter().map(|&p| flat(p)).map(|p| format!("{},{}", p.x, p.y)).collect();
        let _ = writeln!(
            svg,
            "<{element} points=\"{}\"><title>length {}</title></{element}>",
            list.join(" "),
            line.length()
        );
    }
    svg.push_str("</svg>\n");
    std::io::Write::write_all(out, svg.as_bytes()).map_err(|e| out.error(e))
}

/// Unit vectors to the right and upwards for someone who looks against the normal.
fn picture_axes(normal: DVec3) -> [DVec3; 2] {
    let upright = if normal.cross(DVec3::Z).length() > 1e-6 { DVec3::Z } else { DVec3::Y };
    let across = upright.cross(normal).normalize();
    [across, normal.cross(across)]
}
