//! The table of hostile files: whole files cut at every kind of boundary, and files whose numbers,
//! references or nesting cannot be.

use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::io::{Cursor, Write};
use std::path::Path;

pub(super) type Files = Vec<(String, Vec<u8>)>;

/// All files, with names that tell what is wrong with them.
pub(crate) fn files() -> Files {
    let mut files = Vec::new();
    truncated(&mut files);
    stl(&mut files);
    obj(&mut files);
    ply(&mut files);
    off(&mut files);
    gltf(&mut files);
    meshopt(&mut files);
    threemf(&mut files);
    packed(&mut files);
    files
}

fn seed(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds").join(name);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Each kind of file cut where one of its parts ends: lines, headers, chunks, records.
fn truncated(files: &mut Files) {
    let binary_ends = |bytes: &[u8]| vec![1, 4, 12, 20, 79, 80, 83, 84, 85, 134, bytes.len() / 2, bytes.len() - 1];
    let line_ends = |bytes: &[u8]| -> Vec<usize> {
        let ends: Vec<usize> = (1..bytes.len()).filter(|&i| bytes[i - 1] == b'\n').collect();
        let step = ends.len().div_ceil(8).max(1);
        ends.iter().copied().step_by(step).chain([1, bytes.len() / 2, bytes.len() - 2]).collect()
    };
    for name in ["stl/binary.stl", "gltf/u16.glb", "3mf/plain.3mf", "gz/wave.obj.gz"] {
        let bytes = seed(name);
        for end in binary_ends(&bytes).into_iter().filter(|&end| end < bytes.len()) {
            files.push((format!("cut-{end}-{}", name.replace('/', "-")), bytes[..end].to_vec()));
        }
    }
    for name in
        ["stl/ascii.stl", "obj/all.obj", "ply/ascii.ply", "ply/little.ply", "off/plain.off", "gltf/embedded.gltf"]
    {
        let bytes = seed(name);
        for end in line_ends(&bytes) {
            files.push((format!("cut-{end}-{}", name.replace('/', "-")), bytes[..end].to_vec()));
        }
    }
}

fn stl(files: &mut Files) {
    let whole = seed("stl/binary.stl");
    for count in [0, 1, 7, 9, 1 << 20, u32::MAX / 2, u32::MAX] {
        let mut bytes = whole.clone();
        bytes[80..84].copy_from_slice(&u32::to_le_bytes(count));
        files.push((format!("count-{count}.stl"), bytes));
    }
    for (name, value) in
        [("nan", f32::NAN), ("inf", f32::INFINITY), ("huge", f32::MAX), ("denormal", 1e-44), ("zero", 0.0)]
    {
        let mut all = whole.clone();
        let mut one = whole.clone();
        for record in all[84..].chunks_exact_mut(50) {
            record[12..48].as_chunks_mut::<4>().0.fill(value.to_le_bytes());
        }
        one[96..100].copy_from_slice(&value.to_le_bytes());
        files.push((format!("all-{name}.stl"), all));
        files.push((format!("one-{name}.stl"), one));
    }
    // Sizes from the largest to the least that there is, in one file.
    let mut spread = whole;
    for (i, record) in spread[84..].chunks_exact_mut(50).enumerate() {
        for bytes in record[12..48].as_chunks_mut::<4>().0 {
            *bytes = (f32::from_le_bytes(*bytes) * 10_f32.powi(9 * i as i32 - 36)).to_le_bytes();
        }
    }
    files.push(("spread.stl".into(), spread));
    let ascii = String::from_utf8(seed("stl/ascii.stl")).expect("text");
    files.push((
        "no-vertices.stl".into(),
        b"solid\nfacet normal 0 0 1\nouter loop\nendloop\nendfacet\nendsolid\n".to_vec(),
    ));
    files.push(("four-vertices.stl".into(), ascii.replacen("endloop", "vertex 0 0 0\nendloop", 1).into_bytes()));
    files.push(("long-name.stl".into(), ascii.replacen("part", &"x".repeat(1 << 20), 1).into_bytes()));
    files.push(("numbers.stl".into(), ascii.replace("vertex 0", "vertex 1e400").into_bytes()));
    files.push(("solids.stl".into(), "solid a facet normal ".repeat(50_000).into_bytes()));
}

fn obj(files: &mut Files) {
    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let mut add = |name: &str, text: String| files.push((format!("{name}.obj"), text.into_bytes()));
    for index in [
        "0",
        "5",
        "-5",
        "4294967295",
        "4294967297",
        "9223372036854775807",
        "-9223372036854775808",
        "99999999999999999999",
    ] {
        add(&format!("index{index}"), format!("{SQUARE}f 1 2 {index}\n"));
    }
    for number in ["nan", "inf", "1e999", "-1e999", "1e-999", "5e-324", "0x10", "1,5", "--1", "1e", "."] {
        add(&format!("number-{number}"), format!("{SQUARE}v 0 0 {number}\nf 1 2 3\nf 3 4 5\n"));
    }
    add("continued", format!("{SQUARE}f 1 2 3 \\\n{}", "\\\n".repeat(200_000)));
    add("one-line", "v ".repeat(1 << 20));
    add("slashes", format!("{SQUARE}f 1{0} 2{0} 3{0}\n", "/".repeat(1 << 18)));
    // A concave outline of many corners: cubic time for whoever clips ears without a limit.
    let mut comb = String::new();
    for i in 0..20_000 {
        let _ = writeln!(comb, "v {i} {} 0", i % 2 * 10);
    }
    let corners: String = (1..=20_000).fold(String::new(), |all, i| all + " " + &i.to_string());
    add("comb", format!("{comb}f{corners}\n"));
    add("spiral", {
        let mut text = String::new();
        for i in 0..900 {
            let angle = f64::from(i) * 0.7;
            let _ = writeln!(text, "v {} {} 0", f64::from(i) * angle.cos(), f64::from(i) * angle.sin());
        }
        let corners: String = (1..=900).fold(String::new(), |all, i| all + " " + &i.to_string());
        format!("{text}f{corners}\n")
    });
    add("one-vertex", format!("{SQUARE}f{}\n", " 1".repeat(50_000)));
    add("same-face", format!("{SQUARE}{}", "f 1 2 3\n".repeat(50_000)));
    add("one-edge", {
        let apexes: String = (0..5000).fold(String::new(), |all, i| all + &format!("v {i} 7 {}\n", i % 70));
        let faces: String = (5..5005).fold(String::new(), |all, i| all + &format!("f 1 2 {i}\n"));
        format!("{SQUARE}{apexes}{faces}")
    });
    add("groups", format!("{SQUARE}{}", "g a\nf 1 2 3\ng b\nf 1 3 4\n".repeat(10_000)));
    add("empty-groups", format!("{SQUARE}{}f 1 2 3\n", "usemtl a\ng b\n".repeat(100_000)));
    add("libraries", format!("{}{SQUARE}f 1 2 3\n", "mtllib ../../etc/passwd /dev/zero gone.mtl\n".repeat(20_000)));
    add("needle", "v 0 0 0\nv 1e9 0 0\nv 0 1e-9 0\nv 1e9 1e-9 1\nf 1 2 3\nf 2 4 3\n".into());
}

fn ply(files: &mut Files) {
    let header = |vertices: &str, vertex: &str, faces: &str, list: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{vertex}element face {faces}\nproperty list {list} vertex_indices\nend_header\n"
        )
    };
    const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";
    let mut add = |name: &str, head: String, body: Vec<u8>| {
        files.push((format!("{name}.ply"), [head.into_bytes(), body].concat()));
    };
    for count in ["0", "4", "1000000", "4294967296", "18446744073709551615", "99999999999999999999", "-1", "3.5", "x"] {
        add(&format!("vertices-{count}"), header(count, XYZ, "1", "uchar int"), vec![0; 60]);
        add(&format!("faces-{count}"), header("3", XYZ, count, "uchar int"), vec![0; 60]);
    }
    for list in ["uchar float", "float int", "double int", "char int", "int double", "uint uint", "uchar uchar"] {
        let body = [vec![0; 36], vec![255; 64]].concat();
        add(&format!("list-{}", list.replace(' ', "-")), header("3", XYZ, "1", list), body);
    }
    add("no-properties", header("1000000000", "", "1", "uchar int"), vec![3; 99]);
    add("empty-lists", header("3", XYZ, "60", "uchar int"), vec![0; 96]);
    add("other", "ply\nformat ascii 1.0\nelement other 4000000000\nend_header\n".into(), Vec::new());
    add(
        "list-of-x",
        header("3", "property list uchar float x\nproperty float y\nproperty float z\n", "1", "uchar int"),
        vec![0; 99],
    );
    add("properties", header("1", &"property double a\n".repeat(50_000), "1", "uchar int"), vec![0; 99]);
    add("elements", format!("ply\nformat ascii 1.0\n{}end_header\n", "element face 0\n".repeat(100_000)), Vec::new());
    add("no-format", "ply\nelement vertex 1\nend_header\n".into(), Vec::new());
    add(
        "two-vertices",
        header("3", XYZ, "1", "uchar int").replace(
            "element face",
            "element vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face",
        ),
        [vec![0; 36], vec![3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]].concat(),
    );
}

