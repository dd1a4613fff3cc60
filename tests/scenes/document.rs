//! A document and its bytes, read without this crate's own reader; and what it means.

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};

/// A document and the bytes of its buffers.
pub(crate) struct Document {
    pub(crate) json: Value,
    pub(crate) buffers: Vec<Vec<u8>>,
    folder: PathBuf,
}

impl Document {
    pub(crate) fn read(path: &Path) -> Self {
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

    pub(crate) fn view(&self, index: &Value) -> (&[u8], Option<usize>) {
        let view = &self.json["bufferViews"][index.as_u64().expect("a view") as usize];
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        let length = view["byteLength"].as_u64().expect("a length") as usize;
        let buffer = &self.buffers[view["buffer"].as_u64().expect("a buffer") as usize];
        (&buffer[start..start + length], view["byteStride"].as_u64().map(|s| s as usize))
    }

    /// The elements of an accessor as bytes, sparse ones replaced.
    pub(crate) fn elements(&self, index: &Value) -> Vec<Vec<u8>> {
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

    pub(crate) fn image(&self, image: &Value) -> Vec<u8> {
        match image["uri"].as_str() {
            Some(uri) => fs::read(self.folder.join(uri)).expect("an image"),
            None => self.view(&image["bufferView"]).0.to_vec(),
        }
    }

    /// The vertex numbers of the corners of all triangles of a primitive.
    pub(crate) fn corners(&self, primitive: &Value, count: usize) -> Vec<usize> {
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
    pub(crate) fn meaning(&self) -> Value {
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
pub(crate) fn difference(path: &str, a: &Value, b: &Value) -> Option<String> {
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

pub(crate) fn assert_same(input: &Path, output: &Path, what: &str) {
    let (a, b) = (Document::read(input).meaning(), Document::read(output).meaning());
    assert_eq!(difference("", &a, &b), None, "{what}");
}
