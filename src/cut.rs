//! The section of a whole mesh with a plane, by the same walk as the disks.

use crate::lines::Polyline;
use crate::mesh::{Face, Mesh};
use crate::progress::{Progress, Stage};
use crate::section::{Crossing, Features, Plane, Stop};
use glam::DVec3;

/// Faces looked at between two reports of progress.
const CHUNK: u32 = 1 << 16;

/// All polylines in which a plane cuts a mesh, ordered by their lowest face.
///
/// A watertight mesh gives closed loops only. A vertex exactly on the plane counts as above it, so
/// that the section is the border of what lies below: it passes through such vertices and along such
/// edges, and a face that lies in the plane is outlined where the mesh goes on below it. Open ends
/// are at boundary edges and at edges with three or more faces.
pub fn cut(mesh: &Mesh, plane: &Plane, progress: &dyn Progress) -> Vec<Polyline> {
    progress.begin(Stage::Cut, mesh.face_count() as u64);
    let mut visited = vec![false; mesh.face_count()];
    let mut lines = Vec::new();
    for face in (0..mesh.face_count() as u32).map(Face) {
        if (face.0 + 1).is_multiple_of(CHUNK) {
            progress.advance(CHUNK.into());
        }
        let in_surface = mesh.is_in_surface(face);
        if visited[face.index()] || !in_surface {
            continue;
        }
        let Some(first) = Crossing::leaving(mesh, plane, face) else { continue };
        let (mut points, stop) = follow(mesh, plane, first, face, &mut visited);
        let line = if stop == Stop::Closed {
            Polyline::closed(points)
        } else {
            // Also the other way from the first face.
            let back = Crossing::leaving_backwards(mesh, plane, face);
            let back = back.map(|first| follow(mesh, plane, first, face, &mut visited).0).unwrap_or_default();
            points.splice(0..0, back.into_iter().rev());
            Polyline::open(points)
        };
        if line.points.len() > 1 {
            lines.push(line);
        }
    }
    progress.end();
    lines
}

/// The crossings from `first` on, which leaves `start`, until the walk ends or is back there.
fn follow(mesh: &Mesh, plane: &Plane, first: Crossing, start: Face, visited: &mut [bool]) -> (Vec<DVec3>, Stop) {
    visited[start.index()] = true;
    let mut points = vec![first.point];
    let mut at = first;
    loop {
        match at.advance(mesh, plane, Features::Cross) {
            Ok(next) if next.half_edge.face() == start => return (points, Stop::Closed),
            Ok(next) => {
                visited[next.half_edge.face().index()] = true;
                points.push(next.point);
                at = next;
            }
            Err(stop) => return (points, stop),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::progress::NoProgress;
    use crate::soup::{Positions, Soup};
    use crate::synth::{Grid, RoundedBox, Surface};
    use std::f64::consts::PI;

    fn mesh(soup: &Soup) -> Mesh {
        Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh")
    }

    #[test]
    fn a_torus_is_cut_in_two_circles() {
        let mesh = mesh(&Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 200, 100).build().soup);
        // Through vertices and along edges, just beside them, and across.
        for (normal, lengths) in [(DVec3::Z, [8.0 * PI, 4.0 * PI]), (DVec3::Y, [2.0 * PI, 2.0 * PI])] {
            for offset in [0.0, 1e-9, -1e-9] {
                let lines = cut(&mesh, &Plane { point: offset * normal, normal }, &NoProgress);
                assert_eq!(lines.len(), 2, "{normal} {offset}");
                assert!(lines.iter().all(|l| l.closed));
                let total: f64 = lines.iter().map(Polyline::length).sum();
                assert!((total - lengths[0] - lengths[1]).abs() < 2e-3 * total, "{normal} {offset}: {total}");
            }
        }
    }

    #[test]
    fn sharp_edges_do_not_end_a_section() {
        let shape = RoundedBox {
            size: DVec3::new(4.0, 3.0, 2.0),
            fillet: 0.0,
            flat_cells: 4,
            fillet_cells: 1,
            noise: 0.0,
            seed: 0,
        };
        let lines = cut(&mesh(&shape.build().soup), &Plane { point: DVec3::splat(0.1), normal: DVec3::X }, &NoProgress);
        let [line] = lines.as_slice() else { panic!("{} loops", lines.len()) };
        assert!(line.closed && (line.length() - 10.0).abs() < 1e-12, "{}", line.length());
    }

    #[test]
    fn an_open_surface_is_cut_from_border_to_border_whichever_way_its_faces_wind() {
        let soup = Grid::new(Surface::Plane, 7, 5).build().soup;
        let turned =
            soup.triangles.iter().enumerate().map(|(f, &[a, b, c])| if f % 3 == 0 { [a, c, b] } else { [a, b, c] });
        for triangles in [soup.triangles.clone(), turned.collect()] {
            let points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
            let mesh = mesh(&Soup::new(Positions::F64(points), triangles));
            let lines = cut(&mesh, &Plane { point: DVec3::new(0.13, 0.0, 0.0), normal: DVec3::X }, &NoProgress);
            let [line] = lines.as_slice() else { panic!("{} lines", lines.len()) };
            assert!(!line.closed && (line.length() - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_plane_that_misses_cuts_nothing() {
        let mesh = mesh(&Grid::new(Surface::Sphere { radius: 1.0 }, 12, 6).build().soup);
        assert!(cut(&mesh, &Plane { point: DVec3::splat(9.0), normal: DVec3::Z }, &NoProgress).is_empty());
    }
}
