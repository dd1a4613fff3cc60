//! The fuzzers' targets on their seeds and on changes of these by a fixed random sequence: a short
//! stand-in for `fuzz/run.sh`, which every test run can afford. Finds of the fuzzers are tests of
//! their own, beside the code that they are about.

#[path = "../fuzz/targets.rs"]
mod targets;

use std::fs;
use std::path::Path;

/// Words that readers look at twice.
const WORDS: [&[u8]; 16] = [
    b"4294967295",
    b"-1",
    b"nan",
    b"1e999",
    b"\0",
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\n",
    b"#",
    b"\\\n",
    b"{",
    b"\"",
    b"vertex",
    b"f 1 2 3",
    b"solid",
    b"<",
];

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) % limit.max(1) as u64) as usize
    }
}

fn mutate(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..1 + random.below(6) {
        let at = random.below(bytes.len());
        let span = at..(at + 1 + random.below(40)).min(bytes.len());
        match random.below(7) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
            1 if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
            2 => drop(bytes.drain(span)),
            3 => {
                let copy = bytes[span].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            4 => {
                let word = WORDS[random.below(WORDS.len())];
                let end = (at + word.len() * random.below(2)).min(bytes.len());
                bytes.splice(at..end.max(at), word.iter().copied());
            }
            5 => bytes.truncate(at + 1),
            _ => {
                let from = random.below(other.len());
                let part = &other[from..(from + random.below(60)).min(other.len())];
                bytes.splice(span, part.iter().copied());
            }
        }
    }
}

fn run(seeds: &str, target: fn(&[u8]), rounds: usize) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(seeds);
    let mut files: Vec<_> = fs::read_dir(&folder).expect("seeds").map(|e| e.expect("an entry").path()).collect();
    files.sort();
    let seeds: Vec<Vec<u8>> = files.iter().map(|path| fs::read(path).expect("a seed")).collect();
    assert!(!seeds.is_empty(), "{}", folder.display());
    let mut random = Random(seeds.len() as u64);
    for seed in &seeds {
        target(seed);
    }
    for round in 0..rounds {
        let mut bytes = seeds[round % seeds.len()].clone();
        let other = &seeds[random.below(seeds.len())];
        mutate(&mut bytes, other, &mut random);
        target(&bytes);
    }
}

#[test]
fn stl() {
    run("stl", targets::stl, 3000);
}

#[test]
fn obj() {
    run("obj", targets::obj, 3000);
}

#[test]
fn ply() {
    run("ply", targets::ply, 3000);
}

#[test]
fn off() {
    run("off", targets::off, 3000);
}

#[test]
fn gltf() {
    run("gltf", targets::gltf, 3000);
}

#[test]
fn threemf() {
    run("3mf", targets::threemf, 3000);
}

#[test]
fn gz() {
    run("gz", targets::gz, 1000);
}

#[test]
fn mesh() {
    run("mesh", targets::mesh, 3000);
}
