//! The header of a PLY file and the values behind it, in any encoding.

use crate::error::ParseError;
use crate::io::text::{self, Lines, Words};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Scalar::I8,
            b"uchar" | b"uint8" => Scalar::U8,
            b"short" | b"int16" => Scalar::I16,
            b"ushort" | b"uint16" => Scalar::U16,
            b"int" | b"int32" => Scalar::I32,
            b"uint" | b"uint32" => Scalar::U32,
            b"int64" => Scalar::I64,
            b"uint64" => Scalar::U64,
            b"float" | b"float32" => Scalar::F32,
            b"double" | b"float64" => Scalar::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// A value of this type; whole numbers are exact up to 2^53. `raw` has [`Scalar::size`] bytes.
    #[inline]
    pub(super) fn decode(self, raw: &[u8], big: bool) -> f64 {
        let mut w = [0; 8];
        let size = raw.len().min(8);
        w[..size].copy_from_slice(&raw[..size]);
        if big {
            w[..size].reverse();
        }
        match self {
            Scalar::I8 => i8::from_le_bytes([w[0]]).into(),
            Scalar::U8 => w[0].into(),
            Scalar::I16 => i16::from_le_bytes([w[0], w[1]]).into(),
            Scalar::U16 => u16::from_le_bytes([w[0], w[1]]).into(),
            Scalar::I32 => i32::from_le_bytes([w[0], w[1], w[2], w[3]]).into(),
            Scalar::U32 => u32::from_le_bytes([w[0], w[1], w[2], w[3]]).into(),
            Scalar::I64 => i64::from_le_bytes(w) as f64,
            Scalar::U64 => u64::from_le_bytes(w) as f64,
            Scalar::F32 => f32::from_le_bytes([w[0], w[1], w[2], w[3]]).into(),
            Scalar::F64 => f64::from_le_bytes(w),
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub(super) name: Vec<u8>,
    /// The type of the count in front of a list.
    pub(super) list: Option<Scalar>,
    pub(super) scalar: Scalar,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: Vec<u8>,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Encoding {
    Ascii,
    Little,
    Big,
}

pub(super) fn header(bytes: &[u8]) -> Result<(Encoding, Vec<Element>, Values<'_>), ParseError> {
    let mut lines = Lines::new(bytes);
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut last = 0;
    while let Some((line, content)) = lines.next() {
        last = line;
        let words: Vec<&[u8]> = text::words(content).take(5).collect();
        let bad = || ParseError::line(line, format!("{} is no header line of a PLY file", text::quoted(content)));
        match *words.as_slice() {
            [] | [b"ply" | b"comment" | b"obj_info", ..] => {}
            [b"format", name, ..] => {
                encoding = Some(match name {
                    b"ascii" => Encoding::Ascii,
                    b"binary_little_endian" => Encoding::Little,
                    b"binary_big_endian" => Encoding::Big,
                    _ => return Err(bad()),
                });
            }
            [b"element", name, count, ..] => {
                let count = std::str::from_utf8(count).ok().and_then(|s| s.parse().ok()).ok_or_else(bad)?;
                elements.push(Element { name: name.to_vec(), count, properties: Vec::new() });
            }
            [b"property", b"list", count, scalar, name] => {
                let list =
                    Some(Scalar::from_name(count).filter(|s| !matches!(s, Scalar::F32 | Scalar::F64)).ok_or_else(bad)?);
                let scalar = Scalar::from_name(scalar).ok_or_else(bad)?;
                elements.last_mut().ok_or_else(bad)?.properties.push(Property { name: name.to_vec(), list, scalar });
            }
            [b"property", scalar, name, ..] => {
                let scalar = Scalar::from_name(scalar).ok_or_else(bad)?;
                elements.last_mut().ok_or_else(bad)?.properties.push(Property {
                    name: name.to_vec(),
                    list: None,
                    scalar,
                });
            }
            [b"end_header", ..] => {
                let encoding = encoding.ok_or_else(|| ParseError::line(line, "the header names no format"))?;
                let body = lines.rest();
                let mut at = bytes.len() - body.len();
                // Behind lines that end in CR alone, an LF is the first byte of the data.
                let is_cr_alone = matches!(bytes.trim_ascii_start(), [_, _, _, b'\r', next, ..] if *next != b'\n');
                if is_cr_alone && bytes[..at].ends_with(b"\r\n") {
                    at -= 1;
                }
                let values = match encoding {
                    Encoding::Ascii => Values::Ascii { lines, line, words: text::words(b"") },
                    _ => Values::Binary { bytes, at, big: encoding == Encoding::Big },
                };
                return Ok((encoding, elements, values));
            }
            _ => return Err(bad()),
        }
    }
    Err(ParseError::line(last, "the file ends inside the header"))
}

/// The values behind the header, one after another.
#[derive(Clone)]
pub(super) enum Values<'b> {
    Ascii { lines: Lines<'b>, line: u64, words: Words<'b> },
    Binary { bytes: &'b [u8], at: usize, big: bool },
}

impl Values<'_> {
    /// Bytes not yet read.
    fn left(&self) -> usize {
        match self {
            Values::Ascii { lines, words, .. } => words.rest().len() + lines.rest().len(),
            Values::Binary { bytes, at, .. } => bytes.len() - at,
        }
    }

    /// An error at the value last read.
    pub(super) fn error(&self, what: impl Into<String>) -> ParseError {
        match self {
            Values::Ascii { line, .. } => ParseError::line(*line, what),
            Values::Binary { at, .. } => ParseError::byte(*at as u64, what),
        }
    }

    /// Refuses an element that cannot fit into what is left of the file.
    pub(super) fn check(&self, element: &Element, encoding: Encoding) -> Result<(), ParseError> {
        let least: usize = match encoding {
            // A digit and a space.
            Encoding::Ascii => 2 * element.properties.len(),
            _ => element.properties.iter().map(|p| p.list.unwrap_or(p.scalar).size()).sum(),
        };
        let name = text::quoted(&element.name);
        if element.count > 0 && least == 0 {
            return Err(self.error(format!("the element {name} has no properties")));
        }
        // The last ASCII value may end with the file instead of a space.
        let fits = element.count.checked_mul(least as u64).is_some_and(|need| need <= self.left() as u64 + 1);
        if fits {
            return Ok(());
        }
        Err(self.error(format!(
            "the header promises {} {name} elements, but the file ends before; it is truncated or its header is wrong",
            element.count
        )))
    }

    pub(super) fn next(&mut self, scalar: Scalar) -> Result<f64, ParseError> {
        match self {
            Values::Ascii { lines, line, words } => loop {
                if words.rest().trim_ascii_start().is_empty() {
                    let Some((number, next)) = lines.next() else {
                        return Err(ParseError::line(*line, "the file ends before its last value"));
                    };
                    (*line, *words) = (number, text::words(next));
                    continue;
                }
                let mut here = *words;
                return words.number().ok_or_else(|| {
                    let word = here.next().unwrap_or_default();
                    ParseError::line(*line, format!("{} is no number", text::quoted(word)))
                });
            },
            Values::Binary { bytes, at, big } => {
                let size = scalar.size();
                let Some(raw) = bytes.get(*at..*at + size) else {
                    return Err(ParseError::byte(*at as u64, "the file ends before its last value"));
                };
                *at += size;
                Ok(scalar.decode(raw, *big))
            }
        }
    }

    /// All rows of a binary element without lists, with the bytes of each and their order;
    /// `None` for others.
    pub(super) fn rows(&mut self, element: &Element) -> Option<(&[u8], usize, bool)> {
        let Values::Binary { bytes, at, big } = self else { return None };
        if element.properties.iter().any(|property| property.list.is_some()) {
            return None;
        }
        let stride: usize = element.properties.iter().map(|property| property.scalar.size()).sum();
        let length = usize::try_from(element.count).ok()?.checked_mul(stride)?;
        let rows = bytes.get(*at..)?.get(..length)?;
        *at += length;
        Some((rows, stride, *big))
    }

    /// A whole number of at least 0, such as the length of a list.
    pub(super) fn next_count(&mut self, scalar: Scalar) -> Result<usize, ParseError> {
        let value = self.next(scalar)?;
        if value < 0.0 || value.fract() != 0.0 || value > self.left() as f64 {
            return Err(
                self.error(format!("a list of {value} values does not fit into the file, which may be truncated"))
            );
        }
        Ok(value as usize)
    }

    pub(super) fn skip(&mut self, property: &Property) -> Result<(), ParseError> {
        let count = match property.list {
            Some(scalar) => self.next_count(scalar)?,
            None => 1,
        };
        for _ in 0..count {
            self.next(property.scalar)?;
        }
        Ok(())
    }
}
