//! The values after a PLY header, in any of its three encodings.

use super::text::{Lines, parse, shown};
use super::{Fault, MeshErrorKind, Place};
use ply_rs_bw::ply::{ElementDef, Encoding, PropertyType, ScalarType};

/// Reads values one after the other, and knows for its messages what they belong to.
pub(super) struct Values<'a> {
    source: Source<'a>,
    /// Name and number of the element that is being read.
    element: (&'a str, usize),
    count: usize,
}

enum Source<'a> {
    /// The lines to come, and what is left of the line that is being read.
    Ascii {
        lines: Lines<'a>,
        line: &'a [u8],
        number: usize,
    },
    Binary {
        bytes: &'a [u8],
        big_endian: bool,
    },
}

impl<'a> Values<'a> {
    /// Starts at the first byte after the header, which begins line `line` of the file.
    pub(super) fn new(encoding: Encoding, bytes: &'a [u8], line: usize) -> Self {
        let source = match encoding {
            Encoding::Ascii => {
                Source::Ascii { lines: Lines::numbered_from(bytes, line), line: &[], number: line }
            }
            Encoding::BinaryLittleEndian => Source::Binary { bytes, big_endian: false },
            Encoding::BinaryBigEndian => Source::Binary { bytes, big_endian: true },
        };
        Self { source, element: ("", 0), count: 0 }
    }

    /// Goes to element `at` of its kind: in ascii, to the next line that is not blank.
    pub(super) fn begin(&mut self, element: &'a ElementDef, at: usize) -> Result<(), Fault> {
        self.element = (&element.name, at);
        self.count = element.count;
        if element.properties.is_empty() {
            let what = format!("PLY header: element \"{}\" has no property", element.name);
            return Err(Place::File.malformed(what));
        }
        if let Source::Ascii { lines, line, number } = &mut self.source {
            let next = lines.find(|(_, text)| !text.trim_ascii().is_empty());
            let Some((next_number, text)) = next else { return Err(self.truncated()) };
            (*number, *line) = (next_number, text);
        }
        Ok(())
    }

    /// Leaves the element: in ascii, nothing may be left on its line.
    pub(super) fn end(&mut self) -> Result<(), Fault> {
        match &self.source {
            Source::Ascii { line, number, .. } if !line.trim_ascii().is_empty() => {
                let what = format!("{} is one value too many", shown(line.trim_ascii()));
                Err(Place::Line(*number).malformed(what))
            }
            _ => Ok(()),
        }
    }

    /// The place of the value that was just read: its line in ascii, else `element`.
    pub(super) fn place(&self, element: Place) -> Place {
        match &self.source {
            Source::Ascii { number, .. } => Place::Line(*number),
            Source::Binary { .. } => element,
        }
    }

    /// One number. Every type of PLY fits binary64 exactly.
    pub(super) fn scalar(&mut self, data_type: &ScalarType) -> Result<f64, Fault> {
        match &mut self.source {
            Source::Ascii { line, number, .. } => {
                let place = Place::Line(*number);
                let word = next_word(line);
                if word.is_empty() {
                    return Err(place.malformed("the line has too few values"));
                }
                // A float is rounded once, from its decimals to binary32.
                let value = match data_type {
                    ScalarType::Float => parse::<f32>(word).map(f64::from),
                    _ => parse::<f64>(word),
                };
                value.ok_or_else(|| place.malformed(format!("{} is not a number", shown(word))))
            }
            Source::Binary { .. } => self.binary(data_type),
        }
    }

    fn binary(&mut self, data_type: &ScalarType) -> Result<f64, Fault> {
        Ok(match data_type {
            ScalarType::Char => f64::from(i8::from_le_bytes(self.take()?)),
            ScalarType::UChar => f64::from(u8::from_le_bytes(self.take()?)),
            ScalarType::Short => f64::from(i16::from_le_bytes(self.take()?)),
            ScalarType::UShort => f64::from(u16::from_le_bytes(self.take()?)),
            ScalarType::Int => f64::from(i32::from_le_bytes(self.take()?)),
            ScalarType::UInt => f64::from(u32::from_le_bytes(self.take()?)),
            ScalarType::Float => f64::from(f32::from_le_bytes(self.take()?)),
            ScalarType::Double => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next `N` bytes, turned to little-endian order.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        if let Source::Binary { bytes, big_endian } = &mut self.source
            && let Some((head, rest)) = bytes.split_first_chunk::<N>()
        {
            *bytes = rest;
            let mut head = *head;
            if *big_endian {
                head.reverse();
            }
            return Ok(head);
        }
        Err(self.truncated())
    }

    /// The length of a list.
    pub(super) fn list_length(&mut self, data_type: &ScalarType) -> Result<u64, Fault> {
        let length = self.scalar(data_type)?;
        if length < 0.0 || length.fract() != 0.0 || length > f64::from(u32::MAX) {
            let (name, at) = self.element;
            let what = format!("{length} is not a length for a list of {name} {at}");
            return Err(self.place(Place::File).malformed(what));
        }
        Ok(length as u64)
    }

    /// Reads over one property.
    pub(super) fn skip(&mut self, data_type: &PropertyType) -> Result<(), Fault> {
        match data_type {
            PropertyType::Scalar(scalar) => self.scalar(scalar).map(drop),
            PropertyType::List(length, scalar) => {
                for _ in 0..self.list_length(length)? {
                    self.scalar(scalar)?;
                }
                Ok(())
            }
        }
    }

    /// The bytes after everything that was read, blank ones in ascii not counted.
    pub(super) fn left_over(self) -> usize {
        match self.source {
            Source::Ascii { lines, .. } => lines.map(|(_, line)| line.trim_ascii().len()).sum(),
            Source::Binary { bytes, .. } => bytes.len(),
        }
    }

    fn truncated(&self) -> Fault {
        let (name, at) = self.element;
        let what = format!("{name} {at} of {} is not there", self.count);
        Place::File.fault(MeshErrorKind::Truncated(what))
    }
}

/// Takes the next word off a line; empty at its end.
fn next_word<'a>(line: &mut &'a [u8]) -> &'a [u8] {
    let text = line.trim_ascii_start();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    *line = rest;
    word
}
