//! Which streams a glTF file consists of, where each lies, and the document that says so.

use super::write::{External, corner};
use crate::annotation::{Annotation, ColorCarrier};
use crate::error::Error;
use crate::mesh::Face;
use crate::quantity::Quantity;
use crate::soup::Transform;
use gltf_json as json;
use json::accessor::{ComponentType, GenericComponentType, Type};
use json::validation::{Checked, USize64};
use json::{Index, Root};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// The most that the 32-bit length of a GLB can say.
const GLB_LIMIT: u64 = u32::MAX as u64;

/// What one buffer view holds: one attribute of one mesh, or the image.
#[derive(Clone, Debug)]
pub(super) enum Stream {
    Position { faces: Range<u32> },
    Value { faces: Range<u32>, quantity: Quantity, component: usize },
    PaletteCoordinate { faces: Range<u32> },
    VertexColor { faces: Range<u32> },
    Image { length: u64 },
}

impl Stream {
    pub(super) fn faces(&self) -> Range<u32> {
        match self {
            Stream::Position { faces }
            | Stream::Value { faces, .. }
            | Stream::PaletteCoordinate { faces }
            | Stream::VertexColor { faces } => faces.clone(),
            Stream::Image { .. } => 0..0,
        }
    }

    /// A multiple of 4 for all but the image, which comes last.
    fn byte_length(&self) -> u64 {
        let per_vertex = match self {
            Stream::Position { .. } => 12,
            Stream::PaletteCoordinate { .. } => 8,
            Stream::Value { .. } | Stream::VertexColor { .. } => 4,
            Stream::Image { length } => return *length,
        };
        3 * per_vertex * self.faces().len() as u64
    }
}

/// The streams of a file in their order, split into buffers.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    streams: Vec<Stream>,
    /// Streams of each mesh; they stand one after another, mesh by mesh.
    per_mesh: usize,
    /// Streams of each buffer.
    buffers: Vec<Range<usize>>,
}

impl Layout {
    /// `image` goes into the buffer as the last stream; a buffer grows up to `buffer_limit` bytes.
    pub(super) fn new(annotation: &Annotation<'_>, image: Option<&[u8]>, buffer_limit: u64) -> Self {
        let quantities = annotation.gltf_quantities();
        let mut streams = Vec::new();
        for body in annotation.mesh.bodies() {
            let faces = || body.faces.clone();
            streams.push(Stream::Position { faces: faces() });
            for &quantity in &quantities {
                for component in 0..quantity.columns().len() {
                    streams.push(Stream::Value { faces: faces(), quantity, component });
                }
            }
            match (annotation.carrier, &annotation.colors) {
                (ColorCarrier::Texture, Some(_)) => streams.push(Stream::PaletteCoordinate { faces: faces() }),
                (ColorCarrier::Vertex | ColorCarrier::VertexSrgb, Some(_)) => {
                    streams.push(Stream::VertexColor { faces: faces() });
                }
                _ => {}
            }
        }
        let per_mesh = streams.len() / annotation.mesh.bodies().len();
        streams.extend(image.map(|image| Stream::Image { length: image.len() as u64 }));
        let mut buffers = Vec::new();
        let (mut start, mut length) = (0, 0);
        for (i, stream) in streams.iter().enumerate() {
            if i > start && length + stream.byte_length() > buffer_limit {
                buffers.push(start..i);
                (start, length) = (i, 0);
            }
            length += stream.byte_length();
        }
        buffers.push(start..streams.len());
        Layout { streams, per_mesh, buffers }
    }

    /// The streams of each buffer.
    pub(super) fn buffers(&self) -> impl Iterator<Item = &[Stream]> {
        self.buffers.iter().map(|range| &self.streams[range.clone()])
    }

    /// Bytes of all streams together.
    pub(super) fn byte_length(&self) -> u64 {
        self.streams.iter().map(Stream::byte_length).sum()
    }

