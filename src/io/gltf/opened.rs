//! An original document opened again, so that an output can carry over what is not geometry.

use super::accessor::Accessors;
use super::buffers::{Buffers, Source};
use super::container;
use super::read::{Document, parse, requires_meshopt};
use super::references::Object;
use super::strip::VARIANTS;
use super::uri::{has_scheme, load};
use crate::error::{Error, ParseError};
use crate::io::folders::Folders;
use crate::io::real_path;
use crate::soup::{Original, PrimitiveFaces, Scene};
use serde_json::Value;
use std::path::Path;

/// An original document.
pub(super) struct Opened<'o> {
    original: &'o Original,
    /// The faces of each primitive.
    pub(super) primitives: &'o [PrimitiveFaces],
    json: &'o [u8],
    bin: Option<&'o [u8]>,
    /// What of it matters to geometry.
    pub(super) document: Document,
}

impl<'o> Opened<'o> {
    /// Parses the document again that the reader has accepted, where the scene has one.
    pub(super) fn new(scene: &'o Scene) -> Result<Option<Self>, Error> {
        let Some(original) = scene.original.as_deref() else { return Ok(None) };
        let read = || {
            let bytes = original.bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&original.bytes);
            let (json, bin) = if container::is_glb(bytes) {
                let chunks = container::split(bytes, &mut Vec::new())?;
                (chunks.json, chunks.bin)
            } else {
                (bytes, None)
            };
            Ok((json, bin, parse(json, "")?))
        };
        let (json, bin, document) = read().map_err(|e| Error::parse(&original.path, e))?;
        Ok(Some(Opened { original, primitives: &scene.primitives, json, bin, document }))
    }

    /// The whole document.
    pub(super) fn root(&self) -> Result<Object, ParseError> {
        let root: Object = serde_json::from_slice(self.json)
            .map_err(|e| ParseError::file(format!("the document cannot be carried over: {e}")))?;
        let lists = ["accessors", "bufferViews", "buffers", "images", "materials", "meshes", "samplers", "textures"];
        for list in lists.into_iter().chain(["animations", "nodes", "skins", "extensionsUsed"]) {
            if root.get(list).is_some_and(|list| !list.is_array()) {
                return Err(ParseError::json(list, "must be an array"));
            }
        }
        let extensions = root.get("extensions").map(|extensions| (extensions, extensions.get(VARIANTS)));
        if extensions.is_some_and(|(all, variants)| !all.is_object() || variants.is_some_and(|v| !v.is_object())) {
            return Err(ParseError::json("extensions", "must be objects"));
        }
        Ok(root)
    }

    /// True when a document in this folder can name the original's files as they are.
    pub(super) fn is_in(&self, folder: &Path) -> bool {
        let real = |path: &Path| real_path(&path.join("x"));
        self.original.folder.as_deref().is_some_and(|own| real(own) == real(folder))
    }

    /// Where files that it names may lie.
    fn folders(&self) -> Folders<'_> {
        Folders::new(self.original.folder.as_deref(), &self.original.allowed_folders)
    }

    /// Its accessors over its buffers.
    pub(super) fn accessors(&self) -> Accessors<'_> {
        let source = Source { file: &self.original.bytes, bin: self.bin, folders: self.folders() };
        let meshopt = requires_meshopt(&self.document.extensions_required);
        let buffers = Buffers::new(&self.document.buffers, &self.document.buffer_views, meshopt, source);
        Accessors::new(&self.document.accessors, buffers)
    }

    /// The content of an image in a file of its own, of a relative name, or why it cannot be had.
    pub(super) fn image(&self, uri: &str) -> Result<Vec<u8>, String> {
        load(uri, self.folders()).map(|bytes| bytes.into_owned())
    }

    /// Names the original in an error.
    pub(super) fn error(&self, error: ParseError) -> Error {
        Error::parse(&self.original.path, error)
    }
}

/// The media type of an image, by its first bytes or its name.
pub(super) fn media_type(bytes: &[u8], uri: &str) -> Option<&'static str> {
    let by_content = match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some("image/png"),
        [0xff, 0xd8, 0xff, ..] => Some("image/jpeg"),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some("image/webp"),
        [0xab, b'K', b'T', b'X', b' ', b'2', b'0', ..] => Some("image/ktx2"),
        [b'D', b'D', b'S', b' ', ..] => Some("image/vnd-ms.dds"),
        [_, _, _, _, b'f', b't', b'y', b'p', b'a', b'v', b'i', b'f', ..] => Some("image/avif"),
        _ => None,
    };
    by_content.or_else(|| match uri.rsplit('.').next()?.to_ascii_lowercase().as_str() {
        "png" => Some("image/png"),
        "jpg" | "jpeg" => Some("image/jpeg"),
        "webp" => Some("image/webp"),
        "ktx2" => Some("image/ktx2"),
        _ => None,
    })
}

/// True for a URI that names a file beside the document.
pub(super) fn is_relative(uri: &Value) -> Option<&str> {
    uri.as_str().filter(|uri| !has_scheme(uri))
}
