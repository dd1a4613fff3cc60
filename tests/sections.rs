//! The paper's estimators for all faces at once, in 32 bits, against the walk of one leg at a time in 64.

mod common;

use common::{bits, differing, mesh_of};
use glam::{DQuat, DVec3};
use osculate::synth::{Grid, Surface};
use osculate::{
    CurvatureOptions, Estimator, Face, FaceCurvature, FaceState, Mesh, MeshOptions, NoProgress, Place, Positions,
    Radius, Soup, Stop, disk_at, estimate,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const TORUS: Surface = Surface::Torus { major: 3.0, minor: 1.0 };

/// Half the distance of 32-bit numbers at one.
const ROUNDING: f64 = 6e-8;
/// What rounding may do to a turn, curvature times radius: some of it at each of a dozen crossings.
const SMOOTH: f64 = 40.0 * ROUNDING;
/// Where faces are tilted by noise t, chord and arc are both longer by t^2 / 2 of a leg, and the turn is the root of
/// six times what is left between them.
fn rough(tilt: f64) -> f64 {
    SMOOTH + (6.0 * 8.0 * ROUNDING * tilt * tilt).sqrt()
}

fn osculating(radius: Radius) -> CurvatureOptions {
    CurvatureOptions { estimator: Estimator::Osculating, radius, ..CurvatureOptions::default() }
}

fn values(mesh: &Mesh, options: &CurvatureOptions) -> Vec<FaceCurvature> {
    estimate(mesh, options, &NoProgress).expect("valid options")
}

/// Compares all faces with their own disks. Where the two walks do not see the same legs end, for a leg that ends
/// within rounding of a border or of a right angle, or do not choose the same radius, there is nothing to compare;
/// of fifty faces, one may be such, and two more.
fn assert_like_disks(mesh: &Mesh, options: &CurvatureOptions, tolerance: f64) {
    let (mut compared, mut apart) = (0, 0);
    for (f, fast) in values(mesh, options).into_iter().enumerate() {
        let face = Face(f as u32);
        if mesh.face_state(face) != FaceState::Sound {
            continue;
        }
        let (disk, _, slow) = disk_at(mesh, Place::barycentre(face), options).expect("valid options");
        assert_eq!(fast.is_estimated(), slow.is_estimated(), "face {f}");
        let radius = f64::from(slow.radius);
        // All that bends lies beyond the first edges; the less of it there is, the more rounding there is in it.
        let beyond = disk.legs().iter().map(|leg| leg.length - leg.first).fold(0.0, f64::max) / radius;
        let tolerance = if beyond > 0.0 { tolerance / beyond } else { ROUNDING };
        let differ_by = |times: f64| {
            [(fast.k_max, slow.k_max), (fast.k_min, slow.k_min)].into_iter().any(|(a, b)| {
                let (a, b) = (f64::from(a) * radius, f64::from(b) * radius);
                (a - b).abs() > times * tolerance * (1.0 + b.abs())
            })
        };
        // Rounding adds up where what bends is seen by few diameters, or by short ends of them.
        let (differ, differ_much) = (differ_by(1.0), differ_by(50.0));
        let has_turned = disk.legs().iter().any(|leg| leg.stop == Stop::Turned);
        if fast.coverage != slow.coverage
            || (fast.radius - slow.radius).abs() > 1e-4 * slow.radius
            || differ && (has_turned || !differ_much)
        {
            apart += 1;
            continue;
        }
        compared += 1;
        assert!(!differ, "face {f}: {fast:?} {slow:?}");
        let split = f64::from(slow.k_max - slow.k_min) * radius;
        let cosine = f64::from(fast.dir_max.dot(slow.dir_max)).abs();
        // Where both curvatures are alike, any direction is as good.
        let is_told = split > 0.01;
        assert!(
            !is_told || (1.0 - cosine).max(0.0).sqrt() <= 4.0 * tolerance / split + 1e-3,
            "face {f}: {fast:?} {slow:?}"
        );
        assert_eq!(fast.gauss_perimeter.is_nan(), slow.gauss_perimeter.is_nan(), "face {f}");
        if !slow.gauss_perimeter.is_nan() {
            let squared = radius * radius;
            let (a, b) = (f64::from(fast.gauss_perimeter) * squared, f64::from(slow.gauss_perimeter) * squared);
            assert!((a - b).abs() <= 40.0 * tolerance * (1.0 + b.abs()), "face {f}: {fast:?} {slow:?}");
        }
    }
    assert!(compared > 0 && 50 * apart <= 100 + compared, "{apart} of {}", apart + compared);
}

fn moved(soup: &Soup, by: impl Fn(DVec3) -> DVec3) -> Soup {
    let points = (0..soup.positions.len()).map(|v| by(soup.positions.get(v)).to_array()).collect();
    Soup::new(Positions::F64(points), soup.triangles.clone())
}

fn soup_of(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Soup {
    Soup::new(Positions::F64(points), faces)
}

/// The mesh and a triangle apart from it.
fn with_triangle(soup: &Soup, corners: [[f64; 3]; 3]) -> Soup {
    let mut points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
    let first = points.len() as u32;
    points.extend(corners);
    let mut faces = soup.triangles.clone();
    faces.push([first, first + 1, first + 2]);
    soup_of(points, faces)
}

fn radii() -> impl Strategy<Value = Radius> {
    prop_oneof![Just(Radius::Auto), (0.3..6.0).prop_map(Radius::FaceFactor), (0.3..6.0).prop_map(Radius::MeshFactor)]
}

fn surfaces() -> impl Strategy<Value = Surface> {
    prop_oneof![
        Just(TORUS),
        Just(Surface::Saddle),
        Just(Surface::Plane),
        Just(Surface::Wave),
        Just(Surface::Sphere { radius: 2.0 }),
        Just(Surface::Cylinder { radius: 1.0, height: 3.0 }),
    ]
}

proptest! {
    // The same cases in every run: what rounding decides is rare, but not impossible.
    #![proptest_config(ProptestConfig {
        cases: 32, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default()
    })]

    #[test]
    fn all_faces_at_once_are_like_disks_one_by_one(
        surface in surfaces(), seed: u64, radius in radii(), diameters in 3..40_usize, cells in [8..30_usize, 8..30_usize],
        features in prop_oneof![Just(40.0), Just(180.0)]
    ) {
        let soup = Grid { jitter: 0.25, seed, ..Grid::new(surface, cells[0], cells[1]) }.build().soup;
        let mesh = Mesh::from_soup(&soup, &MeshOptions { feature_angle: features, ..MeshOptions::default() }).expect("a mesh");
        assert_like_disks(&mesh, &CurvatureOptions { diameters, ..osculating(radius) }, SMOOTH);
    }

    #[test]
    fn noise_and_features_change_nothing_about_that(seed: u64, noise in 0.01..0.3_f64, radius in radii()) {
        let soup = Grid { noise, seed, ..Grid::new(TORUS, 40, 20) }.build().soup;
        assert_like_disks(&mesh_of(&soup), &osculating(radius), rough(4.0 * noise));
    }

    #[test]
    fn turning_moving_and_scaling_the_mesh_change_only_what_they_must(
        seed: u64, axis in [-1.0..1.0, -1.0..1.0, 0.1..1.0_f64], angle in 0.0..6.0_f64,
        step in [-1e6..1e6, -1e6..1e6, -1e6..1e6_f64], exponent in -9.0..9.0_f64
    ) {
        let soup = Grid { jitter: 0.25, seed, ..Grid::new(Surface::Saddle, 18, 9) }.build().soup;
        let turn = DQuat::from_axis_angle(DVec3::from_array(axis).normalize(), angle);
        let scale = 10.0_f64.powf(exponent);
        let other = moved(&soup, |p| scale * (turn * p) + scale * DVec3::from_array(step));
        let options = osculating(Radius::FaceFactor(3.0));
        for (a, b) in values(&mesh_of(&soup), &options).iter().zip(values(&mesh_of(&other), &options)) {
            if a.coverage == b.coverage {
                let radius = f64::from(a.radius);
                for (a, b) in [(a.k_max, b.k_max), (a.k_min, b.k_min)] {
                    prop_assert!((f64::from(a) - scale * f64::from(b)).abs() * radius <= 2.0 * SMOOTH, "{a} {b}");
                }
            }
        }
    }

    #[test]
    fn faces_against_the_majority_are_walked_over_like_others(seed: u64) {
        let soup = Grid { jitter: 0.25, seed, ..Grid::new(TORUS, 30, 15) }.build().soup;
        let flip = |f: usize| (f as u64 ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 62 == 0;
        let mixed = soup.triangles.iter().enumerate().map(|(f, &[a, b, c])| if flip(f) { [a, c, b] } else { [a, b, c] });
        let mixed = Soup::new(soup.positions.clone(), mixed.collect());
        assert_like_disks(&mesh_of(&mixed), &osculating(Radius::FaceFactor(2.5)), SMOOTH);
    }
}

