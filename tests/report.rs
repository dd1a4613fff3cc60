//! The report from the outside: what a page carries, what a picture shows, and what is refused.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn osculate(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_osculate"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    command.output().expect("the program starts")
}

/// Runs the program and expects this exit code.
fn run(folder: &Path, code: i32, args: &[&str]) -> String {
    let output = osculate(folder, args);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{args:?}\n{said}");
    said
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::os::unix::fs::symlink(Path::new(ROOT).join("fixtures"), folder.path().join("fixtures")).expect("a link");
    folder
}

/// A page as its reader takes it apart.
struct Page {
    text: String,
    facts: Value,
}

impl Page {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).expect("a page");
        let facts = serde_json::from_str(between(&text, "id=\"facts\">", "</script>")).expect("JSON");
        Page { text, facts }
    }

    fn array(&self, model: usize, name: &str) -> Vec<u32> {
        let packed = between(&self.text, &format!("id=\"{model}-{name}\">"), "</script>");
        let mut bytes = Vec::new();
        let deflated = STANDARD.decode(packed).expect("base64");
        ZlibDecoder::new(deflated.as_slice()).read_to_end(&mut bytes).expect("deflate");
        let arrays = self.facts["models"][model]["arrays"].as_array().expect("arrays");
        let array = arrays.iter().find(|array| array["name"] == name).expect("listed");
        let (count, planes) = (array["count"].as_u64().expect("a count") as usize, array["planes"].as_u64());
        assert_eq!(Some((bytes.len() / count) as u64), planes);
        (0..count).map(|i| bytes[i..].iter().step_by(count).rev().fold(0, |n, &b| n << 8 | u32::from(b))).collect()
    }

    fn floats(&self, name: &str) -> Vec<f32> {
        self.array(0, name).into_iter().map(f32::from_bits).collect()
    }

    /// Corners of every face, in file units.
    fn triangles(&self) -> Vec<[[f64; 3]; 3]> {
        let facts = &self.facts["models"][0];
        let (low, step) = (&facts["low"], facts["step"].as_f64().expect("a step"));
        let codes = self.array(0, "positions");
        let count = codes.len() / 3;
        let mut positions = vec![[0.0; 3]; count];
        for axis in 0..3 {
            let mut at = 0_i64;
            for v in 0..count {
                let code = i64::from(codes[axis * count + v]);
                at += code >> 1 ^ -(code & 1);
                positions[v][axis] = low[axis].as_f64().expect("a number") + step * at as f64;
            }
        }
        let mut newest = 0;
        let corners = self.array(0, "corners").into_iter().map(|code| {
            if code == 0 {
                newest += 1;
                return newest - 1;
            }
            newest - code
        });
        let corners: Vec<u32> = corners.collect();
        corners.as_chunks::<3>().0.iter().map(|face| face.map(|v| positions[v as usize])).collect()
    }
}

fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    text.split_once(from)
        .and_then(|(_, rest)| rest.split_once(to))
        .map_or_else(|| panic!("no {from}"), |(found, _)| found)
}

/// Columns of a CSV file by name; NaN for an empty field.
fn column(csv: &str, name: &str) -> Vec<f32> {
    let mut lines = csv.lines();
    let at = lines.next().and_then(|head| head.split(',').position(|n| n == name)).expect("a column");
    lines.map(|line| line.split(',').nth(at).and_then(|field| field.parse().ok()).unwrap_or(f32::NAN)).collect()
}

#[test]
fn a_page_carries_the_numbers_of_the_csv_and_the_mesh_itself() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    run(folder.path(), 0, &["report", "fixtures/suzanne.stl", "-o", "a.html", "-q"]);
    run(folder.path(), 0, &["annotate", "fixtures/suzanne.stl", "-o", "a.csv", "-q"]);
    let page = Page::read(&at("a.html"));
    let csv = fs::read_to_string(at("a.csv")).expect("a CSV");
    for name in ["k_max", "k_min"] {
        assert_eq!(page.floats(name), column(&csv, name), "{name} is kept whole");
    }
    for (radius, whole) in page.floats("radius").into_iter().zip(column(&csv, "radius")) {
        assert!((radius - whole).abs() <= 1e-4 * whole);
    }
    for name in ["coverage", "confidence"] {
        for (code, whole) in page.array(0, name).into_iter().zip(column(&csv, name)) {
            assert!((code as f32 / 255.0 - whole).abs() <= 0.002, "{name} {whole}");
        }
    }
    let classes: Vec<f32> = page.array(0, "kind").into_iter().map(|kind| (kind & 7) as f32 - 1.0).collect();
    assert_eq!(classes, column(&csv, "class"));

    let stl = fs::read(Path::new(ROOT).join("fixtures/suzanne.stl")).expect("a fixture");
    let step = page.facts["models"][0]["step"].as_f64().expect("a step");
    for (f, face) in page.triangles().into_iter().enumerate() {
        for (c, corner) in face.into_iter().enumerate() {
            for (axis, value) in corner.into_iter().enumerate() {
                let byte = 84 + 50 * f + 12 + 12 * c + 4 * axis;
                let exact = f32::from_le_bytes(stl[byte..byte + 4].try_into().expect("four bytes"));
                assert!((value - f64::from(exact)).abs() <= 0.51 * step, "face {f}: {value}, not {exact}");
            }
        }
    }
}

