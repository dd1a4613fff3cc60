//! Values by their rank, of several quantities at once.
//!
//! No list of values is put in order. All faces are looked at twice: the first time values are counted in bins, which
//! tells in which bin each rank is; the second time the values in those bins are taken, a small part of all.

use crate::curvature::FaceCurvature;
use crate::mesh::Face;
use crate::quantity::Quantity;
use rayon::prelude::*;

/// Bins of a quantity: few enough for the nearest cache.
const BINS: usize = 1 << 12;
/// Faces at least from which the range of the bins is taken.
const SAMPLE: usize = 1 << 10;
/// Faces whose numbers are worked out together: with all they hold they stay in the nearest cache.
const TOGETHER: usize = 256;
/// Faces at least that are worth bins of their own.
const WORTH_BINS: usize = 1 << 16;
/// The bin of a face without a number.
const NO_BIN: u32 = BINS as u32;
/// Marks a bin that no rank is in.
const UNWANTED: u8 = u8::MAX;

/// The values at some shares, 0 to 1 in ascending order, of all finite values of each quantity among the estimated
/// faces; `None` for a quantity without any. Shape index and curvedness may be off by the last of their 32 bits.
pub(crate) fn at_shares<const N: usize>(
    quantities: &[Quantity],
    values: &[FaceCurvature],
    shares: [f64; N],
) -> Vec<Option<[f32; N]>> {
    let columns: Vec<Column> = quantities.par_iter().map(|&quantity| Column::new(quantity, values)).collect();
    let none = || vec![[0_u32; BINS + 1]; columns.len()];
    let count =
        |_, counts: &mut [u32; BINS + 1], block: &Block| block.bins.iter().for_each(|&bin| counts[bin as usize] += 1);
    let counts = gather(&columns, values, none, count, |all, more| {
        all.iter_mut().zip(more).for_each(|(all, more)| *all += more);
    });
    let places: Vec<Option<[Place; N]>> =
        counts.iter().map(|counts| Place::of_shares(&counts[..BINS], shares)).collect();
    // Which of the lists of candidates a bin has.
    let mut list_of = vec![[UNWANTED; BINS + 1]; columns.len()];
    for (list_of, places) in list_of.iter_mut().zip(&places) {
        places.iter().flatten().zip(0..).for_each(|(place, list)| list_of[place.bin] = list);
    }
    let none = || vec![vec![Vec::new(); N]; columns.len()];
    let take = |column: usize, lists: &mut Vec<Vec<f32>>, block: &Block| {
        for (&bin, &number) in block.bins.iter().zip(&block.numbers) {
            let list = list_of[column][bin as usize];
            if list != UNWANTED {
                lists[list as usize].push(number);
            }
        }
    };
    let mut candidates = gather(&columns, values, none, take, |all, more| {
        all.iter_mut().zip(more).for_each(|(all, more)| all.extend(more));
    });
    (0..columns.len())
        .map(|column| {
            places[column].map(|places| {
                places.map(|Place { bin, before }| {
                    let list = &mut candidates[column][list_of[column][bin] as usize];
                    columns[column].value(*list.select_nth_unstable_by(before, f32::total_cmp).1)
                })
            })
        })
        .collect()
}

/// Calls `add` for every column with every block of faces, and `join` for what threads have gathered.
fn gather<T: Send>(
    columns: &[Column],
    values: &[FaceCurvature],
    none: impl Fn() -> Vec<T> + Sync + Send,
    add: impl Fn(usize, &mut T, &Block) + Sync,
    join: impl Fn(&mut T, T) + Sync,
) -> Vec<T> {
    let begin = || (none(), Block { numbers: [f32::NAN; TOGETHER], bins: [NO_BIN; TOGETHER] });
    let add = |(mut all, mut block): (Vec<T>, Block), faces: &[FaceCurvature]| {
        for (n, (all, column)) in all.iter_mut().zip(columns).enumerate() {
            column.fill(faces, &mut block);
            add(n, all, &block);
        }
        (all, block)
    };
    let join = |mut all: Vec<T>, more: Vec<T>| {
        all.iter_mut().zip(more).for_each(|(all, more)| join(all, more));
        all
    };
    let blocks = values.par_chunks(TOGETHER).with_min_len(WORTH_BINS / TOGETHER);
    blocks.fold(begin, add).map(|(all, _)| all).reduce_with(join).unwrap_or_else(&none)
}

/// A quantity's numbers of some faces, NaN for a face without and beyond them, and their bins.
struct Block {
    numbers: [f32; TOGETHER],
    bins: [u32; TOGETHER],
}

/// Where a rank is.
#[derive(Clone, Copy)]
struct Place {
    bin: usize,
    /// How many numbers in the bin come before it.
    before: usize,
}

impl Place {
    fn of_shares<const N: usize>(counts: &[u32], shares: [f64; N]) -> Option<[Place; N]> {
        let last = counts.iter().map(|&count| count as usize).sum::<usize>().checked_sub(1)?;
        let (mut bin, mut first) = (0, 0);
        Some(shares.map(|share| {
            let rank = (last as f64 * share).round() as usize;
            while first + counts[bin] as usize <= rank {
                first += counts[bin] as usize;
                bin += 1;
            }
            Place { bin, before: rank - first }
        }))
    }
}

/// A quantity, and equal bins between where most of its values are; those beyond are in the outermost bins.
struct Column {
    quantity: Quantity,
    low: f32,
    /// Bins in one of the quantity's numbers; 0 where all are in one bin.
    scale: f32,
}

