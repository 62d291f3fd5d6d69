//! The parts of a file: JSON and buffers, in one GLB or beside each other.

use super::super::read::read_file;
use super::super::{Fault, MeshErrorKind};
use super::json::{self, Buffer as JsonBuffer, Root};
use super::{bad, requirements};
use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::ops::Range;
use std::path::{Component, Path};

/// The bytes of one glTF buffer: a range of a file.
pub(super) struct Buffer {
    file: Vec<u8>,
    range: Range<usize>,
}

impl Buffer {
    /// A buffer that is not in a file.
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        Self { range: 0..bytes.len(), file: bytes }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.file[self.range.clone()]
    }
}

/// Splits a GLB or glTF file into its JSON and its buffers, and loads those that lie beside it.
pub(super) fn open(bytes: Vec<u8>, folder: &Path) -> Result<(Root, Vec<Buffer>), Fault> {
    let (json, mut binary) =
        if bytes.starts_with(b"glTF") { split_glb(&bytes)? } else { (0..bytes.len(), None) };
    let tree = json::parse(&bytes[json])?;
    requirements::check_version(&tree)?;
    requirements::check_extensions(&tree)?;
    let root: Root = json::structure(tree)?;

    let mut file = Some(bytes);
    let mut buffers = Vec::new();
    for (index, buffer) in root.buffers.iter().enumerate() {
        let loaded = match &buffer.uri {
            Some(uri) => Buffer::new(load_uri(uri, folder)?),
            None if stands_for_compressed(buffer) => {
                buffers.push(Buffer::new(Vec::new()));
                continue;
            }
            None => match (index, binary.take(), file.take()) {
                (0, Some(range), Some(file)) => Buffer { file, range },
                _ => return Err(bad(format!("buffer {index} has no data"))),
            },
        };
        if (loaded.bytes().len() as u64) < buffer.byte_length {
            let what = format!("glTF buffer {index} should have {} bytes", buffer.byte_length);
            return Err(MeshErrorKind::Truncated(what).into());
        }
        buffers.push(loaded);
    }
    Ok((root, buffers))
}

/// Whether a buffer only says how long the data would be that compressed views hold.
fn stands_for_compressed(buffer: &JsonBuffer) -> bool {
    let fallback = |name| buffer.extensions.get(name).is_some_and(|it| it["fallback"] == true);
    ["EXT_meshopt_compression", "KHR_meshopt_compression"].into_iter().any(fallback)
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
    match version {
        1 => return Err(MeshErrorKind::Unsupported(requirements::GLTF_1.into()).into()),
        2 => {}
        _ => return Err(bad(format!("GLB version {version} is not 2"))),
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(truncated("GLB chunks"));
    }
    // A chunk is its length, its kind and its bytes.
    let chunk = |at: usize| {
        let size = word(at)? as usize;
        let range = at + 8..(at + 8).checked_add(size)?;
        let kind = bytes.get(at + 4..at + 8)?;
        (range.end <= length).then_some((kind, range))
    };
    let is = |name: &'static [u8]| move |found: &(&[u8], Range<usize>)| found.0 == name;
    let json = chunk(12).filter(is(b"JSON")).ok_or_else(|| truncated("GLB's JSON chunk"))?.1;
    // Chunks begin at multiples of four. Some writers forget that after the JSON.
    let starts = [json.end, json.end.next_multiple_of(4)];
    let binary = starts.into_iter().filter_map(chunk).find(is(b"BIN\0"));
    match binary {
        Some((_, range)) => Ok((json, Some(range))),
        None if starts[1] + 8 > length || chunk(starts[1]).is_some() => Ok((json, None)),
        None => Err(truncated("GLB's binary chunk")),
    }
}

/// Base64 as writers have it, with padding or without.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// The bytes behind a URI: base64 data in it, or a file below `folder`.
fn load_uri(uri: &str, folder: &Path) -> Result<Vec<u8>, Fault> {
    if let Some(data) = uri.strip_prefix("data:") {
        let encoded = data.split_once(";base64,").map(|(_, encoded)| encoded.as_bytes());
        return encoded
            .and_then(|encoded| BASE64.decode(encoded).ok())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percent_decodes() {
        assert_eq!(decode_percent("my%20mesh.bin").as_deref(), Some("my mesh.bin"));
        assert_eq!(decode_percent("100%"), None);
        assert_eq!(decode_percent("%zz"), None);
    }
}
