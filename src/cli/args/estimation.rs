//! How curvature is estimated.

use crate::cli::choices::EstimatorArg;
use crate::cli::parse::{radius, radius_factor};
use clap::Args;
use osculate::{CurvatureOptions, Radius};

#[derive(Debug, Args)]
#[command(next_help_heading = "Estimation")]
pub(in crate::cli) struct EstimationArgs {
    /// How curvature is estimated
    #[arg(long, value_enum, default_value_t = EstimatorArg::from(CurvatureOptions::default().estimator))]
    estimator: EstimatorArg,

    /// Distance in file units up to which the mesh counts (for disks: length of the legs), above 0; or
    /// auto: chosen for every face
    #[arg(long, value_name = "LENGTH|auto", conflicts_with = "radius_factor", value_parser = radius,
          allow_hyphen_values = true, default_value = "auto")]
    radius: Radius,

    /// The radius in mean edges of the face (F or F:face) or of the whole mesh (F:mesh) instead; above 0, at most 1000
    #[arg(long, value_name = "F[:face|mesh]", value_parser = radius_factor, allow_hyphen_values = true)]
    radius_factor: Option<Radius>,

    /// Diameters of a disk, 3 to 360. auto lays disks only where vertices do not carry a fit, and for gauss_perimeter
    #[arg(long, value_name = "N", default_value_t = CurvatureOptions::default().diameters)]
    diameters: usize,

    /// Turn over a disk (curvature times radius, in radians) that still counts as flat, 0 to 1
    #[arg(long, value_name = "T", default_value_t = CurvatureOptions::default().class_tolerance,
          allow_hyphen_values = true)]
    class_tolerance: f64,
}

impl EstimationArgs {
    pub(in crate::cli) fn options(&self) -> CurvatureOptions {
        CurvatureOptions {
            estimator: self.estimator.into(),
            radius: self.radius_factor.unwrap_or(self.radius),
            diameters: self.diameters,
            class_tolerance: self.class_tolerance,
            perimeter: false,
        }
    }
}
