//! Estimates against surfaces whose curvature is known.

mod common;

use common::{percentile, size, synthetic};
use osculate::synth::{Grid, Surface};
use osculate::{CurvatureOptions, Estimator, FaceClass, FaceCurvature, Method, Radius};

const TORUS: Surface = Surface::Torus { major: 3.0, minor: 1.0 };

/// The radius factor that the paper uses for dense meshes.
fn with(estimator: Estimator) -> CurvatureOptions {
    CurvatureOptions { estimator, radius: Radius::FaceFactor(3.0), ..CurvatureOptions::default() }
}

/// Median errors of k_max, of k_min, of K and of formula (3), in percent of the face's largest
/// curvature (squared for K).
fn medians(grid: &Grid, options: &CurvatureOptions) -> [f64; 4] {
    let (values, exact) = synthetic(grid, options);
    let faces = || values.iter().zip(&exact);
    let gauss = |e: &osculate::synth::Exact| e.k_max * e.k_min;
    [
        percentile(faces().map(|(v, e)| (f64::from(v.k_max) - e.k_max).abs() / size(e)), 0.5),
        percentile(faces().map(|(v, e)| (f64::from(v.k_min) - e.k_min).abs() / size(e)), 0.5),
        percentile(faces().map(|(v, e)| (f64::from(v.gauss()) - gauss(e)).abs() / size(e).powi(2)), 0.5),
        percentile(faces().map(|(v, e)| (f64::from(v.gauss_perimeter) - gauss(e)).abs() / size(e).powi(2)), 0.5),
    ]
}

#[test]
fn a_plane_has_no_curvature() {
    for estimator in [Estimator::Osculating, Estimator::Osculating3, Estimator::Tangent] {
        let (values, _) = synthetic(&Grid { jitter: 0.3, ..Grid::new(Surface::Plane, 12, 12) }, &with(estimator));
        for value in values {
            assert_eq!((value.k_max, value.k_min, value.class), (0.0, 0.0, FaceClass::Flat), "{estimator:?}");
            assert!(value.gauss_perimeter.abs() < 1e-9, "{value:?}");
        }
    }
}

#[test]
fn a_tilted_plane_has_none_either() {
    let soup = Grid { jitter: 0.3, ..Grid::new(Surface::Plane, 12, 12) }.build().soup;
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
    let points = (0..soup.positions.len()).map(|v| (turn * soup.positions.get(v)).to_array()).collect();
    let soup = osculate::Soup::new(osculate::Positions::F64(points), soup.triangles);
    for value in common::values_of(&soup, &CurvatureOptions::default()) {
        assert!(value.k_max.abs() < 1e-6 && value.k_min.abs() < 1e-6 && value.class == FaceClass::Flat, "{value:?}");
        assert!(value.gauss_perimeter.is_nan() || value.gauss_perimeter.abs() < 1e-9, "{value:?}");
    }
}

#[test]
fn a_sphere_has_its_radius_everywhere_and_bends_away_from_its_normals() {
    for radius in [0.5, 20.0] {
        let grid = Grid::new(Surface::Sphere { radius }, 64, 32);
        let [max, min, gauss, perimeter] = medians(&grid, &with(Estimator::Osculating));
        assert!(max < 2.0 && min < 1.0 && gauss < 2.0 && perimeter < 2.0, "{max} {min} {gauss} {perimeter}");
        let (values, _) = synthetic(&grid, &CurvatureOptions::default());
        assert!(values.iter().all(|v| v.k_min > 0.0 && v.is_estimated()));
    }
}

#[test]
fn a_cylinder_bends_around_and_not_along() {
    let grid = Grid::new(Surface::Cylinder { radius: 10.0, height: 20.0 }, 64, 20);
    let (values, exact) = synthetic(&grid, &CurvatureOptions::default());
    let inside: Vec<_> = values.iter().zip(&exact).filter(|(v, _)| v.coverage == 1.0).collect();
    assert!(inside.len() > 500);
    for (value, exact) in inside {
        assert!((f64::from(value.k_max) - 0.1).abs() < 0.002, "{value:?}");
        assert!(f64::from(value.k_min).abs() < 0.003, "{value:?}");
        assert!(value.dir_max.as_dvec3().dot(exact.dir_max).abs() > 0.999, "{value:?}");
        assert_eq!(value.class, FaceClass::Parabolic);
    }
}

