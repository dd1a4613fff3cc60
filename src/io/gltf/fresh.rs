//! A document for a mesh that comes from no glTF file.

use super::document::{ARRAY_BUFFER, FLOAT, Target};
use super::draft::{Draft, Piece};
use super::indexed;
use super::layout::{Stream, stored_bounds};
use super::references::{Kind, Object};
use super::vertices::{Owners, Vertices};
use crate::annotation::{Annotation, Layout};
use crate::numbers::Numbers;
use crate::soup::Transform;
use serde_json::{Value, json};
use std::sync::Arc;

/// A mesh for each body with faces to write, and the nodes that place them.
pub(super) fn fresh<'a>(annotation: &Annotation<'_>) -> (Draft<'a>, Vec<Target>) {
    let mut root = Object::new();
    let generator = format!("osculate {}", env!("CARGO_PKG_VERSION"));
    root.insert("asset".into(), json!({ "version": "2.0", "generator": generator }));
    let mut draft = Draft::new(root);
    let mut targets = Vec::new();
    let all = annotation.faces();
    // The mesh of each body.
    let mut meshes: Vec<Option<usize>> = Vec::new();
    for body in annotation.mesh.bodies() {
        let faces = all.within(&body.faces);
        if faces.len() == 0 {
            meshes.push(None);
            continue;
        }
        let counts = vec![faces.len()];
        let mut corners = Vec::new();
        let mut owners = Owners::Corners(faces.clone());
        let primitive = match annotation.layout {
            Layout::Faces => json!({ "attributes": { "POSITION": add_corners(annotation, &mut draft, faces) } }),
            Layout::Indexed => {
                let (primitive, of_faces) = indexed::shared_vertices(annotation, &mut draft, &faces);
                let count = of_faces.as_flattened().iter().max().map_or(0, |last| last + 1);
                owners = Owners::Vertices(Arc::new(Vertices::kept(count, [(&faces, of_faces.as_slice())])));
                corners.push((faces, of_faces));
                primitive
            }
        };
        let mut mesh = json!({ "primitives": [primitive] });
        let name = if body.name.is_empty() { &annotation.name } else { &body.name };
        if !name.is_empty() {
            mesh["name"] = name.as_str().into();
        }
        let list = draft.list("meshes");
        list.push(mesh);
        meshes.push(Some(list.len() - 1));
        let mesh = list.len() - 1;
        targets.push(Target { mesh, primitives: vec![0], owners, faces: counts, foreign: Vec::new(), corners });
    }
    let (nodes, roots) = nodes(annotation, &meshes);
    draft.root.insert("nodes".into(), nodes);
    draft.root.insert("scenes".into(), json!([{ "nodes": roots }]));
    draft.root.insert("scene".into(), 0.into());
    (draft, targets)
}

/// Positions of the corners of faces.
fn add_corners(annotation: &Annotation<'_>, draft: &mut Draft<'_>, faces: Numbers) -> usize {
    let [min, max] = stored_bounds(annotation, &faces);
    let count = 3 * faces.len();
    let view = draft.add_view(Piece::Stream(Stream::Corners { faces }), Some(ARRAY_BUFFER), None);
    let accessor =
        json!({ "bufferView": view, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max });
    draft.add(Kind::Accessor, accessor)
}

/// The placement of the bodies by their meshes, or one node at the mesh's origin; and the roots.
fn nodes(annotation: &Annotation<'_>, meshes: &[Option<usize>]) -> (Value, Value) {
    let name = |name: &str, node: &mut Value| {
        if !name.is_empty() {
            node["name"] = name.into();
        }
    };
    let Some(scene) = annotation.mesh.scene() else {
        let origin = annotation.node_translation().as_vec3().to_array();
        let mut node = json!({ "mesh": 0 });
        name(&annotation.name, &mut node);
        if origin != [0.0; 3] {
            node["translation"] = json!(origin);
        }
        return (json!([node]), json!([0]));
    };
    let nodes: Vec<Value> = (scene.nodes.iter())
        .map(|given| {
            let mut node = json!({});
            name(&given.name, &mut node);
            if let Some(mesh) = given.body.and_then(|body| *meshes.get(body)?) {
                node["mesh"] = mesh.into();
            }
            if !given.children.is_empty() {
                node["children"] = json!(given.children);
            }
            match &given.transform {
                Transform::Matrix(matrix) => node["matrix"] = json!(matrix),
                Transform::Parts { translation, rotation, scale } => {
                    let parts =
                        [("translation", json!(translation)), ("rotation", json!(rotation)), ("scale", json!(scale))];
                    parts.into_iter().filter(|(_, part)| !part.is_null()).for_each(|(key, part)| node[key] = part);
                }
            }
            node
        })
        .collect();
    (json!(nodes), json!(scene.roots))
}
