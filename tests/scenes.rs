//! glTF in, glTF out: everything of a scene comes out as it went in. Files are read back here without
//! this crate's own reader.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

fn fixture(name: &str) -> PathBuf {
    Path::new(ROOT).join("fixtures").join(name)
}

fn run(input: &Path, output: &Path, extra: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_osculate"))
        .arg("annotate")
        .arg(input)
        .arg("-o")
        .arg(output)
        .args(extra)
        .output()
        .expect("the program starts")
}

fn annotate(input: &Path, output: &Path, extra: &[&str]) -> String {
    let run = run(input, output, extra);
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(matches!(run.status.code(), Some(0 | 3)), "{said}");
    said
}

/// A document and the bytes of its buffers.
struct Document {
    json: Value,
    buffers: Vec<Vec<u8>>,
    folder: PathBuf,
}

impl Document {
    fn read(path: &Path) -> Self {
        let bytes = fs::read(path).expect("a file");
        let folder = path.parent().expect("a folder").to_path_buf();
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes")) as usize;
        if !bytes.starts_with(b"glTF") {
            let json: Value = serde_json::from_slice(&bytes).expect("JSON");
            let uris = json["buffers"].as_array().into_iter().flatten().map(|b| b["uri"].as_str().expect("a URI"));
            let buffers = uris.map(|uri| fs::read(folder.join(uri)).expect("a buffer")).collect();
            return Document { json, buffers, folder };
        }
        let bin = 20 + word(12);
        let json = serde_json::from_slice(&bytes[20..bin]).expect("JSON");
        Document { json, buffers: vec![bytes[bin + 8..].to_vec()], folder }
    }

    fn view(&self, index: &Value) -> (&[u8], Option<usize>) {
        let view = &self.json["bufferViews"][index.as_u64().expect("a view") as usize];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let length = view["byteLength"].as_u64().expect("a length") as usize;
        let buffer = &self.buffers[view["buffer"].as_u64().expect("a buffer") as usize];
        (&buffer[start..start + length], view["byteStride"].as_u64().map(|s| s as usize))
    }

