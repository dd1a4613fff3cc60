//! PLY, both ways.

mod read;
mod rows;
mod values;
mod write;

pub(super) use read::{looks_like, read};
pub(super) use write::write;
