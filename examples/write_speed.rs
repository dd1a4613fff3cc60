//! Speed and memory of writing an annotated torus as `.glb`: wall-clock and processor seconds of the best
//! of several runs, and the peak of memory on top of the mesh and its values.
//!
//! `cargo run --release --example write_speed -- RUNS FACES FILE`

#![allow(clippy::print_stdout, reason = "the line is what it is for")]

use osculate::synth::{Grid, Surface};
use osculate::{
    Annotation, ColorCarrier, ColorRange, ColorScale, Destination, FaceClass, FaceCurvature, Layout, Mesh, MeshOptions,
    NoProgress, OutputFormat, Quantity, Selection, Space,
};
use std::time::Instant;

/// Processor seconds of all threads so far; 0 where the system does not tell.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split_whitespace().collect();
    let ticks = |i: usize| fields.get(i).and_then(|field| field.parse::<f64>().ok()).unwrap_or(0.0);
    (ticks(11) + ticks(12)) / 100.0
}

/// Megabytes of memory, now or at most since the last reset.
fn megabytes(line: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let found =
        status.lines().find_map(|l| l.strip_prefix(line)?.trim().strip_suffix("kB")?.trim().parse::<f64>().ok());
    found.unwrap_or(0.0) / 1024.0
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [runs, faces, file] = arguments.as_slice() else { return Err("usage: write_speed RUNS FACES FILE".into()) };
    let cells = ((faces.parse::<f64>()? / 2.0).sqrt() as usize).max(3);
    let grid = Grid {
        surface: Surface::Torus { major: 3.0, minor: 1.0 },
        cells: [cells, cells],
        jitter: 0.2,
        noise: 0.0,
        seed: 1,
    };
    let torus = grid.build();
    let mesh = Mesh::from_soup(&torus.soup, &MeshOptions::default())?;
    let values: Vec<FaceCurvature> = (torus.exact.iter())
        .map(|exact| FaceCurvature {
            k_max: exact.k_max as f32,
            k_min: exact.k_min as f32,
            dir_max: exact.dir_max.as_vec3(),
            dir_min: exact.dir_min.as_vec3(),
            coverage: 1.0,
            confidence: 1.0,
            class: FaceClass::of(exact.k_max, exact.k_min, 1.0, 0.05),
            ..FaceCurvature::NOT_ESTIMATED
        })
        .collect();
    drop(torus);
    let annotation = Annotation {
        mesh: &mesh,
        values: &values,
        selected: None,
        name: "torus".into(),
        vertex_values: None,
        selection: Selection::default(),
        colors: vec![ColorScale::new(Quantity::Mean, None, ColorRange::Auto, &values)?],
        carrier: ColorCarrier::Texture,
        layout: Layout::Faces,
        force: false,
        metadata: false,
        compress: false,
        space: Space::default(),
        provenance: serde_json::Value::Null,
    };
    let destination = Destination::File(file.into());
    let (mut wall, mut processor) = (f64::INFINITY, f64::INFINITY);
    let before = megabytes("VmRSS:");
    // Five resets the peak.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    for _ in 0..runs.parse()? {
        let (start, used) = (Instant::now(), processor_seconds());
        osculate::write(&annotation, OutputFormat::Glb, &destination, &NoProgress)?;
        wall = wall.min(start.elapsed().as_secs_f64());
        processor = processor.min(processor_seconds() - used);
    }
    let size = std::fs::metadata(file)?.len() as f64 / 1e6;
    println!(
        "{} faces, {size:.1} MB: {wall:.3} s ({:.0} MB/s), {processor:.2} processor seconds, {:.1} MB on top of {before:.1}",
        values.len(),
        size / wall,
        megabytes("VmHWM:") - before
    );
    Ok(())
}
