//! A point of the surface: a face and where in it.

use crate::error::Error;
use crate::mesh::{Face, FaceState, Mesh};
use glam::DVec3;
use rayon::prelude::*;

/// A point of the surface: a face and the weights of its three corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The face.
    pub face: Face,
    /// Barycentric coordinates: weights of the corners, 0 or more, adding up to 1.
    pub weights: [f64; 3],
}

/// A point further from the mesh than this share of its size belongs to something else.
const NEAR: f64 = 0.1;

impl Place {
    /// The barycentre of a face.
    pub fn barycentre(face: Face) -> Self {
        Place { face, weights: [1.0 / 3.0; 3] }
    }

    /// The point `u` of the way along the face's first edge and `v` of the way along its last,
    /// reversed, from the first corner: weights (1 - u - v, u, v).
    ///
    /// # Errors
    /// [`Error::Usage`] for a face number out of range or a point outside the face.
    pub fn in_face(mesh: &Mesh, face: u64, [u, v]: [f64; 2]) -> Result<Self, Error> {
        let face = check_number(mesh, face)?;
        let weights = [1.0 - u - v, u, v];
        if !are_inside(weights) {
            return Err(Error::Usage(format!(
                "{u},{v} lies outside the face: both must be 0 or more, their sum at most 1"
            )));
        }
        let place = Place { face: Face(face), weights: weights.map(|w| w.clamp(0.0, 1.0)) };
        place.check(mesh)?;
        Ok(place)
    }

    /// The point of the mesh nearest to `point`, given in the input's coordinates.
    ///
    /// # Errors
    /// [`Error::Usage`] when the mesh is further away than a tenth of its size.
    pub fn nearest(mesh: &Mesh, point: DVec3) -> Result<Self, Error> {
        let local = point - mesh.origin();
        let nearest = (0..mesh.face_count() as u32)
            .into_par_iter()
            .map(Face)
            .filter(|&f| mesh.is_sound(f))
            .map(|face| {
                let place = Place { face, weights: nearest_in_triangle(mesh.triangle(face), local) };
                (mesh.point(place).distance_squared(local), place)
            })
            // Of equal distances, the lowest face: the same for any number of threads.
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.face.cmp(&b.1.face)));
        let size = mesh.report().bounds.map_or(0.0, |b| b.size().length());
        match nearest {
            Some((squared, place)) if squared.sqrt() <= NEAR * size => Ok(place),
            Some((squared, _)) => Err(Error::Usage(format!(
                "the point {},{},{} lies {:.4} away from the mesh; it must be within {:.4}",
                point.x,
                point.y,
                point.z,
                squared.sqrt(),
                NEAR * size
            ))),
            None => Err(Error::Usage("the mesh has no face with an area".into())),
        }
    }

    /// # Errors
    /// [`Error::Usage`] where no disk can be laid on the face, there is no such face or the weights are none.
    pub(crate) fn check(&self, mesh: &Mesh) -> Result<(), Error> {
        check_number(mesh, self.face.0.into())?;
        if !are_inside(self.weights) {
            let [a, b, c] = self.weights;
            return Err(Error::Usage(format!("weights of corners must be 0 or more and add up to 1, not {a},{b},{c}")));
        }
        match mesh.face_state(self.face) {
            FaceState::Sound => Ok(()),
            FaceState::Duplicate => Err(Error::Usage(format!(
                "face {} repeats the vertices of face {}; use that one",
                self.face.0,
                mesh.duplicate_of(self.face).map_or(0, |f| f.0)
            ))),
            _ => Err(Error::Usage(format!("face {} has no area, so no disk can be laid on it", self.face.0))),
        }
    }
}

/// Whether weights are those of a point of a face, but for rounding.
fn are_inside(weights: [f64; 3]) -> bool {
    let [a, b, c] = weights;
    weights.iter().all(|w| (-1e-12..=1.0 + 1e-12).contains(w)) && (a + b + c - 1.0).abs() <= 1e-9
}

fn check_number(mesh: &Mesh, face: u64) -> Result<u32, Error> {
    let last = mesh.face_count() as u32 - 1;
    let number = u32::try_from(face).ok().filter(|&number| number <= last);
    number.ok_or_else(|| Error::Usage(format!("face {face} is out of range: the faces are 0 to {last}")))
}

/// Weights of the point of a triangle nearest to `p`.
pub(crate) fn nearest_in_triangle([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let double_area = normal.length_squared();
    let weights = [(b, c), (c, a), (a, b)].map(|(q, r)| (r - q).cross(p - q).dot(normal) / double_area);
    if weights.iter().all(|&w| w >= 0.0) {
        return weights;
    }
    // Outside: the nearest point lies on a side.
    let on_side = |q: DVec3, r: DVec3| {
        let side = r - q;
        let t = ((p - q).dot(side) / side.length_squared()).clamp(0.0, 1.0);
        ((q + t * side).distance_squared(p), t)
    };
    let sides = [(a, b), (b, c), (c, a)].map(|(q, r)| on_side(q, r));
    let best = (0..3).min_by(|&i, &j| sides[i].0.total_cmp(&sides[j].0)).unwrap_or(0);
    let mut weights = [0.0; 3];
    weights[best] = 1.0 - sides[best].1;
    weights[(best + 1) % 3] = sides[best].1;
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::synth::{Grid, Surface};

    #[test]
    fn the_nearest_point_is_nearer_than_any_other() {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 20, 10).build().soup;
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a mesh");
        for p in [DVec3::new(4.2, 0.1, 0.0), DVec3::new(-2.0, 2.0, 0.9), DVec3::new(0.0, 3.1, -1.2)] {
            let found = mesh.point(Place::nearest(&mesh, p).expect("near")).distance(p);
            for f in 0..mesh.face_count() as u32 {
                for weights in [[1.0, 0.0, 0.0], [0.3, 0.3, 0.4], [0.5, 0.5, 0.0], [0.1, 0.8, 0.1]] {
                    assert!(mesh.point(Place { face: Face(f), weights }).distance(p) >= found - 1e-12);
                }
            }
        }
        for place in [
            Place::barycentre(Face(400)),
            Place { face: Face(0), weights: [f64::NAN, 0.5, 0.5] },
            Place { face: Face(0), weights: [0.5; 3] },
        ] {
            assert!(place.check(&mesh).is_err_and(|e| e.is_usage()), "{place:?}");
        }
        assert!(Place::barycentre(Face(399)).check(&mesh).is_ok());
        assert!(Place::nearest(&mesh, DVec3::splat(50.0)).is_err());
        assert!(Place::in_face(&mesh, 400, [0.3, 0.3]).is_err() && Place::in_face(&mesh, 3, [0.8, 0.3]).is_err());
    }
}