/// The expansion has no share of an arc, so its sign is chance on saddles.
#[test]
fn the_expansion_is_like_disks_too() {
    let options = CurvatureOptions { estimator: Estimator::Osculating3, ..osculating(Radius::FaceFactor(3.0)) };
    let grid = Grid { jitter: 0.2, ..Grid::new(Surface::Sphere { radius: 2.0 }, 40, 20) };
    assert_like_disks(&mesh_of(&grid.build().soup), &options, SMOOTH);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let soup = Grid { jitter: 0.2, noise: 0.05, ..Grid::new(TORUS, 150, 70) }.build().soup;
    let mesh = mesh_of(&soup);
    for radius in [Radius::Auto, Radius::FaceFactor(3.0)] {
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| values(&mesh, &osculating(radius)))
        };
        let one = on(1);
        for threads in [2, 3, 8] {
            assert_eq!(differing(&one, &on(threads)), 0);
        }
    }
}

/// What a georeferenced file loses in 64 bits, it loses for both walks.
#[test]
fn a_mesh_far_from_zero_keeps_its_digits() {
    let soup = Grid { jitter: 0.2, ..Grid::new(Surface::Saddle, 30, 30) }.build().soup;
    for away in [DVec3::new(5e6, 4e5, 300.0), DVec3::new(0.0, 0.0, 1e5), DVec3::new(12.0, -7.0, 3.0)] {
        assert_like_disks(&mesh_of(&moved(&soup, |p| p + away)), &osculating(Radius::FaceFactor(3.0)), SMOOTH);
    }
    // A small part of something large, so that the origin is of no help.
    let part = moved(&soup, |p| p + DVec3::new(1e4, 2e4, -1e4));
    let large = with_triangle(&part, [[-1e4, 0.0, 0.0], [-1e4, 1.0, 0.0], [-1e4, 0.0, 1.0]]);
    assert_like_disks(&mesh_of(&large), &osculating(Radius::FaceFactor(3.0)), SMOOTH);
}

