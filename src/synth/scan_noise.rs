//! Noise as a range scanner makes it: along the view, alike at neighbouring points, in steps.

use super::random::Random;
use super::{Synthetic, mean_edge};
use crate::soup::{Positions, Soup};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Waves that make up the random field; its values are normal to within a few percent.
const WAVES: usize = 64;

/// Distance, in mean edges, over which the field's correlation falls to exp(-1/2), as a Gaussian:
/// 0.8 between neighbours, a half at 1.8 edges, 0.03 at 4.
const CORRELATION_LENGTH: f64 = 1.5;

/// Steps of the depth, in standard deviations.
const STEP: f64 = 0.5;

/// Errors of depth as in a range image. Every vertex moves along the view direction by a smooth
/// random function of its place in the image plane, and its depth is then rounded to steps of half a
/// standard deviation.
///
/// Neighbouring vertices move alike: the correlation falls to a half over 1.8 mean edges. This is
/// harder for an estimator than displacements that do not know of each other
/// ([`Grid::noise`](super::Grid::noise)), since they look like detail of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanNoise {
    /// Standard deviation, in mean edges; 0 for none.
    pub deviation: f64,
    /// Direction in which the scanner looked, of any length but 0.
    pub view: DVec3,
    /// Chooses the random numbers.
    pub seed: u64,
}

impl ScanNoise {
    /// The mesh as a scanner would see it. Exact values stay those of the surface without noise.
    pub fn apply(&self, synthetic: Synthetic) -> Synthetic {
        let Synthetic { soup, exact } = synthetic;
        let points = points(&soup);
        let edge = mean_edge(&points, &soup.triangles);
        let deviation = self.deviation * edge;
        let view = self.view.normalize_or_zero();
        let moves = deviation > 0.0 && deviation.is_finite() && view != DVec3::ZERO;
        if !moves {
            return Synthetic { soup, exact };
        }
        let (right, up) = view.any_orthonormal_pair();
        let field = Field::new(CORRELATION_LENGTH * edge, self.seed);
        let step = STEP * deviation;
        let seen = |p: DVec3| {
            let depth = p.dot(view);
            let error = deviation * field.at(DVec2::new(p.dot(right), p.dot(up)));
            p + (in_steps(depth + error, step) - depth) * view
        };
        let points = points.into_iter().map(|p| seen(p).to_array()).collect();
        Synthetic { soup: Soup::new(Positions::F64(points), soup.triangles), exact }
    }
}

/// The multiple of `step` nearest to a depth; the depth itself where steps are finer than its digits.
fn in_steps(depth: f64, step: f64) -> f64 {
    let steps = depth / step;
    if steps.abs() < 1.0 / f64::EPSILON { steps.round() * step } else { depth }
}

fn points(soup: &Soup) -> Vec<DVec3> {
    (0..soup.positions.len()).map(|v| soup.positions.get(v)).collect()
}

/// A smooth random function of the plane with mean 0, deviation 1 and correlation
/// exp(-d^2 / (2 length^2)): plane waves whose frequencies follow that function's transform.
struct Field {
    waves: Vec<(DVec2, f64)>,
}

impl Field {
    fn new(length: f64, seed: u64) -> Self {
        // Another stream than those of jitter and noise.
        let mut random = Random::new(seed ^ 0x5ca9_5ca9_5ca9_5ca9);
        let wave = |_| {
            let frequency = DVec2::new(random.normal(), random.normal()) / length;
            (frequency, PI * random.signed())
        };
        Field { waves: (0..WAVES).map(wave).collect() }
    }

    fn at(&self, p: DVec2) -> f64 {
        let sum: f64 = self.waves.iter().map(|(frequency, phase)| (frequency.dot(p) + phase).cos()).sum();
        sum * (2.0 / WAVES as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Grid, Surface};
    use super::*;

    fn clean() -> Synthetic {
        Grid { jitter: 0.2, ..Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, 5000, 1.0) }.build()
    }

    fn noise(seed: u64) -> ScanNoise {
        ScanNoise { deviation: 0.1, view: DVec3::new(1.0, -2.0, 0.5), seed }
    }

    fn edge(synthetic: &Synthetic) -> f64 {
        mean_edge(&points(&synthetic.soup), &synthetic.soup.triangles)
    }

    fn moved(from: &Synthetic, to: &Synthetic) -> Vec<DVec3> {
        points(&to.soup).iter().zip(points(&from.soup)).map(|(a, b)| a - b).collect()
    }

    #[test]
    fn vertices_move_along_the_view_by_the_deviation() {
        let (before, after) = (clean(), noise(1).apply(clean()));
        let (view, h) = (noise(1).view.normalize(), edge(&before));
        let moved = moved(&before, &after);
        assert!(moved.iter().all(|m| m.reject_from(view).length() < 1e-12));
        let deviation = (moved.iter().map(|m| m.length_squared()).sum::<f64>() / moved.len() as f64).sqrt();
        assert!((deviation / (0.1 * h) - 1.0).abs() < 0.15, "{}", deviation / h);
        assert_eq!((&after.exact, &after.soup.triangles), (&before.exact, &before.soup.triangles));
    }

    #[test]
    fn neighbours_move_alike_and_distant_points_do_not() {
        let (before, after) = (clean(), noise(2).apply(clean()));
        let view = noise(2).view.normalize();
        let moved: Vec<f64> = moved(&before, &after).iter().map(|m| m.dot(view)).collect();
        let square = moved.iter().map(|m| m * m).sum::<f64>() / moved.len() as f64;
        let sides = before.soup.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
        let near: Vec<f64> = sides.map(|(a, b)| moved[a as usize] * moved[b as usize]).collect();
        let near = near.iter().sum::<f64>() / near.len() as f64 / square;
        let far = moved.iter().zip(moved.iter().skip(moved.len() / 4)).map(|(a, b)| a * b).sum::<f64>();
        let far = far / (0.75 * moved.len() as f64) / square;
        assert!(near > 0.7 && far.abs() < 0.15, "{near} {far}");
    }

    #[test]
    fn depths_are_multiples_of_half_a_deviation() {
        let (before, after) = (clean(), noise(3).apply(clean()));
        let step = 0.05 * edge(&before);
        let view = noise(3).view.normalize();
        for p in points(&after.soup) {
            let steps = p.dot(view) / step;
            assert!((steps - steps.round()).abs() < 1e-6, "{steps}");
        }
    }

    #[test]
    fn noise_below_the_digits_changes_no_more_than_them() {
        for deviation in [1e-320, 1e-30] {
            let after = ScanNoise { deviation, ..noise(6) }.apply(clean());
            assert!(moved(&clean(), &after).iter().all(|m| m.length() < 1e-14), "{deviation}");
        }
    }

    #[test]
    fn the_seed_chooses_the_noise_and_none_changes_nothing() {
        let offsets = |s: &Synthetic| moved(&clean(), s);
        let first = offsets(&noise(4).apply(clean()));
        assert_eq!(first, offsets(&noise(4).apply(clean())));
        assert_ne!(first, offsets(&noise(5).apply(clean())));
        let none = ScanNoise { deviation: 0.0, ..noise(4) }.apply(clean());
        assert!(offsets(&none).iter().all(|m| *m == DVec3::ZERO));
    }
}