#[test]
fn the_torus_of_the_measures_is_within_one_percent() {
    let [max, _, gauss, perimeter] = medians(&Grid::new(TORUS, 120, 48), &with(Estimator::Osculating));
    assert!(max <= 1.0, "k_max: {max} %");
    assert!(gauss <= 1.5, "K: {gauss} %");
    assert!(perimeter <= 2.0, "K by the perimeter: {perimeter} %");
}

/// Long facets from rim to rim, a coarse cylinder, an ordinary torus: one setting for all.
#[test]
fn the_automatic_radius_fits_dense_meshes_and_long_facets() {
    for (surface, u, v) in [
        (Surface::Cylinder { radius: 1.0, height: 0.5 }, 64, 1),
        (Surface::Cylinder { radius: 1.0, height: 4.0 }, 64, 1),
        (Surface::Cylinder { radius: 1.0, height: 40.0 }, 64, 1),
        (Surface::Cylinder { radius: 10.0, height: 20.0 }, 48, 1),
        (Surface::Cylinder { radius: 1.0, height: 4.0 }, 2000, 1),
        (TORUS, 120, 48),
        (TORUS, 400, 40),
    ] {
        let (values, exact) = synthetic(&Grid::new(surface, u, v), &CurvatureOptions::default());
        let faces = || values.iter().zip(&exact);
        let max = percentile(faces().map(|(v, e)| (f64::from(v.k_max) - e.k_max).abs() / size(e)), 0.5);
        let min = percentile(faces().map(|(v, e)| (f64::from(v.k_min) - e.k_min).abs() / size(e)), 0.5);
        assert!(max < 4.0 && min < 6.0, "{surface:?} {u} x {v}: {max} {min}");
    }
}

/// A radius far beyond what a disk can show is cut where its legs have turned by a right angle.
#[test]
fn a_disk_does_not_go_round_the_ball() {
    for radius in [1.0, 2.0, 3.4] {
        let options = CurvatureOptions { radius: Radius::Length(radius), ..CurvatureOptions::default() };
        let (values, _) = synthetic(&Grid::new(Surface::Sphere { radius: 1.0 }, 48, 24), &options);
        for value in values {
            assert!((value.k_max - 1.0).abs() < 0.1 && (value.k_min - 1.0).abs() < 0.1, "{radius}: {value:?}");
        }
    }
}

#[test]
fn a_finer_mesh_is_not_worse() {
    for surface in [TORUS, Surface::Saddle] {
        for estimator in [Estimator::Osculating, Estimator::Tangent] {
            let coarse = medians(&Grid::new(surface, 60, 24), &with(estimator));
            let fine = medians(&Grid::new(surface, 240, 96), &with(estimator));
            for i in 0..3 {
                assert!(fine[i] <= coarse[i], "{surface:?} {estimator:?}: {coarse:?} then {fine:?}");
                assert!(fine[i] < 2.5, "{surface:?} {estimator:?}: {fine:?}");
            }
        }
    }
}

/// Where a surface hardly bends, a plane may be all that a coarse window tells: not that it is one.
#[test]
fn a_plane_that_does_not_explain_its_window_has_no_confidence() {
    for (u, v) in [(31, 31), (31, 32), (33, 33)] {
        let (values, exact) = synthetic(&Grid::new(Surface::MonkeySaddle, u, v), &CurvatureOptions::default());
        let is_plane = |value: &FaceCurvature| value.method == Method::Fit && value.k_max == 0.0 && value.k_min == 0.0;
        let planes: Vec<_> = values.iter().zip(&exact).filter(|(value, _)| is_plane(value)).collect();
        assert!(!planes.is_empty(), "nothing is tested");
        for (value, exact) in planes {
            assert!(size(exact) < 1e-3 || value.confidence < 0.1, "{u} x {v}: {}", value.confidence);
        }
    }
}