/// Slivers: grid lines moved so close together that faces between them are a million times as long as wide.
#[test]
fn slivers_among_other_faces_do_no_harm() {
    let grid = Grid::new(Surface::Wave, 24, 24).build().soup;
    for squeeze in [1e-2, 1e-4, 1e-6] {
        let soup = moved(&grid, |p| {
            let cell = (p.x * 12.0).floor();
            let within = p.x * 12.0 - cell;
            DVec3::new(if within > 0.4 { (cell + 1.0 - squeeze * (1.0 - within)) / 12.0 } else { p.x }, p.y, p.z)
        });
        for radius in [Radius::Auto, Radius::MeshFactor(2.0)] {
            let options = osculating(radius);
            let mesh = mesh_of(&soup);
            let found = values(&mesh, &options);
            assert!(found.iter().all(|v| !v.is_estimated() || v.k_max.is_finite()), "{squeeze}");
        }
    }
}

/// Facets from rim to rim, up to hundreds of times as long as wide.
#[test]
fn long_facets_are_like_disks() {
    for height in [0.5, 4.0, 40.0] {
        let mesh = mesh_of(&Grid::new(Surface::Cylinder { radius: 1.0, height }, 64, 1).build().soup);
        for radius in [Radius::Auto, Radius::FaceFactor(0.02), Radius::Length(0.4)] {
            assert_like_disks(&mesh, &osculating(radius), rough(0.1));
        }
    }
}

/// Faces around one vertex, a thousand of them and each a needle.
#[test]
fn a_fan_of_needles_is_like_disks() {
    let count = 1000_u32;
    let mut points = vec![[0.0, 0.0, 0.3]];
    points.extend((0..count).map(|i| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / f64::from(count)).sin_cos();
        [cos, sin, 0.0]
    }));
    let faces = (0..count).map(|i| [0, 1 + i, 1 + (i + 1) % count]).collect();
    let mesh = mesh_of(&soup_of(points, faces));
    for radius in [Radius::Auto, Radius::Length(0.2), Radius::Length(1.0)] {
        assert_like_disks(&mesh, &osculating(radius), rough(0.3));
    }
}