    /// The JSON document. `external` gives the URI of a buffer or image that is not in the file.
    pub(super) fn document(
        &self,
        annotation: &Annotation<'_>,
        external: &dyn Fn(External) -> Option<String>,
    ) -> Vec<u8> {
        let mut root = empty_document();
        for (b, streams) in self.buffers.iter().enumerate() {
            let mut offset = 0;
            for stream in &self.streams[streams.clone()] {
                push_view(&mut root, stream, b as u32, offset);
                offset += stream.byte_length();
            }
            root.buffers.push(json::Buffer {
                byte_length: USize64(offset),
                name: None,
                uri: external(External::Buffer(b)),
                extensions: None,
                extras: None,
            });
        }
        let material = push_material(&mut root, annotation, external);
        let extras = serde_json::value::to_raw_value(&annotation.extras()).ok();
        let meshes = self.streams.chunks_exact(self.per_mesh);
        for (m, (body, streams)) in annotation.mesh.bodies().iter().zip(meshes).enumerate() {
            let mut attributes = BTreeMap::new();
            for (i, stream) in streams.iter().enumerate() {
                let (semantic, accessor) = describe(annotation, stream, (m * self.per_mesh + i) as u32);
                attributes.insert(Checked::Valid(semantic), root.push(accessor));
            }
            let name = if body.name.is_empty() { annotation.name.clone() } else { body.name.clone() };
            root.meshes.push(json::Mesh {
                extensions: None,
                extras: extras.clone(),
                name: Some(name).filter(|name| !name.is_empty()),
                primitives: vec![json::mesh::Primitive {
                    attributes,
                    extensions: None,
                    extras: None,
                    indices: None,
                    material: Some(material),
                    mode: Checked::Valid(json::mesh::Mode::Triangles),
                    targets: None,
                }],
                weights: None,
            });
        }
        let nodes = push_nodes(&mut root, annotation);
        let scene = root.push(json::Scene { extensions: None, extras: None, name: None, nodes });
        root.scene = Some(scene);
        // Every part of the document is a number or a string: there is nothing that cannot be written.
        root.to_vec().unwrap_or_default()
    }
}

/// Bytes that a mesh of so many faces takes in a GLB, apart from the document.
pub(in crate::io) fn faces_byte_length(faces: usize, quantities: &[Quantity], carrier: Option<ColorCarrier>) -> u64 {
    let values: usize = quantities.iter().map(|q| q.columns().len()).sum();
    let color = match carrier {
        Some(ColorCarrier::Texture) => 8,
        Some(ColorCarrier::Vertex | ColorCarrier::VertexSrgb) => 4,
        _ => 0,
    };
    3 * faces as u64 * (12 + 4 * values as u64 + color)
}

/// Refuses a GLB of more bytes than it can hold, with the ways out.
pub(in crate::io) fn check_glb_length(length: u64) -> Result<(), Error> {
    if length <= GLB_LIMIT {
        return Ok(());
    }
    Err(Error::TooLarge(format!(
        "the output would have {:.1} GB, but a .glb holds at most 4.3: write .gltf (several buffers) or .ply, or fewer quantities with --attributes",
        length as f64 / 1e9
    )))
}

/// A document that says who made it.
pub(super) fn empty_document() -> Root {
    Root {
        asset: json::Asset {
            generator: Some(format!("osculate {}", env!("CARGO_PKG_VERSION"))),
            version: "2.0".into(),
            ..Default::default()
        },
        ..Default::default()
    }
}

fn push_view(root: &mut Root, stream: &Stream, buffer: u32, offset: u64) {
    let is_image = matches!(stream, Stream::Image { .. });
    root.buffer_views.push(json::buffer::View {
        buffer: Index::new(buffer),
        byte_length: USize64(stream.byte_length()),
        byte_offset: Some(USize64(offset)),
        byte_stride: None,
        name: None,
        target: (!is_image).then_some(Checked::Valid(json::buffer::Target::ArrayBuffer)),
        extensions: None,
        extras: None,
    });
}

/// An attribute's name and accessor.
fn describe(annotation: &Annotation<'_>, stream: &Stream, view: u32) -> (json::mesh::Semantic, json::Accessor) {
    use json::mesh::Semantic;
    let mut accessor = json::Accessor {
        buffer_view: Some(Index::new(view)),
        byte_offset: None,
        count: USize64(3 * stream.faces().len() as u64),
        component_type: Checked::Valid(GenericComponentType(ComponentType::F32)),
        extensions: None,
        extras: None,
        type_: Checked::Valid(Type::Scalar),
        min: None,
        max: None,
        name: None,
        normalized: false,
        sparse: None,
    };
    let semantic = match stream {
        Stream::Position { faces } => {
            let [min, max] = stored_bounds(annotation, faces.clone());
            accessor.type_ = Checked::Valid(Type::Vec3);
            accessor.min = serde_json::to_value(min).ok();
            accessor.max = serde_json::to_value(max).ok();
            Semantic::Positions
        }
        Stream::Value { quantity, component, .. } => {
            // gltf-json puts the underscore back.
            Semantic::Extras(quantity.attributes()[*component].trim_start_matches('_').to_owned())
        }
        Stream::PaletteCoordinate { .. } => {
            accessor.type_ = Checked::Valid(Type::Vec2);
            Semantic::TexCoords(0)
        }
        Stream::VertexColor { .. } | Stream::Image { .. } => {
            accessor.type_ = Checked::Valid(Type::Vec4);
            accessor.component_type = Checked::Valid(GenericComponentType(ComponentType::U8));
            accessor.normalized = true;
            Semantic::Colors(0)
        }
    };
    (semantic, accessor)
}

