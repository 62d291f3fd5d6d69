//! The values after a PLY header, in any of its three encodings.

use super::ply_header::{Element, Encoding, Header, Kind, Scalar};
use super::text::{Lines, is_blank_line, next_word, number, shown};
use super::{Fault, MeshErrorKind, Place};

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
    /// Starts at the first byte after the header.
    pub(super) fn new(header: &Header, bytes: &'a [u8]) -> Self {
        let number = header.next_line;
        let source = match header.encoding {
            Encoding::Ascii => {
                Source::Ascii { lines: Lines::numbered_from(bytes, number), line: &[], number }
            }
            Encoding::LittleEndian => Source::Binary { bytes, big_endian: false },
            Encoding::BigEndian => Source::Binary { bytes, big_endian: true },
        };
        Self { source, element: ("", 0), count: 0 }
    }

    /// Goes to element `at` of its kind: in ascii, to the next line that is not blank.
    pub(super) fn begin(&mut self, element: &'a Element, at: usize) -> Result<(), Fault> {
        self.element = (&element.name, at);
        self.count = element.count;
        if element.properties.is_empty() {
            let what = format!("PLY header: element \"{}\" has no property", element.name);
            return Err(Place::File.malformed(what));
        }
        if let Source::Ascii { lines, line, number } = &mut self.source {
            let next = lines.find(|(_, text)| !is_blank_line(text));
            let Some((next_number, text)) = next else { return Err(self.truncated()) };
            (*number, *line) = (next_number, text);
        }
        Ok(())
    }

    /// Leaves the element: in ascii, nothing may be left on its line.
    pub(super) fn end(&mut self) -> Result<(), Fault> {
        match &self.source {
            Source::Ascii { line, number, .. } if !is_blank_line(line) => {
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

    /// One number. Every type of PLY fits binary64 exactly, and decimals are read in binary64
    /// whatever their type: a file may have more digits than it promises.
    pub(super) fn scalar(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        match &mut self.source {
            Source::Ascii { line, number: at, .. } => {
                let place = Place::Line(*at);
                let word = next_word(line);
                if word.is_empty() {
                    return Err(place.malformed("the line has too few values"));
                }
                number(word)
                    .ok_or_else(|| place.malformed(format!("{} is not a number", shown(word))))
            }
            Source::Binary { .. } => self.binary(scalar),
        }
    }

    fn binary(&mut self, scalar: Scalar) -> Result<f64, Fault> {
        Ok(match scalar {
            Scalar::Int8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::Uint8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::Int16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::Uint16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::Int32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::Uint32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::Int64 => i64::from_le_bytes(self.take()?) as f64,
            Scalar::Uint64 => u64::from_le_bytes(self.take()?) as f64,
            Scalar::Float32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::Float64 => f64::from_le_bytes(self.take()?),
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
    pub(super) fn list_length(&mut self, scalar: Scalar) -> Result<u64, Fault> {
        let length = self.scalar(scalar)?;
        // The comparison fails for NaN too.
        if !(0.0..=f64::from(u32::MAX)).contains(&length) || length.fract() != 0.0 {
            let (name, at) = self.element;
            let what = format!("{length} is not a length for a list of {name} {at}");
            return Err(self.place(Place::File).malformed(what));
        }
        Ok(length as u64)
    }

    /// Reads over one property.
    pub(super) fn skip(&mut self, kind: Kind) -> Result<(), Fault> {
        match kind {
            Kind::Scalar(scalar) => self.scalar(scalar).map(drop),
            Kind::List(length, scalar) => {
                for _ in 0..self.list_length(length)? {
                    self.scalar(scalar)?;
                }
                Ok(())
            }
        }
    }

    /// The bytes after everything that was read, blank ones in ascii not counted.
    pub(super) fn left_over(self) -> usize {
        let in_line = |line: &[u8]| if is_blank_line(line) { 0 } else { line.trim_ascii().len() };
        match self.source {
            Source::Ascii { lines, .. } => lines.map(|(_, line)| in_line(line)).sum(),
            Source::Binary { bytes, .. } => bytes.len(),
        }
    }

    fn truncated(&self) -> Fault {
        let (name, at) = self.element;
        let what = format!("{name} {at} of {} is not there", self.count);
        Place::File.fault(MeshErrorKind::Truncated(what))
    }
}
