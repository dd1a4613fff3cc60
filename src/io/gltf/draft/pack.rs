//! What a finished draft's buffers hold, and where.

use super::{ALIGNMENT, Draft, Piece, ranges_of};
use crate::error::ParseError;
use crate::io::gltf::buffers::Buffers;
use crate::io::gltf::references::{Kind, Object, index, visit};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The buffers of a finished document: the pieces of each, in order.
pub(in crate::io::gltf) struct Packed<'a> {
    /// The JSON.
    pub(in crate::io::gltf) root: Object,
    /// All pieces.
    pub(in crate::io::gltf) pieces: Vec<Piece<'a>>,
    /// The pieces of each buffer.
    pub(in crate::io::gltf) buffers: Vec<Range<usize>>,
}

/// Where everything goes.
struct Plan<'a> {
    pieces: Vec<Piece<'a>>,
    /// The first of the new pieces; those before are the original's.
    first_new: usize,
    /// Buffer and offset of each piece.
    places: Vec<(usize, u64)>,
    /// The pieces of each buffer.
    buffers: Vec<Range<usize>>,
    lengths: Vec<u64>,
    /// The kept parts of the original's buffers in ascending order: buffer, range, piece.
    moved: Vec<(usize, Range<u64>, usize)>,
    /// The original's buffers without bytes that views still need, by their new numbers.
    placeholders: BTreeMap<usize, usize>,
}

