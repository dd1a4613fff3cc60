//! The bytes behind a URI: data, or a file that may be read.

use crate::io::folders::Folders;
use base64::Engine;
use base64::engine::general_purpose::{GeneralPurpose, PAD_INDIFFERENT};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

pub(super) fn is_data(uri: &str) -> bool {
    uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"))
}

/// The bytes behind a URI, or why there are none.
pub(super) fn load<'a>(uri: &'a str, folders: Folders<'_>) -> Result<Cow<'a, [u8]>, String> {
    if is_data(uri) {
        return decode_data_uri(uri);
    }
    let file = find_external(uri, folders)?;
    read_external(uri, &file).map(Cow::Owned)
}

/// What a data URI holds. Its media type is nobody's business here.
pub(super) fn decode_data_uri(uri: &str) -> Result<Cow<'_, [u8]>, String> {
    /// Reads what sloppy encoders write: padding missing, bits left over in the last symbol.
    const BASE64: GeneralPurpose =
        GeneralPurpose::new(&base64::alphabet::STANDARD, PAD_INDIFFERENT.with_decode_allow_trailing_bits(true));

    let (header, content) = uri[5..].split_once(',').ok_or("the data URI has no comma before its data")?;
    let content: Cow<'_, [u8]> = percent_decode_str(content).into();
    let is_base64 = header.rsplit(';').next().is_some_and(|last| last.trim().eq_ignore_ascii_case("base64"));
    if !is_base64 {
        return Ok(content);
    }
    let bytes = if content.iter().any(u8::is_ascii_whitespace) {
        BASE64.decode(content.iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect::<Vec<u8>>())
    } else {
        BASE64.decode(content)
    };
    bytes.map(Cow::Owned).map_err(|error| format!("the base64 data cannot be decoded: {error}"))
}

/// As much of a URI as belongs into a message.
fn shown(uri: &str) -> String {
    uri.chars().take(80).collect()
}

/// Finds a file that must lie where a model's files may.
pub(super) fn find_external(uri: &str, folders: Folders<'_>) -> Result<PathBuf, String> {
    let cut = shown(uri);
    if has_scheme(uri) {
        return Err(format!("\"{cut}\" is not read: only paths relative to the model's folder are"));
    }
    let decoded = percent_decode_str(uri).decode_utf8().map_err(|_| format!("\"{cut}\" is not UTF-8"))?;
    folders.find(&decoded).map_err(|why| format!("\"{cut}\" {why}"))
}

pub(super) fn read_external(uri: &str, file: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(file).map_err(|error| format!("\"{}\" cannot be read: {error}", shown(uri)))
}

/// True for `http:`, `file:` and their like, Windows drive letters among them (RFC 3986, 3.1).
pub(super) fn has_scheme(uri: &str) -> bool {
    uri.split_once(':').is_some_and(|(scheme, _)| {
        scheme.starts_with(|c: char| c.is_ascii_alphabetic())
            && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn data_uris_are_decoded() {
        for (uri, expected) in [
            ("data:application/octet-stream;base64,AAEC/w==", &[0, 1, 2, 255][..]),
            ("data:application/gltf-buffer;base64,AAEC/w", &[0, 1, 2, 255]),
            ("DATA:;BASE64,AAEC/x==", &[0, 1, 2, 255]),
            ("data:;base64,AAEC%2Fw%3D%3D", &[0, 1, 2, 255]),
            ("data:;base64,AAEC\n /w==", &[0, 1, 2, 255]),
            ("data:text/plain;charset=utf-8,a%20b,%00c", b"a b,\0c"),
            ("data:,", b""),
        ] {
            assert_eq!(&*load(uri, Folders::default()).unwrap_or_else(|e| panic!("{uri}: {e}")), expected, "{uri}");
        }
        assert!(load("data:;base64", Folders::default()).expect_err("no comma").contains("comma"));
        assert!(load("data:;base64,A$", Folders::default()).expect_err("a dollar").contains("base64"));
    }

    #[test]
    fn external_files_are_found_by_their_decoded_name() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("sub")).expect("a folder");
        fs::write(folder.path().join("sub/my büffer#1.bin"), b"1234").expect("a file");
        for uri in ["sub/my%20b%C3%BCffer%231.bin", "./sub/my büffer#1.bin"] {
            assert_eq!(&*load(uri, Some(folder.path()).into()).unwrap_or_else(|e| panic!("{uri}: {e}")), b"1234");
        }
        let missing = load("none.bin", Some(folder.path()).into()).expect_err("missing");
        assert!(missing.contains("\"none.bin\" cannot be read: "), "{missing}");
        assert!(load("sub", Some(folder.path()).into()).expect_err("a folder").contains("not a file"));
        assert!(load("sub/x.bin", Folders::default()).expect_err("a stream").contains("stream"));
    }

    #[test]
    fn nothing_outside_the_folder_is_read() {
        let outer = tempfile::tempdir().expect("a folder");
        fs::write(outer.path().join("secret.bin"), b"1234").expect("a file");
        let folder = outer.path().join("model");
        fs::create_dir(&folder).expect("a folder");
        let absolute = outer.path().join("secret.bin").to_string_lossy().into_owned();
        for uri in [
            "../secret.bin",
            "%2e%2E/secret.bin",
            "..%2Fsecret.bin",
            "x/../../secret.bin",
            &absolute,
            &format!("file://{absolute}"),
            "https://example.org/a.bin",
            "C:\\a.bin",
        ] {
            let error = load(uri, Some(folder.as_path()).into()).expect_err(uri);
            assert!(error.contains("is not read"), "{uri}: {error}");
        }
        for uri in ["", ".", "a%00b", "%ff"] {
            load(uri, Some(folder.as_path()).into()).expect_err(uri);
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_only_inside_the_folder() {
        let outer = tempfile::tempdir().expect("a folder");
        fs::write(outer.path().join("secret.bin"), b"1234").expect("a file");
        let folder = outer.path().join("model");
        fs::create_dir(&folder).expect("a folder");
        fs::write(folder.join("own.bin"), b"own").expect("a file");
        std::os::unix::fs::symlink("own.bin", folder.join("inside.bin")).expect("a link");
        std::os::unix::fs::symlink("../secret.bin", folder.join("outside.bin")).expect("a link");
        std::os::unix::fs::symlink(outer.path(), folder.join("up")).expect("a link");
        assert_eq!(&*load("inside.bin", Some(folder.as_path()).into()).expect("inside"), b"own");
        for uri in ["outside.bin", "up/secret.bin"] {
            assert!(load(uri, Some(folder.as_path()).into()).expect_err(uri).contains("leads out"));
        }
    }
}