    /// The elements of an accessor as bytes, sparse ones replaced.
    fn elements(&self, index: &Value) -> Vec<Vec<u8>> {
        let accessor = &self.json["accessors"][index.as_u64().expect("an accessor") as usize];
        let width = |kind: &Value| match kind.as_u64().expect("a type") {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let parts = ["SCALAR", "VEC2", "VEC3", "VEC4", "", "", "", "", "", "MAT4"];
        let shape = parts.iter().position(|p| accessor["type"] == **p).expect("a type");
        let size = width(&accessor["componentType"]) * if shape == 9 { 16 } else { shape + 1 };
        let count = accessor["count"].as_u64().expect("a count") as usize;
        let mut all = vec![vec![0; size]; count];
        if accessor["bufferView"].is_u64() {
            let (bytes, stride) = self.view(&accessor["bufferView"]);
            let bytes = &bytes[accessor["byteOffset"].as_u64().unwrap_or(0) as usize..];
            for (element, chunk) in all.iter_mut().zip(bytes.chunks(stride.unwrap_or(size))) {
                element.copy_from_slice(&chunk[..size]);
            }
        }
        if let Some(sparse) = accessor.get("sparse") {
            let (places, _) = self.view(&sparse["indices"]["bufferView"]);
            let (values, _) = self.view(&sparse["values"]["bufferView"]);
            let wide = width(&sparse["indices"]["componentType"]);
            for (place, value) in places.chunks_exact(wide).zip(values.chunks_exact(size)) {
                all[place.iter().rev().fold(0, |number, &byte| 256 * number + usize::from(byte))] = value.to_vec();
            }
        }
        all
    }

    fn image(&self, image: &Value) -> Vec<u8> {
        match image["uri"].as_str() {
            Some(uri) => fs::read(self.folder.join(uri)).expect("an image"),
            None => self.view(&image["bufferView"]).0.to_vec(),
        }
    }

    /// The vertex numbers of the corners of all triangles of a primitive.
    fn corners(&self, primitive: &Value, count: usize) -> Vec<usize> {
        let numbers: Vec<usize> = match primitive.get("indices") {
            None => (0..count).collect(),
            Some(indices) => (self.elements(indices).into_iter())
                .map(|e| e.iter().rev().fold(0, |number, &byte| 256 * number + usize::from(byte)))
                .collect(),
        };
        match primitive.get("mode").and_then(Value::as_u64).unwrap_or(4) {
            4 => numbers,
            5 => (0..numbers.len() - 2)
                .flat_map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i, i + 2, i + 1] })
                .map(|i| numbers[i])
                .collect(),
            mode => panic!("mode {mode}"),
        }
    }

    /// The document with every accessor and image by its content instead of its number, and what Osculate
    /// added taken out.
    fn meaning(&self) -> Value {
        let hex = |elements: &[Vec<u8>]| -> Value {
            elements.iter().map(|e| e.iter().map(|b| format!("{b:02x}")).collect::<String>()).collect()
        };
        let mut json = self.json.clone();
        let accessor = |index: &Value| {
            let mut described = self.json["accessors"][index.as_u64().expect("an accessor") as usize].clone();
            for key in ["bufferView", "byteOffset", "sparse", "count"] {
                described.as_object_mut().expect("an object").remove(key);
            }
            // The default, which some write out.
            if described["normalized"] == false {
                described.as_object_mut().expect("an object").remove("normalized");
            }
            described
        };
        let is_ours = |value: &Value| value.pointer("/extras/osculate").is_some();
        let ours: Vec<usize> = json["materials"].as_array().map_or(Vec::new(), |materials| {
            materials.iter().enumerate().filter(|(_, m)| is_ours(m)).map(|(i, _)| i).collect()
        });
        for mesh in json["meshes"].as_array_mut().expect("meshes") {
            for primitive in mesh["primitives"].as_array_mut().expect("primitives") {
                let mode = primitive.get("mode").and_then(Value::as_u64).unwrap_or(4);
                if mode < 4 {
                    continue;
                }
                let attributes = primitive["attributes"].clone();
                let count = self.elements(&attributes["POSITION"]).len();
                let corners = self.corners(primitive, count);
                let texcoord = |material: &Value| {
                    let info = &self.json["materials"][material.as_u64().expect("a number") as usize];
                    info["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"].as_u64().unwrap_or(0)
                };
                let mut gone: Vec<String> =
                    ["_FACE_ID", "_CURV", "_DIRECTION", "_COVERAGE", "_CONFIDENCE", "_SHAPE", "_RADIUS"]
                        .map(str::to_owned)
                        .into();
                if is_ours(primitive) {
                    primitive.as_object_mut().expect("an object").remove("extras");
                }
                if let Some(mappings) = primitive.pointer_mut("/extensions/KHR_materials_variants/mappings") {
                    let list = mappings.as_array_mut().expect("mappings");
                    list.retain(|mapping| {
                        let material = mapping["material"].as_u64().expect("a number") as usize;
                        if ours.contains(&material) {
                            gone.push(format!("TEXCOORD_{}", texcoord(&mapping["material"])));
                        }
                        !ours.contains(&material)
                    });
                    if list.is_empty() {
                        primitive["extensions"].as_object_mut().expect("some").remove("KHR_materials_variants");
                        if primitive["extensions"] == json!({}) {
                            primitive.as_object_mut().expect("an object").remove("extensions");
                        }
                    }
                }
                let by_corner = |map: &Value, gone: &[String]| -> Value {
                    let map = map.as_object().expect("attributes").iter();
                    map.filter(|(name, _)| !gone.iter().any(|g| name.starts_with(g.as_str())))
                        .map(|(name, index)| {
                            let elements = self.elements(index);
                            let values: Vec<Vec<u8>> = corners.iter().map(|&c| elements[c].clone()).collect();
                            (name.clone(), json!([accessor(index), hex(&values)]))
                        })
                        .collect::<serde_json::Map<_, _>>()
                        .into()
                };
                primitive["attributes"] = by_corner(&attributes, &gone);
                if let Some(targets) = primitive.get_mut("targets").and_then(Value::as_array_mut) {
                    targets.iter_mut().for_each(|target| *target = by_corner(&target.clone(), &[]));
                }
                let primitive = primitive.as_object_mut().expect("an object");
                primitive.remove("indices");
                primitive.remove("mode");
            }
            if is_ours(mesh) {
                mesh["extras"].as_object_mut().expect("extras").remove("osculate");
                if mesh["extras"] == json!({}) {
                    mesh.as_object_mut().expect("an object").remove("extras");
                }
            }
        }
        for skin in json.get_mut("skins").and_then(Value::as_array_mut).into_iter().flatten() {
            let index = &skin["inverseBindMatrices"];
            skin["inverseBindMatrices"] = json!([accessor(index), hex(&self.elements(index))]);
        }
        for animation in json.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
            for sampler in animation["samplers"].as_array_mut().expect("samplers") {
                for key in ["input", "output"] {
                    sampler[key] = json!([accessor(&sampler[key]), hex(&self.elements(&sampler[key]))]);
                }
            }
        }
        for image in json.get_mut("images").and_then(Value::as_array_mut).into_iter().flatten() {
            if !is_ours(image) {
                let bytes = self.image(image);
                let image = image.as_object_mut().expect("an image");
                ["bufferView", "uri", "mimeType"].iter().for_each(|key| _ = image.remove(*key));
                image.insert("bytes".into(), hex(&[bytes]));
            }
        }
        let root = json.as_object_mut().expect("an object");
        for list in ["materials", "textures", "images", "samplers"] {
            let Some(members) = root.get_mut(list).and_then(Value::as_array_mut) else { continue };
            members.retain(|member| !is_ours(member));
            if members.is_empty() {
                root.remove(list);
            }
        }
        if let Some(variants) = root.get_mut("extensions").and_then(|e| e.get_mut("KHR_materials_variants")) {
            let list = variants["variants"].as_array_mut().expect("variants");
            list.retain(|variant| !is_ours(variant));
            if list.is_empty() {
                root["extensions"].as_object_mut().expect("some").remove("KHR_materials_variants");
                root["extensionsUsed"].as_array_mut().expect("some").retain(|name| name != "KHR_materials_variants");
            }
        }
        for list in ["extensions", "extensionsUsed"] {
            if root.get(list).is_some_and(|v| *v == json!({}) || *v == json!([])) {
                root.remove(list);
            }
        }
        // Extensions that are not known keep their views.
        if let Some(view) = root.get("extensions").and_then(|e| e.get("ACME_data")?.get("bufferView")).cloned() {
            root["extensions"]["ACME_data"]["bufferView"] = hex(&[self.view(&view).0.to_vec()]);
        }
        for list in ["accessors", "bufferViews", "buffers"] {
            root.remove(list);
        }
        json
    }
}

