//! Settings that a file seems to need: said only where the data speak for them.

use super::EdgeLengths;
use crate::io::InputFormat;
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh, MeshOptions};
use crate::soup::Soup;
use crate::space::Unit;
use glam::{DVec3, IVec3};
use std::collections::HashMap;

/// A sentence for each setting.
pub(super) fn suggest(
    mesh: &Mesh,
    soup: &Soup,
    format: InputFormat,
    lengths: Option<EdgeLengths>,
    options: &MeshOptions,
) -> Vec<String> {
    let weld = lengths.filter(|_| options.weld == 0.0).and_then(|lengths| weld(mesh, lengths));
    weld.into_iter().chain(unit(mesh, soup, format)).chain(up(mesh, format)).collect()
}

/// Open edges that run beside one another, nearer than any honest edge is long.
fn weld(mesh: &Mesh, lengths: EdgeLengths) -> Option<String> {
    /// Fewer may be corners of a real slit.
    const LEAST_SHARE: f64 = 0.25;
    let size = mesh.report().bounds?.size().length();
    let most = (0.1 * lengths.p5).min(1e-3 * size);
    if mesh.report().edges.boundary < 10 || most <= 0.0 {
        return None;
    }
    let mut is_open = vec![false; mesh.positions().len()];
    let sides = (0..3 * mesh.face_count() as u32).map(HalfEdge);
    let counted = |h: &HalfEdge| mesh.is_in_surface(h.face());
    for h in sides.filter(counted).filter(|&h| mesh.edge_kind(h) == EdgeKind::Boundary) {
        is_open[mesh.topology().origin(h).0 as usize] = true;
        is_open[mesh.topology().target(h).0 as usize] = true;
    }
    let open: Vec<DVec3> = mesh.positions().iter().zip(is_open).filter(|(_, open)| *open).map(|(p, _)| *p).collect();
    let cell = |p: DVec3| (p / most).round().as_ivec3();
    let mut cells: HashMap<IVec3, Vec<usize>> = HashMap::new();
    for (i, &p) in open.iter().enumerate() {
        let inside = cells.entry(cell(p)).or_default();
        // So many in one cell are a heap that no weld distance sorts out.
        if inside.len() < 64 {
            inside.push(i);
        }
    }
    // The furthest of those that are near: welding must reach all of a corner's copies.
    let gap = |i: usize| {
        let around = (-1..=1).flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| IVec3::new(x, y, z))));
        let cells = around.filter_map(|d| cells.get(&cell(open[i]).saturating_add(d)));
        let others = cells.flatten().filter(|&&j| j != i).map(|&j| open[i].distance(open[j]));
        others.filter(|&distance| distance <= most).max_by(f64::total_cmp)
    };
    let gaps: Vec<f64> = (0..open.len()).filter_map(gap).collect();
    if (gaps.len() as f64) < LEAST_SHARE * open.len() as f64 {
        return None;
    }
    let widest = gaps.iter().copied().fold(0.0, f64::max);
    if widest == 0.0 {
        // Bodies on top of one another: what lies apart by nothing is welded already, within each body.
        return None;
    }
    // One digit, rounded up, so that the widest gap is closed.
    let digit = 10_f64.powf(widest.log10().floor());
    let distance = digit * (widest / digit * 1.01).ceil();
    Some(format!(
        "{} of the {} vertices on open edges lie within {widest:.1e} of another: --weld {distance:.0e} joins them",
        gaps.len(),
        open.len()
    ))
}

/// What the file says of its unit, or what its format is customarily in.
fn unit(mesh: &Mesh, soup: &Soup, format: InputFormat) -> Option<String> {
    if let Some(unit) = Unit::of_file(soup, format) {
        return Some(unit.hint());
    }
    let size = mesh.report().bounds?.size().max_element();
    (format == InputFormat::Stl && (10.0..3000.0).contains(&size)).then(|| {
        format!(
            "the mesh is {size:.4} long, so the file may be in millimetres, as most STL are: --unit mm makes them metres in glTF"
        )
    })
}

