//! Estimates against surfaces whose curvature is known.

mod common;

use common::{percentile, size, synthetic};
use osculate::synth::{Grid, Surface};
use osculate::{CurvatureOptions, Estimator, FaceClass};

const TORUS: Surface = Surface::Torus { major: 3.0, minor: 1.0 };

fn with(estimator: Estimator) -> CurvatureOptions {
    CurvatureOptions { estimator, ..CurvatureOptions::default() }
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
fn a_sphere_has_its_radius_everywhere_and_bends_away_from_its_normals() {
    for radius in [0.5, 20.0] {
        let grid = Grid::new(Surface::Sphere { radius }, 64, 32);
        let [max, min, gauss, perimeter] = medians(&grid, &CurvatureOptions::default());
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
    let [max, _, gauss, perimeter] = medians(&Grid::new(TORUS, 120, 48), &CurvatureOptions::default());
    assert!(max <= 1.0, "k_max: {max} %");
    assert!(gauss <= 1.5, "K: {gauss} %");
    assert!(perimeter <= 2.0, "K by the perimeter: {perimeter} %");
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

#[test]
fn a_saddle_bends_both_ways() {
    for cells in [25, 60] {
        let (values, exact) = synthetic(&Grid::new(Surface::Saddle, cells, cells), &CurvatureOptions::default());
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

/// The paper's expansion is the exact solution's beginning: both must agree on small turns.
#[test]
fn the_expansion_approaches_the_exact_arc() {
    let grid = Grid::new(Surface::Sphere { radius: 1.0 }, 96, 48);
    let (exact, _) = synthetic(&grid, &CurvatureOptions::default());
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
    let [value] = common::values_of(&soup, &CurvatureOptions::default())[..] else { panic!("one face") };
    assert_eq!((value.k_max, value.k_min, value.class, value.coverage), (0.0, 0.0, FaceClass::Flat, 0.0));
}