/// Three sheets that meet in an edge, a box, a surface of one side, and a lone triangle.
#[test]
fn meshes_that_are_no_manifold_or_hardly_a_surface_are_like_disks() {
    let sheets = soup_of(
        vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 1.0, 0.0], [0.5, -1.0, 0.1], [0.6, 0.2, 1.0]],
        vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]],
    );
    let corner = |i: u32| [0, 1, 2].map(|axis| f64::from(i >> axis & 1));
    let solid = soup_of(
        (0..8).map(corner).collect(),
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
            .into_iter()
            .flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect(),
    );
    let cells = 40;
    let strip = (0..cells).flat_map(|i| {
        let turn = std::f64::consts::TAU * f64::from(i) / f64::from(cells);
        [-0.3, 0.3].map(|s: f64| {
            let r = 1.0 + s * (0.5 * turn).cos();
            [r * turn.cos(), r * turn.sin(), s * (0.5 * turn).sin()]
        })
    });
    let moebius = (0..cells as u32).flat_map(|i| {
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i + 1 == cells as u32 { [1, 0] } else { [2 * i + 2, 2 * i + 3] };
        [[a, c, b], [b, c, d]]
    });
    let strip = soup_of(strip.collect(), moebius.collect());
    let lone = soup_of(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]], vec![[0, 1, 2]]);
    assert_eq!(mesh_of(&strip).report().non_orientable_components, 1);
    for soup in [sheets, solid, strip, lone] {
        for radius in [Radius::Auto, Radius::FaceFactor(2.0)] {
            assert_like_disks(&mesh_of(&soup), &osculating(radius), rough(0.3));
        }
    }
}

/// A ball a millionth of the disk's radius in size is gone round within rounding.
#[test]
fn a_radius_far_beyond_the_part_ends() {
    let ball = Grid::new(Surface::Sphere { radius: 1.0 }, 48, 24).build().soup;
    for size in [1.0, 1e-3, 1e-5, 1e-7] {
        let part = moved(&ball, |p| size * p);
        let mesh = mesh_of(&with_triangle(&part, [[9.0, 0.0, 0.0], [10.0, 0.0, 0.0], [9.0, 1.0, 0.0]]));
        for value in &values(&mesh, &osculating(Radius::Length(2.0)))[..ball.face_count()] {
            let turn = f64::from(value.k_max) * size;
            assert!((turn - 1.0).abs() < 0.1 && value.coverage == 0.0, "{size}: {value:?}");
        }
    }
}

/// Beside a vertex so far away, steps on the rest vanish in 32 bits.
#[test]
fn one_stray_vertex_flattens_nothing() {
    let ball = Grid::new(Surface::Sphere { radius: 1.0 }, 48, 24).build().soup;
    let options = osculating(Radius::FaceFactor(3.0));
    for far in [1e6, 1e20, 1e38] {
        let mesh = mesh_of(&with_triangle(&ball, [[9.0, 0.0, 0.0], [far, 0.0, 0.0], [9.0, 1.0, 0.0]]));
        for value in &values(&mesh, &options)[..ball.face_count()] {
            assert!((value.k_max - 1.0).abs() < 0.1 && (value.k_min - 1.0).abs() < 0.1, "{far}: {value:?}");
        }
    }
}

/// Faces come in the order of a curve inside and in the file's outside.
#[test]
fn copies_and_broken_faces_leave_the_others_alone() {
    let soup = Grid::new(Surface::Saddle, 12, 12).build().soup;
    let options = osculating(Radius::FaceFactor(2.0));
    let clean = values(&mesh_of(&soup), &options);
    let mut points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
    points.push([f64::NAN, 0.0, 0.0]);
    let bad = points.len() as u32 - 1;
    let copy = soup.triangles[100];
    let mut faces = soup.triangles;
    faces.extend([[copy[0], copy[2], copy[1]], [copy[0], copy[0], copy[1]], [copy[0], copy[1], bad]]);
    let found = values(&mesh_of(&soup_of(points, faces)), &options);
    let n = clean.len();
    assert_eq!(differing(&found[..n], &clean), 0);
    assert_eq!(bits(&found[n]), bits(&clean[100]));
    assert!(!found[n + 1].is_estimated() && !found[n + 2].is_estimated());
}
