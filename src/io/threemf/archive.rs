//! The ZIP archive around the models, and what its parts may expand to.

use super::model::{Model, attributes, local, xml_error};
use crate::error::ParseError;
use crate::io::text;
use quick_xml::Reader;
use quick_xml::events::Event;
use std::borrow::Cow;
use std::collections::HashMap;
use std::io::{BufRead, BufReader, Cursor, Read};
use zip::ZipArchive;

/// What the parts may always expand to together, and beyond that for each byte of the archive.
const FREE: u64 = 8 << 20;
const MOST_EXPANSION: u64 = 50;

pub(super) struct Archive<'b> {
    zip: ZipArchive<Cursor<&'b [u8]>>,
    /// The names of all parts, in the archive's order.
    names: Vec<String>,
    /// Where they stand in it, by their own spelling and in small letters. The archive's own look-up
    /// goes through all of them.
    places: HashMap<String, usize>,
    limit: u64,
    read: u64,
}

impl<'b> Archive<'b> {
    pub(super) fn open(bytes: &'b [u8]) -> Result<Self, ParseError> {
        let zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
            ParseError::file(format!("the ZIP archive cannot be read: {error}; it may be cut short"))
        })?;
        let name = |name: Result<Cow<'_, str>, _>| name.map(Cow::into_owned).unwrap_or_default();
        let names: Vec<String> = zip.file_names().map(name).collect();
        let mut places: HashMap<String, usize> =
            names.iter().enumerate().map(|(place, name)| (name.to_ascii_lowercase(), place)).collect();
        places.extend(names.iter().cloned().zip(0..));
        let limit = FREE.max((bytes.len() as u64).saturating_mul(MOST_EXPANSION));
        Ok(Archive { zip, names, places, limit, read: 0 })
    }

    /// Bytes of XML read so far.
    pub(super) fn bytes_read(&self) -> usize {
        usize::try_from(self.read).unwrap_or(usize::MAX)
    }

    /// The name of the part that the archive says is its model.
    pub(super) fn root_model(&mut self) -> Result<String, ParseError> {
        let mut target = None;
        if let Some(name) = self.name_of("_rels/.rels") {
            self.parse(&name, |reader| {
                let mut buffer = Vec::new();
                loop {
                    match reader.read_event_into(&mut buffer) {
                        Ok(Event::Eof) => return Ok(()),
                        Ok(Event::Start(e) | Event::Empty(e)) if local(e.name().as_ref()) == "Relationship" => {
                            let mut kind = false;
                            let mut to = None;
                            for attribute in attributes(&e) {
                                match attribute.key.as_ref() {
                                    "Type" => kind = attribute.value.ends_with("/3dmodel"),
                                    "Target" => to = Some(attribute.value.into_owned()),
                                    _ => {}
                                }
                            }
                            target = target.take().or(to.filter(|_| kind));
                        }
                        Ok(_) => {}
                        // A model with a broken list of contents may still be found by its name.
                        Err(_) => return Ok(()),
                    }
                    buffer.clear();
                }
            })?;
        }
        let known = target.and_then(|target| self.name_of(&target)).or_else(|| self.name_of("3D/3dmodel.model"));
        let models = self.names.iter().filter(|name| name.to_ascii_lowercase().ends_with(".model"));
        let any = || models.min().cloned();
        known.or_else(any).ok_or_else(|| {
            ParseError::file(
                "the ZIP archive has no 3D model in it, so it is not 3MF; unpack it and name the mesh file",
            )
        })
    }

    /// A model part, with the names of other parts as the archive has them.
    pub(super) fn model(&mut self, part: &str) -> Result<Model, ParseError> {
        let mut model = self.parse(part, |reader| Model::parse(reader, part))?;
        for reference in model.references_mut() {
            if let Some(path) = &reference.part {
                let found = self.name_of(path);
                reference.part = Some(found.ok_or_else(|| {
                    ParseError::file(format!(
                        "{part}: there is no part {} in the archive",
                        text::quoted(path.as_bytes())
                    ))
                })?);
            }
        }
        Ok(model)
    }

    /// The archive's own spelling of a part's name, which begins with a slash and has any case.
    fn name_of(&self, path: &str) -> Option<String> {
        let path = path.trim_start_matches('/');
        let place = self.places.get(path).or_else(|| self.places.get(&path.to_ascii_lowercase()))?;
        self.names.get(*place).cloned()
    }

    fn parse<T>(
        &mut self,
        part: &str,
        parse: impl FnOnce(&mut Reader<&mut dyn BufRead>) -> Result<T, ParseError>,
    ) -> Result<T, ParseError> {
        let left = self.limit - self.read;
        let failed = |error| ParseError::file(format!("{part}: cannot be unpacked: {error}"));
        let place = self.places.get(part).copied().unwrap_or(usize::MAX);
        let file = self.zip.by_index(place).map_err(failed)?;
        let mut stream = BufReader::with_capacity(1 << 16, file.take(left + 1));
        let mut reader = Reader::from_reader(&mut stream as &mut dyn BufRead);
        let result = parse(&mut reader);
        let read = left + 1 - stream.get_ref().limit();
        if read > left {
            let what = format!("expands to more than {} bytes, which no model of the file's size does", self.limit);
            return Err(ParseError::file(format!("{part}: {what}; unpack it yourself if it is to be trusted")));
        }
        self.read += read;
        result
    }
}

/// Names the part and the place in it where the XML is broken.
pub(super) fn broken(part: &str, reader: &Reader<&mut dyn BufRead>, error: &quick_xml::Error) -> ParseError {
    xml_error(part, reader.error_position(), &error.to_string())
}
