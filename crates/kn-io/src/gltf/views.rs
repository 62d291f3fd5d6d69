//! Buffer views, and the data of those that are compressed with EXT_meshopt_compression.

use super::super::Fault;
use super::accessor::Budget;
use super::bad;
use super::container::Buffer;
use super::json::{self, Root};
use meshopt::{
    decode_filter_color, decode_filter_exp, decode_filter_quat, decode_index_buffer,
    decode_index_sequence, decode_vertex_buffer,
};
use serde::Deserialize;

/// A range of a buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    pub(super) buffer: usize,
    pub(super) start: usize,
    pub(super) end: usize,
    /// Bytes from one element to the next, where that is not their size.
    pub(super) stride: Option<usize>,
}

/// The extension's object.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    byte_offset: u64,
    byte_length: u64,
    byte_stride: u64,
    count: u64,
    mode: String,
    filter: Option<String>,
}

/// All buffer views. The data of compressed ones become further buffers.
///
/// # Errors
/// The data of a compressed view cannot be decompressed, or are too many.
pub(super) fn load(
    root: &Root,
    buffers: &mut Vec<Buffer>,
    budget: &mut Budget,
) -> Result<Vec<View>, Fault> {
    let mut views = Vec::with_capacity(root.buffer_views.len());
    for (index, json) in root.buffer_views.iter().enumerate() {
        let stride = json.byte_stride.map(to_usize);
        let (start, length) = (to_usize(json.byte_offset), to_usize(json.byte_length));
        let Some(object) = ["EXT_meshopt_compression", "KHR_meshopt_compression"]
            .into_iter()
            .find_map(|name| json.extensions.get(name))
        else {
            let end = start.saturating_add(length);
            views.push(View { buffer: json.buffer, start, end, stride });
            continue;
        };
        let compressed: Compressed = json::structure(object.clone())?;
        let bytes = compressed
            .decompress(buffers, budget)?
            .ok_or_else(|| bad(format!("the compressed buffer view {index} cannot be read")))?;
        views.push(View { buffer: buffers.len(), start: 0, end: bytes.len(), stride });
        buffers.push(Buffer::new(bytes));
    }
    Ok(views)
}

/// Lengths beyond what memory can hold lie outside every buffer.
fn to_usize(value: u64) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

impl Compressed {
    /// The data; `None` where they are broken.
    fn decompress(
        &self,
        buffers: &[Buffer],
        budget: &mut Budget,
    ) -> Result<Option<Vec<u8>>, Fault> {
        budget.spend(self.count.saturating_mul(self.byte_stride).div_ceil(4))?;
        let (start, length) = (to_usize(self.byte_offset), to_usize(self.byte_length));
        let data = buffers.get(self.buffer).map(Buffer::bytes).unwrap_or_default();
        let Some(data) = data.get(start..start.saturating_add(length)) else { return Ok(None) };
        let (count, stride) = (to_usize(self.count), to_usize(self.byte_stride));
        Ok(match self.mode.as_str() {
            "ATTRIBUTES" => attributes(data, count, stride)
                .and_then(|bytes| filtered(bytes, stride, self.filter.as_deref())),
            // The decompressor takes whole triangles only.
            "TRIANGLES" if count.is_multiple_of(3) => {
                decode_index_buffer(data, count).ok().and_then(|list| indices(&list, stride))
            }
            "INDICES" => {
                decode_index_sequence(data, count).ok().and_then(|list| indices(&list, stride))
            }
            _ => None,
        })
    }
}

/// Indices of 2 or 4 bytes.
fn indices(list: &[u32], stride: usize) -> Option<Vec<u8>> {
    match stride {
        2 => Some(list.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect()),
        4 => Some(list.iter().flat_map(|index| index.to_le_bytes()).collect()),
        _ => None,
    }
}

/// Elements of 4 to 64 bytes, a multiple of four: no attribute of a glTF file is larger.
fn attributes(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    macro_rules! elements {
        ($($words:literal)*) => {
            match stride {
                $(stride if stride == 4 * $words => decode_vertex_buffer(data, count).map(flat::<$words>),)*
                _ => return None,
            }
        };
    }
    elements!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16).ok()
}

/// The bytes of words in the order of memory.
fn flat<const N: usize>(elements: Vec<[u32; N]>) -> Vec<u8> {
    elements.as_flattened().iter().flat_map(|word| word.to_ne_bytes()).collect()
}

/// The elements of `stride` bytes after the filter of that name; `None` for a filter that is unknown
/// or does not fit.
fn filtered(bytes: Vec<u8>, stride: usize, filter: Option<&str>) -> Option<Vec<u8>> {
    Some(match (filter.unwrap_or("NONE"), stride) {
        // Octahedra hold normals and tangents, which are not read.
        ("NONE" | "OCTAHEDRAL", _) => bytes,
        ("EXPONENTIAL", _) => {
            let words = |word: &[u8]| [u32::from_le_bytes([word[0], word[1], word[2], word[3]])];
            let mut words: Vec<[u32; 1]> = bytes.chunks_exact(4).map(words).collect();
            decode_filter_exp(&mut words);
            words.as_flattened().iter().flat_map(|word| word.to_le_bytes()).collect()
        }
        ("QUATERNION", 8) => {
            let mut turns: Vec<[i16; 4]> = bytes.chunks_exact(8).map(i16s).collect();
            decode_filter_quat(&mut turns);
            turns.as_flattened().iter().flat_map(|part| part.to_le_bytes()).collect()
        }
        ("COLOR", 4) => {
            let mut colours: Vec<[u8; 4]> =
                bytes.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]]).collect();
            decode_filter_color(&mut colours);
            colours.concat()
        }
        ("COLOR", 8) => {
            let unsigned = |element: &[u8]| i16s(element).map(|part| part as u16);
            let mut colours: Vec<[u16; 4]> = bytes.chunks_exact(8).map(unsigned).collect();
            decode_filter_color(&mut colours);
            colours.as_flattened().iter().flat_map(|part| part.to_le_bytes()).collect()
        }
        _ => return None,
    })
}

fn i16s(element: &[u8]) -> [i16; 4] {
    [0, 2, 4, 6].map(|at| i16::from_le_bytes([element[at], element[at + 1]]))
}
