//! Parts as CAD programs mesh them: long facets from rim to rim between fine corners, large flats without inner
//! vertices.

mod common;

use common::{mesh_of, values_of};
use glam::{DQuat, DVec3, EulerRot};
use osculate::synth::{Grid, RoundedBox, Surface};
use osculate::{CurvatureOptions, Face, FaceCurvature, FaceState, Mesh, Method, NoProgress, Positions, Soup};
use std::collections::HashSet;
use std::path::Path;

/// The surfaces of `fixtures/fillet_part.stl`: a block of 40 x 30 x 20 with a hole of radius 5, upright edges rounded
/// with radius 6, the others with 4, where they meet parts of tori.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Flat,
    Hole,
    Upright,
    Edge,
    Corner,
}

impl Part {
    /// By the corners of a face.
    fn of(triangle: [DVec3; 3]) -> Self {
        const NEAR: f64 = 1e-3;
        let all = |is: &dyn Fn(DVec3) -> bool| triangle.iter().all(|p| is(p.abs()));
        let (x, y, z) = (14.0, 9.0, 6.0);
        let is_near = |a: f64, b: f64| (a - b).abs() < NEAR;
        if all(&|p| is_near(p.x.hypot(p.y), 5.0)) {
            Part::Hole
        } else if all(&|p| is_near(p.x, 20.0)) || all(&|p| is_near(p.y, 15.0)) || all(&|p| is_near(p.z, 10.0)) {
            Part::Flat
        } else if all(&|p| is_near((p.x - x).hypot(p.y - y), 6.0) && p.z <= z + NEAR) {
            Part::Upright
        } else if all(&|p| is_near((p.y - 11.0).hypot(p.z - z), 4.0) && p.x <= x + NEAR)
            || all(&|p| is_near((p.x - 16.0).hypot(p.z - z), 4.0) && p.y <= y + NEAR)
        {
            Part::Edge
        } else {
            Part::Corner
        }
    }

    /// k_max and k_min, where all of a part has the same.
    fn exact(self) -> Option<[f64; 2]> {
        match self {
            Part::Flat => Some([0.0, 0.0]),
            Part::Hole => Some([0.0, -0.2]),
            Part::Upright => Some([1.0 / 6.0, 0.0]),
            Part::Edge => Some([0.25, 0.0]),
            Part::Corner => None,
        }
    }
}

fn fixture(name: &str) -> Soup {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    osculate::read(&path, &NoProgress).expect("a fixture").0
}

fn fillet_part() -> Soup {
    fixture("fillet_part.stl")
}

/// Checks all values of the part; `triangle` gives the corners of a face in the part's own axes.
fn check(mesh: &Mesh, values: &[FaceCurvature], triangle: impl Fn(Face) -> [DVec3; 3]) {
    let (mut corners, mut wrong) = (0, 0);
    for (f, v) in (0..).map(Face).zip(values).filter(|(f, _)| mesh.face_state(*f) == FaceState::Sound) {
        let part = Part::of(triangle(f));
        if let Some([k_max, k_min]) = part.exact() {
            let error = (f64::from(v.k_max) - k_max).abs().max((f64::from(v.k_min) - k_min).abs());
            assert!(error < 0.01 * 0.25, "{part:?} {f:?} {v:?}");
        } else {
            corners += 1;
            wrong += usize::from((f64::from(v.k_max) - 0.25).abs() > 0.025);
        }
    }
    // The corners' other curvature varies, and patches of two vertices by three do not determine it.
    assert!(corners > 2500 && wrong * 50 < corners, "{wrong} of {corners} corner faces");
}

#[test]
fn fillets_flats_and_holes_of_a_part_come_out_to_a_hundredth() {
    let mesh = mesh_of(&fillet_part());
    let values = osculate::estimate(&mesh, &CurvatureOptions::default(), &NoProgress).expect("valid options");
    check(&mesh, &values, |f| mesh.triangle(f).map(|p| p + mesh.origin()));
    let count = |method: Method| values.iter().filter(|v| v.method == method).count();
    assert!(count(Method::Strip) > 200 && count(Method::Flat) > 100, "the fixture no longer asks for them");
}

#[test]
fn it_does_not_matter_how_the_part_lies() {
    let soup = fillet_part();
    let original = mesh_of(&soup);
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.4, 1.1, -0.3);
    let points: Vec<DVec3> = (0..soup.positions.len()).map(|v| turn * soup.positions.get(v)).collect();
    // As an STL file has them, and as an OBJ file with six digits behind the point.
    let single = points.iter().map(|p| p.as_vec3().to_array()).collect();
    let decimal = points.iter().map(|p| ((p * 1e6).round() / 1e6).to_array()).collect();
    for positions in [Positions::F32(single), Positions::F64(decimal)] {
        let values = values_of(&Soup::new(positions, soup.triangles.clone()), &CurvatureOptions::default());
        check(&original, &values, |f| original.triangle(f).map(|p| p + original.origin()));
    }
}