/// What differs first between two values, for a message that can be read.
fn difference(path: &str, a: &Value, b: &Value) -> Option<String> {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) => {
            let keys = x.keys().chain(y.keys().filter(|key| !x.contains_key(*key)));
            let of = |map: &serde_json::Map<String, Value>, key: &String| map.get(key).cloned().unwrap_or_default();
            keys.into_iter().find_map(|key| difference(&format!("{path}/{key}"), &of(x, key), &of(y, key)))
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            x.iter().zip(y).enumerate().find_map(|(i, (x, y))| difference(&format!("{path}/{i}"), x, y))
        }
        _ => (a != b).then(|| format!("{path}: {a} and {b}")),
    }
}

fn assert_same(input: &Path, output: &Path, what: &str) {
    let (a, b) = (Document::read(input).meaning(), Document::read(output).meaning());
    assert_eq!(difference("", &a, &b), None, "{what}");
}

#[test]
fn a_scene_comes_out_as_it_went_in() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["character.glb", "scene.glb", "scene.gltf", "suzanne.glb", "two_meshes.gltf"] {
        for (output, extra) in [
            ("out.glb", &[][..]),
            ("out.gltf", &[]),
            ("out.glb", &["--attributes", "class", "--color-by", "class"]),
            ("out.glb", &["--variants", "mean,gauss,k_max,shape_index,class"]),
            ("out.glb", &["--color-by", "none"]),
        ] {
            let output = folder.path().join(output);
            annotate(&fixture(name), &output, extra);
            assert_same(&fixture(name), &output, &format!("{name} {extra:?}"));
        }
    }
}

/// `character_plain.glb` is what glTF-Transform decodes `character_meshopt.glb` to: normals, rotations and
/// floats behind filters among it.
#[test]
fn a_compressed_scene_comes_out_plain() {
    let folder = tempfile::tempdir().expect("a folder");
    for (output, extra) in [("out.glb", &[][..]), ("out.gltf", &[]), ("out.glb", &["--layout", "indexed"])] {
        let output = folder.path().join(output);
        annotate(&fixture("character_meshopt.glb"), &output, extra);
        let found = Document::read(&output);
        assert!(!found.json.to_string().contains("meshopt"), "{extra:?}");
        assert_eq!(found.buffers.len(), 1, "no buffer that only stands for what was decoded");
        if extra.is_empty() {
            assert_same(&fixture("character_plain.glb"), &output, "compressed");
        }
    }
}

/// Damage in a view that no geometry needs is found before any work is done.
#[test]
fn a_damaged_compressed_animation_is_refused_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut bytes = fs::read(fixture("character_meshopt.glb")).expect("a file");
    let at = bytes.windows(10).position(|w| w == b"QUATERNION").expect("a filter of rotations");
    bytes[at..at + 10].copy_from_slice(b"SOMETHING!");
    let input = folder.path().join("damaged.glb");
    fs::write(&input, bytes).expect("writable");
    let run = run(&input, &folder.path().join("out.glb"), &[]);
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("damaged.glb") && said.contains("bufferViews[") && said.contains("SOMETHING!"), "{said}");
    assert!(!folder.path().join("out.glb").exists());
    annotate(&input, &folder.path().join("out.csv"), &[]);
}

/// What comes by standard input, through gzip or from an allowed folder is carried over all the same.
#[test]
fn a_scene_comes_through_from_every_kind_of_input() {
    use std::io::Write;
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let bytes = fs::read(fixture("character.glb")).expect("a file");
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packed.write_all(&bytes).expect("memory");
    let packed = packed.finish().expect("memory");
    fs::write(path("character.glb.gz"), &packed).expect("writable");
    annotate(&path("character.glb.gz"), &path("packed.glb"), &[]);
    assert_same(&fixture("character.glb"), &path("packed.glb"), "gzip");

    fs::write(path("in"), &packed).expect("writable");
    let status = Command::new(env!("CARGO_BIN_EXE_osculate"))
        .args(["annotate", "-", "-q", "-o"])
        .arg(path("piped.glb"))
        .stdin(fs::File::open(path("in")).expect("a file"))
        .status()
        .expect("the program starts");
    assert!(status.success());
    assert_same(&fixture("character.glb"), &path("piped.glb"), "standard input");

    // Buffer and image in a folder of their own.
    for name in ["model", "data"] {
        fs::create_dir(path(name)).expect("a folder");
    }
    for name in ["scene.bin", "Tiles.png"] {
        fs::copy(fixture(name), path("data").join(name)).expect("a copy");
    }
    let mut document: Value = serde_json::from_slice(&fs::read(fixture("scene.gltf")).expect("a file")).expect("JSON");
    document["buffers"][0]["uri"] = json!("../data/scene.bin");
    document["images"][0]["uri"] = json!("../data/Tiles.png");
    fs::write(path("model").join("scene.gltf"), document.to_string()).expect("writable");
    let refused = run(&path("model").join("scene.gltf"), &path("refused.glb"), &[]);
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--allow-folder"));
    let data = path("data");
    for name in ["allowed.glb", "allowed.gltf"] {
        let leave = ["--allow-folder", data.to_str().expect("a name")];
        annotate(&path("model").join("scene.gltf"), &path(name), &leave);
        assert_same(&fixture("scene.gltf"), &path(name), name);
        assert!(!fs::read_to_string(path(name)).unwrap_or_default().contains("../data"), "nothing leads outside");
    }
}

/// The numbers of a CSV column; an empty field is 0, as in glTF.
fn column(csv: &str, name: &str) -> Vec<f32> {
    let at = csv.lines().next().expect("a header").split(',').position(|n| n == name).expect("the column");
    let fields = csv.lines().skip(1).map(|line| line.split(',').nth(at).expect("a field"));
    fields.map(|field| if field.is_empty() { 0.0 } else { field.parse().expect("a number") }).collect()
}