#[test]
fn a_face_takes_at_most_32_bytes_and_threads_change_nothing() {
    let folder = folder();
    run(
        folder.path(),
        0,
        &["synth", "ellipsoid", "--faces", "20000", "--jitter", "0.3", "--noise", "0.05", "-o", "e.stl"],
    );
    run(folder.path(), 0, &["report", "e.stl", "-o", "one.html", "-j", "1", "-q"]);
    run(folder.path(), 0, &["report", "e.stl", "-o", "three.html", "-j", "3", "-q"]);
    let [one, three] = ["one.html", "three.html"].map(|name| Page::read(&folder.path().join(name)));
    let faces = one.facts["models"][0]["faces"].as_u64().expect("a count") as usize;
    assert!(one.text.len() <= 150_000 + 32 * faces, "{} bytes for {faces} faces", one.text.len());
    let timeless = |page: &Page| page.text.replace(&page.facts["models"][0]["seconds"].to_string(), "");
    assert!(timeless(&one) == timeless(&three));
}

#[test]
fn a_large_mesh_is_thinned_and_the_page_says_so() {
    let folder = folder();
    run(folder.path(), 0, &["synth", "torus", "--faces", "20000", "-o", "t.ply"]);
    run(folder.path(), 0, &["report", "t.ply", "-o", "t.html", "--max-faces", "5000", "-q"]);
    run(folder.path(), 0, &["annotate", "t.ply", "-o", "t.csv", "-q"]);
    let page = Page::read(&folder.path().join("t.html"));
    let model = &page.facts["models"][0];
    let shown = model["faces"].as_u64().expect("a count");
    assert!((2500..=5000).contains(&shown), "{shown}");
    assert!(model["sentences"][0].as_str().is_some_and(|s| s.contains(&format!("{shown} of 20068 faces"))), "{model}");
    let csv = fs::read_to_string(folder.path().join("t.csv")).expect("a CSV");
    let all = column(&csv, "k_max");
    let mut number = 0;
    for (step, k) in page.array(0, "numbers").into_iter().zip(page.floats("k_max")) {
        number += step;
        assert_eq!(k, all[number as usize], "every face has its own values");
    }
    // The classes are those of all faces.
    let counted: u64 = model["classes"].as_array().expect("classes").iter().filter_map(|c| c["count"].as_u64()).sum();
    assert_eq!(counted, 20068);
}

#[test]
fn values_of_an_annotated_file_are_shown_again() {
    let folder = folder();
    run(folder.path(), 0, &["annotate", "fixtures/cylinder_holes.stl", "--estimator", "tangent", "-o", "c.glb", "-q"]);
    run(folder.path(), 0, &["report", "c.glb", "fixtures/cylinder_holes.stl", "-o", "c.html", "-q"]);
    run(folder.path(), 0, &["report", "c.glb", "--no-reuse", "-o", "again.html", "-q"]);
    let page = Page::read(&folder.path().join("c.html"));
    let [first, second] = [0, 1].map(|m| page.facts["models"][m]["settings"]["estimator"].clone());
    assert_eq!((first.as_str(), second.as_str()), (Some("tangent"), Some("auto")));
    assert_ne!(page.array(0, "k_max"), page.array(1, "k_max"));
    let again = Page::read(&folder.path().join("again.html"));
    assert_eq!(again.facts["models"][0]["settings"]["estimator"], "auto");
    // An estimate that is asked for is made, also with what is the default.
    for (option, value) in [("--estimator", "auto"), ("--feature-angle", "40")] {
        run(folder.path(), 0, &["report", "c.glb", option, value, "-o", "again.html", "-q"]);
        let again = Page::read(&folder.path().join("again.html"));
        assert_eq!(again.facts["models"][0]["settings"]["estimator"], "auto", "{option}");
    }
    run(folder.path(), 0, &["report", "c.glb", "--radius", "20", "-o", "wide.html", "-q"]);
    let wide = Page::read(&folder.path().join("wide.html"));
    assert_eq!(wide.facts["models"][0]["settings"]["radius"], 20.0);
}

#[test]
fn values_from_a_file_are_not_judged_anew() {
    let folder = folder();
    run(folder.path(), 0, &["annotate", "fixtures/suzanne.stl", "-o", "s.glb", "-q"]);
    let said = run(folder.path(), 0, &["report", "s.glb", "-o", "s.html"]);
    // The file does not say how a face came by its values, so that their confidence is no ground for advice.
    assert!(said.contains("earlier run") && !said.contains("confidence below"), "{said}");
}

