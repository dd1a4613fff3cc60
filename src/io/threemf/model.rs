//! The XML of one model part: objects, components and build items.

use super::archive::broken;
use crate::error::ParseError;
use crate::io::text;
use crate::soup::{Note, short_name};
use glam::{DAffine3, DMat3, DVec3};
use quick_xml::Reader;
use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;
use std::io::BufRead;

/// Vertices and triangles of an object; indices are not checked yet.
#[derive(Default)]
pub(super) struct Mesh {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// An object: a mesh, or other objects in their places.
#[derive(Default)]
pub(super) struct Object {
    pub(super) name: String,
    pub(super) mesh: Mesh,
    pub(super) components: Vec<Reference>,
}

/// An object placed: a build item or a component.
pub(super) struct Reference {
    /// The part that the object is in, where it is another one.
    pub(super) part: Option<String>,
    pub(super) object: u32,
    pub(super) transform: DAffine3,
}

/// A model part.
pub(super) struct Model {
    pub(super) metres_per_unit: f64,
    pub(super) objects: BTreeMap<u32, Object>,
    pub(super) items: Vec<Reference>,
    pub(super) notes: Vec<Note>,
}

/// Extensions that a file may require without a word: they leave meshes alone, or are read.
const HARMLESS: [&str; 4] = ["/production/", "/material/", "/slice/", "/trianglesets/"];

impl Model {
    pub(super) fn references_mut(&mut self) -> impl Iterator<Item = &mut Reference> {
        self.objects.values_mut().flat_map(|object| &mut object.components).chain(&mut self.items)
    }

    /// Other parts that objects of this one come from.
    pub(super) fn other_parts(&self) -> impl Iterator<Item = &str> {
        let components = self.objects.values().flat_map(|object| &object.components);
        components.chain(&self.items).filter_map(|reference| reference.part.as_deref())
    }

    /// Objects that are no component of another one.
    pub(super) fn top_objects(&self) -> Vec<u32> {
        let mut top = self.objects.keys().copied().collect::<std::collections::BTreeSet<u32>>();
        for component in self.objects.values().flat_map(|object| &object.components) {
            top.remove(&component.object);
        }
        top.into_iter().collect()
    }

    pub(super) fn parse(reader: &mut Reader<&mut dyn BufRead>, part: &str) -> Result<Self, ParseError> {
        let mut model =
            Model { metres_per_unit: 0.001, objects: BTreeMap::new(), items: Vec::new(), notes: Vec::new() };
        let mut current: Option<(u32, Object)> = None;
        let mut buffer = Vec::new();
        let (mut is_model, mut depth) = (false, 0_usize);
        loop {
            let event = reader.read_event_into(&mut buffer).map_err(|error| broken(part, reader, &error))?;
            let at = |what: String| xml_error(part, reader.buffer_position(), &what);
            match event {
                Event::Eof => break,
                Event::Start(ref element) | Event::Empty(ref element) => {
                    let is_empty = matches!(event, Event::Empty(_));
                    depth += usize::from(!is_empty);
                    match local(element.name().as_ref()) {
                        "vertex" => {
                            if let Some((_, object)) = &mut current {
                                object.mesh.positions.push(vertex(element).map_err(at)?);
                            }
                        }
                        "triangle" => {
                            if let Some((_, object)) = &mut current {
                                object.mesh.triangles.push(triangle(element).map_err(at)?);
                            }
                        }
                        "object" => {
                            let object = Object { name: name_of(element), ..Object::default() };
                            current = Some((id_of(element, "id").map_err(at)?, object));
                            if is_empty {
                                model.objects.extend(current.take());
                            }
                        }
                        "component" => {
                            if let Some((_, object)) = &mut current {
                                object.components.push(reference(element).map_err(at)?);
                            }
                        }
                        "item" => model.items.push(reference(element).map_err(at)?),
                        "model" => {
                            is_model = true;
                            model.look_at_head(element).map_err(at)?;
                        }
                        _ => {}
                    }
                }
                Event::End(element) => {
                    depth = depth.saturating_sub(1);
                    if local(element.name().as_ref()) == "object" {
                        model.objects.extend(current.take());
                    }
                }
                // Entities of its own would let a small text grow without end; 3MF forbids them.
                Event::DocType(_) => return Err(at("a document type is not allowed in 3MF".into())),
                _ => {}
            }
            buffer.clear();
        }
        if !is_model || depth > 0 {
            return Err(xml_error(part, reader.buffer_position(), "the XML ends before its model does"));
        }
        Ok(model)
    }

