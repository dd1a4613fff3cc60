//! The kinds of noise, and what each means for the windows that are tried and believed.

use super::probe::HOPELESS;

/// Growth of the variance of samples from the first to the second level that says that the surface is
/// smooth and its fits too coarse, not that it is noisy.
pub(super) const SMOOTH: f64 = 6.8;

/// What keeps small windows from being explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::curvature::fit) enum Noise {
    /// On some parts of the mesh only: as likely detail of a clean surface, from which nothing follows for the parts
    /// around.
    Local,
    /// What the samples are off by at one vertex says nothing of the next.
    Independent,
    /// Samples are off by the same over an edge or two, as in range images. Small windows follow it, so that what they
    /// leave is far less than the noise.
    Alike,
    /// Noise and detail at every scale from the edges up, as real scans have it. No window is then better than another
    /// by what the data say.
    Rough,
}

impl Noise {
    /// Growth of the variance of samples from its least at which larger windows are not tried. Alike noise itself makes
    /// it grow.
    pub(super) fn hopeless(self) -> f64 {
        if self == Noise::Alike { 30.0 } else { HOPELESS }
    }

    /// How far a fit is by chance from one of more variance, squared: what is beyond is bias. `None` for one that has
    /// little more.
    pub(super) fn chance(self, witness: f64, variance: f64) -> Option<f64> {
        const LEAST: f64 = 1.15;
        const REACH: f64 = 16.0;
        // Large windows that all miss the surface are alike off. Far smaller ones can tell, if for their own variance
        // they can tell anything.
        const FAR: f64 = 5.0;
        match (self, witness <= REACH * variance) {
            _ if witness < LEAST * variance => None,
            // Once more the witness, since large windows of neighbouring seeds err as one, and one may err by as much.
            (Noise::Independent, true) => Some(2.0 * witness - variance),
            (_, true) => Some(witness - variance),
            (_, false) => Some(FAR * witness),
        }
    }
}