fn off(files: &mut Files) {
    let mut add = |name: &str, text: &str| files.push((format!("{name}.off"), text.as_bytes().to_vec()));
    const BODY: &str = "0 0 0\n1 0 0\n0 1 0\n";
    for count in ["0", "4000000000", "99999999999999999999", "-1", "x"] {
        add(&format!("vertices-{count}"), &format!("OFF\n{count} 1 0\n{BODY}3 0 1 2\n"));
        add(&format!("faces-{count}"), &format!("OFF\n3 {count} 0\n{BODY}3 0 1 2\n"));
        add(&format!("corners-{count}"), &format!("OFF\n3 1 0\n{BODY}{count} 0 1 2\n"));
        add(&format!("corner-{count}"), &format!("OFF\n3 1 0\n{BODY}3 0 1 {count}\n"));
    }
    add("dimension", "nOFF\n4000000000\n3 1 0\n");
    add("no-weight", "4OFF\n3 1 0\n0 0 0 0\n1 0 0 0\n0 1 0 0\n3 0 1 2\n");
    for word in [0_u32, 5, 1 << 20, u32::MAX] {
        let bytes = [
            b"STCN4nOFF BINARY\n".to_vec(),
            [[0, 0, 0, 3], word.to_be_bytes()].concat(),
            word.to_be_bytes().repeat(200),
        ]
        .concat();
        files.push((format!("binary-{word}.off"), bytes));
    }
}

