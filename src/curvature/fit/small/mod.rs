//! Clean surfaces: the smallest window that determines a surface, and what is done at their corners and rims.

pub(super) mod exact;
pub(super) mod first;
pub(super) mod flats;
pub(super) mod groups;
pub(super) mod one_sided;
pub(super) mod strips;
