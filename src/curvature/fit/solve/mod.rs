//! Surfaces through samples, by least squares: four windows at a time, one in each lane.
//!
//! Nothing here knows where the samples come from.

pub(super) mod abreast;
pub(super) mod choice;
pub(super) mod chord_fitter;
pub(super) mod cyclide;
pub(super) mod equations;
mod moments;
pub(super) mod prior;
