//! Meshes and primitives: accessors put together into triangles.

use super::accessor::{Accessors, Indices};
use crate::error::ParseError;
use crate::soup::{Group, MAX_FACES, Note, PrimitiveFaces, short_name};
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::{Accessor, Index, Mesh, validation::Checked};
use serde::Deserialize;
use std::collections::HashMap;
use std::ops::Range;

/// How many vertices or faces a document may expand to by sharing accessors: that many for
/// nothing, and beyond them that many for each byte of input. Without sharing there is less than
/// one per byte, so that no honest file comes near.
const FREE_ELEMENTS: usize = 1 << 20;
const ELEMENTS_PER_BYTE: usize = 16;

/// Faces name their vertices in 32 bits.
const MAX_VERTICES: usize = u32::MAX as usize;

/// The extension whose primitives have their data compressed.
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// A material, as far as geometry is concerned.
#[derive(Deserialize)]
pub(super) struct Material {
    name: Option<String>,
}

/// The geometry read so far.
pub(super) struct Geometry<'a> {
    accessors: Accessors<'a>,
    materials: &'a [Material],
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) bodies: Vec<Group>,
    pub(super) groups: Vec<Group>,
    /// Where each group stands in the document.
    pub(super) primitives: Vec<PrimitiveFaces>,
    pub(super) notes: Vec<Note>,
    /// How many primitives are points or lines, and the path of the first.
    pub(super) skipped: Option<(usize, String)>,
}

impl<'a> Geometry<'a> {
    pub(super) fn new(accessors: Accessors<'a>, materials: &'a [Material], notes: Vec<Note>) -> Self {
        Geometry {
            accessors,
            materials,
            positions: Vec::new(),
            triangles: Vec::new(),
            bodies: Vec::new(),
            groups: Vec::new(),
            primitives: Vec::new(),
            notes,
            skipped: None,
        }
    }

    /// Adds a mesh and gives the index of its body, if it has a face.
    pub(super) fn add_mesh(&mut self, index: usize, mesh: &Mesh) -> Result<Option<usize>, ParseError> {
        let (first_face, first_position) = (self.triangles.len(), self.positions.len());
        // Where the positions of an accessor start: primitives that share them share vertices.
        let mut offsets = HashMap::new();
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let before = self.groups.len();
            self.add_primitive(&format!("meshes[{index}].primitives[{p}]"), primitive, &mut offsets)?;
            let added = self.groups.get(before);
            self.primitives.extend(added.map(|group| PrimitiveFaces {
                mesh: index,
                primitive: p,
                faces: group.faces.clone(),
            }));
        }
        if self.triangles.len() == first_face {
            self.positions.truncate(first_position);
            return Ok(None);
        }
        let faces = number(first_face)..number(self.triangles.len());
        self.bodies.push(Group { name: short_name(mesh.name.as_deref().unwrap_or_default()).to_owned(), faces });
        Ok(Some(self.bodies.len() - 1))
    }

    fn add_primitive(
        &mut self,
        path: &str,
        primitive: &Primitive,
        offsets: &mut HashMap<usize, Range<u32>>,
    ) -> Result<(), ParseError> {
        if primitive.mode == Checked::Invalid {
            return Err(ParseError::json(format!("{path}.mode"), "must be from 0 to 6"));
        }
        let Some(mode) = surface_mode(primitive) else {
            self.skipped.get_or_insert_with(|| (0, path.to_owned())).0 += 1;
            return Ok(());
        };
        let Some(&accessor) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.notes.push(Note::repaired(format!("{path} has no POSITION and was left out")));
            return Ok(());
        };
        let mut needed = [Some(accessor), primitive.indices].into_iter().flatten();
        let is_draco = primitive.extensions.as_ref().is_some_and(|e| e.others.contains_key(DRACO));
        if is_draco && needed.any(|accessor| self.accessors.is_blank(accessor)) {
            return Err(draco_error(format!("{path}.extensions")));
        }
        let vertices = match offsets.get(&accessor.value()) {
            Some(known) => known.clone(),
            None => {
                let added = self.add_positions(path, accessor)?;
                offsets.insert(accessor.value(), added.clone());
                added
            }
        };
        let first_face = self.triangles.len();
        let (corners, left_out) = match primitive.indices {
            None => {
                let corners = vertices.len();
                self.check_growth(path, first_face, face_bound(mode, corners), MAX_FACES)?;
                (corners, assemble(mode, corners, number, &vertices, &mut self.triangles))
            }
            Some(indices) => {
                let indices = self.accessors.indices(indices, &format!("{path}.indices"))?;
                let corners = indices.len();
                self.check_growth(path, first_face, face_bound(mode, corners), MAX_FACES)?;
                (corners, assemble_indexed(mode, &indices, &vertices, &mut self.triangles))
            }
        };
        if mode == Mode::Triangles && corners % 3 != 0 {
            let message =
                format!("{path}: {corners} corners make no whole triangles; the last {} were left out", corners % 3);
            self.notes.push(Note::repaired(message));
        }
        if left_out > 0 {
            let message =
                format!("{path}: triangles left out for an index beyond the {} vertices: {left_out}", vertices.len());
            self.notes.push(Note::repaired(message));
        }
        if self.triangles.len() > first_face {
            let material = primitive.material.and_then(|material| self.materials.get(material.value()));
            let name = material.and_then(|material| material.name.as_deref()).map(short_name).unwrap_or_default();
            self.groups.push(Group { name: name.to_owned(), faces: number(first_face)..number(self.triangles.len()) });
        }
        Ok(())
    }

    /// Adds the positions of an accessor and gives the numbers they got.
    fn add_positions(&mut self, path: &str, accessor: Index<Accessor>) -> Result<Range<u32>, ParseError> {
        let from = format!("{path}.attributes.POSITION");
        let array = self.accessors.vectors(accessor, &from)?;
        let first = self.positions.len();
        self.check_growth(&from, first, array.len(), MAX_VERTICES)?;
        array.append_to(&mut self.positions)?;
        Ok(number(first)..number(self.positions.len()))
    }

    /// Refuses more vertices or faces than can be numbered, or than the input's size justifies.
    ///
    /// Accessors may be shared by any number of primitives, so that a file of a megabyte could ask
    /// for terabytes.
    fn check_growth(&self, path: &str, before: usize, added: usize, most: usize) -> Result<(), ParseError> {
        let total = before.saturating_add(added);
        let bytes = self.accessors.bytes_at_hand();
        if total > most {
            return Err(ParseError::json(
                path,
                format!("{total} vertices or faces are more than the {most} that can be numbered; split the file"),
            ));
        }
        if total > FREE_ELEMENTS.max(bytes.saturating_mul(ELEMENTS_PER_BYTE)) {
            let what = format!("shared accessors expand {bytes} bytes to {total} vertices or faces, which is refused");
            return Err(ParseError::json(path, what));
        }
        Ok(())
    }
}