/// A block with rounded edges, meshed evenly: at the line where a fillet runs out, windows hold a flat and one or two rows
/// of the fillet, which any surface of two sheets explains.
#[test]
fn fillets_of_few_cells_do_not_bend_into_flats_nor_flats_into_them() {
    let share_wrong = |flat_cells, fillet_cells| {
        let size = DVec3::new(4.0, 3.0, 2.0);
        let block = RoundedBox { size, fillet: 0.5, flat_cells, fillet_cells, noise: 0.0, seed: 0 }.build();
        let values = values_of(&block.soup, &CurvatureOptions::default());
        let is_off = |a: f32, b: f64| (f64::from(a) - b).abs() > 0.1 * 2.0;
        let off = values.iter().zip(&block.exact).filter(|(v, e)| is_off(v.k_max, e.k_max) || is_off(v.k_min, e.k_min));
        off.count() as f64 / values.len() as f64
    };
    // Cells across half a fillet; corners of two are still off.
    for (flat_cells, fillet_cells, most) in [(21, 4, 0.01), (12, 4, 0.01), (16, 3, 0.01), (8, 3, 0.02), (16, 2, 0.15)] {
        let share = share_wrong(flat_cells, fillet_cells);
        assert!(share <= most, "{flat_cells} x {fillet_cells}: {share}");
    }
}

/// A fillet that runs out into another one which bends the other way, with a flat between or without: nothing bends as both.
#[test]
fn two_fillets_of_opposite_signs_are_told_apart() {
    const ROW: f64 = std::f64::consts::PI / 18.0;
    let chord = 2.0 * (0.5 * ROW).sin();
    for rows in [4, 6] {
        let bends = [(0.0, 6), (1.0, rows), (0.0, 2), (-1.0, rows), (0.0, 6)];
        let bends: Vec<f64> = bends.into_iter().flat_map(|(k, cells)| std::iter::repeat_n(k, cells)).collect();
        let mut profile = vec![DVec3::ZERO];
        let mut angle = 0.0_f64;
        for k in &bends {
            let middle = angle - 0.5 * k * ROW;
            profile.push(profile[profile.len() - 1] + chord * DVec3::new(middle.cos(), 0.0, middle.sin()));
            angle -= k * ROW;
        }
        let (across, along) = (profile.len() as u32, 24);
        let vertex = |j: u32, p: &DVec3| [p.x, f64::from(j) * chord, p.z];
        let points = (0..=along).flat_map(|j| profile.iter().map(move |p| vertex(j, p))).collect();
        let cell = |a: u32| [[a, a + 1, a + across + 1], [a, a + across + 1, a + across]];
        let faces = (0..along).flat_map(|j| (0..across - 1).flat_map(move |i| cell(j * across + i))).collect();
        let values = values_of(&Soup::new(Positions::F64(points), faces), &CurvatureOptions::default());
        let mut off = 0;
        for (f, value) in values.iter().enumerate() {
            let k = bends[f / 2 % bends.len()];
            let larger = if value.k_max >= -value.k_min { value.k_max } else { value.k_min };
            assert!(k * f64::from(larger) >= -1e-6 || value.confidence < 0.5, "face {f}: {larger} instead of {k}");
            off += usize::from((f64::from(larger) - k).abs() > 0.1);
        }
        assert!(off as f64 <= 0.06 * values.len() as f64, "{rows} rows: {off} of {}", values.len());
    }
}

/// Tessellators leave slivers without an area in the seams of flats.
#[test]
fn slivers_in_a_flat_do_not_bend_it() {
    let soup = fillet_part();
    let mut points: Vec<[f64; 3]> = (0..soup.positions.len()).map(|v| soup.positions.get(v).to_array()).collect();
    let mut faces = soup.triangles;
    // Seams of flats get a vertex in the middle, and a sliver there.
    let key = |p: DVec3, q: DVec3| {
        let [p, q] = [p, q].map(|p| p.to_array().map(f64::to_bits));
        if p < q { [p, q] } else { [q, p] }
    };
    let (mut seen, mut split) = (HashSet::new(), 0);
    for f in 0..faces.len() {
        let corners = faces[f].map(|v| DVec3::from(points[v as usize]));
        if Part::of(corners) != Part::Flat {
            continue;
        }
        let seams: Vec<usize> = (0..3).filter(|&i| !seen.insert(key(corners[i], corners[(i + 1) % 3]))).collect();
        if let Some(&i) = seams.iter().find(|&&i| corners[i].distance(corners[(i + 1) % 3]) > 10.0) {
            let (a, b, c) = (faces[f][i], faces[f][(i + 1) % 3], faces[f][(i + 2) % 3]);
            let middle = points.len() as u32;
            points.push(corners[i].midpoint(corners[(i + 1) % 3]).to_array());
            faces[f] = [a, middle, c];
            faces.extend([[middle, b, c], [a, b, middle]]);
            split += 1;
        }
    }
    assert!(split > 4, "{split}");
    let single = points.into_iter().map(|p| p.map(|c| c as f32)).collect();
    let mesh = mesh_of(&Soup::new(Positions::F32(single), faces));
    let values = osculate::estimate(&mesh, &CurvatureOptions::default(), &NoProgress).expect("valid options");
    for (f, v) in (0..).map(Face).zip(values).filter(|(f, _)| mesh.face_state(*f) == FaceState::Sound) {
        let is_sliver = mesh.least_height(f) < 1e-4;
        if !is_sliver && Part::of(mesh.triangle(f).map(|p| p + mesh.origin())) == Part::Flat {
            assert!(v.k_max.abs() < 0.0025 && v.k_min.abs() < 0.0025, "{f:?} {v:?}");
        }
    }
}

