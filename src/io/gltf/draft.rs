//! A document under construction: its JSON, what its buffers are to hold, and numbers to be given
//! again.
//!
//! Numbers never change while a document is worked on, so that references from extensions that are
//! not known here stay right. What becomes free is used again first; what is still free in the end is
//! taken out, from the tail where possible.

use super::buffers::Buffers;
use super::layout::Stream;
use super::meshopt::NAMES as MESHOPT;
use super::references::{Kind, Object, counts, index, visit};
use crate::error::ParseError;
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
    /// Bytes of the original's buffers that nothing refers to any more: buffer and range.
    dropped: Vec<(usize, Range<u64>)>,
}

/// The buffers of a finished document: the pieces of each, in order.
pub(super) struct Packed<'a> {
    /// The JSON.
    pub(super) root: Object,
    /// All pieces.
    pub(super) pieces: Vec<Piece<'a>>,
    /// The pieces of each buffer.
    pub(super) buffers: Vec<Range<usize>>,
}

impl<'a> Draft<'a> {
    /// Goes on from a document.
    pub(super) fn new(root: Object) -> Self {
        Draft { root, pieces: Vec::new(), placed: BTreeMap::new(), free: BTreeMap::new(), dropped: Vec::new() }
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

    /// Puts the original's buffers, without what nothing refers to any more, and the new pieces
    /// together into as few buffers as `limit` bytes for each allow.
    ///
    /// # Errors
    /// Place and reason where a buffer of the original cannot be read.
    pub(super) fn pack(mut self, given: Option<&'a Buffers<'_>>, limit: u64) -> Result<Packed<'a>, ParseError> {
        if let Some(given) = given {
            self.decompress(given)?;
        }
        self.compact();
        let mut pieces = Vec::new();
        // Where the kept parts of the original's buffers went: buffer, range, piece.
        let mut moved: Vec<(usize, Range<u64>, usize)> = Vec::new();
        let mut placeholders: Vec<(usize, Value)> = Vec::new();
        let old: Vec<Value> = std::mem::take(self.list("buffers"));
        let mut cuts = self.cuts();
        let needed: BTreeSet<usize> = self.old_views().filter_map(|view| index(view.get("buffer")?)).collect();
        for (b, buffer) in old.iter().enumerate() {
            let bytes = match given {
                Some(given) => given.whole(b)?,
                None => None,
            };
            let Some(bytes) = bytes else {
                // One that stood for what compressed views decode to has done its duty.
                if needed.contains(&b) {
                    placeholders.push((b, buffer.clone()));
                }
                continue;
            };
            let declared = buffer.get("byteLength").and_then(Value::as_u64).unwrap_or(u64::MAX);
            let end = declared.min(bytes.len() as u64);
            for range in between(cuts.remove(&b).unwrap_or_default(), end) {
                moved.push((b, range.clone(), pieces.len()));
                pieces.push(Piece::Given(&bytes[range.start as usize..range.end as usize]));
            }
        }
        let first_new = pieces.len();
        pieces.append(&mut self.pieces);

        // Buffer and offset of each piece.
        let mut places = Vec::with_capacity(pieces.len());
        let mut buffers: Vec<Range<usize>> = Vec::new();
        let mut lengths: Vec<u64> = Vec::new();
        for (i, piece) in pieces.iter().enumerate() {
            let offset = lengths.last().map_or(0, |length| length.next_multiple_of(ALIGNMENT));
            if let (Some(range), Some(length)) = (buffers.last_mut(), lengths.last_mut())
                && offset.saturating_add(piece.len()) <= limit
            {
                (range.end, *length) = (i + 1, offset + piece.len());
                places.push((buffers.len() - 1, offset));
            } else {
                places.push((buffers.len(), 0));
                buffers.push(i..i + 1);
                lengths.push(piece.len());
            }
        }

        let real = lengths.len();
        let renumbered: BTreeMap<usize, usize> = placeholders.iter().map(|(old, _)| *old).zip(real..).collect();
        let number_of = |b: usize| renumbered.get(&b).copied();
        let find = |b: usize, start: u64| {
            let at = moved.partition_point(|(buffer, range, _)| (*buffer, range.start) <= (b, start));
            let (buffer, range, piece) = moved.get(at.checked_sub(1)?)?;
            (*buffer == b && start <= range.end).then(|| {
                let (new, offset) = places[*piece];
                (new, offset + (start - range.start))
            })
        };
        let placed = &self.placed;
        for (v, view) in
            self.root.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten().enumerate()
        {
            match placed.get(&v) {
                Some(&piece) => {
                    let (buffer, offset) = places[first_new + piece];
                    put(view, buffer, offset);
                }
                None => relocate(view, &find, &number_of),
            }
        }

        // A lone buffer keeps what the original says of its own.
        let mut described = old.iter().enumerate().filter(|(b, _)| number_of(*b).is_none()).map(|(_, buffer)| buffer);
        let description = described.next().filter(|_| described.next().is_none() && real == 1);
        let list = self.list("buffers");
        for length in lengths {
            let mut buffer = description.cloned().unwrap_or_else(|| json!({}));
            if let Some(buffer) = buffer.as_object_mut() {
                buffer.remove("uri");
                buffer.insert("byteLength".into(), length.into());
            }
            list.push(buffer);
        }
        list.extend(placeholders.into_iter().map(|(_, buffer)| buffer));
        for list in ["buffers", "bufferViews", "accessors", "materials", "textures", "images", "samplers"] {
            if self.root.get(list).and_then(Value::as_array).is_some_and(Vec::is_empty) {
                self.root.remove(list);
            }
        }
        Ok(Packed { root: self.root, pieces, buffers })
    }

