//! Wavefront OBJ: polygon faces with positions, in file order.
//!
//! tobj drops unreferenced vertices and renumbers the others by first use, reads binary32, and
//! panics on some material libraries, so OBJ is read here (see `docs/notes/reading-scans.md`).

use super::materials::note_materials;
use super::parsed::Parsed;
use super::text::{Lines, goes_on, number, shown, words};
use super::{Fault, MeshErrorKind, Place};
use kn_mesh::{Mesh, Precision};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

/// Reads an OBJ file's bytes. `folder` is where its material libraries lie.
pub(super) fn read_obj(bytes: &[u8], folder: &Path) -> Result<Parsed, Fault> {
    let mut reader = ObjReader::default();
    let mut lines = Lines::new(bytes);
    while let Some((number, line)) = lines.next() {
        reader.line = number;
        let whole = if goes_on(line) && holds_numbers(line) { lines.continued(line) } else { line };
        reader.statement(whole)?;
    }
    reader.finish(folder)
}

/// Whether the statement of a line may go on in the next one. A comment or a name may end in a
/// backslash, as a path does, and ends with its line.
fn holds_numbers(line: &[u8]) -> bool {
    let keyword = words(line).next().unwrap_or_default();
    matches!(keyword, b"v" | b"vt" | b"vn" | b"vp" | b"f" | b"fo" | b"l" | b"p")
}

#[derive(Default)]
struct ObjReader {
    parsed: Parsed,
    line: usize,
    /// Indices of vertices that had not come yet, with the line that used them.
    forward: Vec<(usize, i64)>,
    corners: Vec<u32>,
    libraries: BTreeSet<String>,
    /// The first line that is not a statement of OBJ.
    odd: Option<(usize, String)>,
}

impl ObjReader {
    fn statement(&mut self, line: &[u8]) -> Result<(), Fault> {
        let mut words = words(line);
        let Some(keyword) = words.next() else { return Ok(()) };
        let ignored = match keyword {
            b"v" | b"V" => return self.vertex(words),
            b"f" | b"F" | b"fo" => return self.face(words),
            b"mtllib" => {
                self.material_library(line);
                return Ok(());
            }
            b"vt" => "texture coordinates",
            b"vn" => "normals",
            b"l" => "lines",
            b"p" => "points",
            b"o" => "objects",
            b"g" => "groups",
            b"s" => "smoothing groups",
            b"usemtl" => "uses of a material",
            _ => {
                self.odd_line(keyword);
                return Ok(());
            }
        };
        self.parsed.notes.ignore(ignored, 1);
        Ok(())
    }

    /// `v x y z`, `v x y z w`, `v x y z r g b` or `v x y z w r g b`. What follows the position is
    /// not carried, and may be no number at all.
    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Fault> {
        let mut numbers = [0f64; 7];
        let mut count = 0;
        for word in words {
            let value = number(word);
            if count < 3 && value.is_none() {
                return Err(self.malformed(format!("{} is not a number", shown(word))));
            }
            if count < numbers.len() {
                numbers[count] = value.unwrap_or(f64::NAN);
            }
            count += 1;
        }
        if count < 3 {
            return Err(self.malformed(format!("a vertex has 3 coordinates, not {count}")));
        }
        let [x, y, z, ..] = numbers;
        self.parsed.push_vertex([x, y, z], Place::Line(self.line));
        match count {
            3 => {}
            4 => self.parsed.notes.ignore("vertex weights", 1),
            6 | 7 => {
                let colour = [numbers[count - 3], numbers[count - 2], numbers[count - 1]];
                self.parsed.colours.push(colour.map(|channel| channel as f32 * 255.0));
                self.parsed.notes.ignore("vertex weights", u64::from(count == 7));
            }
            _ => self.parsed.notes.ignore("further numbers of vertices", count as u64 - 3),
        }
        Ok(())
    }

