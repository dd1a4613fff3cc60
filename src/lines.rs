//! Polylines in space, in named and coloured layers: what disks, traces, sections and edges are
//! written as.

use crate::color::Rgb;
use glam::DVec3;

/// A chain of points, relative to a mesh's origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// The points; consecutive ones differ.
    pub points: Vec<DVec3>,
    /// True when the last point is joined to the first.
    pub closed: bool,
}

impl Polyline {
    /// An open chain through the points, without repetitions.
    pub fn open(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut points: Vec<DVec3> = points.into_iter().collect();
        points.dedup();
        Polyline { points, closed: false }
    }

    /// A closed chain through the points, without repetitions; open where fewer than three remain.
    pub fn closed(points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut line = Polyline::open(points);
        while line.points.len() > 1 && line.points.first() == line.points.last() {
            line.points.pop();
        }
        line.closed = line.points.len() > 2;
        line
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        let open: f64 = self.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        match self.points.as_slice() {
            [first, .., last] if self.closed => open + last.distance(*first),
            _ => open,
        }
    }
}

/// Polylines that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Name of the object in the output.
    pub name: String,
    /// Their colour.
    pub color: Rgb,
    /// The polylines.
    pub lines: Vec<Polyline>,
    /// Values of the lines: name of the glTF attribute, dimension (the power of length it goes with), and
    /// one number per line. Written where every line is a single segment.
    pub values: Vec<(&'static str, i32, Vec<f64>)>,
}
