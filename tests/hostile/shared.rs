//! Files that say one thing once and use it many times: names, buffers, meshes, parts and
//! statements. Each of them once took gigabytes or minutes.

use super::table::{Files, glb, glb_of, gzip, threemf_of, zip_of};
use serde_json::json;

const LONG: usize = 400_000;
const MANY: usize = 10_000;

pub(super) fn files() -> Files {
    let mut files = names();
    files.extend(look_ups());
    files.extend(copies());
    files
}

/// A long name that thousands of groups share.
fn names() -> Files {
    let name = "x".repeat(LONG);
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let groups = "g a\nf 1 2 3\ng b\nf 1 3 4\n".repeat(MANY);
    let material = glb(|document| {
        let primitive = json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 });
        document["materials"] = json!([{ "name": name }]);
        document["meshes"] = json!([{ "primitives": vec![primitive; MANY] }]);
    });
    let object = format!("<object id='1' name='{name}'>{TRIANGLE}</object>");
    vec![
        ("shared-name.obj".into(), format!("{square}o {name}\n{groups}").into_bytes()),
        ("shared-name.glb".into(), material),
        ("shared-name.3mf".into(), threemf_of(&object, &"<item objectid='1'/>".repeat(MANY))),
    ]
}

const TRIANGLE: &str = "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";

/// What has to be found again and again.
fn look_ups() -> Files {
    // A statement begins within the rest of the line that another began.
    let solids = "solid facet normal 0 0 0 ".repeat(MANY);
    let facet = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet";
    let whole = format!("solid {facet} endsolid ").repeat(MANY);
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let libraries = format!("{square}mtllib {}\nf 1 2 3\n", "libraries-there.obj ".repeat(10 * MANY));
    let statements = format!("{square}{}f 1 2 3\n", "mtllib libraries-there-too.obj\n".repeat(10 * MANY));
    // Every part is named in another spelling than the archive's.
    let part = format!("<model><resources><object id='1'>{TRIANGLE}</object></resources></model>");
    let name = |i: usize| format!("3D/part{i}.model");
    let component = |i: usize| format!("<component objectid='1' p:path='/{}'/>", name(i).to_uppercase());
    let components: String = (0..MANY).map(component).collect();
    let main = format!(
        "<model><resources><object id='1'><components>{components}</components></object></resources><build><item objectid='1'/></build></model>"
    );
    let names: Vec<String> = (0..MANY).map(name).collect();
    let mut parts = vec![("3D/3dmodel.model", main.as_str())];
    parts.extend(names.iter().map(|name| (name.as_str(), part.as_str())));
    vec![
        ("solids-in-a-line.stl".into(), solids.into_bytes()),
        ("whole-solids-in-a-line.stl".into(), whole.into_bytes()),
        ("libraries-there.obj".into(), libraries.into_bytes()),
        ("libraries-there-too.obj".into(), statements.into_bytes()),
        ("spelled-otherwise.3mf".into(), zip_of(&parts)),
    ]
}

/// What is in memory, or looked at, once for each time that it is named.
fn copies() -> Files {
    // The buffers are this file itself.
    let views: Vec<_> = (0..MANY).map(|buffer| json!({ "buffer": buffer, "byteLength": 36 })).collect();
    let accessor = |view| json!({ "bufferView": view, "componentType": 5126, "count": 3, "type": "VEC3" });
    let buffers = json!({
        "asset": { "version": "2.0" },
        "buffers": vec![json!({ "byteLength": 36, "uri": "buffers.gltf" }); MANY],
        "bufferViews": views,
        "accessors": (0..MANY).map(accessor).collect::<Vec<_>>(),
        "meshes": [{ "primitives": (0..MANY).map(|a| json!({ "attributes": { "POSITION": a } })).collect::<Vec<_>>() }]
    });
    let faces = 20_000;
    let corners: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut bin: Vec<u8> = corners.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    bin.extend([0, 1, 2].repeat(faces));
    let instances = json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 3 * faces }
        ],
        "accessors": [accessor(0), { "bufferView": 1, "componentType": 5121, "count": 3 * faces, "type": "SCALAR" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "nodes": vec![json!({ "mesh": 0, "rotation": [0.1, 0.2, 0.3, 0.9] }); 2 * MANY]
    });
    // A face of four bytes, which gzip packs into a two-hundredth.
    let mut same_face = b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 12000000\nproperty list uchar uchar vertex_indices\nend_header\n".to_vec();
    same_face.extend(&bin[..36]);
    same_face.extend(b"\x03\x00\x01\x02".repeat(12_000_000));
    let object = format!(
        "<object id='1'>{}</object>",
        TRIANGLE.replace("</triangles>", &("<triangle v1='0' v2='1' v3='2'/>".repeat(1_500_000) + "</triangles>"))
    );
    vec![
        ("same-face.ply.gz".into(), gzip(&same_face)),
        ("same-face.3mf".into(), threemf_of(&object, "<item objectid='1'/>")),
        ("buffers.gltf".into(), buffers.to_string().into_bytes()),
        ("instances.glb".into(), glb_of(&instances.to_string(), &bin)),
    ]
}