/// A cylinder of one row of long facets whose ends are closed by fine half-spheres.
#[test]
fn a_capsule_is_a_cylinder_between_two_spheres() {
    let (around, rows, half) = (24, 12, 10.0);
    let mut points: Vec<[f64; 3]> = Vec::new();
    for row in 0..=2 * rows + 1 {
        // From pole to pole, the equator twice: once at either end of the cylinder.
        let (step, end) = if row <= rows { (row, half) } else { (row - 1, -half) };
        let polar = std::f64::consts::PI * f64::from(step) / f64::from(2 * rows);
        for i in 0..around {
            let turn = std::f64::consts::TAU * f64::from(i) / f64::from(around);
            points.push([polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos() + end]);
        }
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    let mut is_side = Vec::new();
    for row in 0..=2 * rows {
        for i in 0..around {
            let [a, b] = [i, (i + 1) % around].map(|i| (row * around + i) as u32);
            let [c, d] = [a, b].map(|v| v + around as u32);
            for face in [[a, c, d], [a, d, b]] {
                let [p, q, r] = face.map(|v| DVec3::from(points[v as usize]));
                if (q - p).cross(r - p).length() > 1e-12 {
                    faces.push(face);
                    is_side.push(row == rows);
                }
            }
        }
    }
    let values = values_of(&Soup::new(Positions::F64(points), faces), &CurvatureOptions::default());
    for (v, is_side) in values.iter().zip(is_side) {
        let expected = if is_side { 0.0 } else { 1.0 };
        assert!((v.k_max - 1.0).abs() < 1e-3 && (v.k_min - expected).abs() < 1e-3, "{is_side} {v:?}");
    }
}

/// The facets of a torus may be long as well, but it bends along them.
#[test]
fn long_facets_of_a_torus_are_no_strips() {
    let torus = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 48, 96).build();
    let values = values_of(&torus.soup, &CurvatureOptions::default());
    for (v, e) in values.iter().zip(&torus.exact) {
        assert!(v.method == Method::Fit && (f64::from(v.k_min) - e.k_min).abs() < 0.01, "{v:?} {e:?}");
    }
}

#[test]
fn sharp_edges_of_a_coarse_model_are_meant_and_not_noise() {
    // More than half of the faces of this head are doubtful. Those that sharp edges cut off from the others still have
    // the sections of their own disks, and no windows over the edges.
    let values = values_of(&fixture("suzanne.stl"), &CurvatureOptions::default());
    let by = |method: Method| values.iter().filter(|value| value.method == method).count();
    assert!(2 * by(Method::Patches) > values.len(), "{}", by(Method::Patches));
    assert!(by(Method::Sections) > 150, "{}", by(Method::Sections));
}

/// An octahedron has too few vertices for windows and for fits: with a radius or without, it gets the same sections.
#[test]
fn what_a_radius_says_nothing_of_has_the_value_it_has_without() {
    let corners =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    let soup = Soup::new(Positions::F64(corners.to_vec()), faces.to_vec());
    let round = osculate::MeshOptions { feature_angle: 180.0, ..Default::default() };
    let mesh = Mesh::from_soup(&soup, &round).expect("a mesh");
    let of = |radius: osculate::Radius| {
        let options = CurvatureOptions { radius, ..CurvatureOptions::default() };
        osculate::estimate(&mesh, &options, &NoProgress).expect("an estimate")
    };
    let free = of(osculate::Radius::Auto);
    assert!(free.iter().all(|value| value.method == Method::Sections && value.k_min > 0.0), "{free:?}");
    for radius in [osculate::Radius::FaceFactor(0.5), osculate::Radius::Length(0.3), osculate::Radius::MeshFactor(0.7)]
    {
        assert_eq!(common::differing(&of(radius), &free), 0, "{radius:?}");
    }
}
