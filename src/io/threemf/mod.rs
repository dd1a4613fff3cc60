//! 3MF, the format of printers: a ZIP archive with XML in it.
//!
//! What is read is the build: every item with its components, each placed by its transforms, so that
//! positions are those on the build plate. An archive without build items gives its objects.

mod archive;
mod model;

use crate::error::ParseError;
use crate::soup::{Group, MAX_FACES, Node, Note, Positions, Scene, Soup, Transform};
use archive::Archive;
use glam::{DAffine3, DVec3};
use model::{Mesh, Model, Reference};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Components inside components, at most: more are a circle.
const MOST_DEEP: usize = 64;
/// Placements and faces that an archive may have for nothing, and for each byte of its models: an
/// object may be placed any number of times, so that a small file could ask for terabytes.
const FREE_PLACEMENTS: usize = 1 << 14;
const FREE_FACES: usize = 1 << 19;
const FACES_PER_BYTE: usize = 4;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, ParseError> {
    let mut archive = Archive::open(bytes)?;
    let root = archive.root_model()?;
    let mut models = HashMap::new();
    let mut open = vec![root.clone()];
    while let Some(part) = open.pop() {
        if let Entry::Vacant(place) = models.entry(part) {
            let model = archive.model(place.key())?;
            open.extend(model.other_parts().map(str::to_owned));
            place.insert(model);
        }
    }
    let mut plate = Plate::new(&models, archive.bytes_read());
    let main = &models[&root];
    if main.items.is_empty() {
        plate.notes.push(Note::info("the file has nothing to build; its objects are taken as they lie"));
        for id in main.top_objects() {
            plate.place(&root, &Reference { part: None, object: id, transform: DAffine3::IDENTITY })?;
        }
    }
    for item in &main.items {
        plate.place(&root, item)?;
    }
    plate.notes.extend(main.notes.iter().cloned());
    plate.into_soup(main.metres_per_unit)
}

/// The build as far as it has been put together.
struct Plate<'m> {
    models: &'m HashMap<String, Model>,
    bytes: usize,
    placements: usize,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    bodies: Vec<Group>,
    out_of_range: usize,
    notes: Vec<Note>,
}

impl<'m> Plate<'m> {
    fn new(models: &'m HashMap<String, Model>, bytes: usize) -> Self {
        Plate {
            models,
            bytes,
            placements: 0,
            positions: Vec::new(),
            triangles: Vec::new(),
            bodies: Vec::new(),
            out_of_range: 0,
            notes: Vec::new(),
        }
    }

