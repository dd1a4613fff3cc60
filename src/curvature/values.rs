//! The values of one face.

use super::{FaceClass, Method};
use glam::Vec3;

/// The curvature of one face, in the input's axes and units.
///
/// Kept in 32 bits, as every file that carries it does: the rounding of 6e-8 is far below any
/// estimate's error. Formulas, units and signs: `docs/quantities.md`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCurvature {
    /// Largest normal curvature, 1/length; positive where the surface bends away from its normal.
    pub k_max: f32,
    /// Smallest normal curvature, at most `k_max`.
    pub k_min: f32,
    /// Unit tangent in which the curvature is `k_max`; its sign means nothing.
    pub dir_max: Vec3,
    /// Unit tangent in which the curvature is `k_min`: normal x `dir_max`.
    pub dir_min: Vec3,
    /// Gaussian curvature from the disk's perimeter, 1/length^2; NaN where no sector of the disk
    /// is whole.
    pub gauss_perimeter: f32,
    /// Largest distance of what the values come from: length of the disk's legs, or radius of the
    /// window.
    pub radius: f32,
    /// Share of the legs that reached the radius; for a window, share of its vertices that lie on no border
    /// and no sharp edge. 0 to 1.
    pub coverage: f32,
    /// How far to trust the values, 0 to 1: falls as the expected error grows. Faces sorted by it are
    /// sorted by error on average, see `docs/estimator.md`.
    pub confidence: f32,
    /// Where the values come from.
    pub method: Method,
    /// Class of the face.
    pub class: FaceClass,
}

impl FaceCurvature {
    /// What a face without estimate carries: NaN curvatures, zero directions, class -1.
    pub const NOT_ESTIMATED: FaceCurvature = FaceCurvature {
        k_max: f32::NAN,
        k_min: f32::NAN,
        dir_max: Vec3::ZERO,
        dir_min: Vec3::ZERO,
        gauss_perimeter: f32::NAN,
        radius: f32::NAN,
        coverage: 0.0,
        confidence: 0.0,
        method: Method::None,
        class: FaceClass::NotEstimated,
    };

    /// The value, unless it cannot be written: of a face smaller than 1e-19 the square of a curvature may be more than
    /// 32 bits can hold.
    pub(super) fn within_32_bits(self) -> Self {
        let is_finite = (self.k_max * self.k_max).is_finite() && (self.k_min * self.k_min).is_finite();
        if is_finite { self } else { FaceCurvature::NOT_ESTIMATED }
    }

    /// True when the face has an estimate.
    pub fn is_estimated(&self) -> bool {
        self.class != FaceClass::NotEstimated
    }

    /// (k_max + k_min) / 2, 1/length.
    pub fn mean(&self) -> f32 {
        (0.5 * (f64::from(self.k_max) + f64::from(self.k_min))) as f32
    }

    /// k_max k_min, 1/length^2.
    pub fn gauss(&self) -> f32 {
        (f64::from(self.k_max) * f64::from(self.k_min)) as f32
    }

    /// (2 / pi) atan2(k_max + k_min, k_max - k_min), -1 (cup) to 1 (cap); 0 for a plane.
    pub fn shape_index(&self) -> f32 {
        let (max, min) = (f64::from(self.k_max), f64::from(self.k_min));
        (std::f64::consts::FRAC_2_PI * (max + min).atan2(max - min)) as f32
    }

    /// sqrt((k_max^2 + k_min^2) / 2), 1/length.
    pub fn curvedness(&self) -> f32 {
        (f64::from(self.k_max).hypot(f64::from(self.k_min)) * std::f64::consts::FRAC_1_SQRT_2) as f32
    }
}