#[test]
fn every_corner_of_a_face_carries_the_value_of_the_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf", "two_meshes_embedded.gltf"] {
        annotate(&fixture(name), &path("out.glb"), &["--attributes", "all"]);
        annotate(&fixture(name), &path("out.csv"), &["--attributes", "all"]);
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let out = Document::read(&path("out.glb"));
        for (attribute, name) in [
            ("_FACE_ID", "face"),
            ("_CURVATURE_CLASS", "class"),
            ("_CURVATURE_MAX", "k_max"),
            ("_CURVATURE_GAUSS", "gauss"),
            ("_SHAPE_INDEX", "shape_index"),
            ("_DIRECTION_MIN_Y", "dir_min_y"),
            ("_RADIUS", "radius"),
        ] {
            let mut values = Vec::new();
            for mesh in out.json["meshes"].as_array().expect("meshes") {
                for primitive in mesh["primitives"].as_array().expect("primitives") {
                    let stored = out.elements(&primitive["attributes"][attribute]);
                    for corners in out.corners(primitive, stored.len()).chunks_exact(3) {
                        assert!(corners.iter().all(|&c| stored[c] == stored[corners[0]]));
                        values.push(f32::from_le_bytes(stored[corners[0]][..].try_into().expect("4 bytes")));
                    }
                }
            }
            assert_eq!(values, column(&csv, name), "{attribute}");
        }
    }
}

#[test]
fn annotating_twice_equals_annotating_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for name in ["character.glb", "scene.gltf", "two_meshes.glb"] {
        annotate(&fixture(name), &path("once.glb"), &[]);
        annotate(&path("once.glb"), &path("twice.glb"), &[]);
        assert!(fs::read(path("once.glb")).expect("a GLB") == fs::read(path("twice.glb")).expect("a GLB"), "{name}");
        // Other settings in between leave nothing behind.
        annotate(&path("once.glb"), &path("other.glb"), &["--variants", "k_max,class", "--attributes", "all"]);
        annotate(&path("other.glb"), &path("back.glb"), &[]);
        assert!(fs::read(path("once.glb")).expect("a GLB") == fs::read(path("back.glb")).expect("a GLB"), "{name}");
        annotate(&path("other.glb"), &path("bare.glb"), &["--color-by", "none", "--attributes", "none"]);
        assert_same(&fixture(name), &path("bare.glb"), name);
    }
    // What came from STL has no other look behind ours: ours stays the one shown.
    annotate(&fixture("suzanne.stl"), &path("once.glb"), &["--up", "y"]);
    annotate(&path("once.glb"), &path("twice.glb"), &[]);
    let (once, twice) = (Document::read(&path("once.glb")), Document::read(&path("twice.glb")));
    for key in ["accessors", "bufferViews", "materials", "textures", "images", "nodes"] {
        assert_eq!(once.json[key], twice.json[key], "{key}");
    }
    assert_eq!(once.json["meshes"][0]["primitives"], twice.json["meshes"][0]["primitives"]);
    assert!(once.buffers == twice.buffers);
}