    /// Places an object and all that it is composed of.
    fn place(&mut self, part: &'m str, item: &Reference) -> Result<(), ParseError> {
        let models = self.models;
        let find = |part: &'m str, reference: &Reference| -> Result<(&'m str, &'m model::Object), ParseError> {
            let part = match &reference.part {
                Some(other) => models.get_key_value(other).map_or(part, |(name, _)| name.as_str()),
                None => part,
            };
            let object = models.get(part).and_then(|model| model.objects.get(&reference.object));
            let missing = || ParseError::file(format!("{part}: there is no object {}", reference.object));
            object.map(|object| (part, object)).ok_or_else(missing)
        };
        let (part, object) = find(part, item)?;
        let mut open = vec![(part, object, item.transform, 0)];
        while let Some((part, object, transform, depth)) = open.pop() {
            self.placements += 1;
            if depth > MOST_DEEP {
                let what = format!("components lie more than {MOST_DEEP} deep in one another, or in themselves");
                return Err(ParseError::file(format!("{part}: {what}")));
            }
            if self.placements > FREE_PLACEMENTS.max(self.bytes / 8) {
                return Err(ParseError::file(format!("{part}: components multiply to too many objects")));
            }
            self.add(part, &object.name, &object.mesh, transform)?;
            // From the last to the first, so that the first comes off the stack first.
            for component in object.components.iter().rev() {
                let (part, object) = find(part, component)?;
                open.push((part, object, transform * component.transform, depth + 1));
            }
        }
        Ok(())
    }

    fn add(&mut self, part: &str, name: &str, mesh: &Mesh, transform: DAffine3) -> Result<(), ParseError> {
        let most = MAX_FACES.min(FREE_FACES.max(self.bytes.saturating_mul(FACES_PER_BYTE)));
        let faces = self.triangles.len() + mesh.triangles.len();
        let vertices = self.positions.len() + mesh.positions.len();
        if faces.max(vertices) > most {
            let what = format!("copies of its objects add up to {faces} faces and {vertices} vertices or more");
            return Err(ParseError::file(format!("{part}: {what}")));
        }
        let (first_face, first, count) = (self.triangles.len(), self.positions.len() as u32, mesh.positions.len());
        // A mirror turns the faces over, so that what was outside would be inside.
        let mirrored = transform.matrix3.determinant() < 0.0;
        for &corners in &mesh.triangles {
            if corners.iter().all(|&c| (c as usize) < count) {
                let [a, b, c] = corners.map(|c| first + c);
                self.triangles.push(if mirrored { [a, c, b] } else { [a, b, c] });
            }
        }
        self.out_of_range += mesh.triangles.len() - (self.triangles.len() - first_face);
        if self.triangles.len() == first_face {
            return Ok(());
        }
        let placed = mesh.positions.iter().map(|&p| transform.transform_point3(DVec3::from_array(p)).to_array());
        self.positions.extend(placed);
        let faces = first_face as u32..self.triangles.len() as u32;
        self.bodies.push(Group { name: name.to_owned(), faces });
        Ok(())
    }

    fn into_soup(mut self, metres_per_unit: f64) -> Result<Soup, ParseError> {
        if self.triangles.is_empty() {
            return Err(ParseError::file("there are no triangles to build"));
        }
        if self.out_of_range > 0 {
            let what = format!("triangles left out for a vertex number out of range: {}", self.out_of_range);
            self.notes.push(Note::repaired(what));
        }
        // Positions are placed already: the nodes only say what lies side by side.
        let node = |(body, group): (usize, &Group)| Node {
            name: group.name.clone(),
            transform: Transform::Parts { translation: None, rotation: None, scale: None },
            body: Some(body),
            children: Vec::new(),
        };
        let nodes: Vec<Node> = self.bodies.iter().enumerate().map(node).collect();
        let mut soup = Soup::new(Positions::F64(self.positions), self.triangles);
        soup.groups = self.bodies.clone();
        soup.bodies = self.bodies;
        soup.scene = Some(Scene { roots: (0..nodes.len()).collect(), nodes, ..Scene::default() });
        soup.notes = self.notes;
        soup.metres_per_unit = Some(metres_per_unit);
        Ok(soup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write};
    use zip::write::SimpleFileOptions;

    const MESH: &str = "<mesh><vertices><vertex x='0' y='0' z='0'/><vertex x='1' y='0' z='0'/><vertex x='0' y='1' z='0'/></vertices><triangles><triangle v1='0' v2='1' v3='2'/></triangles></mesh>";

    fn zip_of(files: &[(&str, &str)]) -> Vec<u8> {
        let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in files {
            writer.start_file(*name, SimpleFileOptions::default()).expect("a new file");
            writer.write_all(content.as_bytes()).expect("a vector takes all");
        }
        writer.finish().expect("a vector takes all").into_inner()
    }

    fn model(objects: &str, items: &str) -> String {
        format!(
            "<?xml version='1.0' encoding='UTF-8'?><model unit='inch' xmlns='x' xmlns:p='y'><metadata name='Title'>a &lt; b</metadata><resources>{objects}</resources><build>{items}</build></model>"
        )
    }

    fn read_model(objects: &str, items: &str) -> Result<Soup, ParseError> {
        read(&zip_of(&[("3D/3dmodel.model", &model(objects, items))]))
    }

    #[test]
    fn items_and_components_are_placed() {
        let objects = format!(
            "<object id='1' name='a &amp; b' type='model'>{MESH}</object><object id='7'><components><component objectid='1' transform='0 1 0 -1 0 0 0 0 1 5 0 0'/><component objectid='1'/></components></object>"
        );
        let soup = read_model(&objects, "<item objectid='7' transform='2 0 0 0 2 0 0 0 2 0 0 3'/><item objectid='1' transform='-1 0 0 0 1 0 0 0 1 0 0 0'/>")
            .expect("readable");
        let corners: Vec<_> =
            soup.triangles.as_flattened().iter().map(|&c| soup.positions.get(c as usize).to_array()).collect();
        // Turned by a right angle and moved by 5, doubled and lifted by 3; doubled and lifted; mirrored.
        let expected = [
            [10.0, 0.0, 3.0],
            [10.0, 2.0, 3.0],
            [8.0, 0.0, 3.0],
            [0.0, 0.0, 3.0],
            [2.0, 0.0, 3.0],
            [0.0, 2.0, 3.0],
            [0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [-1.0, 0.0, 0.0],
        ];
        assert_eq!(corners, expected);
        assert_eq!(soup.bodies.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["a & b"; 3]);
        assert_eq!(soup.metres_per_unit, Some(0.0254));
        assert!(soup.notes.is_empty());
    }

    #[test]
    fn objects_may_lie_in_parts_of_their_own() {
        let rels = "<Relationships xmlns='r'><Relationship Target='/Other/main.model' Id='1' Type='http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel'/></Relationships>";
        let part = model(&format!("<object id='3'>{MESH}</object>"), "");
        let main = model(
            "<object id='3'><components><component p:path='/3D/Objects/a.model' objectid='3'/></components></object>",
            "<item objectid='3'/><item p:path='/3D/Objects/a.model' objectid='3'/>",
        );
        let soup = read(&zip_of(&[("_rels/.rels", rels), ("Other/main.model", &main), ("3D/Objects/a.model", &part)]));
        assert_eq!(soup.expect("readable").face_count(), 2);
    }

    #[test]
    fn without_a_build_the_objects_are_taken() {
        let soup = read_model(
            &format!(
                "<object id='1'>{MESH}</object><object id='2'><components><component objectid='1'/></components></object>"
            ),
            "",
        );
        let soup = soup.expect("readable");
        assert_eq!((soup.face_count(), soup.notes.len(), soup.notes[0].repaired), (1, 1, false));
    }

    #[test]
    fn circles_and_multiplying_components_are_errors() {
        let within = |id: u32, of: u32, times: usize| {
            format!(
                "<object id='{id}'><components>{}</components></object>",
                format!("<component objectid='{of}'/>").repeat(times)
            )
        };
        let error = read_model(&within(1, 1, 1), "<item objectid='1'/>").expect_err("a circle").to_string();
        assert!(error.contains("in themselves"), "{error}");
        let mut objects = format!("<object id='0'>{MESH}</object>");
        for id in 1..30 {
            objects += &within(id, id - 1, 10);
        }
        let error = read_model(&objects, "<item objectid='29'/>").expect_err("too many").to_string();
        assert!(error.contains("multiply"), "{error}");
    }

    /// Vertices that no triangle names are copied with every placement, too.
    #[test]
    fn copies_of_many_vertices_are_an_error() {
        let vertices = "<vertex x='0' y='0' z='0'/>".repeat(20_000);
        let object =
            format!("<object id='1'>{}</object>", MESH.replacen("<vertices>", &format!("<vertices>{vertices}"), 1));
        let error = read_model(&object, &"<item objectid='1'/>".repeat(1000)).expect_err("too many").to_string();
        assert!(error.contains("vertices or more"), "{error}");
    }

    #[test]
    fn mistakes_are_told() {
        let object = format!("<object id='1'>{MESH}</object>");
        for (objects, items, message) in [
            (object.as_str(), "<item objectid='2'/>", "there is no object 2"),
            (&object, "<item objectid='1' transform='1 0 0'/>", "twelve numbers"),
            (&object, "<item transform='1 0 0 0 1 0 0 0 1 0 0 0'/>", "objectid"),
            (&object.replace("x='1'", "x='one'"), "<item objectid='1'/>", "\"one\" is no number"),
            (&object.replace("v2='1'", "v2='-1'"), "<item objectid='1'/>", "\"-1\" is no vertex number"),
            (&object.replace("v2='1'", "v2='3'"), "<item objectid='1'/>", "no triangles"),
            (&object.replace("</mesh>", "</mash>"), "<item objectid='1'/>", "byte"),
        ] {
            let error = read_model(objects, items).expect_err(message).to_string();
            assert!(error.contains(message), "{error}");
        }
        assert!(read(&zip_of(&[("a.txt", "x")])).expect_err("no model").to_string().contains("no 3D model"));
        assert!(read(b"PK\x03\x04").expect_err("cut").to_string().contains("ZIP"));
    }

    #[test]
    fn an_archive_cut_anywhere_is_an_error() {
        let whole =
            zip_of(&[("3D/3dmodel.model", &model(&format!("<object id='1'>{MESH}</object>"), "<item objectid='1'/>"))]);
        for end in 0..whole.len() {
            read(&whole[..end]).expect_err("cut");
        }
    }

    /// Found by a fuzzer: a part's name with an end of line in it.
    #[test]
    fn a_part_with_a_control_character_in_its_name_gives_one_line() {
        let error = read(&zip_of(&[("3D/a\nb.model", "<model>")])).expect_err("no end").to_string();
        assert!(error.starts_with("3D/a?b.model, byte 7: ") && error.lines().count() == 1, "{error}");
    }

    #[test]
    fn a_bomb_is_refused() {
        let bomb = model(&" ".repeat(80 << 20), "");
        let bytes = zip_of(&[("3D/3dmodel.model", &bomb)]);
        assert!(bytes.len() < 200_000);
        assert!(read(&bytes).expect_err("a bomb").to_string().contains("expands to more than"));
    }
}