impl<'a> Draft<'a> {
    /// Puts the original's buffers, without what nothing refers to any more, and the new pieces
    /// together into as few buffers as `limit` bytes for each allow.
    ///
    /// # Errors
    /// Place and reason where a buffer of the original cannot be read.
    pub(in crate::io::gltf) fn pack(
        mut self,
        given: Option<&'a Buffers<'_>>,
        limit: u64,
    ) -> Result<Packed<'a>, ParseError> {
        if let Some(given) = given {
            self.decompress(given)?;
        }
        self.compact();
        let old = std::mem::take(self.list("buffers"));
        let plan = self.plan(&old, given, limit)?;
        let stand_in = self.move_views(&plan);
        self.describe_buffers(&plan, &old);
        if !self.coded.is_empty() {
            self.add_stand_in(stand_in);
        }
        for list in ["buffers", "bufferViews", "accessors", "materials", "textures", "images", "samplers"] {
            if self.root.get(list).and_then(Value::as_array).is_some_and(Vec::is_empty) {
                self.root.remove(list);
            }
        }
        Ok(Packed { root: self.root, pieces: plan.pieces, buffers: plan.buffers })
    }

    /// Gives every piece a place; the new pieces go over to the plan.
    fn plan(&mut self, old: &[Value], given: Option<&'a Buffers<'_>>, limit: u64) -> Result<Plan<'a>, ParseError> {
        let (mut pieces, mut moved, mut without_bytes) = (Vec::new(), Vec::new(), Vec::new());
        let mut cuts = self.cuts();
        let needed: BTreeSet<usize> = self.old_views().filter_map(|view| index(view.get("buffer")?)).collect();
        let named = self.named_lengths();
        for (b, buffer) in old.iter().enumerate() {
            let bytes = match given {
                Some(given) => given.whole(b)?,
                None => None,
            };
            let Some(bytes) = bytes else {
                // One that stood for what compressed views decode to has done its duty.
                if needed.contains(&b) {
                    without_bytes.push(b);
                }
                continue;
            };
            let declared = buffer.get("byteLength").and_then(Value::as_u64).unwrap_or(u64::MAX);
            let end = declared.max(named.get(&b).copied().unwrap_or(0)).min(bytes.len() as u64);
            for range in between(cuts.remove(&b).unwrap_or_default(), end) {
                moved.push((b, range.clone(), pieces.len()));
                pieces.push(Piece::Given(&bytes[range.start as usize..range.end as usize]));
            }
        }
        let first_new = pieces.len();
        pieces.append(&mut self.pieces);

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
        let placeholders = without_bytes.into_iter().zip(lengths.len()..).collect();
        Ok(Plan { pieces, first_new, places, buffers, lengths, moved, placeholders })
    }

    /// Lets every view show where its bytes are now, and gives the length of the buffer without bytes in which a reader
    /// that cannot decode would find them.
    fn move_views(&mut self, plan: &Plan<'_>) -> u64 {
        let Draft { root, placed, coded, .. } = self;
        let mut stand_in: u64 = 0;
        for (v, view) in root.get_mut("bufferViews").and_then(Value::as_array_mut).into_iter().flatten().enumerate() {
            match placed.get(&v) {
                Some(&piece) => {
                    let (buffer, offset) = plan.places[plan.first_new + piece];
                    match coded.get(&piece) {
                        Some(coding) => coding.describe(view, [buffer, plan.count()], offset, &mut stand_in),
                        None => put(view, buffer, offset),
                    }
                }
                None => plan.relocate(view),
            }
        }
        stand_in
    }

    /// Lists the buffers of a plan.
    fn describe_buffers(&mut self, plan: &Plan<'_>, old: &[Value]) {
        // A lone buffer keeps what the original says of its own.
        let mut described = (0..old.len()).filter(|b| !plan.placeholders.contains_key(b)).map(|b| &old[b]);
        let description = described.next().filter(|_| described.next().is_none() && plan.lengths.len() == 1);
        let list = self.list("buffers");
        for &length in &plan.lengths {
            let mut buffer = description.cloned().unwrap_or_else(|| json!({}));
            if let Some(buffer) = buffer.as_object_mut() {
                buffer.remove("uri");
                buffer.insert("byteLength".into(), length.into());
            }
            list.push(buffer);
        }
        list.extend(plan.placeholders.keys().map(|&b| old[b].clone()));
    }

    /// How far views reach into each of the original's buffers. Readers take what views name, whatever a sloppy writer
    /// has declared of their buffer.
    fn named_lengths(&self) -> BTreeMap<usize, u64> {
        let mut named: BTreeMap<usize, u64> = BTreeMap::new();
        for view in self.old_views() {
            let number = |name: &str| view.get(name).and_then(Value::as_u64).unwrap_or(0);
            let end = number("byteOffset").saturating_add(number("byteLength"));
            if let Some(buffer) = view.get("buffer").and_then(index) {
                let last = named.entry(buffer).or_insert(end);
                *last = end.max(*last);
            }
        }
        named
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

impl Plan<'_> {
    /// Of buffers, with those without bytes.
    fn count(&self) -> usize {
        self.lengths.len() + self.placeholders.len()
    }

    /// Where a place in a kept part of an original's buffer is now.
    fn find(&self, buffer: usize, start: u64) -> Option<(usize, u64)> {
        let at = self.moved.partition_point(|(b, range, _)| (*b, range.start) <= (buffer, start));
        let (b, range, piece) = self.moved.get(at.checked_sub(1)?)?;
        (*b == buffer && start <= range.end).then(|| {
            let (new, offset) = self.places[*piece];
            (new, offset + (start - range.start))
        })
    }

    /// Follows bytes to where they are now.
    fn relocate(&self, object: &mut Value) {
        let Some(buffer) = object.get("buffer").and_then(index) else { return };
        let start = object.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
        if let Some((buffer, offset)) = self.find(buffer, start) {
            put(object, buffer, offset);
        } else if let Some(&number) = self.placeholders.get(&buffer) {
            object["buffer"] = number.into();
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

pub(super) fn put(object: &mut Value, buffer: usize, offset: u64) {
    object["buffer"] = buffer.into();
    if offset > 0 {
        object["byteOffset"] = offset.into();
    } else if let Some(object) = object.as_object_mut()
        && object.get("byteOffset").is_some_and(|old| old != 0)
    {
        object.remove("byteOffset");
    }
}
