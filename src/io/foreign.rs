//! Files that are often handed over as meshes and are none that can be read: told by name, with a way out.

const CONVERT: &str = "which is not read here; export it as glTF, OBJ, PLY or STL";
const POINTS: &str = "which has no faces; mesh it first";
const NO_MESH: &str = "not a mesh";

/// How such files begin, what they are, and what to do.
const BEGINNINGS: &[(&[u8], &str, &str)] = &[
    (b"version https://git-lfs", "a pointer of Git LFS", "not the mesh itself; `git lfs pull` fetches it"),
    (b"<!doctype html", "a web page", "not a mesh; download the file itself"),
    (b"<html", "a web page", "not a mesh; download the file itself"),
    (b"Kaydara FBX", "FBX", CONVERT),
    (b"; FBX", "FBX", CONVERT),
    (b"BLENDER", "a Blender file", CONVERT),
    (b"ISO-10303-21", "STEP, which holds surfaces", "not triangles; export STL from the CAD program"),
    (b"<COLLADA", "COLLADA", CONVERT),
    (b"<amf", "AMF", CONVERT),
    (b"<X3D", "X3D", CONVERT),
    (b"#X3D", "X3D", CONVERT),
    (b"#VRML", "VRML", CONVERT),
    (b"#Inventor", "Open Inventor", CONVERT),
    (b"PXR-USDC", "USD", CONVERT),
    (b"#usda", "USD", CONVERT),
    (b"# vtk DataFile", "VTK", CONVERT),
    (b"<VTKFile", "VTK", CONVERT),
    (b"$MeshFormat", "a Gmsh file", CONVERT),
    (b"DRACO", "a Draco file", CONVERT),
    (b"LASF", "a LAS point cloud", POINTS),
    (b"# .PCD", "a PCD point cloud", POINTS),
    (b"\x89PNG", "a PNG picture", NO_MESH),
    (b"\xff\xd8\xff", "a JPEG picture", NO_MESH),
    (b"%PDF", "a PDF document", NO_MESH),
    (b"7z\xbc\xaf", "a 7z archive", "not a mesh; unpack it first"),
    (b"Rar!", "a RAR archive", "not a mesh; unpack it first"),
    (b"\x7fELF", "a program", NO_MESH),
];

/// What a file of no known format is, in a sentence.
pub(super) fn sentence(content: &[u8]) -> Option<String> {
    let begins =
        |content: &[u8], with: &[u8]| content.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    // In XML the first element tells, behind declarations and comments.
    let start = &content[..content.len().min(4096)];
    let mut tags = memchr::memchr_iter(b'<', start).map(|at| &content[at..]);
    let is_element = |tag: &&[u8]| tag.get(1).is_some_and(u8::is_ascii_alphabetic);
    let root = if begins(content, b"<?xml") { tags.find(is_element) } else { None };
    let (_, what, way_out) = BEGINNINGS.iter().find(|(with, ..)| begins(root.unwrap_or(content), with))?;
    Some(format!("this is {what}, {way_out}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_mesh_is_called_by_its_name() {
        for (content, start) in [
            ("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n", "this is a pointer of Git LFS, not"),
            ("<!DOCTYPE HTML>\n<html>", "this is a web page, not a mesh"),
            ("<?xml version='1.0'?>\n<!-- made by hand -->\n<COLLADA xmlns='x'>", "this is COLLADA, which"),
            ("<?xml version='1.0'?><AMF unit='mm'>", "this is AMF, which"),
            ("Kaydara FBX Binary  ", "this is FBX, which"),
            ("LASF", "this is a LAS point cloud, which has no faces"),
        ] {
            assert!(sentence(content.as_bytes()).is_some_and(|said| said.starts_with(start)), "{content}");
        }
        assert_eq!(sentence(b"\x89PNG\r\n\x1a\n").as_deref(), Some("this is a PNG picture, not a mesh"));
        for other in ["", "<", "<?xml", "<?xml <", "solid", "v 1 2 3"] {
            assert_eq!(sentence(other.as_bytes()), None);
        }
    }
}
