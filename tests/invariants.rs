//! What must not change the answer, and what must change it in a known way.

mod common;

use common::{differing, mesh_of, values_of};
use glam::{DQuat, DVec3};
use osculate::synth::{Grid, Surface};
use osculate::{
    CurvatureOptions, Estimator, FaceCurvature, Method, NoProgress, Positions, Progress, Radius, Soup, Stage, estimate,
};
use proptest::prelude::*;
use std::sync::Mutex;

/// A small irregular mesh: closed or with a border, elliptic and hyperbolic.
fn soups() -> impl Strategy<Value = Soup> {
    (any::<bool>(), any::<u64>()).prop_map(|(closed, seed)| {
        let surface = if closed { Surface::Torus { major: 3.0, minor: 1.0 } } else { Surface::Saddle };
        Grid { jitter: 0.25, seed, ..Grid::new(surface, 18, 9) }.build().soup
    })
}

fn points(soup: &Soup) -> Vec<DVec3> {
    (0..soup.positions.len()).map(|i| soup.positions.get(i)).collect()
}

fn moved(soup: &Soup, by: impl Fn(DVec3) -> DVec3) -> Soup {
    let points = points(soup).into_iter().map(|p| by(p).to_array()).collect();
    Soup::new(Positions::F64(points), soup.triangles.clone())
}

fn values(soup: &Soup) -> Vec<FaceCurvature> {
    values_of(soup, &CurvatureOptions::default())
}

/// A permutation of 0..n.
fn shuffled(n: usize, seed: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&i| (i as u64 ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(17));
    order
}

/// Values agree to `tolerance` times the curvature over a disk, turned by `turn` and scaled.
fn assert_alike(before: &[FaceCurvature], after: &[FaceCurvature], scale: f64, turn: DQuat, tolerance: f64) {
    let unlike = unlike(before, after, scale, turn, tolerance);
    assert!(unlike.is_empty(), "{unlike:?}");
}

/// The faces whose values do not agree, and how.
fn unlike(before: &[FaceCurvature], after: &[FaceCurvature], scale: f64, turn: DQuat, tolerance: f64) -> Vec<String> {
    let differs = |a: &FaceCurvature, b: &FaceCurvature| {
        let unit = 1.0 / f64::from(a.radius);
        let is_off = |a: f32, b: f32| {
            let off = (f64::from(a) - scale * f64::from(b)).abs();
            off.is_nan() || off > tolerance * unit
        };
        // Where both curvatures are alike, any direction is as good.
        let has_directions = f64::from(a.k_max - a.k_min) > 0.05 * unit;
        let cosine = (turn * a.dir_max.as_dvec3()).dot(b.dir_max.as_dvec3()).abs();
        is_off(a.k_max, b.k_max)
            || is_off(a.k_min, b.k_min)
            || a.coverage != b.coverage
            || (has_directions && cosine <= 1.0 - 1e3 * tolerance.max(1e-7))
    };
    let both = before.iter().zip(after).enumerate();
    both.filter(|(_, (a, b))| differs(a, b)).map(|(f, (a, b))| format!("face {f}: {a:?} and {b:?}")).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_order_of_faces_does_not_matter(soup in soups(), seed: u64) {
        let order = shuffled(soup.face_count(), seed);
        let mixed = Soup::new(soup.positions.clone(), order.iter().map(|&f| soup.triangles[f]).collect());
        // Sums over a disk do not know the order; those of the default's fits round by it.
        let sections = CurvatureOptions { estimator: Estimator::Osculating, ..CurvatureOptions::default() };
        let (before, after) = (values_of(&soup, &sections), values_of(&mixed, &sections));
        prop_assert_eq!(differing(order.iter().map(|&f| &before[f]), &after), 0);
        let before = values(&soup);
        let before: Vec<FaceCurvature> = order.iter().map(|&f| before[f]).collect();
        assert_alike(&before, &values(&mixed), 1.0, DQuat::IDENTITY, 1e-6);
    }

    #[test]
    fn the_order_of_vertices_does_not_matter(soup in soups(), seed: u64) {
        let order = shuffled(soup.positions.len(), seed);
        let mut number = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| number[old] = new as u32);
        let all = points(&soup);
        let mixed = Soup::new(
            Positions::F64(order.iter().map(|&v| all[v].to_array()).collect()),
            soup.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect(),
        );
        prop_assert_eq!(differing(&values(&soup), &values(&mixed)), 0);
    }

    #[test]
    fn which_corner_comes_first_does_not_matter(soup in soups(), seed: u64) {
        let turned = soup.triangles.iter().enumerate().map(|(f, t)| {
            let mut t = *t;
            t.rotate_left((seed as usize).wrapping_add(f) % 3);
            t
        });
        let turned = Soup::new(soup.positions.clone(), turned.collect());
        assert_alike(&values(&soup), &values(&turned), 1.0, DQuat::IDENTITY, 1e-6);
    }

    #[test]
    fn turning_the_mesh_turns_the_directions(soup in soups(), axis in [-1.0..1.0, -1.0..1.0, 0.1..1.0_f64], angle in 0.0..6.0_f64) {
        let turn = DQuat::from_axis_angle(DVec3::from_array(axis).normalize(), angle);
        assert_alike(&values(&soup), &values(&moved(&soup, |p| turn * p)), 1.0, turn, 1e-6);
    }

    #[test]
    fn a_million_away_nothing_changes(soup in soups(), step in [-1e6..1e6, -1e6..1e6, -1e6..1e6_f64]) {
        let moved = moved(&soup, |p| p + DVec3::from_array(step));
        // 64 bits round coordinates of a million by 1e-10, of which windows of so coarse a mesh make some ten thousand
        // times as much, and which may tip a choice between two fits that are nearly as good.
        let unlike = unlike(&values(&soup), &values(&moved), 1.0, DQuat::IDENTITY, 3e-6);
        prop_assert!(100 * unlike.len() <= soup.face_count(), "{unlike:?}");
    }

    #[test]
    fn scaling_by_s_divides_curvature_by_s(soup in soups(), exponent in -9.0..9.0_f64) {
        let scale = 10.0_f64.powf(exponent);
        assert_alike(&values(&soup), &values(&moved(&soup, |p| scale * p)), scale, DQuat::IDENTITY, 1e-6);
    }

    #[test]
    fn mirrored_winding_flips_the_signs(soup in soups()) {
        let mirrored = Soup::new(soup.positions.clone(), soup.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect());
        for (f, (a, b)) in values(&soup).iter().zip(values(&mirrored)).enumerate() {
            let unit = 1.0 / a.radius;
            prop_assert!((a.k_max + b.k_min).abs() < 1e-5 * unit && (a.k_min + b.k_max).abs() < 1e-5 * unit, "face {}", f);
        }
    }

    #[test]
    fn faces_against_the_majority_get_its_sign(soup in soups(), seed: u64) {
        let flip = |f: usize| (f as u64 ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 62 == 0;
        let mixed = soup.triangles.iter().enumerate().map(|(f, &[a, b, c])| if flip(f) { [a, c, b] } else { [a, b, c] });
        let mixed = Soup::new(soup.positions.clone(), mixed.collect());
        let expected = (0..soup.face_count()).filter(|&f| flip(f)).count();
        prop_assert_eq!(mesh_of(&mixed).report().flipped_faces, expected);
        assert_alike(&values(&soup), &values(&mixed), 1.0, DQuat::IDENTITY, 1e-6);
    }
}

