//! Fewer faces for display: vertices of one cell of a grid become one, and of the faces that then lie on the
//! same three cells the first stays.

use super::display::Display;
use glam::DVec3;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A grid is wanted that leaves at least this share of the faces asked for.
const ENOUGH: f64 = 0.8;
/// Attempts at finding one.
const ATTEMPTS: usize = 8;

/// Leaves at most `most` faces. Those that stay keep their values and numbers and move by less than a cell.
pub(super) fn thin(display: &mut Display, most: usize) {
    let (low, high) = extent(&display.positions);
    let size = (high - low).max_element();
    // On a surface the faces go with the square of the cells along an edge.
    let mut cells = (most as f64 / 2.0).sqrt().max(1.0);
    let mut best: Option<(Vec<u32>, Vec<u32>)> = None;
    let (mut least, mut greatest) = (0.0, f64::INFINITY);
    for _ in 0..ATTEMPTS {
        let (of_vertex, kept) = cluster(display, low, size / cells);
        let count = kept.len();
        if (1..=most).contains(&count) {
            least = cells;
            let is_enough = count as f64 >= ENOUGH * most as f64;
            best = Some((of_vertex, kept));
            if is_enough {
                break;
            }
        } else if count > most {
            greatest = cells;
        }
        let wanted = cells * (0.9 * most as f64 / count.max(1) as f64).sqrt();
        cells = if wanted > least && wanted < greatest { wanted } else { 0.5 * (least + greatest.min(4.0 * cells)) };
    }
    let (of_vertex, kept) = best.unwrap_or_else(|| {
        // A heap in which no grid tells faces apart: evenly chosen ones, as they are.
        let step = display.corners.len().div_ceil(most);
        ((0..display.positions.len() as u32).collect(), (0..display.corners.len() as u32).step_by(step).collect())
    });
    display.corners = kept.iter().map(|&f| display.corners[f as usize].map(|v| of_vertex[v as usize])).collect();
    display.numbers = Some(kept);
}

fn extent(positions: &[DVec3]) -> (DVec3, DVec3) {
    positions.iter().fold((DVec3::MAX, DVec3::MIN), |(low, high), &p| (low.min(p), high.max(p)))
}

/// The vertex that stands for each vertex, and the faces that stay.
fn cluster(display: &Display, low: DVec3, cell: f64) -> (Vec<u32>, Vec<u32>) {
    let mut cells: HashMap<u64, u32, BuildHasherDefault<Mix>> = HashMap::default();
    let of_vertex: Vec<u32> = (display.positions.iter().zip(0..))
        .map(|(&p, v)| {
            let [x, y, z] = ((p - low) / cell).to_array().map(|c| c as u64 & 0x1f_ffff);
            *cells.entry(x | y << 21 | z << 42).or_insert(v)
        })
        .collect();
    let mut seen: HashMap<[u32; 3], (), BuildHasherDefault<Mix>> = HashMap::default();
    let kept = (display.corners.iter().zip(0..)).filter_map(|(face, f)| {
        let mut key = face.map(|v| of_vertex[v as usize]);
        key.sort_unstable();
        let is_face = key[0] != key[1] && key[1] != key[2];
        (is_face && seen.insert(key, ()).is_none()).then_some(f)
    });
    let kept = kept.collect();
    (of_vertex, kept)
}

/// Spreads the bits of whole numbers: the default hasher takes three times as long.
#[derive(Default)]
struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 29)
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}
