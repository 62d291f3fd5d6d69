//! The binary variant of OFF: numbers of 32 bits, big-endian.

use super::off::Layout;
use super::parsed::Parsed;
use super::{Fault, MeshErrorKind, Place};

/// Reads what is behind the line `OFF BINARY`: three counts, the vertices as floats, and each face
/// as its number of corners, their indices, the number of its colour's components, and these.
pub(super) fn read_binary(bytes: &[u8], layout: Layout) -> Result<Parsed, Fault> {
    let mut numbers = Numbers { bytes, what: "in the OFF counts", at: (0, 0) };
    let (vertices, faces, _) = (numbers.count()?, numbers.count()?, numbers.count()?);
    let mut parsed = Parsed::default();
    for vertex in 0..vertices {
        (numbers.what, numbers.at) = ("vertex", (vertex, vertices));
        let position = [numbers.float()?, numbers.float()?, numbers.float()?];
        let w = if layout.homogeneous { numbers.float()? } else { 1.0 };
        let place = Place::Vertex(vertex);
        parsed.push_vertex(position.map(|coordinate| coordinate / w), place);
        let further = 3 * usize::from(layout.normal)
            + 4 * usize::from(layout.colour)
            + 2 * usize::from(layout.texture);
        for _ in 0..further {
            numbers.float()?;
        }
        parsed.notes.ignore("further numbers of vertices", further as u64);
    }
    let mut corners = Vec::new();
    for face in 0..faces {
        (numbers.what, numbers.at) = ("face", (face, faces));
        corners.clear();
        for _ in 0..numbers.count()? {
            corners.push(Place::Face(face).vertex(numbers.integer()?, vertices)?);
        }
        let colours = numbers.count()?;
        for _ in 0..colours {
            numbers.float()?;
        }
        parsed.notes.ignore("colours of faces", u64::from(colours > 0));
        parsed.push_polygon(&corners);
    }
    parsed.notes.ignore("bytes after the last face", numbers.bytes.len() as u64);
    Ok(parsed)
}

struct Numbers<'a> {
    bytes: &'a [u8],
    /// What is being read, and which of how many.
    what: &'static str,
    at: (usize, usize),
}

impl Numbers<'_> {
    fn take(&mut self) -> Result<[u8; 4], Fault> {
        let Some((head, rest)) = self.bytes.split_first_chunk::<4>() else {
            let (at, count) = self.at;
            let what = match count {
                0 => self.what.to_owned(),
                _ => format!("{} {at} of {count} is not there", self.what),
            };
            return Err(MeshErrorKind::Truncated(what).into());
        };
        self.bytes = rest;
        Ok(*head)
    }

    fn integer(&mut self) -> Result<i64, Fault> {
        Ok(i64::from(i32::from_be_bytes(self.take()?)))
    }

    fn float(&mut self) -> Result<f64, Fault> {
        Ok(f64::from(f32::from_be_bytes(self.take()?)))
    }

    fn count(&mut self) -> Result<usize, Fault> {
        let count = self.integer()?;
        let what = || Place::File.malformed(format!("{count} is not a count of binary OFF"));
        usize::try_from(count).map_err(|_| what())
    }
}
