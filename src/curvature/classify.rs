//! The paper's five classes of faces.

/// The class of a face; the discriminant is the code in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[repr(i8)]
pub enum FaceClass {
    /// The face has no estimate.
    NotEstimated = -1,
    /// No curvature in any direction.
    Flat = 0,
    /// Curved in one direction only, as a cylinder.
    Parabolic = 1,
    /// Curved to the same side in all directions, as an egg.
    Elliptic = 2,
    /// Curved alike in all directions, as a sphere.
    Umbilic = 3,
    /// Curved to both sides, as a saddle.
    Hyperbolic = 4,
}

impl FaceClass {
    /// All classes, by code.
    pub const ALL: [FaceClass; 6] = [
        FaceClass::NotEstimated,
        FaceClass::Flat,
        FaceClass::Parabolic,
        FaceClass::Elliptic,
        FaceClass::Umbilic,
        FaceClass::Hyperbolic,
    ];

    /// Classifies by curvature times radius, the angle by which the surface turns over the disk:
    /// what is at most `tolerance` (radians) counts as zero.
    pub fn of(k_max: f64, k_min: f64, radius: f64, tolerance: f64) -> Self {
        let (max, min) = (k_max * radius, k_min * radius);
        let is_zero = |turn: f64| turn.abs() <= tolerance;
        match (is_zero(max), is_zero(min)) {
            _ if max.is_nan() || min.is_nan() => FaceClass::NotEstimated,
            (true, true) => FaceClass::Flat,
            _ if is_zero(max - min) => FaceClass::Umbilic,
            (true, false) | (false, true) => FaceClass::Parabolic,
            (false, false) if (max > 0.0) == (min > 0.0) => FaceClass::Elliptic,
            (false, false) => FaceClass::Hyperbolic,
        }
    }

    /// The code in files: -1 to 4.
    pub fn code(self) -> i8 {
        self as i8
    }

    /// The class's name, as in messages and in [`Condition`](crate::Condition)s, there with `_` for the space.
    pub fn name(self) -> &'static str {
        match self {
            FaceClass::NotEstimated => "not estimated",
            FaceClass::Flat => "flat",
            FaceClass::Parabolic => "parabolic",
            FaceClass::Elliptic => "elliptic",
            FaceClass::Umbilic => "umbilic",
            FaceClass::Hyperbolic => "hyperbolic",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_follow_signs_and_do_not_depend_on_scale() {
        let cases = [
            (0.01, -0.01, FaceClass::Flat),
            (1.0, 0.01, FaceClass::Parabolic),
            (0.01, -1.0, FaceClass::Parabolic),
            (1.0, 0.5, FaceClass::Elliptic),
            (-0.5, -1.0, FaceClass::Elliptic),
            (1.0, 0.99, FaceClass::Umbilic),
            (1.0, -1.0, FaceClass::Hyperbolic),
            (f64::NAN, 0.0, FaceClass::NotEstimated),
        ];
        for (k_max, k_min, class) in cases {
            for scale in [1e-6, 1.0, 1e6] {
                assert_eq!(FaceClass::of(k_max / scale, k_min / scale, scale, 0.05), class);
            }
        }
    }
}