/// The mode of a primitive that makes triangles.
pub(super) fn surface_mode(primitive: &Primitive) -> Option<Mode> {
    match primitive.mode {
        Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => Some(mode),
        _ => None,
    }
}

/// The triangles of a primitive of `count` vertices, as the reader found them.
pub(super) fn corners_of(
    accessors: &Accessors<'_>,
    primitive: &Primitive,
    path: &str,
    count: u32,
) -> Result<Vec<[u32; 3]>, ParseError> {
    let mut triangles = Vec::new();
    let Some(mode) = surface_mode(primitive) else { return Ok(triangles) };
    match primitive.indices {
        None => assemble(mode, count as usize, number, &(0..count), &mut triangles),
        Some(indices) => {
            let indices = accessors.indices(indices, &format!("{path}.indices"))?;
            assemble_indexed(mode, &indices, &(0..count), &mut triangles)
        }
    };
    Ok(triangles)
}

/// The most faces that so many corners can make.
fn face_bound(mode: Mode, corners: usize) -> usize {
    if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
}

/// As [`assemble`], by the indices of a primitive.
fn assemble_indexed(mode: Mode, indices: &Indices<'_>, vertices: &Range<u32>, out: &mut Vec<[u32; 3]>) -> usize {
    let before = out.len();
    if mode == Mode::Triangles && indices.append_triangles_to(out) {
        let count = vertices.end - vertices.start;
        let added = &mut out[before..];
        let largest = added.as_flattened().iter().fold(0, |largest, &corner| largest.max(corner));
        if largest < count {
            added.as_flattened_mut().iter_mut().for_each(|corner| *corner += vertices.start);
            return 0;
        }
        out.truncate(before);
    }
    assemble(mode, indices.len(), |i| indices.get(i), vertices, out)
}

/// Appends the triangles of a primitive, whose indices count from the start of `vertices`, and
/// tells how many were left out for an index beyond them.
fn assemble(
    mode: Mode,
    corners: usize,
    index: impl Fn(usize) -> u32,
    vertices: &Range<u32>,
    out: &mut Vec<[u32; 3]>,
) -> usize {
    let count = vertices.end - vertices.start;
    let faces = face_bound(mode, corners);
    let before = out.len();
    let mut connecting = 0;
    out.reserve(faces);
    for face in 0..faces {
        // Winding as in section 3.7.2.1 of the specification.
        let [a, b, c] = match mode {
            Mode::TriangleStrip => [face, face + 1 + face % 2, face + 2 - face % 2],
            Mode::TriangleFan => [face + 1, face + 2, 0],
            _ => [3 * face, 3 * face + 1, 3 * face + 2],
        };
        let [a, b, c] = [index(a), index(b), index(c)];
        if mode == Mode::TriangleStrip && (a == b || b == c || c == a) {
            // Strips are joined by triangles without area, which are no faces by intent.
            connecting += 1;
        } else if a < count && b < count && c < count {
            out.push([vertices.start + a, vertices.start + b, vertices.start + c]);
        }
    }
    faces - connecting - (out.len() - before)
}

