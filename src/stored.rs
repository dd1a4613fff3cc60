//! Values that a file already carries.

use crate::curvature::{FaceClass, FaceCurvature, Method};
use crate::error::Error;
use crate::mesh::{Face, Mesh};
use glam::Vec3;
use serde_json::Value;
use std::collections::BTreeMap;

/// Values of faces as an earlier run wrote them into a glTF file, in that file's axes and units.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredValues {
    /// One value per face of each column (named as in CSV). A face without estimate has 0, class -1.
    pub columns: BTreeMap<&'static str, Vec<f32>>,
    /// The settings of that run.
    pub settings: Value,
}

/// Columns without which values are of no use.
pub(crate) const NEEDED: [&str; 6] = ["k_max", "k_min", "class", "dir_max_x", "dir_max_y", "dir_max_z"];

impl StoredValues {
    /// One value per face. Where the file has no `dir_min`, it is normal x `dir_max`; where it has no
    /// `radius` or `gauss_perimeter`, they are NaN.
    ///
    /// # Errors
    /// [`Error::Usage`] where `k_max`, `k_min`, `class` or `dir_max` is missing, or a column is not one value per face.
    pub fn curvature(&self, mesh: &Mesh) -> Result<Vec<FaceCurvature>, Error> {
        if let Some(missing) = NEEDED.iter().find(|name| !self.columns.contains_key(**name)) {
            let what = format!(
                "the file does not have {missing} of every face, so its values cannot be used again; leave --reuse out"
            );
            return Err(Error::Usage(what));
        }
        if let Some((name, values)) = self.columns.iter().find(|(_, values)| values.len() != mesh.face_count()) {
            let what = format!("{} values of {name} for {} faces", values.len(), mesh.face_count());
            return Err(Error::Usage(what));
        }
        let column = |name: &str| self.columns.get(name).map(Vec::as_slice);
        let at = |column: Option<&[f32]>, f: usize| column.and_then(|column| column.get(f).copied());
        let vector = |columns: [Option<&[f32]>; 3], f: usize| {
            let [x, y, z] = columns.map(|column| at(column, f));
            Some(Vec3::new(x?, y?, z?))
        };
        let [classes, k_max, k_min] = ["class", "k_max", "k_min"].map(column);
        let [perimeters, radii, coverages, confidences] =
            ["gauss_perimeter", "radius", "coverage", "confidence"].map(column);
        let dir_max = ["dir_max_x", "dir_max_y", "dir_max_z"].map(column);
        let dir_min = ["dir_min_x", "dir_min_y", "dir_min_z"].map(column);
        let face = |f: usize| {
            let class = at(classes, f).unwrap_or(-1.0);
            let class = FaceClass::ALL.into_iter().find(|c| f32::from(c.code()) == class);
            let class = class.unwrap_or(FaceClass::NotEstimated);
            if class == FaceClass::NotEstimated {
                return FaceCurvature::NOT_ESTIMATED;
            }
            let direction = vector(dir_max, f).unwrap_or(Vec3::ZERO);
            let normal = mesh.normal(Face(f as u32));
            // Files have 0 for a value that is missing; a surface that is not flat never has it exactly.
            let perimeter = at(perimeters, f).filter(|&k| k != 0.0 || class == FaceClass::Flat);
            FaceCurvature {
                k_max: at(k_max, f).unwrap_or(f32::NAN),
                k_min: at(k_min, f).unwrap_or(f32::NAN),
                dir_max: direction,
                dir_min: vector(dir_min, f).unwrap_or_else(|| normal.cross(direction.as_dvec3()).as_vec3()),
                gauss_perimeter: perimeter.unwrap_or(f32::NAN),
                radius: at(radii, f).unwrap_or(f32::NAN),
                coverage: at(coverages, f).unwrap_or(0.0),
                confidence: at(confidences, f).unwrap_or(0.0),
                method: Method::None,
                class,
            }
        };
        Ok((0..mesh.face_count()).map(face).collect())
    }
}
