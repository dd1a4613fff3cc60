//! Seconds that reading a file takes, the best of several runs. For `benches/readers.py`.
//!
//! `cargo run --release --example read_speed -- [bytes] RUNS FILE...`; with `bytes`, the files are only
//! brought into memory, which is the least that reading can take.

#![allow(clippy::print_stdout, reason = "the table is what it is for")]

use osculate::{NoProgress, read};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).peekable();
    let only_bytes = arguments.next_if(|first| first == "bytes").is_some();
    let runs: usize = arguments.next().ok_or("usage: read_speed [bytes] RUNS FILE...")?.parse()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    for file in arguments {
        let mut best = f64::INFINITY;
        let mut faces = 0;
        for _ in 0..runs {
            let start = Instant::now();
            if only_bytes {
                black_box(std::fs::read(&file)?);
            } else {
                let (soup, _) = pool.install(|| read(Path::new(&file), &NoProgress))?;
                faces = soup.face_count();
            }
            best = best.min(start.elapsed().as_secs_f64());
        }
        println!("{file}\t{faces}\t{best:.6}");
    }
    Ok(())
}
