//! Runs and lists of numbers: the faces or vertices that a file gets.

use std::ops::Range;
use std::sync::Arc;

/// Numbers of faces or vertices in ascending order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Numbers {
    /// All from the first on, up to the last.
    Run(Range<u32>),
    /// Those of a list.
    List(Arc<[u32]>),
}

impl Numbers {
    /// How many there are.
    pub(crate) fn len(&self) -> usize {
        match self {
            Numbers::Run(run) => run.len(),
            Numbers::List(list) => list.len(),
        }
    }

    /// The number at a place. Panics when `place >= len()` of a list.
    #[inline]
    pub(crate) fn at(&self, place: u32) -> u32 {
        match self {
            Numbers::Run(run) => run.start + place,
            Numbers::List(list) => list[place as usize],
        }
    }

    /// All of them.
    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.len() as u32).map(|place| self.at(place))
    }

    /// The place of a number that is among them.
    pub(crate) fn place(&self, number: u32) -> u32 {
        match self {
            Numbers::Run(run) => number - run.start,
            Numbers::List(list) => list.partition_point(|&other| other < number) as u32,
        }
    }

    /// Those of a run that are among these.
    pub(crate) fn within(&self, run: &Range<u32>) -> Numbers {
        match self {
            Numbers::Run(all) => Numbers::Run(run.start.max(all.start)..run.end.min(all.end)),
            Numbers::List(list) => {
                let [start, end] = [run.start, run.end].map(|limit| list.partition_point(|&number| number < limit));
                Numbers::List(list[start..end].into())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_places() {
        for numbers in [Numbers::Run(3..6), Numbers::List([3, 4, 5].into())] {
            assert_eq!((numbers.len(), numbers.iter().collect::<Vec<_>>()), (3, vec![3, 4, 5]));
            assert_eq!((numbers.at(1), numbers.place(5)), (4, 2));
            assert_eq!(numbers.within(&(4..9)).iter().collect::<Vec<_>>(), [4, 5]);
            assert_eq!(numbers.within(&(8..9)).len(), 0);
        }
    }
}
