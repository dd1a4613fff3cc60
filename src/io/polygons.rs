//! Polygons over numbered vertices, as PLY and OFF files list them, and their triangles.

use crate::error::ParseError;
use crate::soup::{MAX_FACES, Note, Positions, Soup};
use crate::triangulate::{Outcome, triangulate};

/// Polygons as read. Corners are checked at the end: faces may come before the vertices.
#[derive(Default)]
pub(super) struct Polygons {
    corners: Vec<u32>,
    /// The end of each polygon in `corners`.
    ends: Vec<usize>,
    too_few: usize,
}

impl Polygons {
    /// Adds a corner to the current polygon or strip.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    fn start(&self) -> usize {
        self.ends.last().copied().unwrap_or(0)
    }

    /// Ends the current polygon.
    #[inline]
    pub(super) fn end_face(&mut self) {
        let start = self.start();
        if self.corners.len() - start < 3 {
            self.corners.truncate(start);
            self.too_few += 1;
        } else {
            self.ends.push(self.corners.len());
        }
    }

    /// Ends the current strip: its corners become triangles.
    pub(super) fn end_strip(&mut self) {
        let strip = self.corners.split_off(self.start());
        for (i, t) in strip.windows(3).enumerate() {
            let [a, b, c] = [t[0], t[1], t[2]];
            // Every other triangle of a strip runs backwards; a repeated corner only moves the strip on.
            if a != b && b != c && c != a {
                self.corners.extend(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                self.ends.push(self.corners.len());
            }
        }
    }

    /// The triangles over `positions`. Polygons that name other vertices are left out and told.
    pub(super) fn into_soup(self, positions: Positions) -> Result<Soup, ParseError> {
        if self.ends.is_empty() {
            return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
        }
        let count = positions.len();
        let most = self.corners.len() - 2 * self.ends.len();
        if most > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        let mut triangles = Vec::with_capacity(most);
        let (mut start, mut rough, mut out_of_range, mut first_out) = (0, 0, 0, 0);
        for (face, &end) in self.ends.iter().enumerate() {
            let corners = &self.corners[start..end];
            start = end;
            if corners.iter().any(|&c| c as usize >= count) {
                if out_of_range == 0 {
                    first_out = face;
                }
                out_of_range += 1;
            } else if triangulate(corners, |c| positions.get(c as usize), &mut triangles) == Outcome::Rough {
                rough += 1;
            }
        }
        if triangles.is_empty() {
            return Err(ParseError::file(format!(
                "all faces name vertices out of range: the file has {count} vertices"
            )));
        }
        let mut soup = Soup::new(positions, triangles);
        if out_of_range > 0 {
            soup.notes.push(Note::repaired(format!(
                "{out_of_range} faces name vertices out of range ({count} vertices) and are left out, the first is face {first_out}"
            )));
        }
        if self.too_few > 0 {
            soup.notes
                .push(Note::repaired(format!("{} faces with fewer than three corners are left out", self.too_few)));
        }
        if rough > 0 {
            soup.notes.push(Note::info(format!(
                "{rough} polygons cross themselves or have no area; their triangles may overlap"
            )));
        }
        Ok(soup)
    }
}