impl Column {
    fn new(quantity: Quantity, values: &[FaceCurvature]) -> Self {
        let mut column = Column { quantity, low: 0.0, scale: 0.0 };
        let mut block = Block { numbers: [f32::NAN; TOGETHER], bins: [NO_BIN; TOGETHER] };
        let mut sample: Vec<f32> = Vec::new();
        for face in values.iter().step_by(values.len().div_ceil(SAMPLE).max(1)) {
            column.fill(std::slice::from_ref(face), &mut block);
            sample.extend(block.numbers[..1].iter().filter(|number| !number.is_nan()));
        }
        sample.sort_unstable_by(f32::total_cmp);
        if let [low, .., high] = sample[sample.len() / 50..sample.len() - sample.len() / 50] {
            let scale = (BINS - 1) as f32 / (high - low);
            column.low = low;
            column.scale = if scale.is_finite() { scale } else { 0.0 };
        }
        column
    }

    fn fill(&self, faces: &[FaceCurvature], block: &mut Block) {
        let numbers = &mut block.numbers[..faces.len()];
        match self.quantity {
            // What grows with the angle and with the root takes far less to work out than these.
            Quantity::ShapeIndex => numbers.iter_mut().zip(faces).for_each(|(slot, of)| *slot = tangent(of)),
            Quantity::Curvedness => numbers.iter_mut().zip(faces).for_each(|(slot, of)| *slot = square(of)),
            quantity => quantity.values(Face(0), faces, 0, numbers),
        }
        for (number, face) in numbers.iter_mut().zip(faces) {
            *number = if face.is_estimated() && number.is_finite() { *number } else { f32::NAN };
        }
        block.numbers[faces.len()..].fill(f32::NAN);
        for (bin, &number) in block.bins.iter_mut().zip(&block.numbers) {
            // Without a branch, so that several are done at once.
            let within = ((number - self.low) * self.scale).clamp(0.0, (BINS - 1) as f32) as i32 as u32;
            *bin = if number.is_nan() { NO_BIN } else { within };
        }
    }

    /// The value that a number stands for.
    fn value(&self, number: f32) -> f32 {
        match self.quantity {
            Quantity::ShapeIndex => (std::f64::consts::FRAC_2_PI * f64::from(number).atan()) as f32,
            Quantity::Curvedness => (0.5 * f64::from(number)).sqrt() as f32,
            _ => number,
        }
    }
}

/// What grows with the shape index: finite, so that a sphere's is not left out.
#[inline]
fn tangent(of: &FaceCurvature) -> f32 {
    let (max, min) = (f64::from(of.k_max), f64::from(of.k_min));
    if max == 0.0 && min == 0.0 {
        return 0.0;
    }
    ((max + min) / (max - min)).clamp(f32::MIN.into(), f32::MAX.into()) as f32
}

/// What grows with the curvedness.
#[inline]
fn square(of: &FaceCurvature) -> f32 {
    let (max, min) = (f64::from(of.k_max), f64::from(of.k_min));
    (max * max + min * min).min(f32::MAX.into()) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curvature::FaceClass;

    #[test]
    fn ranks_are_those_of_sorted_values() {
        let mut random = 1_u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f32 / 1e7 - 0.8
        };
        let values: Vec<FaceCurvature> = (0..3 * SAMPLE + 77)
            .map(|i| {
                let (a, b) = (next(), if i % 5 == 0 { 0.0 } else { next() });
                let class = if i % 7 == 0 { FaceClass::NotEstimated } else { FaceClass::Elliptic };
                let radius = if i % 3 == 0 { f32::NAN } else { 2.5 };
                FaceCurvature { k_max: a.max(b), k_min: a.min(b), radius, class, ..FaceCurvature::NOT_ESTIMATED }
            })
            .collect();
        let shares = [0.0, 0.05, 0.05, 0.5, 0.99, 1.0];
        use Quantity::{Curvedness, Gauss, GaussPerimeter, KMax, KMin, Mean, Radius, ShapeIndex};
        let quantities = [KMax, KMin, Mean, Gauss, ShapeIndex, Curvedness, Radius, GaussPerimeter];
        for (found, quantity) in at_shares(&quantities, &values, shares).into_iter().zip(quantities) {
            let all = values.iter().filter(|v| v.is_estimated()).map(|v| quantity.value(Face(0), v, 0));
            let mut all: Vec<f32> = all.filter(|v| v.is_finite()).collect();
            all.sort_by(f32::total_cmp);
            let Some(found) = found else {
                assert!(all.is_empty() && quantity == GaussPerimeter);
                continue;
            };
            for (found, share) in found.into_iter().zip(shares) {
                let expected = all[((all.len() - 1) as f64 * share).round() as usize];
                let off = (found - expected).abs();
                let exact = !matches!(quantity, ShapeIndex | Curvedness);
                assert!(off <= if exact { 0.0 } else { 2e-7 * expected.abs() }, "{quantity:?}: {found} for {expected}");
            }
        }
        assert_eq!(at_shares(&[KMax], &[], shares), [None]);
        let plane = FaceCurvature { k_max: 0.0, k_min: 0.0, class: FaceClass::Flat, ..FaceCurvature::NOT_ESTIMATED };
        let ball = FaceCurvature { k_max: 2.0, k_min: 2.0, ..plane };
        assert_eq!(at_shares(&[ShapeIndex], &[ball, plane], [0.0, 1.0]), [Some([0.0, 1.0])]);
    }
}
