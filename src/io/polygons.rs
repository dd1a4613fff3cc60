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
}

/// Where in a file of lines something is that a message tells of.
#[derive(Default)]
pub(super) struct Examples {
    /// The largest vertex number of a face with three corners or more, as it is written, and its line.
    pub(super) largest: Option<(i64, u64)>,
    /// The line of the first face with fewer than three corners.
    pub(super) too_few: Option<u64>,
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

    /// Ends the current polygon. One with fewer than three corners counts, but has no triangles.
    #[inline]
    pub(super) fn end_face(&mut self) {
        match self.corners[self.ended()..] {
            [a, b, c] if self.ends.is_empty() => {
                self.triangles.push([a, b, c]);
                self.corners.clear();
            }
            _ => self.ends.push(self.corners.len()),
        }
    }

    /// Polygons that have ended.
    pub(super) fn count(&self) -> usize {
        self.triangles.len() + self.ends.len()
    }

    /// Corners of the current polygon.
    pub(super) fn open_corners(&self) -> usize {
        self.corners.len() - self.ended()
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
        self.into_grouped(positions, &[], &Examples::default())
    }

    /// The same with groups, each a name and the number of polygons before it, which ends the one before. `largest`
    /// says where the largest vertex number stands, if that is known.
    pub(super) fn into_grouped(
        self,
        positions: Positions,
        groups: &[(String, usize)],
        examples: &Examples,
    ) -> Result<Soup, ParseError> {
        if self.count() == 0 {
            return Err(ParseError::file("there are no faces: a point cloud must be meshed first"));
        }
        let count = positions.len();
        let starts = || std::iter::once(0).chain(self.ends.iter().copied());
        let more: usize = starts().zip(&self.ends).map(|(start, &end)| (end - start).saturating_sub(2)).sum();
        if self.triangles.len() + more > MAX_FACES {
            return Err(ParseError::file(format!("there are more than the {MAX_FACES} triangles that can be handled")));
        }
        let mut outside = Few::default();
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
        let (mut rough, mut effort, mut too_few) = (0, Effort::default(), Few::default());
        for (i, (start, &end)) in starts().zip(&self.ends).enumerate() {
            let corners = &self.corners[start..end];
            spans.reach(before + i, triangles.len());
            if corners.len() < 3 {
                too_few.add(before + i);
            } else if outside.all_inside(before + i, corners, count)
                && triangulate(corners, |c| positions.get(c as usize), &mut effort, &mut triangles) == Outcome::Rough
            {
                rough += 1;
            }
        }
        match examples.largest {
            _ if !triangles.is_empty() => {}
            _ if outside.count == 0 => {
                return Err(ParseError::file("there are no faces with three or more corners"));
            }
            Some((vertex, line)) => {
                let what = format!("vertex {vertex} is out of range: the file has {count} vertices");
                return Err(ParseError::line(line, what));
            }
            None => {
                let what = format!("all faces name vertices out of range: the file has {count} vertices");
                return Err(ParseError::file(what));
            }
        }
        let end = triangles.len();
        let mut soup = Soup::new(positions, triangles);
        soup.groups = spans.ended(end);
        let first = |few: &Few| format!(", the first is face {}", few.first);
        if outside.count > 0 {
            let example = examples.largest.map(|(vertex, line)| format!(", such as vertex {vertex} in line {line}"));
            let example = example.unwrap_or_else(|| first(&outside));
            soup.notes.push(Note::repaired(format!(
                "{} left out for a vertex number out of range (there are {count} vertices){example}",
                counted(outside.count, "face")
            )));
        }
        if too_few.count > 0 {
            let example = examples.too_few.map(|line| format!(", the first in line {line}"));
            soup.notes.push(Note::repaired(format!(
                "{} left out for having fewer than three corners{}",
                counted(too_few.count, "face"),
                example.unwrap_or_else(|| first(&too_few))
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

/// Polygons that are left out.
#[derive(Default)]
struct Few {
    count: usize,
    first: usize,
}

impl Few {
    fn add(&mut self, face: usize) {
        if self.count == 0 {
            self.first = face;
        }
        self.count += 1;
    }

    /// True when all corners are below `count`; otherwise the face is added.
    fn all_inside(&mut self, face: usize, corners: &[u32], count: usize) -> bool {
        let inside = corners.iter().all(|&corner| (corner as usize) < count);
        if !inside {
            self.add(face);
        }
        inside
    }
}