/// A scene of everything that exporters seldom write: shared and sparse accessors, interleaved views,
/// narrow attributes, strips, lines over the same vertices, unknown extensions with data, foreign
/// variants, extras that are no objects.
fn odd_scene() -> (Value, Vec<u8>) {
    let mut bin: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let mut view = |bytes: &[u8], stride: Option<usize>| {
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut view = json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() });
        if let Some(stride) = stride {
            view["byteStride"] = stride.into();
        }
        views.push(view);
        bin.extend_from_slice(bytes);
        views.len() - 1
    };
    let grid = 4;
    // Position and texture coordinate side by side.
    let mut both = Vec::new();
    for i in 0..grid {
        for j in 0..grid {
            let (x, y) = (i as f32, j as f32);
            for c in [x, y, 0.3 * x * x - 0.2 * y * y, x / 3.0, y / 3.0] {
                both.extend(c.to_le_bytes());
            }
        }
    }
    let both = view(&both, Some(20));
    let colors: Vec<u8> = (0..4 * grid * grid).map(|i| (i * 13 % 256) as u8).collect();
    let colors = view(&colors, Some(4));
    let mut triangles: Vec<u16> = Vec::new();
    for i in 0..grid - 1 {
        for j in 0..grid - 1 {
            let a = i * grid + j;
            triangles.extend([a, a + grid, a + grid + 1, a, a + grid + 1, a + 1].map(|v| v as u16));
        }
    }
    let half = triangles.len() / 2;
    let bytes = |list: &[u16]| list.iter().flat_map(|i| i.to_le_bytes()).collect::<Vec<u8>>();
    let first = view(&bytes(&triangles[..half]), None);
    let second = view(&bytes(&triangles[half..]), None);
    let strip = view(&[0, 4, 1, 5, 2, 6, 3, 7], None);
    let places = view(&bytes(&[2, 9]), None);
    let deltas: Vec<u8> = [0.5f32, 0.0, 0.25, 0.0, -0.5, 0.125].iter().flat_map(|c| c.to_le_bytes()).collect();
    let deltas = view(&deltas, None);
    let secret = view(b"the data of an extension nobody knows", None);
    let joined = bin.len();
    let points = grid * grid;
    let accessor = |view: usize, offset: usize, component: u32, count: usize, shape: &str| json!({ "bufferView": view, "byteOffset": offset, "componentType": component, "count": count, "type": shape });
    let mut position = accessor(both, 0, 5126, points, "VEC3");
    position["min"] = json!([0.0, 0.0, -1.8]);
    position["max"] = json!([3.0, 3.0, 2.7]);
    position["extras"] = json!("kept");
    let mut color = accessor(colors, 0, 5121, points, "VEC3");
    color["normalized"] = true.into();
    let morph = json!({ "componentType": 5126, "count": points, "type": "VEC3", "min": [0.0, -0.5, 0.0], "max": [0.5, 0.0, 0.25],
        "sparse": { "count": 2, "indices": { "bufferView": places, "componentType": 5123 }, "values": { "bufferView": deltas } } });
    let attributes = json!({ "POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2 });
    let variant = json!({ "KHR_materials_variants": { "mappings": [{ "material": 1, "variants": [0, 1] }] }, "ACME_more": { "x": [1, 2] } });
    let document = json!({
        "asset": { "version": "2.0", "copyright": "someone", "generator": "something", "extras": [1] },
        "extensionsUsed": ["KHR_materials_variants", "ACME_data", "ACME_more"],
        "extensions": {
            "KHR_materials_variants": { "variants": [{ "name": "mean" }, { "name": "dusk" }] },
            "ACME_data": { "bufferView": secret, "n": 7 }
        },
        "buffers": [{ "byteLength": joined, "name": "all", "extras": { "a": 1 } }],
        "bufferViews": views,
        "accessors": [
            position, accessor(both, 12, 5126, points, "VEC2"), color, accessor(first, 0, 5123, half, "SCALAR"),
            accessor(second, 0, 5123, half, "SCALAR"), accessor(strip, 0, 5121, 8, "SCALAR"), morph
        ],
        "materials": [{ "name": "a", "extras": { "b": [true] } }, { "alphaMode": "MASK" }],
        "meshes": [
            { "name": "split", "extras": { "theirs": 1 }, "weights": [0.5], "primitives": [
                { "attributes": attributes, "indices": 3, "material": 0, "targets": [{ "POSITION": 6 }], "extensions": variant },
                { "attributes": attributes, "indices": 4, "targets": [{ "POSITION": 6 }] },
                { "attributes": { "POSITION": 0 }, "mode": 0 }
            ] },
            { "extras": 5, "primitives": [{ "attributes": attributes, "indices": 5, "mode": 5 }] }
        ],
        "nodes": [{ "mesh": 0, "name": "n" }, { "mesh": 1, "scale": [1, 2, 1] }, { "mesh": 0, "translation": [0, 0, 5] }],
        "scenes": [{ "nodes": [0, 1] }, { "name": "second", "nodes": [2] }],
        "scene": 0
    });
    (document, bin)
}

fn write_glb(path: &Path, json: &Value, bin: &[u8]) {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bin = bin.to_vec();
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    for word in [2, 28 + json.len() + bin.len(), json.len(), 0x4e4f_534a] {
        file.extend((word as u32).to_le_bytes());
    }
    file.extend(&json);
    file.extend((bin.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(&bin);
    fs::write(path, file).expect("writable");
}

#[test]
fn odd_scenes_come_out_as_they_went_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    for (output, extra) in [("out.glb", &[][..]), ("out.gltf", &["--variants", "k_max,class", "--attributes", "all"])] {
        annotate(&path("odd.glb"), &path(output), extra);
        assert_same(&path("odd.glb"), &path(output), output);
        annotate(&path(output), &path("bare.glb"), &["--color-by", "none", "--attributes", "none"]);
        assert_same(&path("odd.glb"), &path("bare.glb"), output);
    }
    let out = Document::read(&path("out.gltf"));
    assert_eq!(out.json["buffers"][0]["name"], "all");
    let names: Vec<&Value> = out.json["extensions"]["KHR_materials_variants"]["variants"]
        .as_array()
        .expect("some")
        .iter()
        .map(|v| &v["name"])
        .collect();
    assert_eq!(names, ["mean", "dusk", "k_max", "class"]);
    // Points over the same vertices see as many of them as before.
    let points = &out.json["meshes"][0]["primitives"][2]["attributes"]["POSITION"];
    assert_eq!(out.elements(points).len(), 16);
    // Every face carries its own number in all of its corners.
    let mut face = 0;
    for (mesh, primitive) in [(0, 0), (0, 1), (1, 0)] {
        let primitive = &out.json["meshes"][mesh]["primitives"][primitive];
        let numbers = out.elements(&primitive["attributes"]["_FACE_ID"]);
        for corners in out.corners(primitive, numbers.len()).chunks_exact(3) {
            assert!(corners.iter().all(|&c| numbers[c] == (face as f32).to_le_bytes()), "face {face}");
            face += 1;
        }
    }
    assert_eq!(face, 9 + 9 + 6);
}

#[test]
fn vertices_are_split_only_where_values_differ() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    let vertices = |extra: &[&str]| {
        annotate(&path("odd.glb"), &path("out.glb"), extra);
        let out = Document::read(&path("out.glb"));
        out.elements(&out.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"]).len()
    };
    assert_eq!(vertices(&[]), 3 * 18, "every face has a number of its own");
    assert_eq!(vertices(&["--attributes", "none", "--color-by", "none"]), 16);
    let by_class = vertices(&["--attributes", "class", "--color-by", "class"]);
    assert!((16..40).contains(&by_class), "{by_class}");
}

#[test]
fn a_foreign_attribute_stays_unless_it_is_to_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (mut json, bin) = odd_scene();
    // One of another origin with the very name of ours: here the first coordinates.
    json["accessors"]
        .as_array_mut()
        .expect("a list")
        .push(json!({ "bufferView": 0, "componentType": 5126, "count": 16, "type": "SCALAR" }));
    json["meshes"][1]["primitives"][0]["attributes"]["_COVERAGE"] = 7.into();
    write_glb(&path("odd.glb"), &json, &bin);
    let said = annotate(&path("odd.glb"), &path("out.glb"), &[]);
    assert!(said.contains("meshes[1].primitives[0] has an attribute _COVERAGE of its own"), "{said}");
    let values = |name: &str| {
        let out = Document::read(&path(name));
        let of = &out.json["meshes"][1]["primitives"][0]["attributes"]["_COVERAGE"];
        out.elements(of).into_iter().take(16).flatten().collect::<Vec<u8>>()
    };
    assert_eq!(values("out.glb"), values("odd.glb"));
    assert!(!annotate(&path("odd.glb"), &path("forced.glb"), &["--force"]).contains("of its own"));
    assert_ne!(values("forced.glb"), values("odd.glb"));
    // Attributes that do not fit their mesh are left out, and that is said.
    json["accessors"][7]["count"] = 15.into();
    write_glb(&path("odd.glb"), &json, &bin);
    let run = run(&path("odd.glb"), &path("out.glb"), &[]);
    assert_eq!(run.status.code(), Some(3));
    assert!(String::from_utf8_lossy(&run.stderr).contains("_COVERAGE has 15 elements for 16 vertices"));
}

/// The extension's values of a column, primitive after primitive.
fn face_values(out: &Document, column: &str) -> Vec<f32> {
    let primitives = out.json["meshes"].as_array().expect("meshes").iter().flat_map(|m| m["primitives"].as_array());
    let values = primitives.flatten().map(|p| &p["extensions"]["OSCULATE_face_values"]["values"][column]["accessor"]);
    let bytes = values.filter(|accessor| accessor.is_u64()).flat_map(|accessor| out.elements(accessor));
    bytes.map(|b| f32::from_le_bytes(b[..].try_into().expect("4 bytes"))).collect()
}

#[test]
fn layout_indexed_leaves_vertices_alone_and_has_a_value_for_every_triangle() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (json, bin) = odd_scene();
    write_glb(&path("odd.glb"), &json, &bin);
    for input in [fixture("character.glb"), fixture("scene.gltf"), fixture("suzanne.stl"), path("odd.glb")] {
        annotate(&input, &path("out.glb"), &["--layout", "indexed", "--up", "y"]);
        annotate(&input, &path("out.csv"), &["--up", "y"]);
        let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
        let out = Document::read(&path("out.glb"));
        for name in ["face", "class", "k_max", "k_min", "mean", "gauss", "dir_max_y", "coverage"] {
            assert_eq!(face_values(&out, name), column(&csv, name), "{name}");
        }
        let required = out.json.get("extensionsRequired");
        assert!(required.is_none_or(|list| !list.to_string().contains("OSCULATE")));
        assert!(out.json["extensionsUsed"].to_string().contains("OSCULATE_face_values"));
        if input.extension().is_some_and(|e| e == "stl") {
            let primitive = &out.json["meshes"][0]["primitives"][0];
            assert_eq!(out.elements(&primitive["attributes"]["POSITION"]).len(), 505);
            let boundary = &primitive["extensions"]["OSCULATE_face_values"]["edges"]["boundary"]["accessor"];
            assert_eq!(out.elements(boundary).len(), 2 * 42, "fixtures/README.md counts 42 boundary edges");
            continue;
        }
        let given = Document::read(&input);
        for (mesh, old) in
            out.json["meshes"].as_array().expect("some").iter().zip(given.json["meshes"].as_array().expect("some"))
        {
            for (new, old) in
                mesh["primitives"].as_array().expect("some").iter().zip(old["primitives"].as_array().expect("some"))
            {
                for (name, index) in old["attributes"].as_object().expect("attributes") {
                    assert_eq!(out.elements(&new["attributes"][name]), given.elements(index), "{name}");
                }
            }
        }
        // Annotating in the other layout finds nothing of this one left.
        annotate(&path("out.glb"), &path("faces.glb"), &[]);
        assert!(!fs::read_to_string(path("faces.glb")).is_ok_and(|text| text.contains("OSCULATE_face_values")));
        annotate(&path("out.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
        assert_same(&input, &path("bare.glb"), "bare");
    }
}

/// A CSV without the column `method`, which glTF does not hold.
fn without_method(csv: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(csv).expect("a CSV");
    let column = text.lines().next().and_then(|head| head.split(',').position(|name| name == "method"));
    let fields =
        |line: &str| line.split(',').enumerate().filter(|(i, _)| Some(*i) != column).map(|f| f.1.into()).collect();
    text.lines().map(fields).collect()
}

#[test]
fn values_in_a_file_are_used_again_bit_by_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("scene.glb"), &path("once.csv"), &[]);
    for layout in ["faces", "indexed"] {
        let extra = ["--layout", layout, "--attributes", "default,radius,dir_min", "--radius-factor", "3"];
        annotate(&fixture("scene.glb"), &path("out.glb"), &extra);
        annotate(&fixture("scene.glb"), &path("once.csv"), &extra[4..]);
        let said = annotate(&path("out.glb"), &path("again.csv"), &[]);
        assert!(said.contains("--reuse"), "offered: {said}");
        let stats = path("stats.json");
        annotate(&path("out.glb"), &path("again.csv"), &["--reuse", "--stats", stats.to_str().expect("text")]);
        assert_eq!(without_method(&path("once.csv")), without_method(&path("again.csv")));
        let stats: Value = serde_json::from_slice(&fs::read(stats).expect("statistics")).expect("JSON");
        assert_eq!(
            (&stats["settings"]["radius_factor"], &stats["settings"]["reused"]),
            (&"3:face".into(), &true.into())
        );
    }
    let refused = run(&fixture("scene.glb"), &path("none.csv"), &["--reuse"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("no values of Osculate's"));
    assert!(!path("none.csv").exists());
}

/// The colour that a material shows at a texture coordinate, from the bytes of its palette.
fn shown(out: &Document, material: &Value, primitive: &Value, vertex: usize) -> [u8; 3] {
    let info = &out.json["materials"][material.as_u64().expect("a number") as usize]["pbrMetallicRoughness"]["baseColorTexture"];
    let texture = &out.json["textures"][info["index"].as_u64().expect("a number") as usize];
    let image = &out.json["images"][texture["source"].as_u64().expect("a number") as usize];
    let mut reader = png::Decoder::new(std::io::Cursor::new(out.image(image))).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let frame = reader.next_frame(&mut pixels).expect("pixels");
    let set = info["texCoord"].as_u64().unwrap_or(0);
    let uv = &out.elements(&primitive["attributes"][format!("TEXCOORD_{set}")])[vertex];
    let [u, v] = [0, 4].map(|at| f32::from_le_bytes(uv[at..at + 4].try_into().expect("4 bytes")));
    let (x, y) = ((u * frame.width as f32) as usize, (v * frame.height as f32) as usize);
    let at = 3 * (y * frame.width as usize + x);
    [pixels[at], pixels[at + 1], pixels[at + 2]]
}

#[test]
fn every_variant_shows_its_own_colours() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let quantities = ["mean", "gauss", "k_max", "shape_index", "class"];
    annotate(&fixture("scene.glb"), &path("all.glb"), &["--variants", &quantities.join(",")]);
    let all = Document::read(&path("all.glb"));
    let names: Vec<&str> = all.json["extensions"]["KHR_materials_variants"]["variants"]
        .as_array()
        .expect("variants")
        .iter()
        .map(|v| v["name"].as_str().expect("a name"))
        .collect();
    assert_eq!(names, quantities);
    assert_eq!(all.json["meshes"][0]["extras"]["osculate"]["legends"].as_array().map(Vec::len), Some(5));
    for (v, quantity) in quantities.iter().enumerate() {
        annotate(&fixture("scene.glb"), &path("one.glb"), &["--color-by", quantity]);
        let one = Document::read(&path("one.glb"));
        for (m, mesh) in one.json["meshes"].as_array().expect("meshes").iter().enumerate() {
            for (p, single) in mesh["primitives"].as_array().expect("primitives").iter().enumerate() {
                let mapping = |primitive: &Value, v: usize| {
                    let list = primitive["extensions"]["KHR_materials_variants"]["mappings"]
                        .as_array()
                        .expect("mappings")
                        .clone();
                    list.into_iter().find(|mapping| mapping["variants"] == json!([v])).expect("a mapping")["material"]
                        .clone()
                };
                let several = &all.json["meshes"][m]["primitives"][p];
                assert_eq!(several["material"], single["material"], "the original look stays first");
                for vertex in
                    [0, 7, 20].into_iter().filter(|v| *v < all.elements(&several["attributes"]["POSITION"]).len())
                {
                    let a = shown(&all, &mapping(several, v), several, vertex);
                    let b = shown(&one, &mapping(single, 0), single, vertex);
                    assert_eq!(a, b, "{quantity} in mesh {m}");
                }
            }
        }
    }
    // Three sets for five quantities: some viewers know only four.
    let sets = all.json["meshes"][0]["primitives"][0]["attributes"]
        .as_object()
        .expect("some")
        .keys()
        .filter(|k| k.starts_with("TEXCOORD"))
        .count();
    assert_eq!(sets, 1 + 3);
}

