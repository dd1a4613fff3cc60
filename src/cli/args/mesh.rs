//! How triangles become a mesh.

use clap::Args;
use osculate::MeshOptions;

#[derive(Debug, Args)]
#[command(next_help_heading = "Mesh")]
pub(in crate::cli) struct MeshArgs {
    /// Angle between face normals above which an edge is a feature, where disks end; degrees, 0 to
    /// 180 (180: no features)
    #[arg(long, value_name = "DEGREES", default_value_t = MeshOptions::default().feature_angle,
          allow_hyphen_values = true)]
    feature_angle: f64,

    /// Weld vertices up to this far apart, in file units; 0 welds equal positions only
    #[arg(long, value_name = "DISTANCE", default_value_t = MeshOptions::default().weld, allow_hyphen_values = true)]
    weld: f64,
}

impl MeshArgs {
    pub(in crate::cli) fn options(&self) -> MeshOptions {
        MeshOptions { weld: self.weld, feature_angle: self.feature_angle }
    }
}
