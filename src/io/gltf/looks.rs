//! Curvature looks: palette images, materials and the variants between which a viewer chooses.

use super::draft::{Draft, Piece};
use super::references::Kind;
use super::strip::{MARK, VARIANTS};
use crate::annotation::{Annotation, ColorCarrier};
use crate::color::{Colormap, PALETTE};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Rows of the palette image: clients that are off by a row still hit the right colour.
const PALETTE_ROWS: usize = 4;

/// Sets of texture coordinates that three.js knows.
const FEW_SETS: usize = 4;

/// Along which axis of a palette image, and of its texture coordinate, the colours run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Axis {
    U,
    V,
}

/// The texture coordinates of one colour scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Slot {
    /// Which set, from the first that is ours.
    pub(super) set: usize,
    pub(super) axis: Axis,
}

/// Where each of so many scales has its coordinates, behind `taken` sets of others: a set for each, or
/// two in a set where there would be more sets than some viewers know.
pub(super) fn slots(scales: usize, taken: usize) -> Vec<Slot> {
    let share = scales > 1 && taken + scales > FEW_SETS;
    (0..scales)
        .map(|i| match share {
            false => Slot { set: i, axis: Axis::U },
            true => Slot { set: i / 2, axis: if i % 2 == 0 { Axis::U } else { Axis::V } },
        })
        .collect()
}

/// Number of palette images for scales with these maps.
pub(in crate::io) fn palettes(maps: &[Colormap]) -> usize {
    let mut images: Vec<(Colormap, Axis)> = Vec::new();
    for (slot, &map) in slots(maps.len(), 0).iter().zip(maps) {
        if !images.contains(&(map, slot.axis)) {
            images.push((map, slot.axis));
        }
    }
    images.len()
}

/// The looks of one document.
pub(super) struct Looks<'l> {
    annotation: &'l Annotation<'l>,
    /// Palette images in the order in which files name them: map, axis, image.
    images: Vec<(Colormap, Axis, usize)>,
    textures: Vec<usize>,
    materials: BTreeMap<(usize, usize, Axis), usize>,
    variants: Vec<usize>,
    plain: Option<usize>,
}

impl<'l> Looks<'l> {
    pub(super) fn new(annotation: &'l Annotation<'l>) -> Self {
        Looks {
            annotation,
            images: Vec::new(),
            textures: Vec::new(),
            materials: BTreeMap::new(),
            variants: Vec::new(),
            plain: None,
        }
    }

    /// The material without a palette: white, or with vertex colours.
    pub(super) fn plain(&mut self, draft: &mut Draft<'_>) -> usize {
        *self.plain.get_or_insert_with(|| {
            let colors = self.annotation.colors.first().filter(|_| self.annotation.carrier != ColorCarrier::None);
            let name = colors.map_or("surface", |colors| colors.quantity.token());
            let mark = match colors {
                Some(_) => json!({ "attribute": "COLOR_0" }),
                None => json!({}),
            };
            draft.add(Kind::Material, material(name, &mark, None))
        })
    }

    /// The material of a colour scale whose coordinates are in the set of that number.
    pub(super) fn material(&mut self, draft: &mut Draft<'_>, scale: usize, set: usize, axis: Axis) -> usize {
        if let Some(&known) = self.materials.get(&(scale, set, axis)) {
            return known;
        }
        let colors = &self.annotation.colors[scale];
        let texture = self.texture(draft, colors.map, axis);
        let mut info = json!({ "index": texture });
        if set > 0 {
            info["texCoord"] = set.into();
        }
        let token = colors.quantity.token();
        let number = draft.add(Kind::Material, material(token, &json!({ "quantity": token }), Some(info)));
        self.materials.insert((scale, set, axis), number);
        number
    }

    fn texture(&mut self, draft: &mut Draft<'_>, map: Colormap, axis: Axis) -> usize {
        if let Some(known) = self.images.iter().position(|image| (image.0, image.1) == (map, axis)) {
            return self.textures[known];
        }
        let mark = json!({ MARK: { "colormap": map.name() } });
        let image = draft.add(Kind::Image, json!({ "name": format!("palette {}", map.name()), "extras": mark }));
        let (nearest, clamp) = (9728, 33071);
        let sampler =
            json!({ "magFilter": nearest, "minFilter": nearest, "wrapS": clamp, "wrapT": clamp, "extras": mark });
        let known = self.textures.first().and_then(|&t| draft.list("textures")[t].get("sampler").cloned());
        let sampler = known.unwrap_or_else(|| draft.add(Kind::Sampler, sampler).into());
        let texture = draft.add(Kind::Texture, json!({ "sampler": sampler, "source": image, "extras": mark }));
        self.images.push((map, axis, image));
        self.textures.push(texture);
        texture
    }

    /// The variant that shows a colour scale.
    pub(super) fn variant(&mut self, draft: &mut Draft<'_>, scale: usize) -> usize {
        if self.variants.is_empty() {
            draft.use_extension(VARIANTS);
            let extensions = draft.root.entry("extensions").or_insert_with(|| json!({}));
            let list = &mut extensions[VARIANTS]["variants"];
            if !list.is_array() {
                *list = json!([]);
            }
            let list = list.as_array_mut().into_iter().next();
            if let Some(list) = list {
                for colors in &self.annotation.colors {
                    let token = colors.quantity.token();
                    let taken = list.iter().any(|variant| variant.get("name").is_some_and(|name| name == token));
                    let name = if taken { format!("{token} (curvature)") } else { token.to_owned() };
                    self.variants.push(list.len());
                    list.push(json!({ "name": name, "extras": { MARK: { "quantity": token } } }));
                }
            }
        }
        self.variants[scale]
    }

    /// Gives the images their content: in a file that `uri` names, or in a buffer.
    pub(super) fn finish(&self, draft: &mut Draft<'_>, uri: &dyn Fn(usize) -> Option<String>) {
        for (i, (_, _, image)) in self.images.iter().enumerate() {
            match uri(i) {
                Some(uri) => draft.list("images")[*image]["uri"] = uri.into(),
                None => {
                    let view = draft.add_view(Piece::Bytes(self.png(i)), None, None);
                    let image = &mut draft.list("images")[*image];
                    image["bufferView"] = view.into();
                    image["mimeType"] = "image/png".into();
                }
            }
        }
    }

    /// Number of palette images.
    pub(super) fn image_count(&self) -> usize {
        self.images.len()
    }

    /// A palette as an sRGB PNG of several equal rows, or columns.
    pub(super) fn png(&self, image: usize) -> Vec<u8> {
        let (map, axis, _) = self.images[image];
        let row = map.palette();
        let (width, height) = match axis {
            Axis::U => (PALETTE, PALETTE_ROWS),
            Axis::V => (PALETTE_ROWS, PALETTE),
        };
        let pixels: Vec<u8> = (0..width * height)
            .flat_map(|i| match axis {
                Axis::U => row[i % width],
                Axis::V => row[i / width],
            })
            .collect();
        crate::io::png::rgb(width as u32, height as u32, &pixels)
    }
}

/// White where nothing colours it, rough, seen from both sides, since scans are often open.
fn material(name: &str, mark: &Value, texture: Option<Value>) -> Value {
    let mut material = json!({
        "name": name,
        "doubleSided": true,
        "pbrMetallicRoughness": { "baseColorFactor": [1.0, 1.0, 1.0, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8 },
        "extras": { MARK: mark },
    });
    if let Some(texture) = texture {
        material["pbrMetallicRoughness"]["baseColorTexture"] = texture;
    }
    material
}
