//! What there is to say of the values of a mesh as a whole.

use crate::curvature::{FaceClass, FaceCurvature, Method};
use crate::mesh::{Face, Mesh};
use crate::soup::Note;
use rayon::prelude::*;

/// Says so where faces that have an area and a place have no values.
pub(crate) fn note_of_lost_values(mesh: &Mesh, values: &[FaceCurvature]) -> Option<Note> {
    let is_lost = |(f, v): &(usize, &FaceCurvature)| !v.is_estimated() && mesh.is_sound(Face(*f as u32));
    let lost = values.par_iter().enumerate().filter(is_lost).count();
    (lost > 0).then(|| {
        Note::repaired(format!(
            "{lost} of {} faces got no values although they have an area: their curvature or its square is beyond 32-bit floats; scale the mesh nearer to size one",
            values.len()
        ))
    })
}

/// Says so where many faces have no neighbour: nothing tells how the surface bends there.
pub(crate) fn note_of_lone_faces(mesh: &Mesh) -> Option<Note> {
    let all = mesh.face_count();
    let lone = (0..all as u32).into_par_iter().map(Face).filter(|&face| mesh.is_lone(face)).count();
    (all > 1 && 10 * lone > all).then(|| {
        Note::info(format!(
            "{lone} of {all} faces share no edge with another: they count as flat, without confidence, since nothing tells how the surface bends there; osculate inspect says whether --weld joins them"
        ))
    })
}

/// Says so where many values say little: disks that borders and sharp edges cut, or uncertain fits. Values that were
/// read from a file were judged when they were estimated.
pub(crate) fn note_of_weak_values(values: &[FaceCurvature]) -> Option<Note> {
    let weak = |v: &FaceCurvature| match v.method {
        _ if !v.is_estimated() => [0, 0],
        // Flat faces lose nothing by it.
        Method::Sections => [usize::from(v.coverage < 0.5 && v.class != FaceClass::Flat), 0],
        Method::None => [0, 0],
        _ => [0, usize::from(v.confidence < 0.1)],
    };
    let [of_disks, of_fits] = values.par_iter().map(weak).reduce(|| [0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
    let all = values.len();
    if 10 * of_disks > all {
        // Where there are fits too, sections are what faces get whose patch has too few vertices for one.
        let has_fits = values.par_iter().any(|v| !matches!(v.method, Method::Sections | Method::None));
        if has_fits {
            return Some(Note::info(format!(
                "{of_disks} of {all} faces lie between borders and sharp edges that leave too few vertices for a fit: short sections say less; a larger --feature-angle lets fits reach over more edges"
            )));
        }
        return Some(Note::info(format!(
            "{of_disks} of {all} faces are not flat and have coverage below 0.5: borders or sharp edges cut most of their disk off; a smaller --radius may tell more of them"
        )));
    }
    (10 * of_fits > all).then(|| {
        Note::info(format!(
            "{of_fits} of {all} faces have confidence below 0.1: noise, coordinates with too few digits, or detail that the mesh is too coarse for; a larger --radius gives steadier values"
        ))
    })
}
