//! What several tests need.
#![allow(dead_code, reason = "each test file uses its own share")]

use osculate::synth::{Exact, Grid, Synthetic};
use osculate::{CurvatureOptions, FaceCurvature, Mesh, MeshOptions, NoProgress, Soup, estimate};

/// A mesh that has passed its sanity check.
pub(crate) fn mesh_of(soup: &Soup) -> Mesh {
    let mesh = Mesh::from_soup(soup, &MeshOptions::default()).expect("a mesh");
    mesh.sanity_check();
    mesh
}

/// Curvature of all faces of a soup.
pub(crate) fn values_of(soup: &Soup, options: &CurvatureOptions) -> Vec<FaceCurvature> {
    estimate(&mesh_of(soup), options, &NoProgress).expect("valid options")
}

/// Curvature of a synthetic mesh and the exact one.
pub(crate) fn synthetic(grid: &Grid, options: &CurvatureOptions) -> (Vec<FaceCurvature>, Vec<Exact>) {
    let Synthetic { soup, exact } = grid.build();
    (values_of(&soup, options), exact)
}

/// The larger absolute principal curvature of a face.
pub(crate) fn size(exact: &Exact) -> f64 {
    exact.k_max.abs().max(exact.k_min.abs())
}

/// A percentile of errors, in percent.
pub(crate) fn percentile(errors: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut errors: Vec<f64> = errors.collect();
    errors.sort_by(f64::total_cmp);
    100.0 * errors[((errors.len() - 1) as f64 * share).round() as usize]
}

/// All of a face's values as bits, so that a missing value equals a missing value.
pub(crate) fn bits(of: &FaceCurvature) -> Vec<u32> {
    let scalars = [of.k_max, of.k_min, of.gauss_perimeter, of.radius, of.coverage, of.confidence];
    let numbers = scalars.into_iter().chain(of.dir_max.to_array()).chain(of.dir_min.to_array());
    numbers.map(f32::to_bits).chain([of.class.code() as u32, of.method as u32]).collect()
}

/// The number of faces whose values differ in any bit, of as many on both sides.
pub(crate) fn differing<'v>(
    a: impl IntoIterator<Item = &'v FaceCurvature>,
    b: impl IntoIterator<Item = &'v FaceCurvature>,
) -> usize {
    let (a, b): (Vec<_>, Vec<_>) = (a.into_iter().collect(), b.into_iter().collect());
    assert!(!a.is_empty() && a.len() == b.len(), "{} faces beside {}", a.len(), b.len());
    a.into_iter().zip(b).filter(|(a, b)| bits(a) != bits(b)).count()
}