    /// `f` with corners `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Fault> {
        self.corners.clear();
        for word in words {
            let index = position_index(word)
                .ok_or_else(|| self.malformed(format!("{} is not a face corner", shown(word))))?;
            let vertex = self.vertex_of(index)?;
            self.corners.push(vertex);
        }
        self.parsed.push_polygon(&self.corners);
        Ok(())
    }

    /// The vertex that an index means: from 1 on, or backwards from the last vertex read so far.
    fn vertex_of(&mut self, index: i64) -> Result<u32, Fault> {
        let vertices = self.parsed.mesh.positions.len();
        let vertex = if index < 0 { vertices as i64 + index } else { index - 1 };
        match u32::try_from(vertex) {
            Ok(vertex) => {
                if vertex as usize >= vertices {
                    self.forward.push((self.line, index));
                }
                Ok(vertex)
            }
            Err(_) => {
                let kind = MeshErrorKind::FaceIndex { index, vertices };
                Err(Place::Line(self.line).fault(kind))
            }
        }
    }

    /// `mtllib file`: remembered, and looked into when the rest is known to be good.
    fn material_library(&mut self, line: &[u8]) {
        let line = String::from_utf8_lossy(line.trim_ascii());
        let name = line.strip_prefix("mtllib").unwrap_or(&line);
        self.libraries.insert(name.trim_matches(|c: char| c.is_whitespace() || c == '\0').into());
    }

    /// Lines of other kinds are listed.
    fn odd_line(&mut self, keyword: &[u8]) {
        let shown = shown(keyword);
        let plausible = keyword.len() <= 16
            && keyword.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        if plausible {
            self.parsed.notes.ignore(format!("statements {shown}"), 1);
        } else {
            self.parsed.notes.ignore("lines that are not OBJ statements", 1);
        }
        self.odd.get_or_insert((self.line, shown));
    }

    /// Checks what only the whole file tells.
    fn finish(mut self, folder: &Path) -> Result<Parsed, Fault> {
        let vertices = self.parsed.mesh.positions.len();
        if let Some(&(line, index)) = self.forward.iter().find(|(_, i)| *i > vertices as i64) {
            return Err(Place::Line(line).fault(MeshErrorKind::FaceIndex { index, vertices }));
        }
        // A file of another format must not be read as an empty mesh.
        if let (0, Some((line, word))) = (vertices, &self.odd) {
            let what = format!("{word} is not an OBJ statement, and the file has no vertices");
            return Err(Place::Line(*line).malformed(what));
        }
        for name in &self.libraries {
            note_materials(folder, name, &mut self.parsed.notes);
        }
        Ok(self.parsed)
    }

    fn malformed(&self, what: String) -> Fault {
        Place::Line(self.line).malformed(what)
    }
}

/// The position index of a corner; `None` where it has none. The indices after it are not carried,
/// and may be missing.
fn position_index(corner: &[u8]) -> Option<i64> {
    let end = corner.iter().position(|&byte| byte == b'/').unwrap_or(corner.len());
    let (index, rest) = corner.split_at(end);
    let indices = rest.iter().all(|byte| matches!(byte, b'0'..=b'9' | b'/' | b'+' | b'-'));
    integer(index).filter(|_| indices)
}

/// A decimal integer of at most 18 digits. `str::parse` costs twice the time here.
fn integer(word: &[u8]) -> Option<i64> {
    let (negative, digits) = match word {
        [b'-', digits @ ..] => (true, digits),
        [b'+', digits @ ..] => (false, digits),
        digits => (false, digits),
    };
    if digits.is_empty() || digits.len() > 18 {
        return None;
    }
    let mut value = 0;
    for digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value * 10 + i64::from(digit - b'0');
    }
    Some(if negative { -value } else { value })
}

/// Writes positions and faces as OBJ. Numbers are the shortest that read back to the same bits of
/// that precision.
pub(super) fn write_obj(mesh: &Mesh, precision: Precision, out: &mut dyn Write) -> io::Result<()> {
    if mesh.is_empty() {
        // A file without a byte is taken for one that was not written to its end.
        return writeln!(out, "# an empty frame");
    }
    for position in &mesh.positions {
        match precision {
            Precision::Single => {
                let [x, y, z] = position.map(|coordinate| coordinate as f32);
                writeln!(out, "v {x} {y} {z}")?;
            }
            Precision::Double => {
                let [x, y, z] = position;
                writeln!(out, "v {x} {y} {z}")?;
            }
        }
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|vertex| u64::from(vertex) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}
