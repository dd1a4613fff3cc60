//! Triangles as a file gives them: nothing welded, nothing repaired, nothing dropped.

use crate::error::in_one_line;
use glam::DVec3;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Vertex positions in the width the file stores them.
///
/// A file of 32-bit floats is kept as such: it takes half the memory and later stages know that
/// the coordinates carry a quantisation of 6e-8 of their size.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// From a format whose coordinates are 32-bit floats.
    F32(Vec<[f32; 3]>),
    /// From a text format or one with 64-bit floats.
    F64(Vec<[f64; 3]>),
}

impl Positions {
    /// Number of positions.
    pub fn len(&self) -> usize {
        match self {
            Positions::F32(p) => p.len(),
            Positions::F64(p) => p.len(),
        }
    }

    /// True when there are no positions.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The position at an index, exactly as stored. Panics when `index >= len()`.
    #[inline]
    pub fn get(&self, index: usize) -> DVec3 {
        match self {
            Positions::F32(p) => {
                let [x, y, z] = p[index];
                DVec3::new(x.into(), y.into(), z.into())
            }
            Positions::F64(p) => DVec3::from_array(p[index]),
        }
    }
}

/// A run of faces that the file gives a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The file's name for it, of which 255 bytes are kept; empty where it has none.
    pub name: String,
    /// Its faces.
    pub faces: Range<u32>,
}

/// A node's own transform, kept in the form the file has it.
#[derive(Clone, Debug, PartialEq)]
pub enum Transform {
    /// A column-major 4 x 4 matrix.
    Matrix([f32; 16]),
    /// Translation, rotation (quaternion x, y, z, w) and scale; `None` where the file has none.
    Parts {
        /// Translation.
        translation: Option<[f32; 3]>,
        /// Unit quaternion x, y, z, w.
        rotation: Option<[f32; 4]>,
        /// Scale per axis.
        scale: Option<[f32; 3]>,
    },
}

/// A node of a glTF scene, as far as geometry is concerned.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The file's name for it; empty where it has none.
    pub name: String,
    /// Transform to the parent's space.
    pub transform: Transform,
    /// Index into [`Soup::bodies`].
    pub body: Option<usize>,
    /// Indices into [`Scene::nodes`].
    pub children: Vec<usize>,
}

/// Where a file places its bodies. Only glTF and 3MF have one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// All nodes of the file.
    pub nodes: Vec<Node>,
    /// The nodes at the top of the default scene.
    pub roots: Vec<usize>,
    /// Which faces belong to which primitive of the file, in face order.
    pub primitives: Vec<PrimitiveFaces>,
    /// The file itself, from which a glTF output takes all that is not geometry.
    pub original: Option<Arc<Original>>,
}

/// The faces of a glTF primitive.
#[derive(Clone, Debug, PartialEq)]
pub struct PrimitiveFaces {
    /// Index of the mesh in the document.
    pub mesh: usize,
    /// Index of the primitive in the mesh.
    pub primitive: usize,
    /// Its faces; there is at least one.
    pub faces: Range<u32>,
}

/// A glTF file as it was read.
#[derive(Clone, PartialEq)]
pub struct Original {
    /// Its name, for messages.
    pub path: PathBuf,
    /// Where the files that it names are; `None` when it came from a stream.
    pub folder: Option<PathBuf>,
    /// Folders besides in which such files may lie.
    pub allowed_folders: Vec<PathBuf>,
    /// Its content, decompressed, and text as UTF-8.
    pub bytes: Vec<u8>,
}

impl fmt::Debug for Original {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Original({}, {} bytes)", self.path.display(), self.bytes.len())
    }
}

/// As much of a name as is kept: thousands of groups may share one, and it may be of any length.
pub(crate) fn short_name(name: &str) -> &str {
    &name[..name.floor_char_boundary(255)]
}

/// What a reader had to repair or skip, in a sentence, or only wants to mention.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Note {
    /// The sentence, without a full stop.
    pub message: String,
    /// True when something of the file was repaired or left out (exit code 3).
    pub repaired: bool,
}

impl Note {
    /// A note that something was repaired or left out.
    pub fn repaired(message: impl Into<String>) -> Self {
        Note { message: in_one_line(message.into()), repaired: true }
    }

    /// A note for the reader's information.
    pub fn info(message: impl Into<String>) -> Self {
        Note { message: in_one_line(message.into()), repaired: false }
    }
}

/// Triangles as the file gives them, polygons already triangulated.
///
/// Face numbers here are the face numbers of every output: the triangle at index `f` is face `f`.
/// Every index in `triangles` is below `positions.len()`; coordinates may be anything, NaN
/// included. Bodies cover all faces, in order, without gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct Soup {
    /// Vertex positions, in the file's own axes and units. Where a file gives each corner its own (STL), some that
    /// are equal to the bit are one.
    pub positions: Positions,
    /// Three indices into `positions` per face, in the file's winding.
    pub triangles: Vec<[u32; 3]>,
    /// Faces that share a coordinate space, in face order: one body for a whole STL, OBJ or PLY
    /// file, one for each glTF mesh. Vertices are welded inside a body, never between bodies.
    pub bodies: Vec<Group>,
    /// The file's own division, in face order: OBJ groups, STL solids, glTF primitives. May be empty.
    pub groups: Vec<Group>,
    /// The placement of the bodies, for formats that have one.
    pub scene: Option<Scene>,
    /// What the reader repaired, skipped or wants to mention.
    pub notes: Vec<Note>,
    /// Files besides the input that were read, such as a glTF's buffers.
    pub files: Vec<PathBuf>,
    /// Metres in one unit of the positions, where the file says so: always in glTF and 3MF.
    pub metres_per_unit: Option<f64>,
}

impl Soup {
    /// A soup of one body, without groups or notes.
    ///
    /// Panics when an index is out of range or there are more than [`MAX_FACES`] faces.
    pub fn new(positions: Positions, triangles: Vec<[u32; 3]>) -> Self {
        // The largest of all is found faster than the first that is too large.
        let largest = triangles.as_flattened().iter().fold(0, |largest, &i| largest.max(i));
        assert!(triangles.is_empty() || (largest as usize) < positions.len(), "vertex index out of range");
        let faces = face_count(triangles.len());
        Soup {
            positions,
            triangles,
            bodies: vec![Group { name: String::new(), faces: 0..faces }],
            groups: Vec::new(),
            scene: None,
            notes: Vec::new(),
            files: Vec::new(),
            metres_per_unit: None,
        }
    }

    /// Number of faces.
    pub fn face_count(&self) -> usize {
        self.triangles.len()
    }
}

/// The largest number of faces a mesh may have: half-edges, and what lists both ways along them, are numbered in 32 bits,
/// and vertices in the signed ones of PLY.
pub const MAX_FACES: usize = (i32::MAX / 3) as usize;

fn face_count(len: usize) -> u32 {
    assert!(len <= MAX_FACES, "a mesh may have at most {MAX_FACES} faces");
    len as u32
}
