//! Colours, variants and legends.

use crate::document::Document;
use crate::{annotate, fixture, run};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

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
