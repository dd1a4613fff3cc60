//! Where the defects of a mesh are.

use crate::mesh::{Face, Mesh};
use serde::Serialize;

/// A kind of defect and its first few places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Defect {
    /// `degenerate`, `non_finite`, `duplicate`, `flipped` or `non_manifold`, as in
    /// [`FirstDefects`](crate::FirstDefects).
    pub kind: &'static str,
    /// How many there are: edges for `non_manifold`, faces otherwise.
    pub count: usize,
    /// The first few of them.
    pub places: Vec<DefectPlace>,
}

/// A face with a defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DefectPlace {
    /// Its number in the file.
    pub face: u32,
    /// The mean of its corners, in the input's coordinates; `None` where they are not finite.
    pub at: Option<[f64; 3]>,
}

/// In the order of [`MeshReport::defects`](crate::MeshReport::defects).
pub(super) fn defects(mesh: &Mesh) -> Vec<Defect> {
    let report = mesh.report();
    let first = &report.first_defects;
    let kinds = [
        ("degenerate", report.degenerate_faces, &first.degenerate),
        ("non_finite", report.non_finite_faces, &first.non_finite),
        ("duplicate", report.duplicate_faces, &first.duplicate),
        ("flipped", report.flipped_faces, &first.flipped),
        ("non_manifold", report.edges.non_manifold, &first.non_manifold),
    ];
    let place = |&face: &u32| {
        let at = mesh.barycentre(Face(face)) + mesh.origin();
        DefectPlace { face, at: at.is_finite().then_some(at.to_array()) }
    };
    let found = kinds.into_iter().filter(|(_, count, _)| *count > 0);
    found.map(|(kind, count, faces)| Defect { kind, count, places: faces.iter().map(place).collect() }).collect()
}
