//! Polylines as glTF: a mesh for each layer, a strip, loop or list of lines for each polyline.
//!
//! Always a file of their own: MeshLab takes lines in a file with triangles for triangles.

use super::layout::{check_glb_length, single};
use super::write::write_chunks;
use crate::color::linear_factor;
use crate::error::Error;
use crate::io::Output;
use crate::lines::{Layer, Polyline};
use crate::space::Space;
use glam::DVec3;
use gltf_json as json;
use json::Index;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::validation::{Checked, USize64};
use serde_json::Value;
use std::collections::BTreeMap;

/// What a line file shows and where.
#[derive(Clone, Debug)]
pub struct LineScene<'s> {
    /// The polylines, relative to `origin`. Layers and lines without a segment are left out.
    pub layers: &'s [Layer],
    /// The point that the polylines are relative to: [`crate::Mesh::origin`].
    pub origin: DVec3,
    /// Axes and units of the file.
    pub space: Space,
    /// For the extras of every mesh.
    pub extras: Value,
}

/// Writes polylines as a binary glTF file.
///
/// # Errors
/// [`Error::Io`]; [`Error::TooLarge`] past 4 GiB.
pub fn write_lines(scene: &LineScene<'_>, out: &mut Output) -> Result<(), Error> {
    let mut file = LineFile::new(scene);
    scene.layers.iter().for_each(|layer| file.add_layer(layer));
    let LineFile { mut root, points: mut bin, values, .. } = file;
    if !bin.is_empty() {
        add_views(&mut root, bin.len() as u64, values.len() as u64);
    }
    bin.extend(values);
    let nodes = (0..root.nodes.len() as u32).map(Index::new).collect();
    root.scene = Some(root.push(json::Scene { extensions: None, extras: None, name: None, nodes }));
    let document = root.to_vec().unwrap_or_default();
    check_glb_length((document.len() + bin.len()) as u64)?;
    write_chunks(document, bin.len() as u64, out, |out| std::io::Write::write_all(out, &bin))
}

/// A file under construction.
struct LineFile {
    space: Space,
    /// Of every node.
    translation: glam::Vec3,
    /// What it leaves over.
    remainder: DVec3,
    extras: json::Extras,
    root: json::Root,
    /// Bytes of the first view.
    points: Vec<u8>,
    /// Bytes of the second view, since elements of a view are of one size: values of lines.
    values: Vec<u8>,
}

