//! What a run tells about itself: seconds per stage, defects, and the spread of the values.

use crate::annotated::Written;
use crate::curvature::{FaceClass, FaceCurvature};
use crate::io::InputFormat;
use crate::mesh::MeshReport;
use crate::order_statistics::at_shares;
use crate::quantity::Quantity;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// Wall-clock seconds of each stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Seconds {
    /// From the start to the soup.
    pub read: f64,
    /// Welding, adjacency and edge kinds.
    pub weld: f64,
    /// All that follows until the values are ready.
    pub estimate: f64,
    /// From colours to the rename.
    pub write: f64,
    /// Everything.
    pub total: f64,
}

impl Seconds {
    /// From the times since the start at which each stage ended.
    pub(crate) fn from_marks(read: Duration, weld: Duration, estimate: Duration, write: Duration) -> Self {
        Seconds {
            read: read.as_secs_f64(),
            weld: (weld - read).as_secs_f64(),
            estimate: (estimate - weld).as_secs_f64(),
            write: (write - estimate).as_secs_f64(),
            total: write.as_secs_f64(),
        }
    }
}

/// Percentiles of one quantity over the estimated faces.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Percentiles {
    /// Least value.
    pub min: f32,
    /// 5th percentile.
    pub p5: f32,
    /// 25th percentile.
    pub p25: f32,
    /// Median.
    pub p50: f32,
    /// 75th percentile.
    pub p75: f32,
    /// 95th percentile.
    pub p95: f32,
    /// Greatest value.
    pub max: f32,
}

/// The spread of the values over the faces.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CurvatureSummary {
    /// Number of faces with an estimate.
    pub estimated: usize,
    /// Number of faces in each class.
    pub classes: BTreeMap<FaceClass, usize>,
    /// Percentiles of each quantity, by column name; quantities without any value are left out.
    pub percentiles: BTreeMap<&'static str, Percentiles>,
}

impl CurvatureSummary {
    /// Summarises one value per face.
    pub fn of(values: &[FaceCurvature]) -> Self {
        let mut classes: BTreeMap<FaceClass, usize> = FaceClass::ALL.into_iter().map(|class| (class, 0)).collect();
        for alike in values.chunk_by(|a, b| a.class == b.class) {
            *classes.entry(alike[0].class).or_default() += alike.len();
        }
        use Quantity::{Confidence, Coverage, Curvedness, Gauss, GaussPerimeter, KMax, KMin, Mean, Radius, ShapeIndex};
        let quantities =
            [KMax, KMin, Mean, Gauss, GaussPerimeter, ShapeIndex, Curvedness, Radius, Coverage, Confidence];
        let shares = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];
        let percentiles = (quantities.iter().zip(at_shares(&quantities, values, shares)))
            .filter_map(|(quantity, found)| {
                let [min, p5, p25, p50, p75, p95, max] = found?;
                Some((quantity.token(), Percentiles { min, p5, p25, p50, p75, p95, max }))
            })
            .collect();
        CurvatureSummary { estimated: values.len() - classes[&FaceClass::NotEstimated], classes, percentiles }
    }
}

/// Everything about one run; serialises to the object that `--stats` writes.
#[derive(Clone, Debug, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// Version of this object's layout.
    pub schema: u32,
    /// Version of the program.
    pub version: &'static str,
    /// The input file.
    pub input: String,
    /// Its format.
    pub format: InputFormat,
    /// The mesh and its defects.
    #[serde(flatten)]
    pub report: MeshReport,
    /// What was written. Its notes are those of reading too; its units are those of the input, in which counts, bounds
    /// and percentiles are, and of the output.
    #[serde(flatten)]
    pub written: Written,
    /// Wall-clock seconds.
    pub seconds: Seconds,
    /// The values, in the units of the input, where a summary was asked for.
    pub curvature: Option<CurvatureSummary>,
}

impl Summary {
    /// True when something was repaired or skipped, or the mesh has defects (exit code 3).
    pub fn has_defects(&self) -> bool {
        self.report.has_defects() || self.written.notes.iter().any(|note| note.repaired)
    }
}
