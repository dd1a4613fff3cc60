//! A document under construction: its JSON, what its buffers are to hold, and numbers to be given
//! again.
//!
//! Numbers never change while a document is worked on, so that references from extensions that are
//! not known here stay right. What becomes free is used again first; what is still free in the end is
//! taken out, from the tail where possible.

mod compress;
mod decompress;
mod pack;

pub(super) use pack::Packed;

use super::layout::Stream;
use super::meshopt::NAMES as MESHOPT;
use super::references::{Kind, Object, counts, index};
use compress::Coding;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Every piece of a buffer begins at a multiple of this: the strictest rule of any extension.
pub(super) const ALIGNMENT: u64 = 8;

/// A run of bytes in the output's buffers.
pub(super) enum Piece<'a> {
    /// Bytes of the original's buffers.
    Given(&'a [u8]),
    /// Bytes at hand.
    Bytes(Vec<u8>),
    /// Bytes that are worked out while they are written.
    Stream(Stream<'a>),
}

impl Piece<'_> {
    /// Number of bytes.
    pub(super) fn len(&self) -> u64 {
        match self {
            Piece::Given(bytes) => bytes.len() as u64,
            Piece::Bytes(bytes) => bytes.len() as u64,
            Piece::Stream(stream) => stream.byte_length(),
        }
    }
}

/// A document under construction.
pub(super) struct Draft<'a> {
    /// The JSON.
    pub(super) root: Object,
    pieces: Vec<Piece<'a>>,
    /// The piece that a new view shows, by the number of the view.
    placed: BTreeMap<usize, usize>,
    free: BTreeMap<Kind, BTreeSet<usize>>,
    /// How compressed pieces are coded, by the number of the piece.
    coded: BTreeMap<usize, Coding>,
    /// Bytes of the original's buffers that nothing refers to any more: buffer and range.
    dropped: Vec<(usize, Range<u64>)>,
}

impl<'a> Draft<'a> {
    /// Goes on from a document.
    pub(super) fn new(root: Object) -> Self {
        Draft {
            root,
            pieces: Vec::new(),
            placed: BTreeMap::new(),
            free: BTreeMap::new(),
            coded: BTreeMap::new(),
            dropped: Vec::new(),
        }
    }

    /// The members of a list, made if it is not there.
    pub(super) fn list(&mut self, name: &str) -> &mut Vec<Value> {
        let list = self.root.entry(name).or_insert(Value::Null);
        if !list.is_array() {
            *list = json!([]);
        }
        match list {
            Value::Array(list) => list,
            _ => unreachable!("it has just been made one"),
        }
    }

    /// Adds a member to a list, at the first free number, and gives the number.
    pub(super) fn add(&mut self, kind: Kind, member: Value) -> usize {
        if let Some(slot) = self.free.get_mut(&kind).and_then(BTreeSet::pop_first) {
            self.list(kind.list())[slot] = member;
            return slot;
        }
        self.append(kind, member)
    }

    /// Adds a member to a list behind all others and gives its number.
    pub(super) fn append(&mut self, kind: Kind, member: Value) -> usize {
        let list = self.list(kind.list());
        list.push(member);
        list.len() - 1
    }

    /// Takes an accessor off its views and gives their numbers.
    pub(super) fn detach(&mut self, accessor: usize) -> BTreeSet<usize> {
        let Some(accessor) = self.list("accessors").get_mut(accessor) else { return BTreeSet::new() };
        let views = views_of(accessor);
        if let Some(accessor) = accessor.as_object_mut() {
            accessor.remove("sparse");
            accessor.remove("byteOffset");
            accessor.remove("bufferView");
        }
        views
    }

    /// Makes numbers free. Views that only these members used become free too.
    pub(super) fn free(&mut self, kind: Kind, numbers: impl IntoIterator<Item = usize>) {
        let mut views = BTreeSet::new();
        for number in numbers {
            let Some(member) = self.list(kind.list()).get_mut(number).map(Value::take) else { continue };
            self.free.entry(kind).or_default().insert(number);
            match kind {
                Kind::View => self.dropped.extend(ranges_of(&member)),
                Kind::Accessor | Kind::Image => views.extend(views_of(&member)),
                _ => {}
            }
        }
        // All at once: counting the references of each for itself would take quadratic time.
        self.free_unused(Kind::View, &views);
    }

    /// Makes those of the numbers free that nothing refers to.
    pub(super) fn free_unused(&mut self, kind: Kind, numbers: &BTreeSet<usize>) {
        if !numbers.is_empty() {
            let counts = counts(&mut self.root, kind);
            self.free(kind, numbers.iter().copied().filter(|&n| counts.get(n) == Some(&0)));
        }
    }

    /// Puts new content behind an accessor whose number stays.
    pub(super) fn replace(&mut self, accessor: usize, count: usize, view: usize) {
        let accessor = self.list("accessors").get_mut(accessor).and_then(Value::as_object_mut);
        let Some(accessor) = accessor else { return };
        accessor.remove("sparse");
        accessor.remove("byteOffset");
        accessor.insert("bufferView".into(), view.into());
        accessor.insert("count".into(), count.into());
    }

    /// Adds a view of a new piece and gives its number.
    pub(super) fn add_view(&mut self, piece: Piece<'a>, target: Option<u32>, stride: Option<usize>) -> usize {
        let mut view = json!({ "buffer": 0, "byteLength": piece.len() });
        if let Some(target) = target {
            view["target"] = target.into();
        }
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        let number = self.add(Kind::View, view);
        self.placed.insert(number, self.pieces.len());
        self.pieces.push(piece);
        number
    }

    /// Adds a name to `extensionsUsed`.
    pub(super) fn use_extension(&mut self, name: &str) {
        let used = self.list("extensionsUsed");
        if !used.iter().any(|used| used == name) {
            used.push(name.into());
        }
    }

    /// Bytes of all new pieces.
    pub(super) fn new_bytes(&self) -> u64 {
        self.pieces.iter().map(Piece::len).sum()
    }
}

/// The views that an accessor or an image uses.
fn views_of(member: &Value) -> BTreeSet<usize> {
    ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"]
        .iter()
        .filter_map(|path| index(member.pointer(path)?))
        .collect()
}

/// The bytes that a view refers to: its own and those it is decompressed from.
fn ranges_of(view: &Value) -> Vec<(usize, Range<u64>)> {
    let of = |object: &Value| {
        let buffer = index(object.get("buffer")?)?;
        let start = object.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
        let length = object.get("byteLength")?.as_u64()?;
        Some((buffer, start..start.checked_add(length)?))
    };
    let compressed = MESHOPT.iter().filter_map(|name| view.get("extensions")?.get(name));
    std::iter::once(view).chain(compressed).filter_map(of).collect()
}
