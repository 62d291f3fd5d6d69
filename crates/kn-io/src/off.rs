//! Geomview OFF: positions and polygons, in file order. This file reads text, `off_binary` the
//! binary variant.

use super::off_binary::read_binary;
use super::parsed::Parsed;
use super::text::{Lines, number, parse, shown, words};
use super::{Fault, MeshErrorKind, Place};

/// Reads an OFF file's bytes.
pub(super) fn read_off(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut lines = Lines::new(bytes);
    let first = lines.find(|(_, line)| words(line).next().is_some());
    let Some((line, text)) = first else {
        return Err(MeshErrorKind::Truncated("in the OFF header".into()).into());
    };
    let place = Place::Line(line);
    let mut words: Vec<&[u8]> = words(text).collect();
    let (layout, rest) = Layout::of_keyword(words[0])
        .ok_or_else(|| place.malformed(format!("{} is not OFF", shown(words[0]))))?;
    // Some writers put no blank between keyword and counts.
    if rest.is_empty() {
        words.remove(0);
    } else {
        words[0] = rest;
    }
    if words.first().is_some_and(|word| word.eq_ignore_ascii_case(b"BINARY")) {
        return read_binary(lines.rest(), layout);
    }
    TextReader { layout, lines, end: line }.read(words)
}

/// What the keyword at the start says about a vertex.
#[derive(Clone, Copy, Default)]
pub(super) struct Layout {
    /// `ST`: two texture coordinates.
    pub(super) texture: bool,
    /// `C`: a colour.
    pub(super) colour: bool,
    /// `N`: three components of a normal.
    pub(super) normal: bool,
    /// `4`: a fourth coordinate, which the other three are divided by.
    pub(super) homogeneous: bool,
}

impl Layout {
    /// The layout of `[ST][C][N][4]OFF`, and what comes behind it in the word. A file may begin
    /// with the counts instead.
    fn of_keyword(word: &[u8]) -> Option<(Self, &[u8])> {
        if parse::<usize>(word).is_some() {
            return Some((Self::default(), word));
        }
        let mut rest = word;
        let mut take = |flag: &[u8]| match rest.strip_prefix(flag) {
            Some(tail) => {
                rest = tail;
                true
            }
            None => false,
        };
        let (texture, colour) = (take(b"ST"), take(b"C"));
        let (normal, homogeneous) = (take(b"N"), take(b"4"));
        let keyword = take(b"OFF") || take(b"off");
        keyword.then_some((Self { texture, colour, normal, homogeneous }, rest))
    }
}

struct TextReader<'a> {
    layout: Layout,
    lines: Lines<'a>,
    /// The last line that was read.
    end: usize,
}

impl<'a> TextReader<'a> {
    /// Reads all behind the keyword, whose line also has `header`.
    fn read(mut self, mut header: Vec<&'a [u8]>) -> Result<Parsed, Fault> {
        if header.is_empty() {
            header = self.next("no OFF counts")?;
        }
        let place = Place::Line(self.end);
        let (vertices, faces) = match header[..] {
            [vertices, faces] | [vertices, faces, _] => {
                (count(vertices, place)?, count(faces, place)?)
            }
            _ => return Err(place.malformed("OFF counts are vertices, faces and edges")),
        };
        let mut parsed = Parsed::default();
        for vertex in 0..vertices {
            let words = self.next(&format!("vertex {vertex} of {vertices} is not there"))?;
            self.read_vertex(&words, &mut parsed)?;
        }
        for face in 0..faces {
            let words = self.next(&format!("face {face} of {faces} is not there"))?;
            read_face(&words, vertices, Place::Line(self.end), &mut parsed)?;
        }
        let left = self.lines.filter(|(_, line)| words(line).next().is_some()).count();
        parsed.notes.ignore("lines after the last face", left as u64);
        Ok(parsed)
    }

    /// The words of the next line that is not blank.
    fn next(&mut self, missing: &str) -> Result<Vec<&'a [u8]>, Fault> {
        for (number, line) in self.lines.by_ref() {
            let words: Vec<_> = words(line).collect();
            if !words.is_empty() {
                self.end = number;
                return Ok(words);
            }
        }
        Err(MeshErrorKind::Truncated(missing.into()).into())
    }

    fn read_vertex(&self, words: &[&[u8]], parsed: &mut Parsed) -> Result<(), Fault> {
        let place = Place::Line(self.end);
        let needed = if self.layout.homogeneous { 4 } else { 3 };
        if words.len() < needed {
            let what = format!("a vertex has {needed} coordinates, not {}", words.len());
            return Err(place.malformed(what));
        }
        let mut numbers = [0.0, 0.0, 0.0, 1.0];
        for (coordinate, word) in numbers.iter_mut().zip(&words[..needed]) {
            let no_number = || place.malformed(format!("{} is not a number", shown(word)));
            *coordinate = number(word).ok_or_else(no_number)?;
        }
        let [x, y, z, w] = numbers;
        parsed.push_vertex([x, y, z].map(|coordinate| coordinate / w), place);
        parsed.notes.ignore("further numbers of vertices", (words.len() - needed) as u64);
        Ok(())
    }
}

fn count(word: &[u8], place: Place) -> Result<usize, Fault> {
    parse(word).ok_or_else(|| place.malformed(format!("{} is not a count", shown(word))))
}

/// `n` and `n` indices; a colour may follow.
fn read_face(
    words: &[&[u8]],
    vertices: usize,
    place: Place,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let corners = count(words[0], place)?;
    if corners >= words.len() {
        return Err(place.malformed(format!("a face of {corners} corners lists fewer")));
    }
    let (indices, rest) = words[1..].split_at(corners);
    let mut face = Vec::with_capacity(corners);
    for word in indices {
        let index: i64 = parse(word)
            .ok_or_else(|| place.malformed(format!("{} is not an index", shown(word))))?;
        face.push(place.vertex(index, vertices)?);
    }
    parsed.notes.ignore("colours of faces", u64::from(!rest.is_empty()));
    parsed.push_polygon(&face);
    Ok(())
}
