//! The part of the surface around a place: its vertices gathered, weighed and laid side by side for a fit.

pub(super) mod batch;
mod marks;
pub(super) mod rings;
pub(super) mod rulings;
pub(super) mod samples;
pub(super) mod window;
