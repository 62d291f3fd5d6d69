//! The parts of a file: JSON and buffers, in one GLB or beside each other.

use super::super::read::read_file;
use super::super::{Fault, MeshErrorKind};
use super::bad;
use gltf::json::Root;
use std::ops::Range;
use std::path::{Component, Path};

/// The bytes of one glTF buffer: a range of a file.
pub(super) struct Buffer {
    file: Vec<u8>,
    range: Range<usize>,
}

impl Buffer {
    pub(super) fn bytes(&self) -> &[u8] {
        &self.file[self.range.clone()]
    }
}

/// Splits a GLB or glTF file into its JSON and its buffers, and loads those that lie beside it.
pub(super) fn open(bytes: Vec<u8>, folder: &Path) -> Result<(Root, Vec<Buffer>), Fault> {
    let (json, mut binary) =
        if bytes.starts_with(b"glTF") { split_glb(&bytes)? } else { (0..bytes.len(), None) };
    let root: Root = gltf::json::deserialize::from_slice(&bytes[json])
        .map_err(|error| bad(format!("JSON {error}")))?;
    check_extensions(&root)?;

    let mut file = Some(bytes);
    let mut buffers = Vec::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        let loaded = match &buffer.uri {
            Some(uri) => {
                let file = load_uri(uri, folder)?;
                Buffer { range: 0..file.len(), file }
            }
            None => match (index, binary.take(), file.take()) {
                (0, Some(range), Some(file)) => Buffer { file, range },
                _ => return Err(bad(format!("buffer {index} has no data"))),
            },
        };
        if (loaded.bytes().len() as u64) < buffer.byte_length.0 {
            let what = format!("glTF buffer {index} should have {} bytes", buffer.byte_length.0);
            return Err(MeshErrorKind::Truncated(what).into());
        }
        buffers.push(loaded);
    }
    Ok((root, buffers))
}

/// Finds the JSON chunk of a GLB file and, if there is one, its binary chunk.
fn split_glb(bytes: &[u8]) -> Result<(Range<usize>, Option<Range<usize>>), Fault> {
    let truncated = |what: &str| Fault::from(MeshErrorKind::Truncated(format!("in its {what}")));
    let word = |at: usize| {
        let bytes = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(truncated("GLB header"));
    };
    if version != 2 {
        return Err(bad(format!("GLB version {version} is not 2")));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(truncated("GLB chunks"));
    }
    // A chunk is its length, its kind and its bytes.
    let chunk = |at: usize, kind: &[u8; 4]| {
        let size = word(at)? as usize;
        let range = at + 8..(at + 8).checked_add(size)?;
        (bytes.get(at + 4..at + 8)? == kind && range.end <= length).then_some(range)
    };
    let json = chunk(12, b"JSON").ok_or_else(|| truncated("GLB's JSON chunk"))?;
    let binary_start = json.end.next_multiple_of(4);
    if binary_start >= length {
        return Ok((json, None));
    }
    let binary = chunk(binary_start, b"BIN\0").ok_or_else(|| truncated("GLB's binary chunk"))?;
    Ok((json, Some(binary)))
}

/// Refuses files that cannot be understood without an extension that is not supported here.
/// Materials, textures and lights are not carried in any case, whatever their extension.
fn check_extensions(root: &Root) -> Result<(), Fault> {
    let harmless = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"];
    for extension in &root.extensions_required {
        let known = extension == "KHR_mesh_quantization"
            || harmless.iter().any(|prefix| extension.starts_with(prefix));
        if !known {
            let what = format!("the file requires the glTF extension {}", extension.escape_debug());
            return Err(MeshErrorKind::Unsupported(what).into());
        }
    }
    Ok(())
}

/// The bytes behind a URI: base64 data in it, or a file below `folder`.
fn load_uri(uri: &str, folder: &Path) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded.as_bytes());
        return encoded
            .and_then(decode_base64)
            .ok_or_else(|| bad("a data URI is not valid base64"));
    }
    let name = decode_percent(uri).ok_or_else(|| bad("a buffer's URI is not valid"))?;
    let path = Path::new(&name);
    // A mesh file must not make us open devices or files elsewhere.
    let beside = path.components().all(|part| matches!(part, Component::Normal(_)));
    if !beside || uri.contains(':') || !folder.join(path).is_file() {
        let what = format!("the buffer {} is not a file beside it", uri.escape_debug());
        return Err(MeshErrorKind::Unsupported(what).into());
    }
    read_file(&folder.join(path)).map_err(|error| error.kind.into())
}

fn decode_percent(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [byte, tail @ ..] = rest {
        rest = tail;
        if *byte == b'%' {
            let digits = std::str::from_utf8(rest.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &rest[2..];
        } else {
            bytes.push(*byte);
        }
    }
    String::from_utf8(bytes).ok()
}

fn decode_base64(encoded: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(encoded.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for symbol in encoded {
        let value = match symbol {
            b'A'..=b'Z' => symbol - b'A',
            b'a'..=b'z' => symbol - b'a' + 26,
            b'0'..=b'9' => symbol - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => break,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_decode() {
        assert_eq!(decode_base64(b"aGVsbG8="), Some(b"hello".to_vec()));
        assert_eq!(decode_base64(b"/+8"), Some(vec![0xFF, 0xEF]));
        assert_eq!(decode_base64(b"a b"), None);
        assert_eq!(decode_percent("my%20mesh.bin").as_deref(), Some("my mesh.bin"));
        assert_eq!(decode_percent("100%"), None);
        assert_eq!(decode_percent("%zz"), None);
    }
}
