//! Compressed views of an original, written plainly.

use super::{Draft, Piece, ranges_of};
use crate::error::ParseError;
use crate::io::gltf::buffers::Buffers;
use crate::io::gltf::meshopt::NAMES as MESHOPT;
use serde_json::Value;

impl<'a> Draft<'a> {
    /// Puts what compressed views decode to in their place: the vertices beside them are not
    /// compressed either, and few programs can read such files.
    pub(super) fn decompress(&mut self, given: &'a Buffers<'_>) -> Result<(), ParseError> {
        let mut unpacked = Vec::new();
        for v in 0..self.list("bufferViews").len() {
            if self.placed.contains_key(&v) {
                continue;
            }
            let view = &mut self.list("bufferViews")[v];
            let ranges = ranges_of(view);
            if !drop_meshopt(view) {
                continue;
            }
            if let Some(bytes) = given.unpacked(v)? {
                view["byteLength"] = bytes.len().into();
                unpacked.push((v, bytes));
            }
            // What a view with a fallback shows is needed still, and is not cut out.
            self.dropped.extend(ranges);
        }
        // In front, where an original that was plain has them.
        self.placed.values_mut().for_each(|piece| *piece += unpacked.len());
        self.coded = std::mem::take(&mut self.coded).into_iter().map(|(p, c)| (p + unpacked.len(), c)).collect();
        self.placed.extend(unpacked.iter().enumerate().map(|(piece, (view, _))| (*view, piece)));
        let given = unpacked.into_iter().map(|(_, bytes)| Piece::Given(bytes));
        self.pieces = given.chain(std::mem::take(&mut self.pieces)).collect();
        for buffer in self.list("buffers") {
            drop_meshopt(buffer);
        }
        for list in ["extensionsUsed", "extensionsRequired"] {
            let Some(Value::Array(names)) = self.root.get_mut(list) else { continue };
            names.retain(|name| !MESHOPT.iter().any(|meshopt| name == meshopt));
            if names.is_empty() {
                self.root.remove(list);
            }
        }
        Ok(())
    }
}

/// Takes the words about compression out of a view or a buffer; true when there were any.
fn drop_meshopt(object: &mut Value) -> bool {
    let Some(extensions) = object.get_mut("extensions").and_then(Value::as_object_mut) else { return false };
    let before = extensions.len();
    extensions.retain(|name, _| !MESHOPT.contains(&name.as_str()));
    let found = extensions.len() < before;
    if extensions.is_empty()
        && found
        && let Some(object) = object.as_object_mut()
    {
        object.remove("extensions");
    }
    found
}
