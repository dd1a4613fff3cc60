//! The classified edges of a mesh as lines.

use crate::color::Rgb;
use crate::lines::{Layer, Polyline};
use crate::mesh::{EdgeKind, Face, HalfEdge, Mesh};
use glam::DVec3;

/// Boundary, feature and non-manifold edges, each kind a layer; with a view direction, from the
/// viewer to the mesh, the silhouette as a fourth. Every edge once, as a line of two points, with its
/// kind (`_EDGE_KIND`: 1 boundary, 2 feature, 3 non-manifold, 4 silhouette), the angle between the normals of
/// its two faces (`_DIHEDRAL`, degrees; 0 where there are not two) and its length (`_LENGTH`).
pub fn edge_layers(mesh: &Mesh, view: Option<DVec3>) -> Vec<Layer> {
    let kind = |kind: EdgeKind| move |mesh: &Mesh, h: HalfEdge| mesh.edge_kind(h) == kind;
    let mut layers = vec![
        layer(mesh, "boundary", 1.0, [230, 159, 0], kind(EdgeKind::Boundary)),
        layer(mesh, "feature", 2.0, [0, 114, 178], kind(EdgeKind::Feature)),
        layer(mesh, "non-manifold", 3.0, [213, 94, 0], kind(EdgeKind::NonManifold)),
    ];
    layers.extend(
        view.map(|view| {
            layer(mesh, "silhouette", 4.0, [0, 158, 115], move |mesh: &Mesh, h| mesh.is_silhouette(h, view))
        }),
    );
    layers
}

fn layer(mesh: &Mesh, name: &str, kind: f64, color: Rgb, shown: impl Fn(&Mesh, HalfEdge) -> bool) -> Layer {
    let topology = mesh.topology();
    let mut ends: Vec<([u32; 2], HalfEdge)> = (0..mesh.face_count() as u32)
        .map(Face)
        .filter(|&f| mesh.is_in_surface(f))
        .flat_map(Face::half_edges)
        .filter(|&h| topology.twin(h).is_none_or(|twin| h < twin) && shown(mesh, h))
        .map(|h| {
            let (a, b) = (topology.origin(h).0, topology.target(h).0);
            ([a.min(b), a.max(b)], h)
        })
        .collect();
    // An edge with three faces has three sides, none of which is another's twin.
    ends.sort_unstable();
    ends.dedup_by_key(|(ends, _)| *ends);
    let angle = |h: HalfEdge| mesh.dihedral_angle(h).map_or(0.0, f64::to_degrees);
    let line = |ends: &[u32; 2]| Polyline::open(ends.map(|v| mesh.positions()[v as usize]));
    let lines: Vec<Polyline> = ends.iter().map(|(ends, _)| line(ends)).collect();
    let values = vec![
        ("_EDGE_KIND", 0, vec![kind; lines.len()]),
        ("_DIHEDRAL", 0, ends.iter().map(|&(_, h)| angle(h)).collect()),
        ("_LENGTH", 1, lines.iter().map(Polyline::length).collect()),
    ];
    Layer { name: name.into(), color, lines, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::synth::RoundedBox;

    #[test]
    fn a_box_shows_its_twelve_edges_and_its_outline() {
        let shape = RoundedBox {
            size: DVec3::new(4.0, 3.0, 2.0),
            fillet: 0.0,
            flat_cells: 4,
            fillet_cells: 1,
            noise: 0.0,
            seed: 0,
        };
        let mesh = Mesh::from_soup(&shape.build().soup, &MeshOptions::default()).expect("a mesh");
        let layers = edge_layers(&mesh, Some(DVec3::new(1.0, 2.0, 3.0)));
        let count: Vec<usize> = layers.iter().map(|l| l.lines.len()).collect();
        assert_eq!(count, [0, 48, 0, 24], "seen over a corner, six of twelve edges are the outline");
        let values = |name: &str| &layers[1].values.iter().find(|v| v.0 == name).expect("a column").2;
        assert!(values("_EDGE_KIND").iter().all(|&kind| kind == 2.0));
        assert!(values("_DIHEDRAL").iter().all(|angle| (angle - 90.0).abs() < 1e-9));
        assert!((values("_LENGTH").iter().sum::<f64>() - 36.0).abs() < 1e-12);
        let length: f64 = layers[1].lines.iter().map(Polyline::length).sum();
        assert!((length - 36.0).abs() < 1e-12);
    }
}
