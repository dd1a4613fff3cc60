//! Parametric surfaces with their exact curvature.

use glam::{DMat2, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// A smooth surface over a rectangle of parameters, with normals outward or upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The square [-1, 1]^2 at height 0.
    Plane,
    /// A sphere.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// The side of a cylinder about the z axis, open at both ends.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Height; from -height/2 to height/2.
        height: f64,
    },
    /// A torus about the z axis.
    Torus {
        /// Radius of the centre circle.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// An ellipsoid with its axes along x, y and z.
    Ellipsoid {
        /// Half lengths along x, y and z.
        axes: DVec3,
    },
    /// z = x^2 - y^2 over [-1, 1]^2.
    Saddle,
    /// z = x^3 - 3 x y^2 over [-1, 1]^2.
    MonkeySaddle,
    /// z = 0.1 sin(pi x) cos(pi y) over [-1, 1]^2.
    Wave,
}

/// A point of a surface with its first and second derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub(super) point: DVec3,
    u: DVec3,
    v: DVec3,
    uu: DVec3,
    uv: DVec3,
    vv: DVec3,
}

/// Exact curvature at a point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    /// Largest normal curvature.
    pub k_max: f64,
    /// Smallest normal curvature.
    pub k_min: f64,
    /// Unit tangent of `k_max`.
    pub dir_max: DVec3,
    /// Unit tangent of `k_min`.
    pub dir_min: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

/// How a parameter runs over its range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Axis {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) periodic: bool,
}

impl Surface {
    /// The least number of cells along u and v: 3 around, 2 between poles, 1 otherwise.
    pub fn least_cells(&self) -> [usize; 2] {
        let [u, v] = self.axes().map(|axis| if axis.periodic { 3 } else { 1 });
        [u, if self.has_poles() { 2 } else { v }]
    }

    /// The ranges of u and v.
    pub(super) fn axes(&self) -> [Axis; 2] {
        let turn = Axis { start: 0.0, end: 2.0 * PI, periodic: true };
        let side = Axis { start: -1.0, end: 1.0, periodic: false };
        match *self {
            Surface::Plane | Surface::Saddle | Surface::MonkeySaddle | Surface::Wave => [side, side],
            Surface::Sphere { .. } | Surface::Ellipsoid { .. } => {
                [turn, Axis { start: -FRAC_PI_2, end: FRAC_PI_2, periodic: false }]
            }
            Surface::Cylinder { height, .. } => {
                [turn, Axis { start: -0.5 * height, end: 0.5 * height, periodic: false }]
            }
            Surface::Torus { .. } => [turn, turn],
        }
    }

    /// True where the ends of v are single points.
    pub(super) fn has_poles(&self) -> bool {
        matches!(self, Surface::Sphere { .. } | Surface::Ellipsoid { .. })
    }

    pub(super) fn jet(&self, at: DVec2) -> Jet {
        let DVec2 { x: u, y: v } = at;
        let (su, cu) = u.sin_cos();
        let (sv, cv) = v.sin_cos();
        let round = DVec3::new(cu, su, 0.0);
        let along = DVec3::new(-su, cu, 0.0);
        match *self {
            Surface::Plane => graph(u, v, [0.0; 6]),
            Surface::Saddle => graph(u, v, [u * u - v * v, 2.0 * u, -2.0 * v, 2.0, 0.0, -2.0]),
            Surface::MonkeySaddle => graph(
                u,
                v,
                [u * u * u - 3.0 * u * v * v, 3.0 * u * u - 3.0 * v * v, -6.0 * u * v, 6.0 * u, -6.0 * v, -6.0 * u],
            ),
            Surface::Wave => {
                let (su, cu) = (PI * u).sin_cos();
                let (sv, cv) = (PI * v).sin_cos();
                let (z, z1, z2) = (0.1, 0.1 * PI, 0.1 * PI * PI);
                graph(u, v, [z * su * cv, z1 * cu * cv, -z1 * su * sv, -z2 * su * cv, -z2 * cu * sv, -z2 * su * cv])
            }
            Surface::Ellipsoid { axes } => Surface::Sphere { radius: 1.0 }.jet(at).scaled(axes),
            Surface::Sphere { radius: r } => Jet {
                point: r * (cv * round + sv * DVec3::Z),
                u: r * cv * along,
                v: r * (-sv * round + cv * DVec3::Z),
                uu: -r * cv * round,
                uv: -r * sv * along,
                vv: -r * (cv * round + sv * DVec3::Z),
            },
            Surface::Cylinder { radius: r, .. } => Jet {
                point: r * round + v * DVec3::Z,
                u: r * along,
                v: DVec3::Z,
                uu: -r * round,
                uv: DVec3::ZERO,
                vv: DVec3::ZERO,
            },
            Surface::Torus { major, minor } => Jet {
                point: (major + minor * cv) * round + minor * sv * DVec3::Z,
                u: (major + minor * cv) * along,
                v: minor * (-sv * round + cv * DVec3::Z),
                uu: -(major + minor * cv) * round,
                uv: -minor * sv * along,
                vv: -minor * (cv * round + sv * DVec3::Z),
            },
        }
    }