#[test]
fn a_saddle_bends_both_ways() {
    for cells in [25, 60] {
        let (values, exact) = synthetic(&Grid::new(Surface::Saddle, cells, cells), &with(Estimator::Osculating));
        for (value, exact) in values.iter().zip(&exact).filter(|(v, _)| v.coverage == 1.0) {
            // Away from where a curvature times the radius is as small as the tolerance.
            if exact.k_max.min(-exact.k_min) * f64::from(value.radius) > 0.1 {
                assert_eq!(value.class, FaceClass::Hyperbolic, "{value:?}");
            }
            assert!((f64::from(value.k_max) - exact.k_max).abs() < 0.15 * size(exact), "{value:?} {exact:?}");
            assert!((f64::from(value.k_min) - exact.k_min).abs() < 0.15 * size(exact), "{value:?} {exact:?}");
        }
    }
}

/// An edge just before the end of a leg or just behind it must not make a difference.
#[test]
fn the_turning_of_tangents_does_not_depend_on_where_legs_end() {
    let cylinder = Surface::Cylinder { radius: 10.0, height: 30.0 };
    for (grid, most) in [
        (Grid::new(TORUS, 120, 48), [0.5, 1.0]),
        (Grid { jitter: 0.2, ..Grid::new(TORUS, 120, 48) }, [0.7, 1.0]),
        (Grid::new(cylinder, 64, 30), [0.6, 0.7]),
    ] {
        for i in 0..=5 {
            let radius = Radius::FaceFactor(2.5 + 0.3 * f64::from(i));
            let options = CurvatureOptions { radius, ..with(Estimator::Tangent) };
            let [max, min, ..] = medians(&grid, &options);
            assert!(max < most[0] && min < most[1], "{grid:?} {radius:?}: {max} % {min} %");
        }
    }
}

/// Between a cylinder's rims most disks are in part; what is left of them has no Gaussian curvature either.
#[test]
fn the_perimeter_of_a_part_of_a_disk_shows_no_curvature_on_a_cylinder() {
    for (cells, factor) in [([64, 10], 3.0), ([48, 1], 0.7), ([24, 1], 0.7)] {
        let grid = Grid::new(Surface::Cylinder { radius: 10.0, height: 10.0 }, cells[0], cells[1]);
        let options =
            CurvatureOptions { radius: Radius::FaceFactor(factor), diameters: 180, ..with(Estimator::Osculating) };
        let (values, exact) = synthetic(&grid, &options);
        let partial = values.iter().filter(|v| v.coverage < 1.0).count();
        assert!(2 * partial > values.len(), "{partial}");
        for (value, exact) in values.iter().zip(&exact) {
            let error = f64::from(value.gauss_perimeter) / size(exact).powi(2);
            assert!(error.abs() < 0.004, "{cells:?}: {error} {value:?}");
        }
    }
}

/// The paper's expansion is the exact solution's beginning: both must agree on small turns.
#[test]
fn the_expansion_approaches_the_exact_arc() {
    let grid = Grid::new(Surface::Sphere { radius: 1.0 }, 96, 48);
    let (exact, _) = synthetic(&grid, &with(Estimator::Osculating));
    let (third, _) = synthetic(&grid, &with(Estimator::Osculating3));
    for (a, b) in exact.iter().zip(&third) {
        assert!((a.mean() - b.mean()).abs() < 0.03, "{a:?} {b:?}");
    }
}

