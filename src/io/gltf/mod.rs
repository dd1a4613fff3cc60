//! glTF 2.0, as a JSON document (`.gltf`) and in its binary form (`.glb`).
//!
//! Reading: `container`, `buffers`, `accessor`, `geometry`, `scene`, put together in `read`. Writing:
//! `document` builds the JSON on a `draft` and lists the streams of `layout`, which `stream_writer` writes; a
//! document that came from glTF is `opened` again, `strip`ped of what an earlier run added, and its vertices split
//! in `pool`.
//!
//! Files are parsed with `gltf-json` and without its validation, which refuses too much (every
//! extension it does not know) and promises too little: every index, offset and count of a
//! document is checked here, where it is used.

mod accessor;
mod buffers;
mod columns;
mod container;
mod cull;
mod document;
mod draft;
mod fresh;
mod geometry;
mod indexed;
mod layout;
mod lines;
mod looks;
mod meshopt;
mod metadata;
mod opened;
mod pool;
mod read;
mod references;
mod scene;
mod stream_writer;
mod strip;
mod uri;
mod values;
mod vertices;
mod write;

pub(super) use layout::{check_glb_length, expected_bytes};
pub use lines::{LineScene, write_lines};
pub(super) use looks::palettes;
pub(super) use read::read;
pub(super) use values::{are_there, read_values};
pub(super) use write::{check_original, files_of, most_files, write_embedded, write_glb, write_gltf};