#[test]
fn names_in_files_stay_text_and_paths_stay_at_home() {
    let folder = folder();
    let obj = "g </script><script>alert(1)</script>\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\ng b\u{202e}\nf 2 3 4\nf 3 1 4\n";
    let name = "'\"><script>x.obj";
    fs::write(folder.path().join(name), obj).expect("writable");
    let input = folder.path().join(name);
    run(folder.path(), 0, &["report", input.to_str().expect("text"), "-o", "h.html", "-q"]);
    let page = Page::read(&folder.path().join("h.html"));
    assert_eq!(page.text.matches("<script>").count(), 0, "every script of the page has a type");
    assert_eq!(page.facts["models"][0]["groups"][0]["name"], "</script><script>alert(1)</script>");
    assert!(!page.text.contains('\u{202e}'));
    assert!(!page.text.contains(folder.path().to_str().expect("text")), "the sender's folders are not told");
}

/// Width, height, bytes a pixel and pixels of a PNG.
fn picture(path: &Path) -> (u32, u32, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).expect("a picture")))
        .read_info()
        .expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("fits")];
    let info = reader.next_frame(&mut pixels).expect("pixels");
    (info.width, info.height, info.color_type.samples(), pixels)
}

#[test]
fn a_picture_shows_the_palettes_colours_from_the_side_asked_for() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    run(folder.path(), 0, &["synth", "cylinder", "--faces", "4000", "-o", "c.stl"]);
    let draw = |name: &str, more: &[&str]| {
        let mut args = vec!["report", "c.stl", "--png", name, "--size", "300x240", "--color-by", "class", "-q"];
        args.extend(more);
        run(folder.path(), 0, &args);
        picture(&at(name))
    };
    let (width, height, samples, side) = draw("side.png", &["--view", "x", "--no-legend"]);
    assert_eq!((width, height, samples), (300, 240, 3));
    let pixel =
        |pixels: &[u8], x: usize, y: usize, samples: usize| pixels[samples * (300 * y + x)..][..samples].to_vec();
    assert_eq!(pixel(&side, 2, 2, 3), [250, 249, 246], "paper");
    // A cylinder is parabolic: blue, darker than the palette's by the light on it.
    let [r, g, b] = pixel(&side, 150, 120, 3)[..] else { panic!("three channels") };
    assert!(b > g && g > r && b > 180 && b <= 233, "{r} {g} {b}");
    // From above, an open cylinder shows paper in its middle.
    let (.., top) = draw("top.png", &["--view", "z", "--no-legend"]);
    assert_eq!(pixel(&top, 150, 120, 3), [250, 249, 246]);
    let (.., along) = draw("along.png", &["--view", "-1,0,0", "--no-legend"]);
    assert!(along == side, "a direction may be given as numbers");
    let (_, _, samples, clear) = draw("clear.png", &["--transparent", "--no-legend"]);
    assert_eq!((samples, pixel(&clear, 1, 1, 4)[3]), (4, 0));
    let partly = clear.chunks(4).filter(|p| p[3] > 0 && p[3] < 255).count();
    assert!(partly > 100, "{partly} pixels at the outline are blended");
    let (.., legend) = draw("legend.png", &["--view", "x"]);
    assert!(legend.chunks(3).any(|p| p == [240, 228, 66]), "the legend shows the colour of flat faces");
}

#[test]
fn what_cannot_be_reported_is_refused_in_a_sentence() {
    let folder = folder();
    let refused = |code: i32, args: &[&str], what: &str| {
        let said = run(folder.path(), code, args);
        assert!(said.contains(what), "{args:?}: {said}");
    };
    let stl = "fixtures/suzanne.stl";
    refused(2, &["report", stl], "--output");
    refused(2, &["report", stl, "-o", "a.pdf"], ".html");
    refused(2, &["report", stl, "-o", "a.html", "--view", "x"], "--png");
    refused(2, &["report", stl, "--png", "a.jpg"], ".png");
    refused(2, &["report", stl, stl, "--png", "a.png"], "one mesh");
    refused(2, &["report", stl, "--png", "a.png", "--size", "20x20"], "--size");
    refused(2, &["report", stl, "--png", "a.png", "--view", "0,0,0"], "zero");
    refused(2, &["report", stl, "-o", "a.html", "--color-by", "none"], "--color-by");
    refused(2, &["report", stl, "-o", "a.html", "--max-faces", "5"], "--max-faces");
    refused(2, &["report", stl, stl, stl, "-o", "a.html"], "unexpected");
    refused(2, &["report", "-", "-", "-o", "a.html"], "once");
    refused(1, &["report", stl, "-o", "none/a.html"], "none/a.html");
    fs::write(folder.path().join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").expect("writable");
    refused(1, &["report", "flat.obj", "-o", "a.html"], "flat.obj");
    fs::write(folder.path().join("in.html"), "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n").expect("writable");
    refused(2, &["report", "in.html", "--input-format", "obj", "-o", "in.html"], "belongs to the input");
    assert!(!folder.path().join("a.html").exists() && !folder.path().join("a.png").exists());
    let said = run(folder.path(), 3, &["report", "fixtures/fillet_degenerate.stl", "-o", "d.html"]);
    assert!(said.contains("without area"), "{said}");
    refused(1, &["report", stl, "-o", "d.html", "--no-clobber"], "exists");
}
