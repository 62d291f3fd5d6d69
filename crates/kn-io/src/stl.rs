//! STL, text or binary. Its triangles share no vertices: equal positions become one vertex, in the
//! order of their first use.

use super::parsed::Parsed;
use super::text::{Lines, number, shown, words};
use super::{Fault, MeshErrorKind, Place};
use std::collections::HashMap;

/// Bytes before the triangles of a binary file: a text of 80 bytes, and their number.
const HEADER_BYTES: usize = 84;
/// A normal and three corners in binary32, and two bytes that some programs put a colour into.
const TRIANGLE_BYTES: usize = 50;

/// Reads an STL file's bytes.
pub(super) fn read_stl(bytes: &[u8]) -> Result<Parsed, Fault> {
    // Binary files may begin with `solid` too. Their size tells.
    let sized = promised(bytes).is_some_and(|size| size == bytes.len());
    if !sized && is_text(bytes) { read_text(bytes) } else { read_binary(bytes) }
}

/// The size of a binary file with as many triangles as the header says.
fn promised(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(HEADER_BYTES - 4..HEADER_BYTES)?;
    let count = u32::from_le_bytes(count.try_into().ok()?);
    (count as usize).checked_mul(TRIANGLE_BYTES)?.checked_add(HEADER_BYTES)
}

/// Whether a file begins as a text does. NULs fill the header of a binary file, and a count below
/// 2^24 has one.
fn is_text(bytes: &[u8]) -> bool {
    let binary = bytes.get(..HEADER_BYTES).is_some_and(|header| header.contains(&0));
    let keyword = Lines::new(bytes).find_map(|(_, line)| words(line).next());
    !binary && keyword.is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// The vertices so far.
#[derive(Default)]
struct Soup {
    parsed: Parsed,
    vertices: HashMap<[u64; 3], u32>,
}

impl Soup {
    fn vertex(&mut self, position: [f64; 3], place: Place) -> u32 {
        // Adding +0 turns −0 into +0: equal bits, equal position.
        let bits = position.map(|coordinate| (coordinate + 0.0).to_bits());
        let next = self.parsed.mesh.positions.len() as u32;
        let vertex = *self.vertices.entry(bits).or_insert(next);
        if vertex == next {
            self.parsed.push_vertex(position, place);
        }
        vertex
    }
}

fn read_binary(bytes: &[u8]) -> Result<Parsed, Fault> {
    let truncated = |what: String| Fault::from(MeshErrorKind::Truncated(what));
    let size = promised(bytes).ok_or_else(|| truncated("in the STL header".into()))?;
    let body = &bytes[HEADER_BYTES..];
    // Programs that write while they scan leave the count at 0.
    let promised = (size - HEADER_BYTES) / TRIANGLE_BYTES;
    let count = if promised == 0 { body.len() / TRIANGLE_BYTES } else { promised };
    let mut soup = Soup::default();
    for triangle in 0..count {
        let start = triangle * TRIANGLE_BYTES;
        let Some(record) = body.get(start..start + TRIANGLE_BYTES) else {
            return Err(truncated(format!("triangle {triangle} of {count} is not there")));
        };
        let float = |at: usize| {
            let bytes = [record[at], record[at + 1], record[at + 2], record[at + 3]];
            f64::from(f32::from_le_bytes(bytes))
        };
        let corner = |at: usize| [float(at), float(at + 4), float(at + 8)];
        let place = Place::Face(triangle);
        let corners = [12, 24, 36].map(|at| soup.vertex(corner(at), place));
        soup.parsed.push_polygon(&corners);
        soup.parsed.notes.ignore("colours of faces", u64::from(record[48..] != [0, 0]));
    }
    let left = body.len() - count * TRIANGLE_BYTES;
    soup.parsed.notes.ignore("bytes after the last triangle", left as u64);
    Ok(soup.parsed)
}

/// `facet`, `vertex x y z` three times, `endfacet`; the words between them say nothing. A loop of
/// more corners is a polygon.
fn read_text(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let (mut in_facet, mut ended) = (false, false);
    for (at, line) in Lines::new(bytes) {
        let place = Place::Line(at);
        let mut words = words(line);
        let Some(keyword) = words.next() else { continue };
        match &keyword.to_ascii_lowercase()[..] {
            b"solid" => ended = false,
            b"facet" if !in_facet => in_facet = true,
            b"vertex" if in_facet => {
                let position = read_vertex(&mut words, place)?;
                corners.push(soup.vertex(position, place));
            }
            b"endfacet" if in_facet => {
                soup.parsed.push_polygon(&corners);
                corners.clear();
                in_facet = false;
            }
            b"outer" | b"loop" | b"endloop" => {}
            b"endsolid" | b"end" if !in_facet => ended = true,
            _ => {
                let what = format!("{} is not expected here in STL", shown(keyword));
                return Err(place.malformed(what));
            }
        }
    }
    if !ended {
        return Err(MeshErrorKind::Truncated("there is no \"endsolid\"".into()).into());
    }
    Ok(soup.parsed)
}

fn read_vertex<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    place: Place,
) -> Result<[f64; 3], Fault> {
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        let word = words.next().unwrap_or_default();
        let no_number = || place.malformed(format!("{} is not a number", shown(word)));
        *coordinate = number(word).ok_or_else(no_number)?;
    }
    Ok(position)
}
