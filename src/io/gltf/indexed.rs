//! Layout `indexed`: values of faces and classified edges in an extension of the primitive, beside
//! vertices that faces share (docs/file-format.md).

use super::document::{ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_INT, index_type};
use super::draft::{Draft, Piece};
use super::layout::{Stream, stored_points_bounds};
use super::references::Kind;
use super::vertices::Owners;
use crate::annotation::Annotation;
use crate::mesh::{EdgeKind, Face};
use crate::numbers::Numbers;
use crate::quantity::Quantity;
use serde_json::{Value, json};

/// Positions of the welded vertices of a body and the faces over them, as a primitive; and the corners
/// of its faces.
pub(super) fn shared_vertices(
    annotation: &Annotation<'_>,
    draft: &mut Draft<'_>,
    faces: &Numbers,
) -> (Value, Vec<[u32; 3]>) {
    let topology = annotation.mesh.topology();
    let mut corners: Vec<[u32; 3]> = faces.iter().map(|f| topology.corners(Face(f)).map(|v| v.0)).collect();
    let vertices = annotation.vertices_of(faces);
    corners.as_flattened_mut().iter_mut().for_each(|corner| *corner = vertices.place(*corner));

    let [min, max] = stored_points_bounds(annotation, &vertices);
    let count = vertices.len();
    let view = draft.add_view(Piece::Stream(Stream::Positions { vertices }), Some(ARRAY_BUFFER), None);
    let positions = json!({
        "bufferView": view, "componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max
    });
    let positions = draft.add(Kind::Accessor, positions);
    let (wide, component) = index_type(count);
    let stream = Stream::Indices { corners: corners.clone(), wide };
    let view = draft.add_view(Piece::Stream(stream), Some(ELEMENT_ARRAY_BUFFER), None);
    let indices = json!({
        "bufferView": view, "componentType": component, "count": 3 * corners.len(), "type": "SCALAR"
    });
    let indices = draft.add(Kind::Accessor, indices);
    (json!({ "attributes": { "POSITION": positions }, "indices": indices }), corners)
}

/// The extension of a primitive: an accessor for each column of each quantity, and one for each kind of
/// edge that is not inner.
pub(super) fn face_values<'a>(
    annotation: &Annotation<'_>,
    draft: &mut Draft<'a>,
    quantities: &[Quantity],
    faces: &Numbers,
    corners: &[[u32; 3]],
) -> Value {
    let mut values = json!({});
    for &quantity in quantities {
        for (component, column) in quantity.columns().iter().enumerate() {
            let stream = Stream::Value { owners: Owners::Faces(faces.clone()), quantity, component };
            let view = draft.add_view(Piece::Stream(stream), None, None);
            let accessor =
                json!({ "bufferView": view, "componentType": FLOAT, "count": faces.len(), "type": "SCALAR" });
            values[column] = json!({ "accessor": draft.add(Kind::Accessor, accessor) });
        }
    }
    let mut edges = json!({});
    let kinds =
        [("boundary", EdgeKind::Boundary), ("feature", EdgeKind::Feature), ("non_manifold", EdgeKind::NonManifold)];
    for (name, kind) in kinds {
        let ends = edges_of_kind(annotation, kind, faces, corners);
        if ends.is_empty() {
            continue;
        }
        let count = 2 * ends.len();
        let bytes = ends.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = draft.add_view(Piece::Bytes(bytes), None, None);
        let accessor = json!({ "bufferView": view, "componentType": UNSIGNED_INT, "count": count, "type": "SCALAR" });
        edges[name] = json!({ "accessor": draft.add(Kind::Accessor, accessor) });
    }
    json!({ "values": values, "edges": edges })
}

/// The ends of all edges of a kind, as vertices of the primitive, each pair once and in order.
fn edges_of_kind(annotation: &Annotation<'_>, kind: EdgeKind, faces: &Numbers, corners: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut ends: Vec<[u32; 2]> = Vec::new();
    // A face that is no part of the surface has no neighbours, so that its edges would pass for a border.
    let in_surface = |face: &Face| annotation.mesh.is_in_surface(*face);
    for (face, triangle) in faces.iter().map(Face).zip(corners).filter(|(face, _)| in_surface(face)) {
        for (i, h) in face.half_edges().into_iter().enumerate() {
            let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
            if a != b && annotation.mesh.edge_kind(h) == kind {
                ends.push([a.min(b), a.max(b)]);
            }
        }
    }
    ends.sort_unstable();
    ends.dedup();
    ends
}
