//! The faces around which windows of a noisy surface are laid.

use super::Ground;
use crate::mesh::Face;
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Numbers for faces and vertices, drawn from the cells of a fine grid that moves, turns and grows with the mesh, so
/// that neither the order of faces nor the place of the mesh plays a part.
pub(super) struct Draw<'g> {
    ground: &'g Ground<'g>,
    centre: DVec3,
    /// From space to cells.
    to_cells: DMat3,
}

impl<'g> Draw<'g> {
    /// From cells of which many fit into a face.
    pub(super) fn new(ground: &'g Ground<'g>) -> Self {
        /// Along the mesh.
        const CELLS: f64 = (1 << 18) as f64;
        /// Along a face.
        const OF_FACE: f64 = 16.0;
        Draw::from_cells(ground, CELLS, OF_FACE)
    }

    /// From cells about as wide as faces.
    pub(super) fn of_width(ground: &'g Ground<'g>) -> Self {
        Draw::from_cells(ground, 1.0, 1.0)
    }

    /// From a grid of at least so many cells along the mesh; finer, if a few far vertices make the mesh large, so that
    /// a face still has so many.
    fn from_cells(ground: &'g Ground<'g>, along_mesh: f64, along_face: f64) -> Self {
        let (centre, axes, size) = ground.mesh.own_frame().unwrap_or((DVec3::ZERO, DMat3::IDENTITY, 1.0));
        let cells = along_mesh.max((along_face * size / ground.width).log2().ceil().exp2());
        Draw { ground, centre, to_cells: axes.transpose() * (cells / size) }
    }

    /// Where a point lies, in cells.
    fn place(&self, point: DVec3) -> DVec3 {
        // Off the cells' borders, on which points of regular meshes would lie.
        self.to_cells * (point - self.centre) + 0.37
    }

    fn of(&self, face: Face) -> u64 {
        number(self.place(self.ground.mesh.barycentre(face)))
    }

    /// A number for a point that mostly stays if the point moves by less than a cell: first that of its cell counts,
    /// then how near it is to the cell's middle.
    pub(super) fn lasting(&self, point: DVec3) -> u32 {
        const NEARNESS: u32 = 0xFFFF;
        let place = self.place(point);
        // At the corners it is 3/4.
        let nearness = 1.0 - from_middle(place) / 0.75;
        number(place) as u32 & !NEARNESS | (nearness * f64::from(NEARNESS)) as u32
    }
}

/// A number that any other bit of another one changes throughout.
pub(super) fn mixed(mut x: u64) -> u64 {
    x = (x ^ (x >> 31)).wrapping_mul(0x7FB5_D329_728E_A185);
    x = (x ^ (x >> 27)).wrapping_mul(0x81DA_DEF4_BC2D_D44D);
    x ^ (x >> 33)
}

/// The number of the cell in which a place lies.
fn number(place: DVec3) -> u64 {
    place.to_array().iter().fold(1, |h: u64, c| mixed(h ^ c.floor() as i64 as u64))
}

/// The square of the distance of a place from the middle of its cell.
fn from_middle(place: DVec3) -> f64 {
    (place - place.floor()).distance_squared(DVec3::splat(0.5))
}

/// At most `count` of the `wanted` faces, which lie all over them, at much the same places however the surface is
/// meshed.
pub(in crate::curvature::fit) fn scattered(ground: &Ground<'_>, wanted: &[bool], count: usize) -> Vec<Face> {
    /// A grid of so many cells along the mesh has ten to twenty thousand on the surface.
    const CELLS: f64 = 128.0;
    /// Faces of which the nearest are found at a time: they share cells, so that few are left.
    const TOGETHER: usize = 1 << 14;
    let draw = Draw::from_cells(ground, CELLS, 1.0 / 64.0);
    // Of each cell the face nearest to its middle.
    let thin_out = |faces: &mut Vec<(u64, f64, u32)>| {
        faces.sort_unstable_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        faces.dedup_by_key(|face| face.0);
    };
    let chunks = wanted.par_chunks(TOGETHER).enumerate().map(|(chunk, wanted)| {
        let numbered = (chunk * TOGETHER..).map(|f| Face(f as u32)).zip(wanted);
        let sound = numbered.filter(|(face, is_wanted)| **is_wanted && ground.mesh.is_sound(*face));
        let placed = sound.map(|(face, _)| {
            let place = draw.place(ground.mesh.barycentre(face));
            (number(place), from_middle(place), face.0)
        });
        let mut faces: Vec<(u64, f64, u32)> = placed.collect();
        thin_out(&mut faces);
        faces
    });
    let mut faces: Vec<(u64, f64, u32)> = chunks.flatten_iter().collect();
    thin_out(&mut faces);
    faces.into_iter().take(count).map(|(_, _, f)| Face(f)).collect()
}

