//! Values of vertices: the mean of the faces around, by area. For clients that shade smoothly.

use crate::curvature::FaceCurvature;
use crate::mesh::{Face, Mesh};
use crate::quantity::Quantity;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One value per welded vertex of each quantity, in the input's units; NaN where no face around has
/// one. A vertex in a sharp edge gets the mean of both sides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VertexValues {
    columns: BTreeMap<Quantity, Vec<f32>>,
}

impl VertexValues {
    /// Averages those of the quantities that have a mean: curvatures, not classes or directions.
    pub fn of(mesh: &Mesh, values: &[FaceCurvature], quantities: &[Quantity]) -> Self {
        let averaged = quantities.iter().copied().filter(|&q| q.is_signed() || q == Quantity::Curvedness);
        let areas: Vec<f64> = (0..mesh.face_count() as u32).into_par_iter().map(|f| mesh.area(Face(f))).collect();
        let columns: Vec<(Quantity, Vec<f32>)> = averaged
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|quantity| (quantity, average(mesh, values, &areas, quantity)))
            .collect();
        VertexValues { columns: columns.into_iter().collect() }
    }

    /// The quantities that have values.
    pub fn quantities(&self) -> impl Iterator<Item = Quantity> + '_ {
        self.columns.keys().copied()
    }

    /// The values of a quantity, one per welded vertex.
    pub fn get(&self, quantity: Quantity) -> Option<&[f32]> {
        self.columns.get(&quantity).map(Vec::as_slice)
    }
}

fn average(mesh: &Mesh, values: &[FaceCurvature], areas: &[f64], quantity: Quantity) -> Vec<f32> {
    let mut sums = vec![(0.0, 0.0); mesh.positions().len()];
    for (f, (value, &area)) in (0..).map(Face).zip(values.iter().zip(areas)) {
        let value = f64::from(quantity.value(f, value, 0));
        if value.is_finite() && area.is_finite() {
            for corner in mesh.topology().corners(f) {
                let (sum, weight) = &mut sums[corner.index()];
                *sum += area * value;
                *weight += area;
            }
        }
    }
    sums.into_iter().map(|(sum, weight)| if weight > 0.0 { (sum / weight) as f32 } else { f32::NAN }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::soup::{Positions, Soup};

    #[test]
    fn larger_faces_count_for_more() {
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-3.0, 0.0, 0.0], [9.0, 9.0, 9.0]];
        let soup = Soup::new(Positions::F64(corners), vec![[0, 1, 2], [0, 2, 3]]);
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        let with = |k: f32| FaceCurvature {
            k_max: k,
            k_min: k,
            class: crate::FaceClass::Umbilic,
            ..FaceCurvature::NOT_ESTIMATED
        };
        let of = |a, b| VertexValues::of(&mesh, &[a, b], &[Quantity::Mean, Quantity::Class]);
        let values = of(with(1.0), with(5.0));
        assert_eq!(values.quantities().collect::<Vec<_>>(), [Quantity::Mean]);
        assert_eq!(values.get(Quantity::Mean), Some(&[4.0, 1.0, 4.0, 5.0][..]), "areas 0.5 and 1.5");
        let values = of(with(1.0), FaceCurvature::NOT_ESTIMATED);
        let mean = values.get(Quantity::Mean).expect("a column");
        assert_eq!(mean[..3], [1.0; 3]);
        assert!(mean[3].is_nan());
    }
}