#[test]
fn legends_are_pictures_of_the_scale() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (png, svg) = (path("legend.png"), path("legend.svg"));
    let text = |path: &Path| path.to_str().expect("text").to_owned();
    annotate(
        &fixture("suzanne.stl"),
        &path("out.glb"),
        &["--variants", "k_max,class", "--range", "-2:2", "--legend", &text(&png)],
    );
    annotate(&fixture("suzanne.stl"), &path("out.ply"), &["--color-by", "gauss", "--legend", &text(&svg)]);
    assert!(fs::read(&png).expect("a PNG").starts_with(b"\x89PNG"));
    let svg = fs::read_to_string(&svg).expect("an SVG");
    assert!(svg.contains("gauss [1/unit^2]") && svg.ends_with("</svg>\n"));
    for (extra, why) in
        [(["--legend", "x.bmp"], ".svg or .png"), (["--legend", "/no/such/folder/x.png"], "/no/such/folder")]
    {
        let refused = run(&fixture("suzanne.stl"), &path("not.glb"), &extra);
        assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains(why));
        assert!(!path("not.glb").exists());
    }
}

#[test]
fn what_cannot_be_done_is_said_before_any_work() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for (input, extra, code, why) in [
        ("scene.glb", &["--color", "vertex"][..], 2, "vertex colours"),
        ("scene.glb", &["--unit", "mm"], 2, "--unit does not apply to glTF"),
        ("suzanne.stl", &["--variants", "mean,sharpness"], 2, "sharpness"),
        ("suzanne.stl", &["--variants", "mean,k_max", "--color", "vertex"], 2, "--color texture"),
        ("suzanne.stl", &["--variants", "mean", "--layout", "indexed"], 2, "no colours"),
        ("suzanne.stl", &["--range", "2:1"], 2, "empty or reversed"),
        ("suzanne.stl", &["--range", "1:1"], 2, "empty or reversed"),
        ("suzanne.stl", &["--attributes", "k_mux"], 2, "k_mux"),
        ("suzanne.stl", &["--colormap", "rainbow"], 2, "rainbow"),
    ] {
        let refused = run(&fixture(input), &path("out.glb"), extra);
        let said = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(code), "{extra:?}: {said}");
        assert!(said.contains(why), "{said}");
        assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0, "{extra:?}");
    }
    let refused = run(&fixture("scene.glb"), &path("no/out.glb"), &[]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("the folder does not exist"));
}