/// A number of vertices or faces, which have been counted before: it fits.
fn number(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

/// Says that a mesh is compressed, and the way out.
pub(super) fn draco_error(path: String) -> ParseError {
    let way_out = "`gltf-transform copy in.glb out.glb` decodes it";
    ParseError::json(path, format!("the mesh is compressed with {DRACO}, which is not read here; {way_out}"))
}

#[cfg(test)]
mod tests {
    use super::super::read::tests::{error_of, primitives, read_glb};
    use crate::soup::{Group, Transform};
    use serde_json::json;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        for (mode, indices, expected) in [
            (5, &[0, 1, 2, 3, 4][..], &[[0, 1, 2], [1, 3, 2], [2, 3, 4]][..]),
            (6, &[0, 1, 2, 3, 4], &[[1, 2, 0], [2, 3, 0], [3, 4, 0]]),
            (5, &[0, 1, 2, 2, 3, 3, 4, 1], &[[0, 1, 2], [3, 1, 4]]),
        ] {
            let parts = primitives(&json!([{ "attributes": { "POSITION": 0 }, "indices": 1, "mode": mode }]));
            let soup = read_glb(indices, &parts).expect("readable");
            assert_eq!(soup.triangles, expected, "mode {mode}");
            assert!(soup.notes.is_empty());
        }
    }

    #[test]
    fn without_indices_the_vertices_are_taken_in_order() {
        let strip = primitives(&json!([{ "attributes": { "POSITION": 0 }, "mode": 5 }]));
        assert_eq!(read_glb(&[], &strip).expect("readable").triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let soup = read_glb(&[], &primitives(&json!([{ "attributes": { "POSITION": 0 } }]))).expect("readable");
        assert_eq!(soup.triangles, [[0, 1, 2]]);
        assert!(soup.notes[0].repaired && soup.notes[0].message.contains("the last 2"), "{:?}", soup.notes);
    }

    #[test]
    fn triangles_with_a_wild_index_are_left_out_and_counted() {
        let soup = read_glb(&[0, 1, 2, 0, 1, 255, 5, 6, 7, 2, 1, 3], &json!({})).expect("readable");
        assert_eq!(soup.triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(soup.notes.len(), 1);
        let message = &soup.notes[0].message;
        assert!(message.starts_with("meshes[0].primitives[0]: ") && message.ends_with(": 2"), "{message}");
        assert!(soup.notes[0].repaired);
        assert!(error_of(&[7, 8, 9], &json!({})).starts_with("there are no triangles: "));
    }

    #[test]
    fn meshes_become_bodies_and_primitives_groups() {
        let part = |material: u32| json!({ "attributes": { "POSITION": 0 }, "indices": 1, "material": material });
        let lines = json!({ "attributes": { "POSITION": 0 }, "mode": 1 });
        let parts = json!({
            "materials": [{ "name": "Red" }, {}],
            "meshes": [
                { "name": "wire", "primitives": [lines, lines] },
                { "name": "two", "primitives": [part(0), lines, part(1)] },
                { "primitives": [part(9)] }
            ],
            "nodes": [{ "mesh": 2 }, { "mesh": 0 }, { "mesh": 1, "name": "n", "scale": [1, 2, 3] }]
        });
        let soup = read_glb(&[0, 1, 2], &parts).expect("readable");
        let group = |name: &str, faces| Group { name: name.into(), faces };
        assert_eq!(soup.bodies, [group("two", 0..2), group("", 2..3)]);
        assert_eq!(soup.groups, [group("Red", 0..1), group("", 1..2), group("", 2..3)]);
        assert_eq!(soup.triangles, [[0, 1, 2], [0, 1, 2], [5, 6, 7]], "shared within a mesh, not between meshes");
        assert_eq!(soup.positions.len(), 10);
        let scene = soup.scene.expect("always");
        assert_eq!(scene.nodes.iter().map(|n| n.body).collect::<Vec<_>>(), [Some(1), None, Some(0)]);
        assert_eq!(scene.roots, [0, 1, 2]);
        let transform = Transform::Parts { translation: None, rotation: None, scale: Some([1.0, 2.0, 3.0]) };
        assert_eq!((scene.nodes[2].name.as_str(), &scene.nodes[2].transform), ("n", &transform));
        assert_eq!(soup.notes.len(), 1);
        assert!(!soup.notes[0].repaired && soup.notes[0].message.ends_with("3, the first is meshes[0].primitives[0]"));
    }

    #[test]
    fn shared_accessors_cannot_expand_a_small_file_without_end() {
        let mesh = json!({ "primitives": [{ "attributes": { "POSITION": 0 } }] });
        let parts = json!({
            "accessors": [{ "componentType": 5126, "count": 65_000, "type": "VEC3" }],
            "meshes": vec![mesh; 300]
        });
        let error = error_of(&[], &parts);
        assert!(error.starts_with("meshes[") && error.contains("shared accessors"), "{error}");
    }
}
