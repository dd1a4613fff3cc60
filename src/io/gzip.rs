//! Input compressed with gzip.

use crate::error::ParseError;
use flate2::bufread::GzDecoder;
use std::io::Read;

/// What a compressed file may always expand to: the same few faces over and over, which compress best,
/// would be two million of them.
const FREE: u64 = 8 << 20;
/// Beyond that, bytes for each compressed byte. Text of meshes shrinks to a fifth or a tenth; a
/// thousandth, gzip's best, is not reached by anything worth reading.
const MOST_EXPANSION: u64 = 50;

pub(super) fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b, 8])
}

/// All members of a gzip file, one after another.
pub(super) fn decompress(bytes: &[u8]) -> Result<Vec<u8>, ParseError> {
    let limit = FREE.max((bytes.len() as u64).saturating_mul(MOST_EXPANSION));
    let mut out = Vec::new();
    let mut rest = bytes;
    while is_gzip(rest) {
        let left = limit - out.len() as u64;
        let mut member = GzDecoder::new(rest);
        (&mut member).take(left + 1).read_to_end(&mut out).map_err(|error| {
            let at = (bytes.len() - member.get_ref().len()) as u64;
            ParseError::byte(at, format!("the gzip data cannot be decompressed: {error}; it may be cut short"))
        })?;
        if out.len() as u64 > limit {
            return Err(ParseError::file(format!(
                "the gzip data expands to more than {limit} bytes, which no mesh of its size does; decompress it yourself if it is to be trusted"
            )));
        }
        // Padding behind the last member is nobody's mesh.
        rest = member.into_inner();
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::{Compression, write::GzEncoder};
    use std::io::Write;

    fn gzip(content: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(content).expect("a vector takes all");
        encoder.finish().expect("a vector takes all")
    }

    #[test]
    fn members_and_padding_are_understood() {
        let bytes = [gzip(b"one "), gzip(b"two"), vec![0; 100]].concat();
        assert_eq!(decompress(&bytes).expect("sound"), b"one two");
    }

    #[test]
    fn a_cut_or_damaged_file_is_an_error() {
        let content: Vec<u8> = (0..5000_u32).flat_map(|i| (i * i).to_le_bytes()).collect();
        let whole = gzip(&content);
        for end in [12, 100, whole.len() - 1] {
            assert!(decompress(&whole[..end]).expect_err("cut").to_string().contains("cut short"));
        }
        let mut damaged = whole;
        let at = damaged.len() - 6;
        damaged[at] ^= 1;
        decompress(&damaged).expect_err("the checksum is wrong");
    }

    #[test]
    fn a_bomb_is_refused() {
        let bomb = gzip(&vec![0; 70 << 20]);
        assert!(bomb.len() < 100_000);
        assert!(decompress(&bomb).expect_err("a bomb").to_string().contains("expands to more than"));
    }
}
