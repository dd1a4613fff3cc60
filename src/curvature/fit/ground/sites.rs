//! Where windows take their samples from.

use super::fans::Fans;
use glam::{DVec3, Vec3};

/// Samples of the surface, each with neighbours: the fans of a mesh or [`cells`](super::cells) of them.
pub(in crate::curvature::fit) trait Sites: Sync {
    /// Least number of samples in a window of given radius.
    const LEAST: usize;

    fn fans(&self) -> &Fans<'_>;

    fn count(&self) -> usize;

    /// The one that a fan belongs to.
    fn of_fan(&self, fan: u32) -> u32;

    fn position(&self, site: u32) -> DVec3;

    /// The longer the larger its faces are.
    fn normal(&self, site: u32) -> Vec3;

    /// Of the normal; zero where there is none.
    fn direction(&self, site: u32) -> Vec3;

    /// Those that hang together with it; some of them may be named twice.
    fn neighbours(&self, site: u32) -> &[u32];

    /// Of how many fans it is the mean, against all others.
    fn weight(&self, site: u32) -> f64;

    /// The vertex, if other sites stand for the same.
    fn shared_vertex(&self, site: u32) -> Option<u32>;

    /// The share of vertices that lie neither on a border nor on a sharp edge.
    fn coverage(&self, sites: &[u32]) -> f64;
}
