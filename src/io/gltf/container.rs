//! The chunks of a binary glTF file (GLB).

use crate::error::ParseError;
use crate::soup::Note;

const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// The chunks of a GLB that the specification knows; others are skipped.
#[derive(Debug, PartialEq)]
pub(super) struct Chunks<'a> {
    /// The document, without the padding after it.
    pub(super) json: &'a [u8],
    /// The data of the first buffer, up to three bytes of padding included.
    pub(super) bin: Option<&'a [u8]>,
}

/// True when the file begins as a GLB.
pub(super) fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Finds the chunks of a GLB.
///
/// Chunks are followed as far as the file goes, whatever length the header gives: streaming
/// exporters leave a zero there, and a wrong length does no harm as long as the chunks are whole.
pub(super) fn split<'a>(bytes: &'a [u8], notes: &mut Vec<Note>) -> Result<Chunks<'a>, ParseError> {
    let length = bytes.len();
    let (Some(version), Some(declared)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return Err(ParseError::byte(length as u64, "the file ends inside the 12 bytes of the GLB header"));
    };
    if version != 2 {
        return Err(ParseError::byte(4, format!("this is GLB version {version}; only version 2 can be read")));
    }
    let declared = u64::from(declared);
    if declared != length as u64 {
        notes.push(Note::repaired(format!("the GLB header says {declared} bytes, but the file has {length}")));
    }

    let mut json = None;
    let mut bin = None;
    let mut at = HEADER;
    while at < length {
        // What follows the declared end is somebody's padding unless it makes sense.
        let behind_the_end = json.is_some() && at as u64 >= declared;
        let (Some(size), Some(kind)) = (u32_at(bytes, at), u32_at(bytes, at + 4)) else {
            if behind_the_end {
                break;
            }
            return Err(ParseError::byte(at as u64, "the file ends inside a chunk header: it has been cut short"));
        };
        if json.is_none() && kind != JSON {
            return Err(ParseError::byte(at as u64, "the first chunk of a GLB must be JSON, and this one is not"));
        }
        let start = at + CHUNK_HEADER;
        let end = usize::try_from(size).ok().and_then(|size| start.checked_add(size));
        let Some((end, content)) = end.and_then(|end| Some((end, bytes.get(start..end)?))) else {
            if behind_the_end && kind != BIN {
                break;
            }
            return Err(ParseError::byte(
                at as u64,
                format!("the chunk says {size} bytes, but {} follow: the file has been cut short", length - start),
            ));
        };
        match kind {
            JSON if json.is_none() => json = Some(content),
            BIN if bin.is_none() => bin = Some(content),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or_else(|| ParseError::byte(length as u64, "the file ends before its JSON chunk"))?;
    Ok(Chunks { json: without_zeros(json), bin })
}

/// The specification pads JSON with spaces; some writers pad with zeros, which are no JSON.
fn without_zeros(json: &[u8]) -> &[u8] {
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &json[..end]
}

fn u32_at(bytes: &[u8], offset: usize) -> Option<u32> {
    bytes.get(offset..)?.first_chunk().map(|&b| u32::from_le_bytes(b))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A GLB of the given chunks, padded as the specification wants.
    pub(in crate::io::gltf) fn glb_of(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut body = Vec::new();
        for (kind, content) in chunks {
            let padded = content.len().next_multiple_of(4);
            body.extend(u32::try_from(padded).expect("small").to_le_bytes());
            body.extend(*kind);
            body.extend(*content);
            body.resize(body.len() + padded - content.len(), if *kind == b"JSON" { b' ' } else { 0 });
        }
        let mut file = MAGIC.to_vec();
        file.extend(2u32.to_le_bytes());
        file.extend(u32::try_from(HEADER + body.len()).expect("small").to_le_bytes());
        file.extend(body);
        file
    }

    fn split_quietly(bytes: &[u8]) -> Result<Chunks<'_>, ParseError> {
        split(bytes, &mut Vec::new())
    }

    #[test]
    fn unknown_chunks_are_skipped() {
        let file = glb_of(&[(b"JSON", b"{}"), (b"ABCD", b"1234"), (b"BIN\0", b"data"), (b"EFGH", b"")]);
        let mut notes = Vec::new();
        let chunks = split(&file, &mut notes).expect("readable");
        assert_eq!(chunks, Chunks { json: b"{}  ", bin: Some(b"data") });
        assert!(notes.is_empty());
    }

    #[test]
    fn a_glb_without_a_bin_chunk_is_whole() {
        assert_eq!(
            split_quietly(&glb_of(&[(b"JSON", b"{ }\0")])).expect("readable"),
            Chunks { json: b"{ }", bin: None }
        );
    }

    #[test]
    fn the_first_chunk_must_be_json() {
        let error = split_quietly(&glb_of(&[(b"BIN\0", b"data"), (b"JSON", b"{}")])).expect_err("BIN first");
        assert!(error.to_string().starts_with("byte 12: the first chunk"), "{error}");
    }

    #[test]
    fn another_version_is_refused() {
        let mut file = glb_of(&[(b"JSON", b"{}")]);
        file[4] = 1;
        assert!(split_quietly(&file).expect_err("version 1").to_string().contains("GLB version 1"));
    }

    #[test]
    fn a_wrong_total_length_is_noted_and_ignored() {
        let whole = glb_of(&[(b"JSON", b"{}"), (b"BIN\0", b"data")]);
        for wrong in [0u32, 12, 20, 1000, u32::MAX] {
            let mut file = whole.clone();
            file[8..12].copy_from_slice(&wrong.to_le_bytes());
            let mut notes = Vec::new();
            assert_eq!(split(&file, &mut notes).expect("readable").bin, Some(&b"data"[..]));
            assert!(notes.len() == 1 && notes[0].repaired);
        }
    }

    #[test]
    fn bytes_behind_the_declared_end_are_ignored() {
        let whole = glb_of(&[(b"JSON", b"{}"), (b"BIN\0", b"data")]);
        for tail in [&b"x"[..], b"\n\n\n\n\n\n\n\n\n", &[0xff; 40]] {
            let file = [&whole, tail].concat();
            let mut notes = Vec::new();
            assert_eq!(split(&file, &mut notes).expect("readable").bin, Some(&b"data"[..]));
            assert_eq!(notes.len(), 1);
        }
    }

    #[test]
    fn a_cut_file_names_the_place() {
        let whole = glb_of(&[(b"JSON", b"{}"), (b"BIN\0", b"data")]);
        for length in 4..whole.len() {
            match split_quietly(&whole[..length]) {
                Ok(chunks) => assert!(length == 24 && chunks.bin.is_none(), "only a cut between chunks may pass"),
                Err(error) => assert!(error.to_string().starts_with("byte "), "{error}"),
            }
        }
    }
}