#[test]
fn a_box_is_flat_on_every_face() {
    // Each side in 2 x 2 cells, so that legs reach neighbours on the same side.
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0.0, 2.0] {
            let first = positions.len() as u32;
            for i in 0..9 {
                let mut p = [side; 3];
                p[(axis + 1) % 3] = f64::from(i % 3);
                p[(axis + 2) % 3] = f64::from(i / 3);
                positions.push(p);
            }
            for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let [a, b, c, d] = [0, 1, 4, 3].map(|corner| first + i + 3 * j + corner);
                let faces = if side > 0.0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
                triangles.extend(faces);
            }
        }
    }
    let soup = osculate::Soup::new(osculate::Positions::F64(positions), triangles);
    let report = common::mesh_of(&soup).report().clone();
    assert_eq!((report.edges.feature, report.edges.boundary, report.closed), (24, 0, true));
    assert_eq!(report.inside_out_components, 0);
    for value in common::values_of(&soup, &CurvatureOptions::default()) {
        assert!(value.k_max.abs() < 1e-6 && value.k_min.abs() < 1e-6, "{value:?}");
        assert_eq!(value.class, FaceClass::Flat);
    }
}

#[test]
fn one_triangle_is_a_flat_mesh() {
    let soup = osculate::Soup::new(
        osculate::Positions::F64(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]]),
        vec![[0, 1, 2]],
    );
    for options in [CurvatureOptions::default(), with(Estimator::Osculating)] {
        let [value] = common::values_of(&soup, &options)[..] else { panic!("one face") };
        assert_eq!((value.k_max, value.k_min, value.class), (0.0, 0.0, FaceClass::Flat));
        if options.estimator == Estimator::Osculating {
            assert_eq!(value.coverage, 0.0, "every leg ends at the border");
        }
    }
}

/// Three mean edges of the mesh are as long as three mean edges of a face where all faces are alike.
#[test]
fn a_factor_of_the_mesh_is_one_of_the_face_on_an_even_mesh() {
    let grid = Grid::new(Surface::Plane, 10, 10);
    let with = |radius| synthetic(&grid, &CurvatureOptions { radius, ..with(Estimator::Osculating) }).0;
    for (a, b) in with(Radius::MeshFactor(2.0)).iter().zip(with(Radius::FaceFactor(2.0))) {
        assert!(
            (a.radius - b.radius).abs() < 1e-6 && (a.radius - 2.0 * (0.4 + 0.2 * 2.0_f32.sqrt()) / 3.0).abs() < 1e-5
        );
    }
}

/// Half of the disk at a straight border is there.
#[test]
fn coverage_is_the_share_of_whole_legs() {
    let options = CurvatureOptions { radius: Radius::Length(0.2), ..with(Estimator::Osculating) };
    let (values, _) = synthetic(&Grid::new(Surface::Plane, 40, 40), &options);
    assert!(values.iter().filter(|v| v.coverage == 1.0).count() > 1800);
    let at_border = values[40].coverage;
    assert!((0.45..0.65).contains(&at_border), "{at_border}");
}

#[test]
fn edges_towards_and_away_from_the_viewer_are_told_apart() {
    use osculate::{Face, HalfEdge};
    let mesh = common::mesh_of(&Grid::new(Surface::Sphere { radius: 1.0 }, 24, 12).build().soup);
    let view = glam::DVec3::X;
    let silhouette: Vec<HalfEdge> =
        (0..3 * mesh.face_count() as u32).map(HalfEdge).filter(|&h| mesh.is_silhouette(h, view)).collect();
    assert!(silhouette.len() >= 40 && silhouette.len().is_multiple_of(2), "{}", silhouette.len());
    for h in silhouette {
        let p = mesh.position(mesh.topology().origin(h));
        assert!(p.x.abs() < 0.3, "the outline of a ball is far from {p}");
    }
    assert_eq!(mesh.report().inside_out_components, 0);
    let soup = Grid::new(Surface::Sphere { radius: 1.0 }, 24, 12).build().soup;
    let inverted =
        osculate::Soup::new(soup.positions.clone(), soup.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
    let inverted = common::mesh_of(&inverted);
    assert_eq!(inverted.report().inside_out_components, 1);
    assert!(inverted.normal(Face(100)).dot(inverted.barycentre(Face(100))) < 0.0, "it is reported, not turned");
}