/// A NumPy array of an archive: kind, shape as it is written, bytes.
fn array(npz: &[u8], name: &str) -> (String, String, Vec<u8>) {
    use std::io::Read;
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(npz)).expect("an archive");
    let mut bytes = Vec::new();
    archive.by_name(&format!("{name}.npy")).expect("an array").read_to_end(&mut bytes).expect("readable");
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00"));
    let start = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    let header = String::from_utf8(bytes[10..start].to_vec()).expect("text");
    let part = |from: &str, to: &str| {
        header.split(from).nth(1).and_then(|rest| rest.split(to).next()).expect("a part").to_owned()
    };
    (part("'descr': '", "'"), part("'shape': (", ")"), bytes[start..].to_vec())
}

fn f32s(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().expect("4 bytes"))).collect()
}

#[test]
fn npz_holds_what_the_csv_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    annotate(&fixture("suzanne.stl"), &path("out.npz"), &["--attributes", "all", "--vertex-values"]);
    annotate(&fixture("suzanne.stl"), &path("out.csv"), &["--attributes", "all"]);
    let npz = fs::read(path("out.npz")).expect("an archive");
    let csv = fs::read_to_string(path("out.csv")).expect("a CSV");
    for name in ["k_max", "gauss", "shape_index", "coverage"] {
        let (kind, shape, bytes) = array(&npz, name);
        assert_eq!((kind.as_str(), shape.as_str()), ("<f4", "968,"));
        let values: Vec<f32> = f32s(&bytes).into_iter().map(|v| if v.is_nan() { 0.0 } else { v }).collect();
        assert_eq!(values, column(&csv, name), "{name}");
    }
    let (kind, shape, bytes) = array(&npz, "dir_max");
    assert_eq!((kind.as_str(), shape.as_str()), ("<f4", "968, 3,"));
    assert_eq!(f32s(&bytes).into_iter().skip(1).step_by(3).collect::<Vec<_>>(), column(&csv, "dir_max_y"));
    let (kind, _, bytes) = array(&npz, "class");
    assert_eq!(kind, "|i1");
    assert_eq!(bytes.iter().map(|&b| f32::from(b as i8)).collect::<Vec<_>>(), column(&csv, "class"));
    assert_eq!(array(&npz, "positions").1, "505, 3,");
    let (kind, shape, faces) = array(&npz, "faces");
    assert_eq!((kind.as_str(), shape.as_str(), faces.len()), ("<u4", "968, 3,", 12 * 968));
    assert_eq!(array(&npz, "vertex_mean").1, "505,");
    let (kind, _, settings) = array(&npz, "settings");
    let text: String = settings.chunks_exact(4).map(|b| char::from(b[0])).collect();
    assert!(kind.starts_with("<U") && serde_json::from_str::<Value>(&text).is_ok_and(|s| s["diameters"].is_u64()));
}