    /// Lengths of the middle lines along u and v.
    pub(super) fn lengths(&self) -> [f64; 2] {
        const STEPS: usize = 64;
        let [u, v] = self.axes();
        let at = |axis: Axis, share: f64| axis.start + (axis.end - axis.start) * share;
        let line = |point: &dyn Fn(f64) -> DVec3| {
            (0..STEPS).map(|i| point(i as f64 / STEPS as f64).distance(point((i + 1) as f64 / STEPS as f64))).sum()
        };
        let point = |s: f64, t: f64| self.jet(DVec2::new(at(u, s), at(v, t))).point;
        // A quarter of a turn is the middle of what a torus has inside and outside.
        let across = if v.periodic { 0.25 } else { 0.5 };
        [line(&|s| point(s, across)), line(&|t| point(0.5, t))]
    }

    /// Exact curvature at the point of the surface nearest to `p`, searched from `start`.
    pub(super) fn exact_at_foot(&self, start: DVec2, p: DVec3) -> Exact {
        let mut at = start;
        for _ in 0..20 {
            let jet = self.jet(at);
            let away = p - jet.point;
            // Newton's method for both tangents being at right angles to the way to p.
            let gradient = DVec2::new(away.dot(jet.u), away.dot(jet.v));
            let off = jet.u.dot(jet.v) - away.dot(jet.uv);
            let hessian = DMat2::from_cols(
                DVec2::new(jet.u.dot(jet.u) - away.dot(jet.uu), off),
                DVec2::new(off, jet.v.dot(jet.v) - away.dot(jet.vv)),
            );
            let step = hessian.inverse() * gradient;
            at += step;
            if step.length() < 1e-15 * (1.0 + at.length()) {
                break;
            }
        }
        self.jet(at).curvature()
    }
}

/// A jet of the graph of a height function: value, d/du, d/dv, d2/du2, d2/dudv, d2/dv2.
fn graph(u: f64, v: f64, [z, zu, zv, zuu, zuv, zvv]: [f64; 6]) -> Jet {
    Jet {
        point: DVec3::new(u, v, z),
        u: DVec3::new(1.0, 0.0, zu),
        v: DVec3::new(0.0, 1.0, zv),
        uu: zuu * DVec3::Z,
        uv: zuv * DVec3::Z,
        vv: zvv * DVec3::Z,
    }
}

impl Jet {
    /// The jet of the surface stretched along x, y and z.
    fn scaled(self, by: DVec3) -> Self {
        Jet {
            point: by * self.point,
            u: by * self.u,
            v: by * self.v,
            uu: by * self.uu,
            uv: by * self.uv,
            vv: by * self.vv,
        }
    }

    /// Principal curvatures from the first and second fundamental forms.
    fn curvature(&self) -> Exact {
        let normal = self.u.cross(self.v).normalize();
        // Orthonormal tangents x along u, y = normal x x; derivatives in them by the chain rule.
        let x = self.u.normalize();
        let y = normal.cross(x);
        let first =
            DMat2::from_cols(DVec2::new(self.u.dot(x), self.u.dot(y)), DVec2::new(self.v.dot(x), self.v.dot(y)));
        let second = DMat2::from_cols(
            DVec2::new(self.uu.dot(normal), self.uv.dot(normal)),
            DVec2::new(self.uv.dot(normal), self.vv.dot(normal)),
        );
        let to_parameters = first.inverse();
        // Positive where the surface bends away from its normal: hence the minus.
        let shape = to_parameters.transpose() * second * to_parameters * -1.0;
        let (a, b, c) = (shape.x_axis.x, shape.x_axis.y, shape.y_axis.y);
        let angle = 0.5 * (2.0 * b).atan2(a - c);
        let (mean, amplitude) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let dir_max = angle.cos() * x + angle.sin() * y;
        Exact { k_max: mean + amplitude, k_min: mean - amplitude, dir_max, dir_min: normal.cross(dir_max), normal }
    }
}