impl LineFile {
    fn new(scene: &LineScene<'_>) -> Self {
        let translation = scene.space.point(scene.origin).as_vec3();
        LineFile {
            space: scene.space,
            translation,
            remainder: scene.space.point(scene.origin) - translation.as_dvec3(),
            extras: serde_json::value::to_raw_value(&scene.extras).ok(),
            root: empty_document(),
            points: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Adds a layer as a node with a mesh, where it has a segment.
    fn add_layer(&mut self, layer: &Layer) {
        let strips = strips(&layer.lines);
        if strips.is_empty() {
            return;
        }
        let material = self.root.push(material(layer));
        let is_single = matches!(strips.as_slice(), [(json::mesh::Mode::Lines, _)]);
        let primitive = |(mode, points): (json::mesh::Mode, Vec<DVec3>)| {
            let mut attributes: BTreeMap<_, _> =
                [(Checked::Valid(json::mesh::Semantic::Positions), self.add_points(&points))].into();
            if is_single {
                attributes.extend(self.add_values(layer));
            }
            json::mesh::Primitive {
                attributes,
                extensions: None,
                extras: None,
                indices: None,
                material: Some(material),
                mode: Checked::Valid(mode),
                targets: None,
            }
        };
        let primitives = strips.into_iter().map(primitive).collect();
        let mesh = self.root.push(json::Mesh {
            extensions: None,
            extras: self.extras.clone(),
            name: Some(layer.name.clone()),
            primitives,
            weights: None,
        });
        self.root.push(json::Node {
            mesh: Some(mesh),
            name: Some(layer.name.clone()),
            translation: (self.translation != glam::Vec3::ZERO).then_some(self.translation.to_array()),
            ..Default::default()
        });
    }

    fn add_points(&mut self, points: &[DVec3]) -> Index<json::Accessor> {
        let stored: Vec<[f32; 3]> = points.iter().map(|&p| single(self.space.point(p) + self.remainder)).collect();
        let position = self.root.push(accessor(&stored, self.points.len() as u64));
        self.points.extend(stored.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        position
    }

    /// The values of a layer's segments, one for each of their ends, by name.
    fn add_values(&mut self, layer: &Layer) -> Vec<(Checked<json::mesh::Semantic>, Index<json::Accessor>)> {
        let add = |(name, dimension, values): &(&str, i32, Vec<f64>)| {
            let factor = self.space.factor(*dimension);
            let drawn = layer.lines.iter().zip(values).filter(|(line, _)| line.points.len() > 1);
            let stored: Vec<f32> = drawn.flat_map(|(_, &value)| [(value * factor) as f32; 2]).collect();
            let semantic = json::mesh::Semantic::Extras(name.trim_start_matches('_').to_owned());
            let accessor = self.root.push(scalars(stored.len(), self.values.len() as u64));
            self.values.extend(stored.iter().flat_map(|c| c.to_le_bytes()));
            (Checked::Valid(semantic), accessor)
        };
        layer.values.iter().map(add).collect()
    }
}

/// Adds the buffer and its views: of points, and of values of lines if there are any.
fn add_views(root: &mut json::Root, points: u64, values: u64) {
    let byte_length = USize64(points + values);
    root.buffers.push(json::Buffer { byte_length, name: None, uri: None, extensions: None, extras: None });
    let users = |view: u32| root.accessors.iter().filter(|a| a.buffer_view == Some(Index::new(view))).count();
    let view = |number: u32, byte_offset: Option<u64>, length: u64, stride: usize| json::buffer::View {
        buffer: Index::new(0),
        byte_length: USize64(length),
        byte_offset: byte_offset.map(USize64),
        // Required where several accessors share a view, and of no use to a single one.
        byte_stride: (users(number) > 1).then_some(json::buffer::Stride(stride)),
        name: None,
        target: Some(Checked::Valid(json::buffer::Target::ArrayBuffer)),
        extensions: None,
        extras: None,
    };
    let mut views = vec![view(0, None, points, 12)];
    if values > 0 {
        views.push(view(1, Some(points), values, 4));
    }
    root.buffer_views = views;
}

/// The plain colour of a layer.
fn material(layer: &Layer) -> json::Material {
    let [r, g, b] = layer.color.map(linear_factor);
    json::Material {
        name: Some(layer.name.clone()),
        pbr_metallic_roughness: json::material::PbrMetallicRoughness {
            base_color_factor: json::material::PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: json::material::StrengthFactor(0.0),
            ..Default::default()
        },
        ..Default::default()
    }
}

/// A document that says who made it.
fn empty_document() -> json::Root {
    json::Root {
        asset: json::Asset {
            generator: Some(format!("osculate {}", env!("CARGO_PKG_VERSION"))),
            version: "2.0".into(),
            ..Default::default()
        },
        ..Default::default()
    }
}

/// How polylines are drawn: single segments in one list, others each for itself.
fn strips(lines: &[Polyline]) -> Vec<(json::mesh::Mode, Vec<DVec3>)> {
    use json::mesh::Mode;
    let drawn = || lines.iter().filter(|line| line.points.len() > 1);
    if drawn().all(|line| line.points.len() == 2) {
        let points: Vec<DVec3> = drawn().flat_map(|line| line.points.iter().copied()).collect();
        return if points.is_empty() { Vec::new() } else { vec![(Mode::Lines, points)] };
    }
    drawn().map(|line| (if line.closed { Mode::LineLoop } else { Mode::LineStrip }, line.points.clone())).collect()
}

/// Numbers of lines, in the second view.
fn scalars(count: usize, offset: u64) -> json::Accessor {
    json::Accessor {
        buffer_view: Some(Index::new(1)),
        byte_offset: Some(USize64(offset)),
        count: USize64(count as u64),
        component_type: Checked::Valid(GenericComponentType(ComponentType::F32)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(Type::Scalar),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    }
}

fn accessor(points: &[[f32; 3]], offset: u64) -> json::Accessor {
    let bound = |pick: fn(f32, f32) -> f32| {
        let first = points[0];
        points.iter().fold(first, |b, p| [0, 1, 2].map(|i| pick(b[i], p[i])))
    };
    json::Accessor {
        buffer_view: Some(Index::new(0)),
        byte_offset: Some(USize64(offset)),
        count: USize64(points.len() as u64),
        component_type: Checked::Valid(GenericComponentType(ComponentType::F32)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(Type::Vec3),
        min: serde_json::to_value(bound(f32::min)).ok(),
        max: serde_json::to_value(bound(f32::max)).ok(),
        name: None,
        normalized: false,
        sparse: None,
    }
}