/// The mean of the faces around a vertex is the same in every file, and in every copy of the vertex.
#[test]
fn vertices_have_the_mean_of_the_faces_around() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let vertex_values = |input: &Path, extra: &[&str]| {
        annotate(input, &path("out.glb"), &[&["--vertex-values", "--up", "y"], extra].concat());
        let out = Document::read(&path("out.glb"));
        let primitive = out.json["meshes"][0]["primitives"][0].clone();
        let at: Vec<Vec<u8>> = out.elements(&primitive["attributes"]["POSITION"]);
        let values = f32s(&out.elements(&primitive["attributes"]["_CURVATURE_MEAN_VERTEX"]).concat());
        at.into_iter().zip(values).collect::<std::collections::BTreeMap<_, _>>()
    };
    annotate(&fixture("suzanne.stl"), &path("out.npz"), &["--vertex-values", "--up", "y"]);
    let npz = fs::read(path("out.npz")).expect("an archive");
    let means = f32s(&array(&npz, "vertex_mean").2);
    let positions = array(&npz, "positions").2;
    let positions = positions.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().expect("8 bytes")) as f32);
    let positions: Vec<Vec<u8>> = positions
        .collect::<Vec<_>>()
        .chunks_exact(3)
        .map(|p| p.iter().flat_map(|c| c.to_le_bytes()).collect())
        .collect();
    let npz: std::collections::BTreeMap<_, _> = positions.into_iter().zip(means).collect();
    for extra in [&[][..], &["--layout", "indexed"]] {
        assert_eq!(vertex_values(&fixture("suzanne.stl"), extra), npz, "{extra:?}");
    }
    let faces = vertex_values(&fixture("character.glb"), &[]);
    assert_eq!(faces, vertex_values(&fixture("character.glb"), &["--layout", "indexed"]));
    annotate(&path("out.glb"), &path("bare.glb"), &["--attributes", "none", "--color-by", "none"]);
    assert_same(&fixture("character.glb"), &path("bare.glb"), "character");
    annotate(&fixture("suzanne.stl"), &path("out.ply"), &["--vertex-values"]);
    let ply = fs::read(path("out.ply")).expect("a PLY");
    let header = String::from_utf8_lossy(&ply[..1500]).into_owned();
    assert!(header.contains("property float z\nproperty float quality\nproperty float k_max\n"), "{header}");
    // And it can be read again.
    annotate(&path("out.ply"), &path("again.csv"), &[]);
}