/// Least and greatest coordinates of the corners as they are stored.
fn stored_bounds(annotation: &Annotation<'_>, faces: Range<u32>) -> [[f32; 3]; 2] {
    let empty = || [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    let join = |[min, max]: [[f32; 3]; 2], [low, high]: [[f32; 3]; 2]| {
        [[0, 1, 2].map(|i| min[i].min(low[i])), [0, 1, 2].map(|i| max[i].max(high[i]))]
    };
    let remainder = annotation.translation_remainder();
    faces
        .into_par_iter()
        .map(|f| {
            let corners = annotation.finite_triangle(Face(f)).map(|p| corner(annotation, remainder, p));
            corners.into_iter().fold(empty(), |bounds, c| join(bounds, [c, c]))
        })
        .reduce(empty, join)
}

/// The one material: white where nothing colours it, rough, seen from both sides, since scans are
/// often open.
fn push_material(
    root: &mut Root,
    annotation: &Annotation<'_>,
    external: &dyn Fn(External) -> Option<String>,
) -> Index<json::Material> {
    use json::texture::{MagFilter, MinFilter, WrappingMode};
    let has_texture = annotation.carrier == ColorCarrier::Texture && annotation.colors.is_some();
    let texture = has_texture.then(|| {
        let uri = external(External::Image);
        let image = root.push(json::Image {
            buffer_view: uri.is_none().then(|| Index::new(root.buffer_views.len() as u32 - 1)),
            mime_type: uri.is_none().then(|| json::image::MimeType("image/png".into())),
            name: Some("curvature palette".into()),
            uri,
            extensions: None,
            extras: None,
        });
        let sampler = root.push(json::texture::Sampler {
            mag_filter: Some(Checked::Valid(MagFilter::Nearest)),
            min_filter: Some(Checked::Valid(MinFilter::Nearest)),
            wrap_s: Checked::Valid(WrappingMode::ClampToEdge),
            wrap_t: Checked::Valid(WrappingMode::ClampToEdge),
            ..Default::default()
        });
        let texture =
            json::Texture { name: None, sampler: Some(sampler), source: image, extensions: None, extras: None };
        json::texture::Info { index: root.push(texture), tex_coord: 0, extensions: None, extras: None }
    });
    root.push(json::Material {
        name: Some(annotation.colors.as_ref().map_or("surface", |colors| colors.quantity.token()).into()),
        double_sided: true,
        pbr_metallic_roughness: json::material::PbrMetallicRoughness {
            base_color_factor: json::material::PbrBaseColorFactor([1.0; 4]),
            base_color_texture: texture,
            metallic_factor: json::material::StrengthFactor(0.0),
            roughness_factor: json::material::StrengthFactor(0.8),
            ..Default::default()
        },
        ..Default::default()
    })
}

/// The input's placement of its meshes, or one node at the mesh's origin. Returns the roots.
fn push_nodes(root: &mut Root, annotation: &Annotation<'_>) -> Vec<Index<json::Node>> {
    let Some(scene) = annotation.mesh.scene() else {
        let origin = annotation.node_translation().as_vec3().to_array();
        let node = json::Node {
            mesh: Some(Index::new(0)),
            name: Some(annotation.name.clone()).filter(|name| !name.is_empty()),
            translation: (origin != [0.0; 3]).then_some(origin),
            ..Default::default()
        };
        return vec![root.push(node)];
    };
    // Nodes without a mesh below them were there for cameras, bones or lights, which this layout
    // does not carry. Children come after their parent, so one pass backwards finds what is needed.
    let mut order: Vec<usize> = scene.roots.clone();
    let mut next = 0;
    while next < order.len() {
        order.extend_from_slice(&scene.nodes[order[next]].children);
        next += 1;
    }
    let mut needed = vec![false; scene.nodes.len()];
    for &n in order.iter().rev() {
        needed[n] = scene.nodes[n].body.is_some() || scene.nodes[n].children.iter().any(|&c| needed[c]);
    }
    let kept: Vec<usize> = order.into_iter().filter(|&n| needed[n]).collect();
    let mut number = vec![Index::new(0); scene.nodes.len()];
    for (i, &n) in kept.iter().enumerate() {
        number[n] = Index::new(i as u32);
    }
    let indices = |nodes: &[usize]| -> Vec<Index<json::Node>> {
        nodes.iter().filter(|&&n| needed[n]).map(|&n| number[n]).collect()
    };
    for &n in &kept {
        let node = &scene.nodes[n];
        let children = indices(&node.children);
        let mut out = json::Node {
            mesh: node.body.map(|body| Index::new(body as u32)),
            name: Some(node.name.clone()).filter(|name| !name.is_empty()),
            children: (!children.is_empty()).then_some(children),
            ..Default::default()
        };
        match &node.transform {
            Transform::Matrix(matrix) => out.matrix = Some(*matrix),
            Transform::Parts { translation, rotation, scale } => {
                out.translation = *translation;
                out.rotation = rotation.map(json::scene::UnitQuaternion);
                out.scale = *scale;
            }
        }
        root.nodes.push(out);
    }
    indices(&scene.roots)
}
