//! Numbers side by side, for loops that run with the processor's vectors and give the same bits on all of them.

pub(super) mod eight;
pub(super) mod four;
