//! Windows wider than those of clean surfaces: under noise, on rough scans, and of a radius that the user has given.

pub(super) mod kind;
mod lepski;
pub(super) mod patches;
mod probe;
pub(super) mod rough;
pub(super) mod scale;
pub(super) mod shared;
pub(super) mod steady;
