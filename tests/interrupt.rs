//! Ctrl-C at any moment: the program ends at once with exit code 130 and leaves nothing behind.
#![cfg(unix)]

use osculate::synth::{Grid, Surface};
use osculate::write_mesh;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// When to send the signal.
enum Moment {
    /// So many milliseconds after the start.
    After(u64),
    /// When so many bytes of the output are written.
    Written(u64),
}

/// Bytes of temporary files in a folder.
fn unfinished(folder: &Path) -> u64 {
    let entries = fs::read_dir(folder).expect("a folder").flatten();
    let parts = entries.filter(|entry| entry.file_name().to_string_lossy().ends_with(".part"));
    parts.filter_map(|entry| Some(entry.metadata().ok()?.len())).sum()
}

/// Milliseconds between the signal and the end of the program; `None` where it was done before.
fn interrupt(folder: &Path, args: &[&str], moment: &Moment) -> Option<f64> {
    for output in ["out.glb", "out.gltf", "out.bin", "out.png", "edges.glb"] {
        // Left by a run that was done before its signal.
        let _ = fs::remove_file(folder.join(output));
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_osculate"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("the program starts");
    let start = Instant::now();
    loop {
        match *moment {
            Moment::After(milliseconds) if start.elapsed() >= Duration::from_millis(milliseconds) => break,
            Moment::Written(bytes) if unfinished(folder) >= bytes => break,
            _ if child.try_wait().expect("a child").is_some() => return None,
            _ => std::thread::sleep(Duration::from_millis(1)),
        }
    }
    let sent = Instant::now();
    let signal = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let status = child.wait().expect("it ends");
    let milliseconds = 1e3 * sent.elapsed().as_secs_f64();
    assert!(signal.success());
    if status.success() {
        // It was done while the signal was on its way.
        return None;
    }
    assert_eq!(status.code(), Some(130), "{args:?}");
    assert_eq!(unfinished(folder), 0, "{args:?}: a temporary file is left");
    let outputs = fs::read_dir(folder).expect("a folder").count();
    assert_eq!(outputs, 1, "{args:?}: only the input is there");
    Some(milliseconds)
}

#[test]
fn ctrl_c_ends_every_stage_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let torus = Grid::with_faces(Surface::Torus { major: 3.0, minor: 1.0 }, 1_000_000, 1.0).build();
    write_mesh(&torus.soup, &folder.path().join("torus.stl")).expect("writable");

    let annotate = ["annotate", "torus.stl", "-o", "out.glb", "-q"];
    // With every edge a feature there is nothing to estimate, so that writing comes soon.
    let flat = ["annotate", "torus.stl", "-o", "out.glb", "-q", "--feature-angle", "0"];
    let beside = ["annotate", "torus.stl", "-o", "out.gltf", "-q", "--feature-angle", "0", "--edges", "edges.glb"];
    let mut slowest: f64 = 0.0;
    let mut interrupted = 0;
    for (args, moment) in [20, 60, 150, 400, 900, 2000]
        .map(|milliseconds| (&annotate[..], Moment::After(milliseconds)))
        .into_iter()
        .chain([1, 10, 40, 80].map(|megabytes| (&flat[..], Moment::Written(megabytes << 20))))
        .chain([1, 60].map(|megabytes| (&beside[..], Moment::Written(megabytes << 20))))
    {
        if let Some(milliseconds) = interrupt(folder.path(), args, &moment) {
            interrupted += 1;
            slowest = slowest.max(milliseconds);
        }
    }
    assert!(interrupted >= 6, "most moments come before the end, not {interrupted}");
    // 100 ms on a machine of its own; here other tests run beside.
    assert!(slowest < 1000.0, "the slowest took {slowest:.0} ms");
}