/// A part that rests on its base tells which way is up; so do coordinates of a map.
fn up(mesh: &Mesh, format: InputFormat) -> Option<String> {
    /// A base of this share of all area is one; below the other share there is none.
    const BASE: f64 = 0.03;
    const NO_BASE: f64 = 0.005;
    if format == InputFormat::Gltf {
        return None;
    }
    let bounds = mesh.report().bounds?;
    let size = bounds.size();
    // Map coordinates are metres from a far origin on two axes, heights on the third.
    let is_map = |across: f64, up: f64| across.abs() > 1e5 && up.abs() < 1e4;
    let center = bounds.center();
    let is_map_z = is_map(center.x, center.z) && is_map(center.y, center.z);
    let (mut area, mut base_y, mut base_z) = (0.0, 0.0, 0.0);
    for face in (0..mesh.face_count() as u32).map(Face).filter(|&f| mesh.is_sound(f)) {
        let (normal, part) = (mesh.normal(face), mesh.area(face));
        let at = mesh.barycentre(face) + mesh.origin() - bounds.min;
        area += part;
        base_y += if normal.y < -0.999 && at.y <= 1e-3 * size.y { part } else { 0.0 };
        base_z += if normal.z < -0.999 && at.z <= 1e-3 * size.z { part } else { 0.0 };
    }
    let stands = |on: f64, not: f64| on > BASE * area && not < NO_BASE * area;
    if format.is_z_up() {
        return (stands(base_y, base_z) && !is_map_z)
            .then(|| "the mesh rests on a flat base at its lowest y: --up y if Y points up".into());
    }
    let why = if is_map_z {
        "the coordinates look like those of a map with heights along z"
    } else if stands(base_z, base_y) {
        "the mesh rests on a flat base at its lowest z"
    } else {
        return None;
    };
    Some(format!("{why}: --up z if Z points up"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::soup::{Group, Positions};
    use crate::synth::{Grid, Surface};

    fn hints(soup: &Soup, format: InputFormat) -> Vec<String> {
        let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
        let lengths = super::super::edge_lengths(&mesh);
        suggest(&mesh, soup, format, lengths, &MeshOptions::default())
    }

    fn pyramid(turn: impl Fn([f64; 3]) -> [f64; 3], shift: [f64; 3]) -> Soup {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0], [2.0, 2.0, 3.0]];
        let moved = corners.map(|p| {
            let p = turn(p);
            [p[0] + shift[0], p[1] + shift[1], p[2] + shift[2]]
        });
        let faces = vec![[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        Soup::new(Positions::F64(moved.to_vec()), faces)
    }

    #[test]
    fn a_base_tells_which_way_is_up() {
        let upright = pyramid(|p| p, [0.0; 3]);
        assert!(hints(&upright, InputFormat::Obj)[0].contains("--up z"));
        assert!(hints(&upright, InputFormat::Stl).is_empty());
        let lying = pyramid(|[x, y, z]| [y, z, x], [0.0; 3]);
        assert!(hints(&lying, InputFormat::Stl)[0].contains("--up y"));
        assert!(hints(&lying, InputFormat::Obj).is_empty());
        let on_a_map = pyramid(|[x, y, z]| [y, z, x], [4e6, 5e5, 300.0]);
        assert!(hints(&on_a_map, InputFormat::Ply)[0].contains("map"));
    }

    #[test]
    fn units_are_suggested_where_the_file_or_the_custom_says_so() {
        let mut soup = pyramid(|p| p.map(|c| 20.0 * c), [0.0; 3]);
        assert!(hints(&soup, InputFormat::Stl)[0].contains("--unit mm"));
        soup.metres_per_unit = Some(0.0254);
        assert!(hints(&soup, InputFormat::ThreeMf)[0].contains("--unit in"));
    }

    #[test]
    fn corners_that_nearly_meet_are_found() {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 30, 20).build().soup;
        assert!(hints(&soup, InputFormat::Ply).is_empty(), "a closed mesh needs no weld");
        let corners = soup.triangles.as_flattened();
        let positions = corners.iter().enumerate().map(|(i, &corner)| {
            let noise = 1e-5 * ((i * 7919 % 13) as f64 / 13.0 - 0.5);
            (soup.positions.get(corner as usize) + DVec3::new(noise, -noise, 0.5 * noise)).to_array()
        });
        let apart = Soup::new(
            Positions::F64(positions.collect()),
            (0..soup.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect(),
        );
        let hint = hints(&apart, InputFormat::Ply).remove(0);
        let distance: f64 =
            hint.split("--weld ").nth(1).and_then(|s| s.split(' ').next()?.parse().ok()).expect("a distance");
        let mesh = Mesh::from_soup(&apart, &MeshOptions { weld: distance, ..MeshOptions::default() }).expect("a mesh");
        assert!(mesh.report().closed, "{hint}: {:?}", mesh.report());
    }

    #[test]
    fn bodies_on_top_of_one_another_are_no_gap() {
        let mut soup = Grid::new(Surface::Saddle, 12, 12).build().soup;
        let once = soup.triangles.clone();
        soup.triangles.extend(&once);
        let count = once.len() as u32;
        let body = |faces| Group { name: String::new(), faces };
        soup.bodies = vec![body(0..count), body(count..2 * count)];
        let found = hints(&soup, InputFormat::ThreeMf);
        assert!(found.iter().all(|hint| !hint.contains("--weld")), "{found:?}");
    }
}