/// A GLB with five vertices and the indices 0 to 2, 2, 1, 3 after `change`.
pub(super) fn glb(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let corners: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [2.0, 2.0, 1.0]];
    let mut bin: Vec<u8> = corners.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    bin.extend([0, 1, 2, 2, 1, 3, 0, 0]);
    let mut document = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": 68 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 60 }, { "buffer": 0, "byteOffset": 60, "byteLength": 8 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR" }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "nodes": [{ "mesh": 0 }]
    });
    change(&mut document);
    glb_of(&document.to_string(), &bin)
}

pub(super) fn glb_of(json: &str, bin: &[u8]) -> Vec<u8> {
    let json = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let bin = [bin, &vec![0; bin.len().next_multiple_of(4) - bin.len()]].concat();
    let length = (28 + json.len() + bin.len()) as u32;
    let mut bytes = b"glTF".to_vec();
    for part in [&2_u32.to_le_bytes()[..], &length.to_le_bytes(), &(json.len() as u32).to_le_bytes(), b"JSON"] {
        bytes.extend(part);
    }
    bytes.extend(json.as_bytes());
    bytes.extend((bin.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(bin);
    bytes
}

fn gltf(files: &mut Files) {
    let mut set = |name: &str, pointer: &str, value: Value| {
        let bytes = glb(|document| {
            let (parent, key) = pointer.rsplit_once('/').expect("a path");
            let parent = document.pointer_mut(parent).expect("there");
            match key.parse::<usize>() {
                Ok(index) => parent[index] = value,
                Err(_) => parent[key] = value,
            }
        });
        files.push((format!("{name}.glb"), bytes));
    };
    for huge in [0, 7, 1 << 16, 1 << 31, u64::from(u32::MAX), 1 << 62, u64::MAX - 3, u64::MAX] {
        for (name, pointer) in [
            ("count", "/accessors/0/count"),
            ("index-count", "/accessors/1/count"),
            ("offset", "/accessors/0/byteOffset"),
            ("view-offset", "/bufferViews/0/byteOffset"),
            ("view-length", "/bufferViews/0/byteLength"),
            ("stride", "/bufferViews/0/byteStride"),
            ("accessor", "/meshes/0/primitives/0/indices"),
            ("child", "/nodes/0/children"),
        ] {
            let value = if name == "child" { json!([huge]) } else { json!(huge) };
            set(&format!("{name}-{huge}"), pointer, value);
        }
    }
    set("self", "/nodes/0/children", json!([0]));
    set("negative", "/accessors/0/count", json!(-1));
    set("fraction", "/accessors/0/count", json!(2.5));
    set("text", "/accessors", json!("none"));
    set("overlap", "/bufferViews/1", json!({ "buffer": 0, "byteOffset": 0, "byteLength": 60 }));
    set("uri-up", "/buffers/0/uri", json!("../../../../../../etc/passwd"));
    set("uri-root", "/buffers/0/uri", json!("/dev/zero"));
    set("uri-file", "/buffers/0/uri", json!("file:///etc/passwd"));
    set("uri-http", "/buffers/0/uri", json!("http://localhost/a.bin"));
    set("uri-folder", "/buffers/0/uri", json!("."));
    set("uri-data", "/buffers/0/uri", json!("data:application/octet-stream;base64,AAAA"));
    set(
        "matrix",
        "/nodes/0/matrix",
        json!([1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38, 1e38]),
    );
    set("rotation", "/nodes/0/rotation", json!([0, 0, 0, 0]));
    // Zeros that take no bytes, shared by many meshes, each placed many times.
    let zeros = glb(|document| {
        document["accessors"][0] = json!({ "componentType": 5126, "count": 65_536, "type": "VEC3" });
        document["meshes"] = json!(vec![json!({ "primitives": [{ "attributes": { "POSITION": 0 } }] }); 500]);
    });
    files.push(("shared-zeros.glb".into(), zeros));
    let primitives = glb(|document| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1 });
        document["meshes"] = json!([{ "primitives": vec![primitive; 20_000] }]);
    });
    files.push(("primitives.glb".into(), primitives));
    let chain = glb(|document| {
        document["nodes"] = (1..50_000).map(|next| json!({ "children": [next % 49_999] })).collect();
    });
    files.push(("ring.glb".into(), chain));
    let depth = 100_000;
    files.push((
        "deep.gltf".into(),
        format!("{{\"asset\":{{\"version\":\"2.0\",\"extras\":{}{}}}}}", "[".repeat(depth), "]".repeat(depth))
            .into_bytes(),
    ));
    files.push(("deep-unknown.gltf".into(), format!("{{\"x\":{}", "{\"x\":".repeat(depth)).into_bytes()));
    files.push((
        "numbers.gltf".into(),
        format!("{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":{}}}", "9".repeat(1 << 16)).into_bytes(),
    ));
    for (name, at, value) in [
        ("version", 4, u32::MAX),
        ("length", 8, u32::MAX),
        ("json-length", 12, u32::MAX),
        ("json-kind", 16, 7),
        ("json-zero", 12, 0),
    ] {
        let mut bytes = glb(|_| {});
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        files.push((format!("chunk-{name}.glb"), bytes));
    }
    for (name, sparse) in [
        (
            "huge",
            json!({ "count": 1_u64 << 40, "indices": { "bufferView": 1, "componentType": 5121 }, "values": { "bufferView": 0 } }),
        ),
        (
            "wild",
            json!({ "count": 1, "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 } }),
        ),
        (
            "none",
            json!({ "count": 0, "indices": { "bufferView": 9, "componentType": 5121 }, "values": { "bufferView": 9 } }),
        ),
    ] {
        files.push((format!("sparse-{name}.glb"), glb(|document| document["accessors"][0]["sparse"] = sparse)));
    }
}

fn meshopt(files: &mut Files) {
    for (mode, header) in [("ATTRIBUTES", 0xa0_u8), ("ATTRIBUTES", 0xa1), ("TRIANGLES", 0xe1), ("INDICES", 0xd1)] {
        for (count, stride) in
            [(0_u64, 4_u64), (3, 4), (48, 4), (1 << 20, 4), (1 << 40, 256), (u64::MAX, 4), (3, 0), (3, 3)]
        {
            let view = json!({ "buffer": 1, "byteLength": count.saturating_mul(stride), "extensions": { "EXT_meshopt_compression": {
                "buffer": 0, "byteLength": 4096, "byteStride": stride, "count": count, "mode": mode
            } } });
            let accessor = json!({ "bufferView": 0, "componentType": 5126, "count": (count * u64::from(mode == "ATTRIBUTES") / 3).max(1), "type": "VEC3" });
            let document = json!({
                "asset": { "version": "2.0" }, "extensionsRequired": ["EXT_meshopt_compression"],
                "buffers": [{ "byteLength": 4096 }, { "byteLength": 0 }], "bufferViews": [view], "accessors": [accessor],
                "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }]
            });
            let mut bin = vec![0xff; 4096];
            bin[0] = header;
            files
                .push((format!("meshopt-{mode}-{header:x}-{count}-{stride}.glb"), glb_of(&document.to_string(), &bin)));
        }
    }
}

pub(super) fn zip_of(parts: &[(&str, &str)]) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        writer.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a new file");
        writer.write_all(content.as_bytes()).expect("a vector takes all");
    }
    writer.finish().expect("a vector takes all").into_inner()
}

