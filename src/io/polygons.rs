//! Polygons over numbered vertices, as OBJ, PLY and OFF files list them, and their triangles.

use crate::error::ParseError;
use crate::soup::{Group, MAX_FACES, Note, Positions, Soup};
use crate::triangulate::{Effort, Outcome, triangulate};
use crate::wording::counted;
use rayon::prelude::*;

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

    /// Polygons that have ended and have not been dropped.
    pub(super) fn count(&self) -> usize {
        self.triangles.len() + self.ends.len()
    }

    /// Corners of the current polygon.
    pub(super) fn open_corners(&self) -> usize {
        self.corners.len() - self.ended()
    }

    /// Drops the current polygon.
    pub(super) fn drop_face(&mut self) {
        self.corners.truncate(self.ended());
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
        self.into_grouped(positions, &[], None)
    }

    /// The same with groups, each a name and the number of polygons before it, which ends the one before. `largest`
    /// says where the largest vertex number stands, if that is known.
    pub(super) fn into_grouped(
        self,
        positions: Positions,
        groups: &[(String, usize)],
        largest: Option<&str>,
    ) -> Result<Soup, ParseError> {
        if self.count() == 0 {
            return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
        }
        let count = positions.len();
        let more = self.ended() - 2 * self.ends.len();
        if self.triangles.len() + more > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        let mut outside = Outside::default();
        let mut spans = Spans { left: groups, spans: Vec::new() };
        let mut triangles = self.triangles;
        let before = triangles.len();
        if triangles.par_iter().any(|corners| corners.iter().any(|&corner| corner as usize >= count)) {
            let mut kept = 0;
            for face in 0..before {
                spans.reach(face, kept);
                if outside.all_inside(face, &triangles[face], count) {
                    triangles[kept] = triangles[face];
                    kept += 1;
                }
            }
            triangles.truncate(kept);
        } else {
            while let Some(&(_, face)) = spans.left.first().filter(|(_, face)| *face < before) {
                spans.reach(face, face);
            }
        }
        triangles.reserve_exact(more);
        let (mut rough, mut start, mut effort) = (0, 0, Effort::default());
        for (i, &end) in self.ends.iter().enumerate() {
            let corners = &self.corners[start..end];
            spans.reach(before + i, triangles.len());
            if outside.all_inside(before + i, corners, count)
                && triangulate(corners, |c| positions.get(c as usize), &mut effort, &mut triangles) == Outcome::Rough
            {
                rough += 1;
            }
            start = end;
        }
        let example = largest.map(|largest| format!(", such as {largest}")).unwrap_or_default();
        if triangles.is_empty() {
            return Err(ParseError::file(format!(
                "all faces name vertices out of range: the file has {count} vertices{example}"
            )));
        }
        let end = triangles.len();
        let mut soup = Soup::new(positions, triangles);
        soup.groups = spans.ended(end);
        if let Outside { faces: 1.., first } = outside {
            let example = if example.is_empty() { format!(", the first is face {first}") } else { example };
            soup.notes.push(Note::repaired(format!(
                "{} left out for a vertex number out of range (there are {count} vertices){example}",
                counted(outside.faces, "face")
            )));
        }
        if self.too_few > 0 {
            soup.notes.push(Note::repaired(format!(
                "{} left out for having fewer than three corners",
                counted(self.too_few, "face")
            )));
        }
        if rough > 0 {
            soup.notes.push(Note::info(format!(
                "{rough} polygons cross themselves, have no area or are too long; their triangles may overlap"
            )));
        }
        Ok(soup)
    }
}

/// Groups on their way from polygons to triangles.
struct Spans<'g> {
    /// Names, each with the number of polygons before it.
    left: &'g [(String, usize)],
    spans: Vec<Group>,
}

impl Spans<'_> {
    /// Begins the groups that begin at a polygon or before, of which so many triangles have been made.
    fn reach(&mut self, polygon: usize, triangles: usize) {
        while let [(name, before), left @ ..] = self.left
            && *before <= polygon
        {
            self.begin(name, triangles as u32);
            self.left = left;
        }
    }

    /// Ends the group before and begins the next; a group without faces leaves no trace.
    fn begin(&mut self, name: &str, at: u32) {
        self.spans.pop_if(|last| last.faces.start == at);
        match self.spans.last_mut() {
            Some(last) if last.name == name => {}
            last => {
                if let Some(last) = last {
                    last.faces.end = at;
                }
                self.spans.push(Group { name: name.to_owned(), faces: at..at });
            }
        }
    }

    fn ended(mut self, triangles: usize) -> Vec<Group> {
        self.spans.pop_if(|last| last.faces.start as usize == triangles);
        if let Some(last) = self.spans.last_mut() {
            last.faces.end = triangles as u32;
        }
        self.spans
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
