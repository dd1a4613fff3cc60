//! Which faces share a fit.
//!
//! A fit serves the faces within a step or two of its own. Taken in the order of faces, each group would find half of
//! its surroundings taken; so of the faces within reach, the one is fitted that most open ones are around.

use crate::mesh::{EdgeKind, Face, Mesh};
use std::ops::Range;

/// Faces of one range, as those who share their fits are taken from it. Reused from range to range.
pub(super) struct Groups {
    start: u32,
    /// The faces over inner edges that lie in the range.
    across: Vec<[u16; 3]>,
    /// Faces that no group has.
    open: Vec<bool>,
    /// No face before this one is open.
    next: usize,
}

/// A face whose fit serves others, itself the first of them.
pub(super) struct Group {
    faces: [Face; Group::MOST],
    count: usize,
}

/// No face within the range.
const NONE: u16 = u16::MAX;

impl Group {
    /// A face, its neighbours over edges and theirs.
    const MOST: usize = 10;

    pub(super) fn alone(seed: Face) -> Self {
        Group { faces: [seed; Group::MOST], count: 1 }
    }

    pub(super) fn faces(&self) -> &[Face] {
        &self.faces[..self.count]
    }
}

impl Groups {
    pub(super) fn new() -> Self {
        Groups { start: 0, across: Vec::new(), open: Vec::new(), next: 0 }
    }

    /// Opens the sound faces of a range of fewer than 65,536.
    pub(super) fn open(&mut self, mesh: &Mesh, faces: Range<u32>) {
        debug_assert!(faces.len() <= usize::from(NONE));
        (self.start, self.next) = (faces.start, 0);
        let is_sound = |f: Face| mesh.is_sound(f);
        self.open.clear();
        self.open.extend(faces.clone().map(|f| is_sound(Face(f))));
        let near = |h| {
            let twin = mesh.topology().twin(h).filter(|_| mesh.edge_kind(h) == EdgeKind::Inner);
            let beside = twin.map(|twin| twin.face()).filter(|f| faces.contains(&f.0) && is_sound(*f));
            beside.map_or(NONE, |f| (f.0 - faces.start) as u16)
        };
        self.across.clear();
        self.across.extend(faces.clone().map(|f| Face(f).half_edges().map(near)));
    }

    /// The face to be fitted next for those within some steps of it, at most two; `None` when no face is open.
    pub(super) fn seed(&mut self, steps: usize) -> Option<Face> {
        self.next += self.open[self.next..].iter().position(|&is_open| is_open)?;
        let first = self.next as u16;
        let mut best = (0, first);
        self.around(first, steps, |f| {
            if self.open[f as usize] {
                let mut count = 0;
                self.around(f, steps, |g| count += u32::from(self.open[g as usize]));
                // Of equals the first by number: an order that does not depend on which corner comes first.
                if count > best.0 || count == best.0 && f < best.1 {
                    best = (count, f);
                }
            }
        });
        Some(self.face(best.1))
    }

    /// Takes an open face and the open ones within some steps of it, at most two.
    pub(super) fn take(&mut self, seed: Face, steps: usize) -> Group {
        let mut group = Group::alone(seed);
        let at = (seed.0 - self.start) as u16;
        let mut found = [NONE; Group::MOST];
        let mut count = 0;
        self.open[usize::from(at)] = false;
        self.around(at, steps, |f| {
            if self.open[usize::from(f)] && !found[..count].contains(&f) {
                found[count] = f;
                count += 1;
            }
        });
        for &f in &found[..count] {
            self.open[usize::from(f)] = false;
            group.faces[group.count] = self.face(f);
            group.count += 1;
        }
        group
    }

    /// Names the faces within some steps of a face, at most two, itself the first.
    #[inline]
    fn around(&self, face: u16, steps: usize, mut name: impl FnMut(u16)) {
        name(face);
        if steps == 0 {
            return;
        }
        for near in self.across[usize::from(face)].into_iter().filter(|&f| f != NONE) {
            name(near);
            if steps > 1 {
                let beyond = self.across[usize::from(near)].into_iter().filter(|&f| f != NONE && f != face);
                beyond.for_each(&mut name);
            }
        }
    }

    fn face(&self, at: u16) -> Face {
        Face(self.start + u32::from(at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::MeshOptions;
    use crate::synth::{Grid, Surface};

    #[test]
    fn every_sound_face_is_in_one_group_and_few_are_needed() {
        let soup = Grid::new(Surface::Torus { major: 3.0, minor: 1.0 }, 60, 30).build().soup;
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).expect("a sound mesh");
        let (mesh, _) = mesh.into_order();
        let count = mesh.face_count();
        let mut groups = Groups::new();
        for (steps, least) in [(0, 1.0), (1, 3.0), (2, 6.0)] {
            let mut times = vec![0; count];
            let mut taken = 0;
            for start in (0..count as u32).step_by(1000) {
                groups.open(&mesh, start..count.min(start as usize + 1000) as u32);
                while let Some(seed) = groups.seed(steps) {
                    let group = groups.take(seed, steps);
                    assert_eq!(group.faces()[0], seed);
                    group.faces().iter().for_each(|f| times[f.index()] += 1);
                    taken += 1;
                }
            }
            assert!(times.iter().all(|&times| times == 1));
            assert!(count as f64 >= least * f64::from(taken), "{taken} groups of {count} faces within {steps} steps");
        }
    }
}