/// Faces of which none shares a vertex with another: those whose number is the greatest around.
pub(in crate::curvature::fit) fn seeds(ground: &Ground<'_>, wanted: &[bool]) -> Vec<Face> {
    let mesh = ground.mesh;
    let draw = Draw::new(ground);
    let faces = || (0..wanted.len() as u32).into_par_iter();
    let numbers: Vec<u64> = faces().map(|f| if wanted[f as usize] { draw.of(Face(f)) } else { 0 }).collect();
    let rank = |f: u32| (numbers[f as usize], f);
    faces()
        .filter(|&f| wanted[f as usize] && mesh.is_sound(Face(f)))
        .filter(|&f| {
            let corners = mesh.topology().corners(Face(f));
            corners.iter().all(|v| ground.stars.of(v.0).iter().all(|&g| rank(g) <= rank(f)))
        })
        .map(Face)
        .collect()
}

/// The wanted faces in the order of their numbers, the greatest first.
pub(in crate::curvature::fit) fn drawn(ground: &Ground<'_>, wanted: &[bool]) -> Vec<Face> {
    let draw = Draw::new(ground);
    let faces = (0..wanted.len() as u32).into_par_iter().filter(|&f| wanted[f as usize]);
    let mut numbered: Vec<(u64, u32)> = faces.map(|f| (draw.of(Face(f)), f)).collect();
    numbered.par_sort_unstable_by(|a, b| b.cmp(a));
    numbered.into_iter().map(|(_, f)| Face(f)).collect()
}

/// The tier of each seed: seeds of tier 1 and higher are a subset of all, those of tier 2 and higher one of that, and
/// so on, as many as there are numbers in `nearest`. Each seed left behind is among so many nearest of one that went
/// on, in the subset both come from. `near` names the seeds around one, the nearest first.
pub(in crate::curvature::fit) fn tiers<'n>(
    ground: &Ground<'_>,
    seeds: &[Face],
    near: impl Fn(usize) -> &'n [u32],
    nearest: &[usize],
) -> Vec<usize> {
    let draw = Draw::new(ground);
    let numbers: Vec<u64> = seeds.par_iter().map(|&seed| draw.of(seed)).collect();
    let mut order: Vec<usize> = (0..seeds.len()).collect();
    order.par_sort_unstable_by_key(|&i| (numbers[i], i));
    let mut tiers = vec![0; seeds.len()];
    for (tier, &nearest) in nearest.iter().enumerate() {
        let mut is_left_behind = vec![false; seeds.len()];
        for &i in &order {
            if tiers[i] < tier || is_left_behind[i] {
                continue;
            }
            tiers[i] = tier + 1;
            let others =
                near(i).iter().map(|&other| other as usize).filter(|&other| other != i && tiers[other] >= tier);
            others.take(nearest).for_each(|other| is_left_behind[other] = tiers[other] == tier);
        }
    }
    tiers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::fit::ground::work::Work;
    use crate::progress::NoProgress;
    use crate::synth::{Grid, Surface};
    use crate::{Mesh, MeshOptions};

    #[test]
    fn seeds_keep_apart_and_thin_out() {
        let grid = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, 20_000, 1.0);
        let mesh = Mesh::from_soup(&grid.build().soup, &MeshOptions::default()).expect("a mesh");
        let work = Work::new(&NoProgress, 0);
        let ground = Ground::new(&mesh, false, &work);
        let seeds = seeds(&ground, &vec![true; mesh.face_count()]);
        let share = seeds.len() as f64 / mesh.face_count() as f64;
        assert!((0.06..0.1).contains(&share), "{share}");
        let mut is_taken = vec![false; mesh.positions().len()];
        for vertex in seeds.iter().flat_map(|&seed| mesh.topology().corners(seed)) {
            assert!(!std::mem::replace(&mut is_taken[vertex.index()], true));
        }

        let square = |a: Face, b: Face| mesh.barycentre(a).distance_squared(mesh.barycentre(b));
        let near: Vec<Vec<u32>> = seeds
            .iter()
            .map(|&seed| {
                let mut near: Vec<u32> = (0..seeds.len() as u32).collect();
                near.sort_by(|&a, &b| square(seed, seeds[a as usize]).total_cmp(&square(seed, seeds[b as usize])));
                near.truncate(16);
                near
            })
            .collect();
        let tiers = tiers(&ground, &seeds, |i| &near[i], &[1, 1]);
        let counts: Vec<usize> = (0..3).map(|tier| tiers.iter().filter(|t| **t >= tier).count()).collect();
        for (more, fewer) in counts.iter().zip(&counts[1..]) {
            let share = *fewer as f64 / *more as f64;
            assert!((0.5..0.75).contains(&share), "{counts:?}");
        }
        // No seed is far from one of any tier.
        for tier in 1..3 {
            assert!(near.iter().all(|near| near.iter().any(|&i| tiers[i as usize] >= tier)), "tier {tier}");
        }
    }
}