#[test]
fn one_thread_or_many_give_the_same_values() {
    let soup = Grid { jitter: 0.2, ..Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 200, 100) }.build().soup;
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| values(&soup))
    };
    let one = on(1);
    for threads in [2, 3, 8] {
        assert_eq!(differing(&one, &on(threads)), 0);
    }
}

/// Above 20,000 faces, and noisy all over.
fn noisy_torus() -> Soup {
    let torus = Surface::Torus { major: 3.0, minor: 1.0 };
    Grid { jitter: 0.2, noise: 0.1, seed: 3, ..Grid::with_faces(torus, 21_000, 1.0) }.build().soup
}

#[test]
fn one_thread_or_many_give_the_same_values_under_noise() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| values(&noisy_torus()))
    };
    let one = with(1);
    assert_eq!(differing(&one, &with(3)), 0);
    let patches = one.iter().filter(|value| value.method == Method::Patches).count();
    assert!(1000 * patches >= 999 * one.len(), "{patches} of {}", one.len());
}

/// Of 21,000 faces, and without any symmetry.
fn irregular_wave(noise: f64) -> Soup {
    Grid { jitter: 0.3, noise, seed: 5, ..Grid::with_faces(Surface::Wave, 21_000, 1.0) }.build().soup
}

/// The same surface with its faces in another order, turned; and its values, brought back.
fn turned_and_shuffled(soup: &Soup, turn: DQuat, of: impl Fn(&Soup) -> Vec<FaceCurvature>) -> Vec<FaceCurvature> {
    let order = shuffled(soup.face_count(), 11);
    let triangles = order.iter().map(|&f| soup.triangles[f]).collect();
    let turned = of(&moved(&Soup::new(soup.positions.clone(), triangles), |p| turn * p));
    let mut back = turned.clone();
    order.iter().zip(turned).for_each(|(&f, value)| back[f] = value);
    back
}