    /// Unit and required extensions.
    fn look_at_head(&mut self, element: &BytesStart<'_>) -> Result<(), String> {
        let mut required = String::new();
        let mut spaces = BTreeMap::new();
        for attribute in attributes(element) {
            let value = attribute.value.clone().into_owned();
            match attribute.key.as_ref() {
                "unit" => {
                    self.metres_per_unit = match value.as_str() {
                        "micron" => 1e-6,
                        "millimeter" => 0.001,
                        "centimeter" => 0.01,
                        "inch" => 0.0254,
                        "foot" => 0.3048,
                        "meter" => 1.0,
                        _ => return Err(format!("{} is no unit of 3MF", text::quoted(value.as_bytes()))),
                    };
                }
                "requiredextensions" => required = value,
                key => {
                    if let Some(prefix) = key.strip_prefix("xmlns:") {
                        spaces.insert(prefix.to_owned(), value);
                    }
                }
            }
        }
        for prefix in required.split_whitespace().take(16) {
            let space = spaces.get(prefix).map_or(prefix, String::as_str);
            if !HARMLESS.iter().any(|known| space.contains(known)) {
                let name = text::quoted(space.as_bytes());
                self.notes.push(Note::repaired(format!("the required extension {name} is not known and was ignored")));
            }
        }
        Ok(())
    }
}

/// The name of an element or attribute without its prefix.
pub(super) fn local(name: &str) -> &str {
    name.rsplit_once(':').map_or(name, |(_, local)| local)
}

pub(super) fn xml_error(part: &str, at: u64, what: &str) -> ParseError {
    ParseError::file(format!("{part}, byte {at}: {what}"))
}

/// The attributes that can be read; whether one stands there twice is nobody's business.
pub(super) fn attributes<'e>(element: &'e BytesStart<'_>) -> impl Iterator<Item = Attribute<'e>> {
    let mut attributes = element.attributes();
    attributes.with_checks(false);
    attributes.flatten()
}

fn vertex(element: &BytesStart<'_>) -> Result<[f64; 3], String> {
    let mut point = [None; 3];
    for attribute in attributes(element) {
        if let [axis @ b'x'..=b'z'] = *attribute.key.as_ref().as_bytes() {
            let value = text::number(attribute.value.trim().as_bytes());
            let value = value.ok_or_else(|| format!("{} is no number", text::quoted(attribute.value.as_bytes())))?;
            point[usize::from(axis - b'x')] = Some(value);
        }
    }
    match point {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => Err("a vertex lacks one of x, y and z".into()),
    }
}

fn triangle(element: &BytesStart<'_>) -> Result<[u32; 3], String> {
    let mut corners = [None; 3];
    for attribute in attributes(element) {
        if let [b'v', digit @ b'1'..=b'3'] = *attribute.key.as_ref().as_bytes() {
            let value = text::count(attribute.value.trim().as_bytes());
            let value =
                value.ok_or_else(|| format!("{} is no vertex number", text::quoted(attribute.value.as_bytes())))?;
            corners[usize::from(digit - b'1')] = Some(value);
        }
    }
    match corners {
        [Some(a), Some(b), Some(c)] => Ok([a, b, c]),
        _ => Err("a triangle lacks one of v1, v2 and v3".into()),
    }
}

fn id_of(element: &BytesStart<'_>, key: &str) -> Result<u32, String> {
    let mut attributes = attributes(element);
    let value = attributes.find(|a| a.key.as_ref() == key).and_then(|a| text::count(a.value.trim().as_bytes()));
    value.ok_or_else(|| format!("the number {key} is missing or no number"))
}

fn name_of(element: &BytesStart<'_>) -> String {
    let mut attributes = attributes(element);
    let name = attributes.find(|a| a.key.as_ref() == "name").map(|a| a.value.into_owned()).unwrap_or_default();
    let name = quick_xml::escape::unescape(&name).map(|plain| plain.into_owned()).unwrap_or(name);
    short_name(&name).to_owned()
}

fn reference(element: &BytesStart<'_>) -> Result<Reference, String> {
    let mut transform = DAffine3::IDENTITY;
    let mut part = None;
    for attribute in attributes(element) {
        match local(attribute.key.as_ref()) {
            "transform" => transform = affine(attribute.value.as_bytes())?,
            "path" => part = Some(attribute.value.into_owned()),
            _ => {}
        }
    }
    Ok(Reference { part, object: id_of(element, "objectid")?, transform })
}

/// Twelve numbers, row by row of a matrix that row vectors are multiplied with.
fn affine(value: &[u8]) -> Result<DAffine3, String> {
    let numbers: Vec<f64> = text::words(value).map_while(text::number).take(13).collect();
    let numbers: [f64; 12] =
        numbers.try_into().map_err(|_| format!("a transform has twelve numbers, not {}", text::quoted(value)))?;
    let row = |i: usize| DVec3::new(numbers[i], numbers[i + 1], numbers[i + 2]);
    Ok(DAffine3 { matrix3: DMat3::from_cols(row(0), row(3), row(6)), translation: row(9) })
}
