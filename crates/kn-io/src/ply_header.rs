//! The header of a PLY file, as it is found: lines that end in LF, CR LF or CR, blank lines, spaces
//! before a line, keywords in capitals, several properties of one name.

use super::text::{parse, shown, words};
use super::{Fault, MeshErrorKind, Place};

/// The encodings of the values after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The types of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    /// No type of the format, but some programs write it.
    Int64,
    /// No type of the format, but some programs write it.
    Uint64,
    Float32,
    Float64,
}

/// The types of properties.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    /// The type of the length, and that of the items.
    List(Scalar, Scalar),
}

#[derive(Debug)]
pub(super) struct Property {
    /// In small letters.
    pub(super) name: String,
    pub(super) kind: Kind,
}

#[derive(Debug)]
pub(super) struct Element {
    /// In small letters.
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The number of the line behind the header.
    pub(super) next_line: usize,
}

/// Reads the header. Returns it with the bytes behind it.
pub(super) fn read_header(bytes: &[u8]) -> Result<(Header, &[u8]), Fault> {
    let mut lines = HeaderLines::new(bytes);
    let magic = lines.next().map(|(_, line)| line).unwrap_or_default();
    if !magic.trim_ascii().eq_ignore_ascii_case(b"ply") {
        return Err(Place::Line(1).malformed("PLY header: the first line is not \"ply\""));
    }
    let mut encoding = None;
    let mut elements = Vec::new();
    while let Some((number, line)) = lines.next() {
        let place = Place::Line(number);
        let mut words = words(line);
        let Some(keyword) = words.next() else { continue };
        let rest: Vec<&[u8]> = words.collect();
        match &keyword.to_ascii_lowercase()[..] {
            b"comment" | b"obj_info" => {}
            b"format" => encoding = Some(encoding_of(&rest, place)?),
            b"element" => elements.push(element_of(&rest, place)?),
            b"property" => {
                let property = property_of(&rest, place)?;
                let element: &mut Element = elements
                    .last_mut()
                    .ok_or_else(|| place.malformed("PLY header: a property of no element"))?;
                element.properties.push(property);
            }
            b"end_header" => {
                let no_format = || Place::File.malformed("PLY header: there is no line \"format\"");
                let encoding = encoding.ok_or_else(no_format)?;
                return Ok((Header { encoding, elements, next_line: number + 1 }, lines.bytes));
            }
            _ => {
                let what = format!("PLY header: {} is not a keyword", shown(keyword));
                return Err(place.malformed(what));
            }
        }
    }
    Err(MeshErrorKind::Truncated("in the PLY header".into()).into())
}

/// The lines of a header. They end as the first one does, so that values which begin with a byte 10
/// or 13 lose nothing.
struct HeaderLines<'a> {
    bytes: &'a [u8],
    end: u8,
    number: usize,
}

impl<'a> HeaderLines<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let first = bytes.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let cr_alone =
            first.is_some_and(|at| bytes[at] == b'\r' && bytes.get(at + 1) != Some(&b'\n'));
        Self { bytes, end: if cr_alone { b'\r' } else { b'\n' }, number: 0 }
    }
}

impl<'a> Iterator for HeaderLines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.bytes.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr::memchr(self.end, self.bytes).unwrap_or(self.bytes.len());
        let line = &self.bytes[..end];
        self.bytes = self.bytes.get(end + 1..).unwrap_or(&[]);
        Some((self.number, line))
    }
}

fn encoding_of(words: &[&[u8]], place: Place) -> Result<Encoding, Fault> {
    let word = words.first().copied().unwrap_or_default();
    match &word.to_ascii_lowercase()[..] {
        b"ascii" => Ok(Encoding::Ascii),
        b"binary_little_endian" => Ok(Encoding::LittleEndian),
        b"binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(place.malformed(format!("PLY header: {} is not a format", shown(word)))),
    }
}

fn element_of(words: &[&[u8]], place: Place) -> Result<Element, Fault> {
    let [names @ .., count] = words else {
        return Err(place.malformed("PLY header: an element has a name and a count"));
    };
    let bad_count = || place.malformed(format!("PLY header: {} is not a count", shown(count)));
    let count = parse(count).ok_or_else(bad_count)?;
    Ok(Element { name: name_of(names, place)?, count, properties: Vec::new() })
}

fn property_of(words: &[&[u8]], place: Place) -> Result<Property, Fault> {
    let scalar = |word: &[u8]| {
        let unknown = || place.malformed(format!("PLY header: {} is not a type", shown(word)));
        scalar_of(word).ok_or_else(unknown)
    };
    let (kind, names) = match words {
        [list, length, item, names @ ..] if list.eq_ignore_ascii_case(b"list") => {
            (Kind::List(scalar(length)?, scalar(item)?), names)
        }
        [kind, names @ ..] => (Kind::Scalar(scalar(kind)?), names),
        [] => return Err(place.malformed("PLY header: a property has a type and a name")),
    };
    Ok(Property { name: name_of(names, place)?, kind })
}

fn scalar_of(word: &[u8]) -> Option<Scalar> {
    Some(match &word.to_ascii_lowercase()[..] {
        b"char" | b"int8" => Scalar::Int8,
        b"uchar" | b"uint8" => Scalar::Uint8,
        b"short" | b"int16" => Scalar::Int16,
        b"ushort" | b"uint16" => Scalar::Uint16,
        b"int" | b"int32" => Scalar::Int32,
        b"uint" | b"uint32" => Scalar::Uint32,
        b"int64" => Scalar::Int64,
        b"uint64" => Scalar::Uint64,
        b"float" | b"float32" => Scalar::Float32,
        b"double" | b"float64" => Scalar::Float64,
        _ => return None,
    })
}

/// Names may have blanks, though the format does not say so.
fn name_of(words: &[&[u8]], place: Place) -> Result<String, Fault> {
    if words.is_empty() {
        return Err(place.malformed("PLY header: a name is missing"));
    }
    Ok(String::from_utf8_lossy(&words.join(&b' ')).to_lowercase())
}

impl Scalar {
    /// Whether the numbers of the type are integers.
    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::Float32 | Self::Float64)
    }
}
