//! Polygons over numbered vertices, as PLY and OFF files list them, and their triangles.

use crate::error::ParseError;
use crate::soup::{MAX_FACES, Note, Positions, Soup};
use crate::triangulate::{Effort, Outcome, triangulate};

/// Polygons as read. Corners are checked at the end: faces may come before the vertices.
#[derive(Default)]
pub(super) struct Polygons {
    /// The polygons before the first that is no triangle: mostly all of them, and then these become
    /// the soup's without a copy.
    triangles: Vec<[u32; 3]>,
    /// The corners of the polygons from there on, and behind them those of the current one.
    corners: Vec<u32>,
    /// The end of each polygon in `corners`.
    ends: Vec<usize>,
    too_few: usize,
}

impl Polygons {
    /// Makes room for so many triangles, which must be known to be there.
    pub(super) fn reserve(&mut self, triangles: usize) {
        self.triangles.reserve(triangles);
    }

    /// Adds a corner to the current polygon or strip.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Adds a triangle. There must be no current polygon.
    #[inline]
    pub(super) fn triangle(&mut self, corners: [u32; 3]) {
        if self.ends.is_empty() {
            self.triangles.push(corners);
        } else {
            self.corners.extend(corners);
            self.ends.push(self.corners.len());
        }
    }

    /// Ends the current polygon.
    #[inline]
    pub(super) fn end_face(&mut self) {
        let ended = self.ended();
        match self.corners[ended..] {
            [] | [_] | [_, _] => {
                self.corners.truncate(ended);
                self.too_few += 1;
            }
            [a, b, c] if self.ends.is_empty() => {
                self.triangles.push([a, b, c]);
                self.corners.clear();
            }
            _ => self.ends.push(self.corners.len()),
        }
    }

    /// The corners of polygons that have ended.
    #[inline]
    fn ended(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Ends the current strip: its corners become triangles.
    pub(super) fn end_strip(&mut self) {
        let strip = self.corners.split_off(self.ended());
        for (i, t) in strip.windows(3).enumerate() {
            let [a, b, c] = [t[0], t[1], t[2]];
            // Every other triangle of a strip runs backwards; a repeated corner only moves the strip on.
            if a != b && b != c && c != a {
                self.triangle(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
            }
        }
    }

    /// The triangles over `positions`. Polygons that name other vertices are left out and told.
    pub(super) fn into_soup(self, positions: Positions) -> Result<Soup, ParseError> {
        if self.triangles.is_empty() && self.ends.is_empty() {
            return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
        }
        let count = positions.len();
        let more = self.ended() - 2 * self.ends.len();
        if self.triangles.len() + more > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        let mut outside = Outside::default();
        let mut triangles = self.triangles;
        let before = triangles.len();
        let largest = triangles.as_flattened().iter().fold(0, |largest, &corner| largest.max(corner));
        if largest as usize >= count {
            let mut face = 0;
            triangles.retain(|corners| {
                face += 1;
                outside.all_inside(face - 1, corners, count)
            });
        }
        triangles.reserve_exact(more);
        let (mut rough, mut start, mut effort) = (0, 0, Effort::default());
        for (i, &end) in self.ends.iter().enumerate() {
            let corners = &self.corners[start..end];
            if outside.all_inside(before + i, corners, count)
                && triangulate(corners, |c| positions.get(c as usize), &mut effort, &mut triangles) == Outcome::Rough
            {
                rough += 1;
            }
            start = end;
        }
        if triangles.is_empty() {
            return Err(ParseError::file(format!(
                "all faces name vertices out of range: the file has {count} vertices"
            )));
        }
        let mut soup = Soup::new(positions, triangles);
        if let Outside { faces: 1.., first } = outside {
            soup.notes.push(Note::repaired(format!(
                "{} faces name vertices out of range ({count} vertices) and are left out, the first is face {first}",
                outside.faces
            )));
        }
        if self.too_few > 0 {
            soup.notes
                .push(Note::repaired(format!("{} faces with fewer than three corners are left out", self.too_few)));
        }
        if rough > 0 {
            soup.notes.push(Note::info(format!(
                "{rough} polygons cross themselves, have no area or are too long; their triangles may overlap"
            )));
        }
        Ok(soup)
    }
}

/// Polygons that name vertices out of range.
#[derive(Default)]
struct Outside {
    faces: usize,
    first: usize,
}

impl Outside {
    /// True when all corners are below `count`; otherwise the face is counted.
    fn all_inside(&mut self, face: usize, corners: &[u32], count: usize) -> bool {
        let inside = corners.iter().all(|&corner| (corner as usize) < count);
        if !inside {
            if self.faces == 0 {
                self.first = face;
            }
            self.faces += 1;
        }
        inside
    }
}