#[test]
fn windows_of_noisy_surfaces_turn_with_them() {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 2.0);
    let soup = irregular_wave(0.1);
    let before = values(&soup);
    assert!(2 * before.iter().filter(|value| value.method == Method::Patches).count() > before.len());
    // Seeds are drawn by cells, and rounding moves a few faces into others.
    let unlike = unlike(&before, &turned_and_shuffled(&soup, turn, values), 1.0, turn, 1e-6);
    assert!(200 * unlike.len() <= before.len(), "{} of {}: {:?}", unlike.len(), before.len(), &unlike[..1]);
}

#[test]
fn windows_of_a_large_given_radius_turn_with_the_surface() {
    let turn = DQuat::from_axis_angle(DVec3::new(-0.3, 1.0, 0.8).normalize(), 4.0);
    let soup = irregular_wave(0.0);
    let mesh = mesh_of(&soup);
    let size = mesh.report().bounds.expect("bounds").size().max_element();
    let options = CurvatureOptions { radius: Radius::Length(0.1 * size), ..CurvatureOptions::default() };
    let values = |soup: &Soup| estimate(&mesh_of(soup), &options, &NoProgress).expect("valid options");
    let before = values(&soup);
    assert!(before.iter().all(|value| value.method == Method::Window && value.confidence > 0.0));
    let unlike = unlike(&before, &turned_and_shuffled(&soup, turn, values), 1.0, turn, 1e-6);
    assert!(200 * unlike.len() <= before.len(), "{} of {}: {:?}", unlike.len(), before.len(), &unlike[..1]);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| values(&soup))
    };
    assert_eq!(differing(&on(1), &on(3)), 0);
}

#[test]
fn progress_on_a_noisy_surface_is_told_in_small_parts_that_add_up() {
    struct Told(Mutex<Vec<u64>>);

    impl Progress for Told {
        fn begin(&self, _: Stage, _: u64) {}
        fn advance(&self, amount: u64) {
            self.0.lock().expect("no panic").push(amount);
        }
        fn end(&self) {}
    }

    let mesh = mesh_of(&noisy_torus());
    let told = Told(Mutex::default());
    estimate(&mesh, &CurvatureOptions::default(), &told).expect("valid options");
    let parts = told.0.into_inner().expect("no panic");
    assert_eq!(parts.iter().sum::<u64>(), mesh.face_count() as u64);
    let largest = parts.iter().copied().max().unwrap_or(0);
    assert!(5 * largest < mesh.face_count() as u64, "{largest}");
}

/// With one more face, far away.
fn with_a_far_face(soup: &Soup, far: f64, is_single: bool) -> Soup {
    let mut points: Vec<[f64; 3]> = points(soup).iter().map(|p| p.to_array()).collect();
    let next = points.len() as u32;
    points.extend([[far, 0.0, 0.0], [far, 0.5 * far, 0.0], [far, 0.0, 0.5 * far]]);
    let triangles = soup.triangles.iter().copied().chain([[next, next + 1, next + 2]]).collect();
    match is_single {
        true => Soup::new(Positions::F32(points.iter().map(|p| p.map(|x| x as f32)).collect()), triangles),
        false => Soup::new(Positions::F64(points), triangles),
    }
}

#[test]
fn a_face_far_away_changes_nothing() {
    let torus = Grid { jitter: 0.2, ..Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 60, 30) }.build().soup;
    let before = values(&torus);
    for (far, is_single, tolerance) in [(1e7, true, 1e-3), (1e30, true, 1e-3), (1e7, false, 1e-6), (1e9, false, 1e-6)] {
        let after = values(&with_a_far_face(&torus, far, is_single));
        for (f, (a, b)) in before.iter().zip(&after).enumerate() {
            assert!((a.k_max - b.k_max).abs() < tolerance && (a.k_min - b.k_min).abs() < tolerance, "{far} {f}");
            assert!(b.confidence > 0.9, "{far} {f}: {}", b.confidence);
        }
    }
}

#[test]
fn a_face_far_away_leaves_a_noisy_surface_its_windows() {
    let torus = noisy_torus();
    let after = values(&with_a_far_face(&torus, 1e8, false));
    let mut errors: Vec<f32> = after[..torus.face_count()].iter().map(|v| (v.k_max - 1.0).abs()).collect();
    errors.sort_by(f32::total_cmp);
    assert!(errors[errors.len() / 2] < 0.02, "{}", errors[errors.len() / 2]);
}

/// In 32 bits, half a unit is all that coordinates of millions tell.
#[test]
fn flats_that_rounding_makes_have_no_confidence() {
    let torus = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 60, 30).build().soup;
    let far = points(&torus).iter().map(|p| (*p + 5.4e6).as_vec3().to_array()).collect();
    let found = values(&Soup::new(Positions::F32(far), torus.triangles));
    assert!(found.iter().all(|v| v.k_max != 0.0 || v.confidence < 0.1));
}

