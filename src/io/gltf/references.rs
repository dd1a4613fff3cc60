//! Where a document refers to its own parts: for counting references and for renumbering.
//!
//! Extensions that are not known here keep the numbers they have: parts of a document are only
//! renumbered where something that Osculate added earlier is taken out of their middle.

use super::strip::FACE_VALUES;
use serde_json::{Map, Value};

/// A JSON object.
pub(super) type Object = Map<String, Value>;

/// A list of a document whose members are referred to by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Accessor,
    View,
    Material,
    Texture,
    Image,
    Sampler,
}

impl Kind {
    pub(super) const ALL: [Kind; 6] =
        [Kind::Accessor, Kind::View, Kind::Material, Kind::Texture, Kind::Image, Kind::Sampler];

    /// The name of the list.
    pub(super) fn list(self) -> &'static str {
        match self {
            Kind::Accessor => "accessors",
            Kind::View => "bufferViews",
            Kind::Material => "materials",
            Kind::Texture => "textures",
            Kind::Image => "images",
            Kind::Sampler => "samplers",
        }
    }
}

/// Calls `found` with every reference to a member of a list.
pub(super) fn visit(root: &mut Object, kind: Kind, found: &mut dyn FnMut(&mut Value)) {
    match kind {
        Kind::Accessor => {
            each_primitive(root, &mut |primitive| {
                primitive.get_mut("attributes").into_iter().flat_map(values).for_each(&mut *found);
                primitive.get_mut("indices").into_iter().for_each(&mut *found);
                primitive.get_mut("targets").into_iter().flat_map(values).flat_map(values).for_each(&mut *found);
                let ours = primitive.get_mut("extensions").and_then(|e| e.get_mut(FACE_VALUES));
                let of_faces = ours.into_iter().flat_map(values).flat_map(values);
                of_faces.filter_map(|member| member.get_mut("accessor")).for_each(&mut *found);
            });
            each(root, &["skins"], "inverseBindMatrices", found);
            let samplers = root.get_mut("animations").into_iter().flat_map(values);
            for sampler in samplers.filter_map(|a| a.get_mut("samplers")).flat_map(values) {
                for key in ["input", "output"] {
                    sampler.get_mut(key).into_iter().for_each(&mut *found);
                }
            }
            for node in root.get_mut("nodes").into_iter().flat_map(values) {
                let instances = node.pointer_mut("/extensions/EXT_mesh_gpu_instancing/attributes");
                instances.into_iter().flat_map(values).for_each(&mut *found);
            }
        }
        Kind::View => {
            for accessor in root.get_mut("accessors").into_iter().flat_map(values) {
                for path in ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"] {
                    accessor.pointer_mut(path).into_iter().for_each(&mut *found);
                }
            }
            each(root, &["images"], "bufferView", found);
            each_primitive(root, &mut |primitive| {
                let draco = primitive.get_mut("extensions").and_then(|e| e.get_mut("KHR_draco_mesh_compression"));
                draco.and_then(|draco| draco.get_mut("bufferView")).into_iter().for_each(&mut *found);
            });
            let extensions = root.get_mut("extensions");
            let tables = extensions.and_then(|e| e.pointer_mut("/EXT_structural_metadata/propertyTables"));
            let properties = tables.into_iter().flat_map(values).filter_map(|table| table.get_mut("properties"));
            for property in properties.flat_map(values) {
                for key in ["values", "arrayOffsets", "stringOffsets"] {
                    property.get_mut(key).into_iter().for_each(&mut *found);
                }
            }
        }
        Kind::Material => each_primitive(root, &mut |primitive| {
            primitive.get_mut("material").into_iter().for_each(&mut *found);
            let extensions = primitive.get_mut("extensions");
            let mappings = extensions.and_then(|e| e.pointer_mut("/KHR_materials_variants/mappings"));
            let materials = mappings.into_iter().flat_map(values).filter_map(|mapping| mapping.get_mut("material"));
            materials.for_each(&mut *found);
        }),
        Kind::Texture => {
            root.get_mut("materials").into_iter().for_each(|materials| textures_in(materials, found));
        }
        Kind::Image => {
            for texture in root.get_mut("textures").into_iter().flat_map(values) {
                texture.get_mut("source").into_iter().for_each(&mut *found);
                let extensions = texture.get_mut("extensions").into_iter().flat_map(values);
                extensions.filter_map(|extension| extension.get_mut("source")).for_each(&mut *found);
            }
        }
        Kind::Sampler => each(root, &["textures"], "sampler", found),
    }
}

/// How often each member of a list is referred to.
pub(super) fn counts(root: &mut Object, kind: Kind) -> Vec<usize> {
    let mut counts = vec![0; root.get(kind.list()).and_then(Value::as_array).map_or(0, Vec::len)];
    visit(root, kind, &mut |reference| {
        if let Some(count) = index(reference).and_then(|i| counts.get_mut(i)) {
            *count += 1;
        }
    });
    counts
}

/// A reference as a number.
pub(super) fn index(reference: &Value) -> Option<usize> {
    reference.as_u64().and_then(|i| usize::try_from(i).ok())
}

/// The members of a list or an object.
fn values(value: &mut Value) -> Box<dyn Iterator<Item = &mut Value> + '_> {
    match value {
        Value::Array(list) => Box::new(list.iter_mut()),
        Value::Object(object) => Box::new(object.values_mut()),
        _ => Box::new(std::iter::empty()),
    }
}

fn each(root: &mut Object, lists: &[&str], key: &str, found: &mut dyn FnMut(&mut Value)) {
    for list in lists {
        for member in root.get_mut(*list).into_iter().flat_map(values) {
            member.get_mut(key).into_iter().for_each(&mut *found);
        }
    }
}

/// Calls `found` with every primitive of every mesh.
pub(super) fn each_primitive(root: &mut Object, found: &mut dyn FnMut(&mut Object)) {
    let meshes = root.get_mut("meshes").into_iter().flat_map(values);
    for primitive in meshes.filter_map(|mesh| mesh.get_mut("primitives")).flat_map(values) {
        primitive.as_object_mut().into_iter().for_each(&mut *found);
    }
}

/// Texture references: `index` in every object whose name ends in "Texture", in extensions too.
fn textures_in(value: &mut Value, found: &mut dyn FnMut(&mut Value)) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|member| textures_in(member, found)),
        Value::Object(object) => {
            for (name, member) in object.iter_mut().filter(|(name, _)| *name != "extras") {
                if name.ends_with("Texture") {
                    member.get_mut("index").into_iter().for_each(&mut *found);
                }
                textures_in(member, found);
            }
        }
        _ => {}
    }
}
