//! Where the viewer stands and what comes to lie where on the screen.

use super::super::display::Display;
use crate::error::Error;
use glam::{DVec3, Vec3};

/// The side that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ViewFrom {
    /// From the front, the right and above, so that three sides show.
    #[default]
    Iso,
    /// From the positive end of the x axis.
    X,
    /// From the positive end of the y axis.
    Y,
    /// From the positive end of the z axis.
    Z,
    /// Along a direction from the viewer to the mesh, in the input's axes.
    Along(DVec3),
}

impl ViewFrom {
    pub(super) fn check(&self) -> Result<(), Error> {
        match self {
            ViewFrom::Along(direction) if direction.try_normalize().is_none() => {
                Err(Error::Usage("a view direction must not be zero".into()))
            }
            _ => Ok(()),
        }
    }

    /// Unit vector from the mesh to the viewer.
    fn back(self, z_up: bool) -> DVec3 {
        let back = match self {
            ViewFrom::Iso if z_up => DVec3::new(1.0, -1.0, 0.8),
            ViewFrom::Iso => DVec3::new(1.0, 0.8, 1.0),
            ViewFrom::X => DVec3::X,
            ViewFrom::Y => DVec3::Y,
            ViewFrom::Z => DVec3::Z,
            ViewFrom::Along(direction) => -direction,
        };
        back.normalize_or(DVec3::Z)
    }
}

/// A pinhole that sees the whole mesh.
pub(super) struct Camera {
    right: DVec3,
    up: DVec3,
    back: DVec3,
    centre: DVec3,
    distance: f64,
    /// Pixels per unit of slope.
    focal: f64,
    middle: [f64; 2],
}

/// Half the vertical opening angle, as in the page.
const HALF_OPENING: f64 = 0.26;
/// Share of the picture that stays free around the mesh.
const MARGIN: f64 = 0.05;

impl Camera {
    /// As near as it can come while every vertex is seen.
    pub(super) fn fit(view: &ViewFrom, z_up: bool, display: &Display, [width, height]: [usize; 2]) -> Self {
        let back = view.back(z_up);
        let axis = if z_up { DVec3::Z } else { DVec3::Y };
        // Seen along its up axis a mesh has its next axis up.
        let next = if z_up { DVec3::Y } else { DVec3::NEG_Z };
        let right = if back.dot(axis).abs() > 0.999 { next.cross(back) } else { axis.cross(back) }.normalize();
        let up = back.cross(right);
        let used = || display.corners.as_flattened().iter().map(|&v| display.positions[v as usize]);
        let (low, high) = used().fold((DVec3::MAX, DVec3::MIN), |(low, high), p| (low.min(p), high.max(p)));
        let centre = 0.5 * low + 0.5 * high;
        let (width, height) = (width as f64, height as f64);
        let slope = HALF_OPENING.tan();
        let focal = 0.5 * height / slope;
        let [slope_x, slope_y] = [slope * width / height, slope].map(|s| s * (1.0 - 2.0 * MARGIN));
        // How far vertices reach beyond lines of sight: to the right, the left, above and below.
        let reach = used().fold([f64::MIN; 4], |[r, l, a, b], p| {
            let p = p - centre;
            let (x, y, z) = (p.dot(right), p.dot(up), p.dot(back));
            let (zx, zy) = (slope_x * z, slope_y * z);
            [r.max(x + zx), l.max(zx - x), a.max(y + zy), b.max(zy - y)]
        });
        let [r, l, a, b] = reach;
        let centre = centre + 0.5 * (r - l) * right + 0.5 * (a - b) * up;
        let needed = (0.5 * (r + l) / slope_x).max(0.5 * (a + b) / slope_y);
        // A mesh that is a line along the view would end in the viewer's eye.
        let distance = needed + 0.01 * (high - low).length();
        let distance = if distance > 0.0 { distance } else { 1.0 };
        Camera { right, up, back, centre, distance, focal, middle: [0.5 * width, 0.5 * height] }
    }

    /// Pixels from the left and the top, and nearness: 1 over the distance, in 1 over the camera's own.
    pub(super) fn project(&self, p: DVec3) -> [f64; 3] {
        let p = p - self.centre;
        let near = 1.0 / (self.distance - p.dot(self.back)).max(1e-9 * self.distance);
        let [x, y] = [p.dot(self.right), -p.dot(self.up)].map(|c| c * near * self.focal);
        [self.middle[0] + x, self.middle[1] + y, near * self.distance]
    }

    /// A direction in the viewer's axes: right, up, towards the viewer.
    pub(super) fn turn(&self, direction: DVec3) -> Vec3 {
        DVec3::new(direction.dot(self.right), direction.dot(self.up), direction.dot(self.back)).as_vec3()
    }
}
