//! glTF 2.0, as a JSON document (`.gltf`) and in its binary form (`.glb`).
//!
//! Files are parsed with `gltf-json` and without its validation, which refuses too much (every
//! extension it does not know) and promises too little: every index, offset and count of a
//! document is checked here, where it is used.

mod accessor;
mod buffers;
mod container;
mod geometry;
mod layout;
mod lines;
mod meshopt;
mod read;
mod scene;
mod write;

pub(super) use layout::{check_glb_length, faces_byte_length};
pub use lines::{LineScene, write_lines};
pub(super) use read::read;
pub(super) use write::{files_beside, write_embedded, write_glb, write_gltf};
