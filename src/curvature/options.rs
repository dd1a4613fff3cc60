//! Settings of the estimation.

use crate::error::Error;
use crate::mesh::Mesh;
use crate::wording::short;

/// How curvature is estimated: from windows of vertices, or read off the diameters of a disk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Estimator {
    /// Surfaces fitted to windows of vertices, of the kind and size that explain them best; sections
    /// where vertices carry no fit. `docs/estimator.md` has the rules.
    #[default]
    Auto,
    /// Formula (1) of the paper, solved exactly: the circle with the diameter's chord and arc.
    Osculating,
    /// Formula (1) as printed: the third-order expansion.
    Osculating3,
    /// Formula (2): turning of the tangent over arc length, averaged over the radii up to r_g.
    Tangent,
}

impl Estimator {
    /// The name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Estimator::Auto => "auto",
            Estimator::Osculating => "osculating",
            Estimator::Osculating3 => "osculating3",
            Estimator::Tangent => "tangent",
        }
    }
}

/// How the radius of windows, or the length of a disk's legs, is chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Radius {
    /// This many times the mean edge length of the face itself (the paper's choice).
    FaceFactor(f64),
    /// This many times the mean edge length of the whole mesh.
    MeshFactor(f64),
    /// A length in file units.
    Length(f64),
    /// By the face's surroundings. Windows are as large as the data let them be. Legs are long enough that sections
    /// have some segments to bend at, and short enough that the surface turns by less than about a radian over them.
    #[default]
    Auto,
}

/// Settings for [`estimate`](super::estimate).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureOptions {
    /// How curvature is estimated. Default: auto.
    pub estimator: Estimator,
    /// For [`Estimator::Auto`], the radius of the windows of vertices that a face's values come from; by
    /// default they choose themselves. For the others, the length of the legs: sections are polygons,
    /// so the error of formula (1) falls with the square of edge over radius, and grows with the square of
    /// radius over the distance in which the curvature changes.
    ///
    /// Default: automatic. For legs that is 5.4 times the width of the faces around, shorter (to a quarter) while the
    /// surface turns by more than 0.8 radians over it, longer (to three mean edges of the face) while it turns by
    /// little.
    pub radius: Radius,
    /// Number of diameters per disk, 3 to 360. Default 12.
    pub diameters: usize,
    /// A turn (curvature times radius, in radians) up to this counts as none in the class of a
    /// face, 0 to 1. Default 0.05.
    pub class_tolerance: f64,
    /// Whether [`Estimator::Auto`] lays a disk on every face besides, for `gauss_perimeter`; the others
    /// always do. Default: no.
    pub perimeter: bool,
}

impl Default for CurvatureOptions {
    fn default() -> Self {
        CurvatureOptions {
            estimator: Estimator::default(),
            radius: Radius::default(),
            diameters: 12,
            class_tolerance: 0.05,
            perimeter: false,
        }
    }
}

impl CurvatureOptions {
    /// Checks every range, and a radius against the mesh.
    pub(crate) fn check_for(&self, mesh: &Mesh) -> Result<(), Error> {
        self.check()?;
        let size = mesh.report().bounds.map_or(0.0, |bounds| bounds.size().length());
        match self.radius {
            Radius::Length(length) if length > size => Err(Error::Usage(format!(
                "the radius {} is larger than the mesh, which is {} across",
                short(length),
                short(size)
            ))),
            _ => Ok(()),
        }
    }

    /// Checks every range.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let usage = |message: String| Err(Error::Usage(message));
        match self.radius {
            Radius::FaceFactor(f) | Radius::MeshFactor(f) if !(f > 0.0 && f <= 1000.0) => {
                usage(format!("the radius factor must be above 0 and at most 1000, not {f}"))
            }
            Radius::Length(l) if !(l > 0.0 && l.is_finite()) => usage(format!("the radius must be above 0, not {l}")),
            _ if !(3..=360).contains(&self.diameters) => {
                usage(format!("the number of diameters must be 3 to 360, not {}", self.diameters))
            }
            _ if !(0.0..=1.0).contains(&self.class_tolerance) => {
                usage(format!("the class tolerance must be 0 to 1, not {}", self.class_tolerance))
            }
            _ => Ok(()),
        }
    }
}