pub(super) fn threemf_of(objects: &str, items: &str) -> Vec<u8> {
    let model = format!("<model><resources>{objects}</resources><build>{items}</build></model>");
    zip_of(&[("3D/3dmodel.model", &model)])
}

fn threemf(files: &mut Files) {
    const MESH: &str = "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";
    let mut add = |name: &str, objects: &str, items: &str| {
        files.push((format!("{name}.3mf"), threemf_of(objects, items)));
    };
    let object = format!("<object id='1'>{MESH}</object>");
    let item = "<item objectid='1'/>";
    for index in ["3", "4294967295", "99999999999", "-1", "", "x"] {
        add(&format!("vertex-{index}"), &object.replace("v3='2'", &format!("v3='{index}'")), item);
    }
    for number in ["nan", "1e999", "", "&#x31;", "5e-324"] {
        let name: String = number.chars().filter(char::is_ascii_alphanumeric).collect();
        add(&format!("coordinate-{name}"), &object.replace("x='1'", &format!("x='{number}'")), item);
    }
    add(
        "circle",
        "<object id='1'><components><component objectid='2'/></components></object><object id='2'><components><component objectid='1'/></components></object>",
        item,
    );
    let mut towers = format!("<object id='0'>{MESH}</object>");
    for id in 1..40 {
        let _ = write!(
            towers,
            "<object id='{id}'><components>{}</components></object>",
            format!("<component objectid='{}'/>", id - 1).repeat(10)
        );
    }
    add("tower", &towers, "<item objectid='39'/>");
    add("items", &object, &item.repeat(100_000));
    add("flat", &object, "<item objectid='1' transform='0 0 0 0 0 0 0 0 0 0 0 0'/>");
    add("far", &object, "<item objectid='1' transform='1e300 0 0 0 1e300 0 0 0 1e300 0 0 0'/>");
    add("deep", &"<object id='1'>".repeat(100_000), item);
    add("attributes", &format!("<object id='1' {}>{MESH}</object>", "a='b' ".repeat(100_000)), item);
    add("path", &object, "<item objectid='1' p:path='../../../etc/passwd'/>");
    add("space", &" ".repeat(60 << 20), "");
    add("larger-space", &" ".repeat(90 << 20), "");
    let laughs = "<!DOCTYPE a [<!ENTITY b \"cccccccccc\"><!ENTITY d \"&b;&b;&b;&b;&b;&b;\">]><model>&d;</model>";
    files.push(("laughs.3mf".into(), zip_of(&[("3D/3dmodel.model", laughs)])));
    files.push(("no-model.3mf".into(), zip_of(&[("readme.txt", "nothing")])));
    files.push(("not-xml.3mf".into(), zip_of(&[("3D/3dmodel.model", "\0\u{1}\u{2}<<<>>>&&&")])));
    let rels = "<Relationships><Relationship Type='x/3dmodel' Target='/_rels/.rels'/></Relationships>";
    files.push(("rels-to-itself.3mf".into(), zip_of(&[("_rels/.rels", rels)])));
    let mut bytes = seed("3mf/plain.3mf");
    let end = bytes.len() - 22;
    bytes[end + 8..end + 20].fill(0xff);
    files.push(("directory.3mf".into(), bytes));
}

pub(super) fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(content).expect("a vector takes all");
    encoder.finish().expect("a vector takes all")
}

fn packed(files: &mut Files) {
    let bomb = gzip(&vec![b' '; 100 << 20]);
    files.push(("bomb.obj.gz".into(), bomb.clone()));
    files.push(("twice.obj.gz".into(), gzip(&gzip(&bomb))));
    files.push(("empty.stl.gz".into(), gzip(b"")));
    files.push(("members.stl.gz".into(), gzip(b"").repeat(50_000)));
    let mut damaged = seed("gz/wave.ply.gz");
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0x55;
    files.push(("damaged.ply.gz".into(), damaged));
    files.push(("utf-16.obj".into(), [vec![0xff, 0xfe], b"v\0 \x001\0".repeat(1 << 17), vec![0xd8]].concat()));
    files.push(("surrogates.obj".into(), [&b"\xff\xfev\0 \x001\0 \0"[..], &[0x00, 0xd8].repeat(1 << 16)].concat()));
    for (name, byte) in [("zeros", 0_u8), ("ones", 255), ("spaces", b' '), ("braces", b'{'), ("lines", b'\n')] {
        files.push((format!("{name}.bin"), vec![byte; 1 << 20]));
    }
}
