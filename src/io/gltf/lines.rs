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
    let translation = scene.space.point(scene.origin).as_vec3();
    let remainder = scene.space.point(scene.origin) - translation.as_dvec3();
    let mut bin: Vec<u8> = Vec::new();
    // Values of lines go into a view of their own: elements of a view are of one size.
    let mut scalar_bytes: Vec<u8> = Vec::new();
    let mut root = empty_document();
    let extras = serde_json::value::to_raw_value(&scene.extras).ok();
    for layer in scene.layers {
        let strips = strips(&layer.lines);
        if strips.is_empty() {
            continue;
        }
        let [r, g, b] = layer.color.map(linear_factor);
        let material = root.push(json::Material {
            name: Some(layer.name.clone()),
            pbr_metallic_roughness: json::material::PbrMetallicRoughness {
                base_color_factor: json::material::PbrBaseColorFactor([r, g, b, 1.0]),
                metallic_factor: json::material::StrengthFactor(0.0),
                ..Default::default()
            },
            ..Default::default()
        });
        let mut primitives = Vec::with_capacity(strips.len());
        let is_single = matches!(strips.as_slice(), [(json::mesh::Mode::Lines, _)]);
        for (mode, points) in strips {
            let stored: Vec<[f32; 3]> = points.iter().map(|&p| single(scene.space.point(p) + remainder)).collect();
            let position = root.push(accessor(&stored, bin.len() as u64));
            bin.extend(stored.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
            let mut attributes: BTreeMap<_, _> = [(Checked::Valid(json::mesh::Semantic::Positions), position)].into();
            for (name, dimension, values) in layer.values.iter().filter(|_| is_single) {
                let factor = scene.space.factor(*dimension);
                let drawn = layer.lines.iter().zip(values).filter(|(line, _)| line.points.len() > 1);
                let stored: Vec<f32> = drawn.flat_map(|(_, &value)| [(value * factor) as f32; 2]).collect();
                let semantic = json::mesh::Semantic::Extras(name.trim_start_matches('_').to_owned());
                attributes
                    .insert(Checked::Valid(semantic), root.push(scalars(stored.len(), scalar_bytes.len() as u64)));
                scalar_bytes.extend(stored.iter().flat_map(|c| c.to_le_bytes()));
            }
            primitives.push(json::mesh::Primitive {
                attributes,
                extensions: None,
                extras: None,
                indices: None,
                material: Some(material),
                mode: Checked::Valid(mode),
                targets: None,
            });
        }
        let mesh = root.push(json::Mesh {
            extensions: None,
            extras: extras.clone(),
            name: Some(layer.name.clone()),
            primitives,
            weights: None,
        });
        root.push(json::Node {
            mesh: Some(mesh),
            name: Some(layer.name.clone()),
            translation: (translation != glam::Vec3::ZERO).then_some(translation.to_array()),
            ..Default::default()
        });
    }
    if !bin.is_empty() {
        let byte_length = USize64((bin.len() + scalar_bytes.len()) as u64);
        root.buffers.push(json::Buffer { byte_length, name: None, uri: None, extensions: None, extras: None });
        let users = |view: u32| root.accessors.iter().filter(|a| a.buffer_view == Some(Index::new(view))).count();
        let shared = [users(0) > 1, users(1) > 1];
        let byte_length = USize64(bin.len() as u64);
        root.buffer_views.push(json::buffer::View {
            buffer: Index::new(0),
            byte_length,
            byte_offset: None,
            // Required where several accessors share a view, and of no use to a single one.
            byte_stride: shared[0].then_some(json::buffer::Stride(12)),
            name: None,
            target: Some(Checked::Valid(json::buffer::Target::ArrayBuffer)),
            extensions: None,
            extras: None,
        });
        if !scalar_bytes.is_empty() {
            root.buffer_views.push(json::buffer::View {
                buffer: Index::new(0),
                byte_length: USize64(scalar_bytes.len() as u64),
                byte_offset: Some(byte_length),
                byte_stride: shared[1].then_some(json::buffer::Stride(4)),
                name: None,
                target: Some(Checked::Valid(json::buffer::Target::ArrayBuffer)),
                extensions: None,
                extras: None,
            });
        }
    }
    bin.extend(scalar_bytes);
    let nodes = (0..root.nodes.len() as u32).map(Index::new).collect();
    root.scene = Some(root.push(json::Scene { extensions: None, extras: None, name: None, nodes }));
    let document = root.to_vec().unwrap_or_default();
    check_glb_length((document.len() + bin.len()) as u64)?;
    write_chunks(document, bin.len() as u64, out, |out| std::io::Write::write_all(out, &bin))
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
