//! Polygons over numbered vertices, as PLY and OFF files list them, and their triangles.

use crate::error::ParseError;
use crate::soup::{MAX_FACES, Note, Positions, Soup};
use crate::triangulate::{Outcome, triangulate};

/// Polygons as read. Corners are checked at the end: faces may come before the vertices.
#[derive(Default)]
pub(super) struct Polygons {
    corners: Vec<u32>,
    /// The corners of polygons that have ended.
    ended: usize,
    /// The end of each polygon in `corners`; `None` as long as all are triangles, as most are.
    ends: Option<Vec<usize>>,
    too_few: usize,
}

impl Polygons {
    /// Adds a corner to the current polygon or strip.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends the current polygon.
    #[inline]
    pub(super) fn end_face(&mut self) {
        let corners = self.corners.len() - self.ended;
        if corners < 3 {
            self.corners.truncate(self.ended);
            self.too_few += 1;
            return;
        }
        if corners > 3 && self.ends.is_none() {
            self.ends = Some((1..=self.ended / 3).map(|i| 3 * i).collect());
        }
        self.ended = self.corners.len();
        if let Some(ends) = &mut self.ends {
            ends.push(self.ended);
        }
    }

    /// Ends the current strip: its corners become triangles.
    pub(super) fn end_strip(&mut self) {
        let strip = self.corners.split_off(self.ended);
        for (i, t) in strip.windows(3).enumerate() {
            let [a, b, c] = [t[0], t[1], t[2]];
            // Every other triangle of a strip runs backwards; a repeated corner only moves the strip on.
            if a != b && b != c && c != a {
                self.corners.extend(if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                self.end_face();
            }
        }
    }

    /// The triangles over `positions`. Polygons that name other vertices are left out and told.
    pub(super) fn into_soup(self, positions: Positions) -> Result<Soup, ParseError> {
        if self.ended == 0 {
            return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
        }
        let count = positions.len();
        let polygons = self.ends.as_ref().map_or(self.ended / 3, Vec::len);
        let most = self.ended - 2 * polygons;
        if most > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        let mut triangles = Vec::with_capacity(most);
        let (mut rough, mut out_of_range, mut first_out) = (0, 0, 0);
        let mut add = |face: usize, corners: &[u32]| {
            if corners.iter().any(|&c| c as usize >= count) {
                if out_of_range == 0 {
                    first_out = face;
                }
                out_of_range += 1;
            } else if triangulate(corners, |c| positions.get(c as usize), &mut triangles) == Outcome::Rough {
                rough += 1;
            }
        };
        match &self.ends {
            None => self.corners[..self.ended]
                .as_chunks::<3>()
                .0
                .iter()
                .enumerate()
                .for_each(|(face, corners)| add(face, corners)),
            Some(ends) => {
                let mut start = 0;
                for (face, &end) in ends.iter().enumerate() {
                    add(face, &self.corners[start..end]);
                    start = end;
                }
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