#[test]
fn a_soup_of_loose_triangles_is_the_same_mesh() {
    let soup = Grid::new(Surface::Saddle, 12, 12).build().soup;
    let loose: Vec<[f64; 3]> =
        soup.triangles.as_flattened().iter().map(|&v| soup.positions.get(v as usize).to_array()).collect();
    let triangles = (0..soup.face_count() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    assert_eq!(differing(&values(&soup), &values(&Soup::new(Positions::F64(loose), triangles))), 0);
}

/// A copy of a face gets the values of the first and does not open the mesh around it.
#[test]
fn defects_leave_the_rest_of_the_mesh_alone() {
    let soup = Grid::new(Surface::Saddle, 12, 12).build().soup;
    let clean = values(&soup);
    let mut spoilt = soup.clone();
    let mut points: Vec<[f64; 3]> = points(&soup).iter().map(|p| p.to_array()).collect();
    points.push([f64::NAN, 0.0, 0.0]);
    let bad = points.len() as u32 - 1;
    let copy = soup.triangles[100];
    spoilt.triangles.extend([[copy[0], copy[2], copy[1]], [copy[0], copy[0], copy[1]], [copy[0], copy[1], bad]]);
    let spoilt = Soup::new(Positions::F64(points), spoilt.triangles);
    let found = values(&spoilt);
    let n = clean.len();
    assert_eq!(differing(&found[..n], &clean), 0);
    assert_eq!(common::bits(&found[n]), common::bits(&clean[100]));
    assert!(!found[n + 1].is_estimated() && !found[n + 2].is_estimated());
    let report = mesh_of(&spoilt).report().clone();
    assert_eq!((report.duplicate_faces, report.degenerate_faces, report.non_finite_faces), (1, 1, 1));
}

/// Found by a fuzzer: curvature of 1e38 and more overflowed to infinity in a face that was said to be
/// estimated.
#[test]
fn curvature_beyond_32_bits_is_no_estimate() {
    for (exponent, estimated) in [(-18, true), (-21, false), (-38, false), (-42, false)] {
        let grid = Grid::new(Surface::Sphere { radius: 10_f64.powi(exponent) }, 16, 8);
        for value in values_of(&grid.build().soup, &CurvatureOptions::default()) {
            assert_eq!(value.is_estimated(), estimated, "radius 1e{exponent}: {value:?}");
            assert!(!estimated || (value.gauss().is_finite() && value.k_max.is_finite()), "{value:?}");
        }
    }
}

/// A grid with noise upright to it, and a triangle far away.
fn rough_grid(far: f64) -> Soup {
    let mut soup = Grid { jitter: 0.2, ..Grid::new(Surface::Saddle, 20, 20) }.build().soup;
    let mut points: Vec<[f64; 3]> = points(&soup).iter().map(|p| p.to_array()).collect();
    for (i, p) in points.iter_mut().enumerate() {
        p[2] += 1e-3 * ((i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / f64::from(1_u32 << 24);
    }
    let first = points.len() as u32;
    points.extend([[far, 0.0, 0.0], [far, 1.0, 0.0], [far, 0.0, 1.0]]);
    soup.triangles.push([first, first + 1, first + 2]);
    Soup::new(Positions::F64(points), soup.triangles)
}

/// All other faces then lie in few cells of the curve that orders them.
#[test]
fn the_order_of_faces_does_not_matter_beside_an_outlier() {
    for far in [1e3, 1e6, 1e9] {
        let soup = rough_grid(far);
        let order = shuffled(soup.face_count(), 7);
        let mixed = Soup::new(soup.positions.clone(), order.iter().map(|&f| soup.triangles[f]).collect());
        let before = values(&soup);
        let before: Vec<FaceCurvature> = order.iter().map(|&f| before[f]).collect();
        assert_alike(&before, &values(&mixed), 1.0, DQuat::IDENTITY, 1e-6);
    }
}

/// Curvatures of such meshes leave the range of 32-bit numbers, the meshes do not.
#[test]
fn very_small_and_very_large_meshes_are_estimated() {
    let soup = rough_grid(3.0);
    let given = |length| CurvatureOptions { radius: Radius::Length(length), ..CurvatureOptions::default() };
    let within = values_of(&soup, &given(0.4));
    for exponent in [-60, -41, -40, -39, -15, 15, 22, 30] {
        let scale = 10.0_f64.powi(exponent);
        let scaled = moved(&soup, |p| scale * p);
        let found = values(&scaled);
        assert_eq!(found.len(), soup.face_count());
        // Squares of curvatures beyond 32-bit numbers are none.
        if (-15..=30).contains(&exponent) {
            let middle = 400;
            let found = values_of(&scaled, &given(0.4 * scale))[middle];
            let (found, wanted) = (scale * f64::from(found.k_max), f64::from(within[middle].k_max));
            assert!((found - wanted).abs() <= 1e-3 * wanted.abs(), "1e{exponent}: {found} instead of {wanted}");
        }
    }
}
