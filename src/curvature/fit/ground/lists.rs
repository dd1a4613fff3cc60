//! Many short lists in two arrays.

use super::blocks::Blocks;
use std::ops::Range;

/// Lists of numbers one behind the other, as many as vertices for instance: first the lengths are counted in `ends`,
/// then there is room, then the numbers are pushed.
pub(in crate::curvature::fit) struct Lists {
    ends: Vec<u32>,
    entries: Vec<u32>,
}

impl Lists {
    fn counted(count: usize) -> Self {
        Lists { ends: vec![0; count], entries: Vec::new() }
    }

    /// From pairs of a list and an entry.
    pub(in crate::curvature::fit) fn of_pairs<I: Iterator<Item = (u32, u32)>>(
        count: usize,
        pairs: impl Fn() -> I,
    ) -> Self {
        let mut lists = Lists::counted(count);
        pairs().for_each(|(list, _)| lists.ends[list as usize] += 1);
        lists.make_room();
        pairs().for_each(|(list, entry)| lists.push(list, entry));
        lists
    }

    /// From pairs of a vertex and an entry that blocks of faces tell, and some besides.
    pub(super) fn by_vertex<I: Iterator<Item = (u32, u32)>>(
        count: usize,
        blocks: &Blocks,
        pairs: impl Fn(Range<u32>) -> I + Sync,
        besides: Vec<(u32, u32)>,
    ) -> Self {
        let mut lists = Lists::counted(count);
        let others = blocks.fill(&mut lists.ends, |faces, own, ends| {
            let mut others = Vec::new();
            pairs(faces).for_each(|(v, _)| match own.contains(&(v as usize)) {
                true => ends[v as usize - own.start] += 1,
                false => others.push(v),
            });
            others
        });
        others.into_iter().chain(besides.iter().map(|(v, _)| *v)).for_each(|v| lists.ends[v as usize] += 1);
        lists.make_room();
        let mut shares = Vec::with_capacity(blocks.own().len());
        let (mut ends, mut entries, mut start) = (&mut lists.ends[..], &mut lists.entries[..], 0);
        for own in blocks.own() {
            let of_own;
            (of_own, ends) = ends.split_at_mut(own.len());
            let until = ends.first().map_or(start + entries.len(), |&next| next as usize);
            let share;
            (share, entries) = entries.split_at_mut(until - start);
            shares.push((start, of_own, share));
            start = until;
        }
        let others = blocks.each(shares, |faces, own, (start, ends, entries)| {
            let mut others = Vec::new();
            pairs(faces).for_each(|(v, entry)| {
                if own.contains(&(v as usize)) {
                    let end = &mut ends[v as usize - own.start];
                    entries[*end as usize - start] = entry;
                    *end += 1;
                } else {
                    others.push((v, entry));
                }
            });
            others
        });
        others.into_iter().chain(besides).for_each(|(v, entry)| lists.push(v, entry));
        lists
    }

    /// Turns lengths into starts.
    fn make_room(&mut self) {
        let mut total = 0;
        for end in &mut self.ends {
            total += std::mem::replace(end, total);
        }
        self.entries.resize(total as usize, 0);
    }

    /// Pushing moves the start of each list to its end.
    #[inline]
    fn push(&mut self, list: u32, entry: u32) {
        let at = &mut self.ends[list as usize];
        self.entries[*at as usize] = entry;
        *at += 1;
    }

    #[inline]
    pub(in crate::curvature::fit) fn of(&self, list: u32) -> &[u32] {
        let start = if list == 0 { 0 } else { self.ends[list as usize - 1] };
        &self.entries[start as usize..self.ends[list as usize] as usize]
    }
}