    /// Puts what compressed views decode to in their place: the vertices beside them are not
    /// compressed either, and few programs can read such files.
    fn decompress(&mut self, given: &'a Buffers<'_>) -> Result<(), ParseError> {
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
                self.placed.insert(v, self.pieces.len());
                self.pieces.push(Piece::Given(bytes));
            }
            // What a view with a fallback shows is needed still, and is not cut out.
            self.dropped.extend(ranges);
        }
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

    /// The original's views that still show its own bytes.
    fn old_views(&self) -> impl Iterator<Item = &Value> {
        let views = self.root.get("bufferViews").and_then(Value::as_array).into_iter().flatten();
        views.enumerate().filter(|(v, _)| !self.placed.contains_key(v)).map(|(_, view)| view)
    }

    /// What may be cut out of each of the original's buffers: dropped, and nothing else needs it.
    fn cuts(&self) -> BTreeMap<usize, Vec<Range<u64>>> {
        let needed = merged(self.old_views().flat_map(ranges_of));
        let mut dropped = merged(self.dropped.iter().cloned());
        for (buffer, dropped) in &mut dropped {
            let Some(needed) = needed.get(buffer) else { continue };
            let mut cuts = Vec::new();
            let mut needed = needed.iter().peekable();
            for drop in dropped.iter() {
                let mut start = drop.start;
                while let Some(range) = needed.peek().filter(|range| range.start < drop.end) {
                    if range.start > start {
                        cuts.push(start..range.start);
                    }
                    start = start.max(range.end);
                    if range.end > drop.end {
                        break;
                    }
                    needed.next();
                }
                if start < drop.end {
                    cuts.push(start..drop.end);
                }
            }
            *dropped = cuts;
        }
        dropped
    }

    /// Takes out what is still free.
    fn compact(&mut self) {
        for kind in Kind::ALL {
            let Some(free) = self.free.remove(&kind).filter(|free| !free.is_empty()) else { continue };
            let list = self.list(kind.list());
            let mut next = 0..;
            let renumbered: Vec<Option<usize>> =
                (0..list.len()).map(|i| if free.contains(&i) { None } else { next.next() }).collect();
            let mut numbers = 0..;
            list.retain(|_| numbers.next().is_some_and(|i| !free.contains(&i)));
            visit(&mut self.root, kind, &mut |reference| {
                if let Some(new) = index(reference).and_then(|i| *renumbered.get(i)?) {
                    *reference = new.into();
                }
            });
            if kind == Kind::View {
                let placed = std::mem::take(&mut self.placed);
                self.placed = placed.into_iter().filter_map(|(view, piece)| Some((renumbered[view]?, piece))).collect();
            }
        }
    }
}

/// Ranges of each buffer, widened to whole multiples of the alignment, sorted and put together.
fn merged(ranges: impl Iterator<Item = (usize, Range<u64>)>) -> BTreeMap<usize, Vec<Range<u64>>> {
    let mut all: BTreeMap<usize, Vec<Range<u64>>> = BTreeMap::new();
    for (buffer, range) in ranges.filter(|(_, range)| !range.is_empty()) {
        let end = range.end.checked_next_multiple_of(ALIGNMENT).unwrap_or(range.end);
        all.entry(buffer).or_default().push(range.start / ALIGNMENT * ALIGNMENT..end);
    }
    for ranges in all.values_mut() {
        ranges.sort_by_key(|range| range.start);
        let mut joined: Vec<Range<u64>> = Vec::with_capacity(ranges.len());
        for range in ranges.drain(..) {
            match joined.last_mut().filter(|last| range.start <= last.end) {
                Some(last) => last.end = last.end.max(range.end),
                None => joined.push(range),
            }
        }
        *ranges = joined;
    }
    all
}

/// What is left of `0..end` between cuts in ascending order.
fn between(cuts: Vec<Range<u64>>, end: u64) -> Vec<Range<u64>> {
    let mut at = 0;
    let mut kept = Vec::new();
    for cut in cuts.into_iter().chain(std::iter::once(end..end)) {
        if at < cut.start.min(end) {
            kept.push(at..cut.start.min(end));
        }
        at = at.max(cut.end);
    }
    kept
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

fn put(object: &mut Value, buffer: usize, offset: u64) {
    object["buffer"] = buffer.into();
    if offset > 0 {
        object["byteOffset"] = offset.into();
    } else if let Some(object) = object.as_object_mut()
        && object.get("byteOffset").is_some_and(|old| old != 0)
    {
        object.remove("byteOffset");
    }
}

/// Follows bytes to where they are now.
fn relocate(
    object: &mut Value,
    find: &dyn Fn(usize, u64) -> Option<(usize, u64)>,
    number_of: &dyn Fn(usize) -> Option<usize>,
) {
    let Some(buffer) = object.get("buffer").and_then(index) else { return };
    let start = object.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
    if let Some((buffer, offset)) = find(buffer, start) {
        put(object, buffer, offset);
    } else if let Some(number) = number_of(buffer) {
        object["buffer"] = number.into();
    }
}
