//! Surfaces that a fit can find, each in a frame of its own: what they are like below a point.
//!
//! Nothing here knows of samples or of meshes.

pub(super) mod bivariate;
pub(super) mod chord;
pub(super) mod foot;
pub(super) mod frame;
pub(super) mod implicit;
pub(super) mod polynomial;
pub(super) mod shape;
