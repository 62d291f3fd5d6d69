//! Wavefront OBJ: polygon faces with positions, in file order.
//!
//! tobj drops unreferenced vertices and renumbers the others by first use, so positions and faces
//! are read here, and tobj reads the material libraries (see `docs/notes/reading-scans.md`).

use super::read::Parsed;
use super::text::{Lines, parse, shown, words};
use super::{Fault, MeshErrorKind, Place, ReadNotes};
use kn_mesh::Mesh;
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Component, Path};

/// Reads an OBJ file's bytes. `folder` is where its material libraries lie.
pub(super) fn read_obj(bytes: &[u8], folder: &Path) -> Result<Parsed, Fault> {
    let mut reader = ObjReader::default();
    for (number, line) in Lines::new(bytes) {
        reader.line = number;
        reader.statement(line)?;
    }
    let vertices = reader.parsed.mesh.positions.len();
    if let Some(&(line, index)) = reader.forward.iter().find(|(_, i)| *i > vertices as i64) {
        return Err(Place::Line(line).fault(MeshErrorKind::FaceIndex { index, vertices }));
    }
    for name in &reader.libraries {
        note_materials(folder, name, &mut reader.parsed.notes);
    }
    Ok(reader.parsed)
}

/// Notes how many materials and textures a library holds.
fn note_materials(folder: &Path, name: &str, notes: &mut ReadNotes) {
    let shown = name.escape_debug();
    match load_materials(folder, name) {
        Ok(materials) => {
            let textures = materials.iter().map(texture_count).sum();
            notes.ignore(format!("materials of {shown}"), materials.len() as u64);
            notes.ignore(format!("textures of {shown}"), textures);
        }
        Err(reason) => notes.ignore(format!("material library {shown}: {reason}"), 1),
    }
}

/// The largest material library that is looked into, in bytes.
const MAX_LIBRARY_BYTES: u64 = 1 << 20;

fn load_materials(folder: &Path, name: &str) -> Result<Vec<tobj::Material>, String> {
    // A mesh file must not make us open devices or files elsewhere.
    let path = Path::new(name);
    if !path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err("not beside the mesh".into());
    }
    let path = folder.join(path);
    match path.metadata() {
        Ok(found) if found.is_file() && found.len() <= MAX_LIBRARY_BYTES => {}
        Ok(_) => return Err("too large".into()),
        Err(_) => return Err("not there".into()),
    }
    tobj::load_mtl(&path).map(|(materials, _)| materials).map_err(|error| error.to_string())
}

#[derive(Default)]
struct ObjReader {
    parsed: Parsed,
    line: usize,
    /// Indices of vertices that had not come yet, with the line that used them.
    forward: Vec<(usize, i64)>,
    corners: Vec<u32>,
    libraries: BTreeSet<String>,
}

impl ObjReader {
    fn statement(&mut self, line: &[u8]) -> Result<(), Fault> {
        let mut words = words(line);
        let Some(keyword) = words.next() else { return Ok(()) };
        let ignored = match keyword {
            b"v" => return self.vertex(words),
            b"f" => return self.face(words),
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
            _ => return self.unknown(keyword),
        };
        self.parsed.notes.ignore(ignored, 1);
        Ok(())
    }

    /// `v x y z`, `v x y z w`, `v x y z r g b` or `v x y z w r g b`.
    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Fault> {
        let mut numbers = [0f32; 7];
        let mut count = 0;
        for word in words {
            let Some(number) = parse::<f32>(word) else {
                return Err(self.malformed(format!("{} is not a number", shown(word))));
            };
            if !number.is_finite() {
                return Err(Place::Line(self.line).fault(MeshErrorKind::NotFinite));
            }
            if count < numbers.len() {
                numbers[count] = number;
            }
            count += 1;
        }
        if !matches!(count, 3 | 4 | 6 | 7) {
            return Err(self.malformed(format!("a vertex has 3 coordinates, not {count}")));
        }
        let [x, y, z, ..] = numbers;
        self.parsed.mesh.positions.push([x, y, z]);
        if count >= 6 {
            let colour = [numbers[count - 3], numbers[count - 2], numbers[count - 1]];
            self.parsed.colours.push(colour.map(|channel| channel * 255.0));
        }
        if matches!(count, 4 | 7) {
            self.parsed.notes.ignore("vertex weights", 1);
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
        self.parsed.push_polygon(&self.corners, Place::Line(self.line))
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

    /// `mtllib file`: remembered, and read when the rest is known to be good.
    fn material_library(&mut self, line: &[u8]) {
        let line = String::from_utf8_lossy(line.trim_ascii());
        let name = line.strip_prefix("mtllib").unwrap_or(&line).trim();
        self.libraries.insert(name.to_owned());
    }

    /// Statements of other kinds are listed; what does not even look like one is an error, so
    /// that a file of another format is not read as an empty mesh.
    fn unknown(&mut self, keyword: &[u8]) -> Result<(), Fault> {
        let plausible = keyword.len() <= 16
            && keyword.iter().all(|byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        if !plausible {
            return Err(self.malformed(format!("{} is not an OBJ statement", shown(keyword))));
        }
        self.parsed.notes.ignore(format!("statements {}", shown(keyword)), 1);
        Ok(())
    }

    fn malformed(&self, what: String) -> Fault {
        Place::Line(self.line).malformed(what)
    }
}

fn texture_count(material: &tobj::Material) -> u64 {
    let textures = [
        &material.ambient_texture,
        &material.diffuse_texture,
        &material.specular_texture,
        &material.normal_texture,
        &material.shininess_texture,
        &material.dissolve_texture,
    ];
    textures.into_iter().flatten().count() as u64
}

/// The position index of a corner; `None` where the corner is not written as the format says.
fn position_index(corner: &[u8]) -> Option<i64> {
    let mut parts = corner.split(|&byte| byte == b'/');
    let index = integer(parts.next()?)?;
    for (at, part) in parts.enumerate() {
        if at > 1 || !(part.is_empty() && at == 0) && integer(part).is_none() {
            return None;
        }
    }
    Some(index)
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

/// Writes positions and faces as OBJ. Numbers are the shortest that read back to the same bits.
pub(super) fn write_obj(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    for [x, y, z] in &mesh.positions {
        writeln!(out, "v {x} {y} {z}")?;
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|vertex| u64::from(vertex) + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}
