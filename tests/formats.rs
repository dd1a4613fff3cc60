//! Files of real programs: what `fixtures/README.md` says is in them must be found.

mod common;

use common::values_of;
use osculate::{CurvatureOptions, InputFormat, Mesh, MeshOptions, NoProgress, Soup, read};
use std::path::{Path, PathBuf};

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn soup_of(name: &str) -> (Soup, InputFormat) {
    read(&fixture(name), &NoProgress).unwrap_or_else(|e| panic!("{e}"))
}

/// File, format, triangles, vertices, degenerate, inner + feature edges, boundary edges, loops,
/// components.
const FACTS: [(&str, InputFormat, [usize; 7]); 24] = [
    ("suzanne.stl", InputFormat::Stl, [968, 505, 0, 1431, 42, 4, 3]),
    ("suzanne_meshlab_ascii.stl", InputFormat::Stl, [968, 505, 0, 1431, 42, 4, 3]),
    ("suzanne.obj", InputFormat::Obj, [968, 505, 0, 1431, 42, 4, 3]),
    ("suzanne.ply", InputFormat::Ply, [968, 505, 0, 1431, 42, 4, 3]),
    ("suzanne.glb", InputFormat::Gltf, [968, 505, 0, 1431, 42, 4, 3]),
    ("cylinder_holes.stl", InputFormat::Stl, [568, 316, 0, 820, 64, 2, 1]),
    ("fillet_part.stl", InputFormat::Stl, [3916, 1958, 0, 5874, 0, 0, 1]),
    ("fillet_degenerate.stl", InputFormat::Stl, [968, 480, 8, 1440, 0, 0, 1]),
    ("groups.obj", InputFormat::Obj, [138, 73, 0, 207, 0, 0, 2]),
    ("negative.obj", InputFormat::Obj, [138, 73, 0, 207, 0, 0, 2]),
    ("two_meshes.glb", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("two_meshes.gltf", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("two_meshes_embedded.gltf", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("sphere_ascii.ply", InputFormat::Ply, [320, 162, 0, 480, 0, 0, 1]),
    ("sphere_be.ply", InputFormat::Ply, [320, 162, 0, 480, 0, 0, 1]),
    ("sphere_le.ply", InputFormat::Ply, [320, 162, 0, 480, 0, 0, 1]),
    ("sphere.off", InputFormat::Off, [320, 162, 0, 480, 0, 0, 1]),
    ("sphere_color.off", InputFormat::Off, [320, 162, 0, 480, 0, 0, 1]),
    ("sphere_binary.off", InputFormat::Off, [320, 162, 0, 480, 0, 0, 1]),
    ("two_bodies.3mf", InputFormat::ThreeMf, [640, 324, 0, 960, 0, 0, 2]),
    ("two_meshes_ext.glb", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("two_meshes_khr.glb", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("two_meshes_ext_float.glb", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
    ("two_meshes_khr_float.glb", InputFormat::Gltf, [896, 450, 0, 1344, 0, 0, 2]),
];

#[test]
fn every_fixture_holds_what_its_readme_says() {
    for (name, format, expected) in FACTS {
        let (soup, found) = soup_of(name);
        assert_eq!(found, format, "{name}");
        assert!(soup.notes.is_empty(), "{name}: {:?}", soup.notes);
        let mesh = common::mesh_of(&soup);
        let r = mesh.report();
        let edges = r.edges.inner + r.edges.feature;
        if name.starts_with("cylinder") || name.starts_with("sphere") {
            // The caps of the cylinder meet its side at right angles all around; nothing else is sharp.
            let rims = mesh_rims(&mesh);
            assert_eq!(r.edges.feature, rims, "{name}");
        }
        let facts = [r.faces, r.vertices, r.degenerate_faces, edges, r.edges.boundary, r.boundary_loops, r.components];
        assert_eq!(facts, expected, "{name}");
        let others =
            [r.edges.non_manifold, r.duplicate_faces, r.flipped_faces, r.non_finite_faces, r.inside_out_components];
        assert_eq!(others, [0; 5], "{name}");
        assert_eq!(r.closed, expected[4] == 0, "{name}");
    }
}

/// Concave polygons keep their area: a fan over the bracket's caps would give 80.7.
#[test]
fn polygons_keep_their_area() {
    for name in ["groups.obj", "negative.obj"] {
        let mesh = common::mesh_of(&soup_of(name).0);
        let area: f64 = (0..mesh.face_count() as u32).map(|f| mesh.area(osculate::Face(f))).sum();
        assert!((area - 76.7256).abs() < 1e-3, "{name}: {area}");
    }
}

#[test]
fn obj_objects_are_kept_apart_by_name_and_together_as_a_surface() {
    let (soup, _) = soup_of("groups.obj");
    let names: Vec<&str> = soup.groups.iter().map(|g| g.name.as_str()).collect();
    assert!(["Drum", "Dome", "Bracket"].iter().all(|n| names.iter().any(|name| name.contains(n))), "{names:?}");
    assert_eq!(soup.bodies.len(), 1);
}

/// The same triangles in the same order, whatever file they came in.
#[test]
fn formats_agree_on_the_values() {
    let options = CurvatureOptions { estimator: osculate::Estimator::Osculating, ..CurvatureOptions::default() };
    let values = |name| values_of(&soup_of(name).0, &options);
    // MeshLab writes STL with 6 decimals.
    for (name, tolerance) in [("suzanne_meshlab_ascii.stl", 1e-3), ("suzanne.glb", 1e-4)] {
        let mut close = 0;
        let reference = values("suzanne.stl");
        for (a, b) in reference.iter().zip(values(name)) {
            close += usize::from((a.k_max - b.k_max).abs() <= tolerance * (1.0 + a.k_max.abs()));
        }
        assert!(close > reference.len() * 95 / 100, "{name}: {close} of {}", reference.len());
    }
    let two = values("two_meshes.glb");
    assert_eq!(common::differing(&two, &values("two_meshes.gltf")), 0);
    assert_eq!(common::differing(&two, &values("two_meshes_embedded.gltf")), 0);
    // Rounding to floats decides which of two equal edges a disk's angles start from, and on which side
    // of a vertex a leg passes: at 4 faces of 320, and by half a percent of the curvature of 0.5.
    let sphere = values("sphere_le.ply");
    let differences = sphere.iter().zip(values("sphere_be.ply")).map(|(a, b)| (a.mean() - b.mean()).abs());
    let (apart, most) = differences.fold((0, 0.0_f32), |(apart, most), d| (apart + usize::from(d > 1e-3), most.max(d)));
    assert!(apart <= 8 && most < 2.5e-3, "{apart} faces, by {most}");
}

#[test]
fn the_cad_cylinder_is_flat_on_top_and_round_at_its_side() {
    // Long thin facets: the paper's cyl3 uses a radius factor of 0.5.
    let options = CurvatureOptions {
        estimator: osculate::Estimator::Osculating,
        radius: osculate::Radius::FaceFactor(0.5),
        ..CurvatureOptions::default()
    };
    let (soup, _) = soup_of("cylinder_holes.stl");
    let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
    let values = values_of(&soup, &options);
    let mut side = 0;
    for (f, value) in values.iter().enumerate() {
        if mesh.normal(osculate::Face(f as u32)).z.abs() > 0.5 {
            assert!(value.k_max.abs() < 1e-6 && value.k_min.abs() < 1e-6, "{value:?}");
        } else {
            side += usize::from((value.k_max - 0.1).abs() < 0.005);
        }
    }
    assert!(side >= 310 * 9 / 10, "{side} of 320 faces of the side");
}

/// Bounds of the placed meshes: every node transform is applied, parents included.
#[test]
fn a_scene_is_placed_by_its_nodes() {
    for name in ["two_meshes.glb", "two_meshes.gltf"] {
        let found = osculate::inspect(&fixture(name), &MeshOptions::default(), None, &NoProgress).expect("a scene");
        let bounds = found.scene.and_then(|s| s.bounds).expect("bounds");
        let expected = [-3.92644, -0.00277977, -3.30413, 6.34774, 4.00278, 3.26918];
        let actual: Vec<f64> = bounds.min.to_array().into_iter().chain(bounds.max.to_array()).collect();
        assert!(actual.iter().zip(expected).all(|(a, e)| (a - e).abs() < 1e-4), "{actual:?}");
    }
}

/// Edges between a horizontal and an upright face.
fn mesh_rims(mesh: &Mesh) -> usize {
    let flat = |f: osculate::Face| mesh.normal(f).z.abs() > 0.99;
    let topology = mesh.topology();
    (0..3 * mesh.face_count() as u32)
        .map(osculate::HalfEdge)
        .filter(|&h| topology.twin(h).is_some_and(|t| h < t && flat(h.face()) != flat(t.face())))
        .filter(|&h| mesh.dihedral_angle(h).is_some_and(|angle| angle > 1.0))
        .count()
}
