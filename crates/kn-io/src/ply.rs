//! Stanford PLY: header by ply-rs-bw, values read here.
//!
//! ply-rs-bw's value reader loops over elements without properties, drops surplus values silently
//! and names no vertex (see `docs/notes/reading-scans.md`).

use super::ply_values::Values;
use super::read::Parsed;
use super::{Fault, MeshErrorKind, Place};
use kn_mesh::Mesh;
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{DefaultElement, ElementDef, Header, PropertyDef, PropertyType, ScalarType};
use std::io::{self, Write};

/// Reads a PLY file's bytes: ascii, binary little-endian or binary big-endian.
pub(super) fn read_ply(bytes: &[u8]) -> Result<Parsed, Fault> {
    let mut reader = Reader::new(bytes);
    let header = Parser::<DefaultElement>::new()
        .read_header(&mut reader)
        .map_err(|error| header_fault(&error))?;
    let payload_line = reader.line();
    let mut values = Values::new(header.encoding, reader.into_inner(), payload_line);

    let mut parsed = Parsed::default();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut parsed)?,
            "face" => read_faces(element, vertex_count(&header), &mut values, &mut parsed)?,
            "tristrips" => {
                let what = "triangle strips in PLY are not read, only faces";
                return Err(MeshErrorKind::Unsupported(what.into()).into());
            }
            _ => skip_element(element, &mut values, &mut parsed)?,
        }
    }
    parsed.notes.ignore("bytes after the last element", values.left_over() as u64);
    note_properties(&header, &mut parsed);
    Ok(parsed)
}

fn header_fault(error: &ply_rs_bw::parser::ParseError) -> Fault {
    // Its messages repeat the line and the grammar on further lines; the first says enough.
    let message = error.to_string();
    let first = message.lines().next().unwrap_or_default();
    let what = first.split_once(": ").map_or(first, |(_, what)| what);
    let place = error.line().map_or(Place::File, Place::Line);
    if error.kind() == io::ErrorKind::UnexpectedEof {
        return place.fault(MeshErrorKind::Truncated("in the PLY header".into()));
    }
    place.malformed(format!("PLY header: {what}"))
}

fn vertex_count(header: &Header) -> usize {
    header.elements.get("vertex").map_or(0, |element| element.count)
}

/// The use of a vertex property.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Coordinate(usize),
    /// A colour channel, and what makes its full value 255.
    Colour(usize, f32),
    Label,
    Ignored,
}

fn role_of(property: &PropertyDef) -> Role {
    let PropertyType::Scalar(scalar) = &property.data_type else { return Role::Ignored };
    let full = match scalar {
        ScalarType::Float | ScalarType::Double => 255.0,
        _ => 1.0,
    };
    match property.name.as_str() {
        "x" => Role::Coordinate(0),
        "y" => Role::Coordinate(1),
        "z" => Role::Coordinate(2),
        "red" | "diffuse_red" => Role::Colour(0, full),
        "green" | "diffuse_green" => Role::Colour(1, full),
        "blue" | "diffuse_blue" => Role::Colour(2, full),
        "label" => Role::Label,
        _ => Role::Ignored,
    }
}

/// A vertex while its properties come in.
struct VertexReader<'a> {
    properties: Vec<(&'a PropertyType, Role)>,
    has_colour: bool,
    position: [f32; 3],
    colour: [f32; 3],
    /// Coordinates whose binary64 value is no binary32.
    inexact: u64,
}

fn read_vertices<'a>(
    element: &'a ElementDef,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let mut reader = VertexReader::new(element)?;
    for vertex in 0..element.count {
        values.begin(element, vertex)?;
        let place = values.place(Place::Vertex(vertex));
        reader.read(values, place, parsed)?;
        values.end()?;
    }
    parsed.notes.ignore("coordinates rounded to binary32", reader.inexact);
    Ok(())
}

impl<'a> VertexReader<'a> {
    fn new(element: &'a ElementDef) -> Result<Self, Fault> {
        let properties: Vec<_> =
            element.properties.values().map(|p| (&p.data_type, role_of(p))).collect();
        let has = |role: Role| properties.iter().any(|(_, found)| *found == role);
        if !(0..3).all(|axis| has(Role::Coordinate(axis))) {
            return Err(Place::File.malformed("PLY header: the vertices have no x, y and z"));
        }
        let is_colour = |(_, role): &&(_, Role)| matches!(role, Role::Colour(..));
        let has_colour = properties.iter().filter(is_colour).count() == 3;
        Ok(Self { properties, has_colour, position: [0.0; 3], colour: [0.0; 3], inexact: 0 })
    }

    fn read(&mut self, values: &mut Values, place: Place, out: &mut Parsed) -> Result<(), Fault> {
        for (data_type, role) in &self.properties {
            let PropertyType::Scalar(scalar) = data_type else {
                values.skip(data_type)?;
                continue;
            };
            let value = values.scalar(scalar)?;
            match *role {
                Role::Coordinate(axis) => {
                    self.position[axis] = value as f32;
                    self.inexact += u64::from(f64::from(self.position[axis]) != value);
                }
                Role::Colour(channel, full) => self.colour[channel] = value as f32 * full,
                Role::Label => out.labels.push(whole(value, place, "label")?),
                Role::Ignored => {}
            }
        }
        if !self.position.iter().all(|coordinate| coordinate.is_finite()) {
            return Err(place.fault(MeshErrorKind::NotFinite));
        }
        out.mesh.positions.push(self.position);
        if self.has_colour {
            out.colours.push(self.colour);
        }
        Ok(())
    }
}

fn read_faces<'a>(
    element: &'a ElementDef,
    vertices: usize,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let mut corners = Vec::new();
    for face in 0..element.count {
        values.begin(element, face)?;
        let place = values.place(Place::Face(face));
        corners.clear();
        for property in element.properties.values() {
            match &property.data_type {
                PropertyType::List(length, index) if is_corner_list(property) => {
                    for _ in 0..values.list_length(length)? {
                        let index = whole(values.scalar(index)?, place, "face index")?;
                        corners.push(vertex_at(index, vertices, place)?);
                    }
                }
                data_type => values.skip(data_type)?,
            }
        }
        values.end()?;
        parsed.push_polygon(&corners, place)?;
    }
    Ok(())
}

fn is_corner_list(property: &PropertyDef) -> bool {
    matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
}

fn skip_element<'a>(
    element: &'a ElementDef,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    for at in 0..element.count {
        values.begin(element, at)?;
        for property in element.properties.values() {
            values.skip(&property.data_type)?;
        }
        values.end()?;
    }
    parsed.notes.ignore(format!("elements \"{}\"", element.name), element.count as u64);
    Ok(())
}

/// A value that must be an integer.
fn whole(value: f64, place: Place, what: &str) -> Result<i64, Fault> {
    // Beyond 2^53 a binary64 may stand for another integer; nothing legal is that large.
    if value.fract() == 0.0 && value.abs() <= 9_007_199_254_740_992.0 {
        Ok(value as i64)
    } else {
        Err(place.malformed(format!("{what} {value} is not an integer")))
    }
}

fn vertex_at(index: i64, vertices: usize, place: Place) -> Result<u32, Fault> {
    match u32::try_from(index) {
        Ok(vertex) if (vertex as usize) < vertices => Ok(vertex),
        _ => Err(place.fault(MeshErrorKind::FaceIndex { index, vertices })),
    }
}

/// Lists the properties that were read over.
fn note_properties(header: &Header, parsed: &mut Parsed) {
    for element in header.elements.values() {
        for property in element.properties.values() {
            let carried = match element.name.as_str() {
                "vertex" => role_of(property) != Role::Ignored,
                "face" => is_corner_list(property),
                _ => true,
            };
            if !carried {
                parsed.notes.ignore(group_of(&element.name, &property.name), element.count as u64);
            }
        }
    }
}

/// The name of a property in the notes. Properties that belong together have one name.
fn group_of(element: &str, property: &str) -> String {
    match (element, property) {
        ("vertex", "nx" | "ny" | "nz") => "normal components".into(),
        ("vertex", "s" | "t" | "u" | "v" | "texture_u" | "texture_v") | ("face", "texcoord") => {
            "texture coordinates".into()
        }
        ("vertex", "alpha") => "opacities".into(),
        _ => format!("{element} property \"{property}\""),
    }
}

/// Writes binary little-endian PLY: positions, labels where the mesh has them, and one scalar per
/// vertex (`#V`), for instance an error, under the given name.
pub(super) fn write_ply(
    mesh: &Mesh,
    scalar: Option<(&str, &[f32])>,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    writeln!(out, "property float x\nproperty float y\nproperty float z")?;
    if !mesh.labels.is_empty() {
        writeln!(out, "property uchar label")?;
    }
    if let Some((name, _)) = scalar {
        writeln!(out, "property float {name}")?;
    }
    writeln!(out, "element face {}", mesh.faces.len())?;
    writeln!(out, "property list uchar int vertex_indices\nend_header")?;
    for (vertex, position) in mesh.positions.iter().enumerate() {
        for coordinate in position {
            out.write_all(&coordinate.to_le_bytes())?;
        }
        if let Some(label) = mesh.labels.get(vertex) {
            out.write_all(&[*label])?;
        }
        if let Some((_, values)) = scalar {
            out.write_all(&values[vertex].to_le_bytes())?;
        }
    }
    for face in &mesh.faces {
        out.write_all(&[3])?;
        for index in face {
            out.write_all(&index.to_le_bytes())?;
        }
    }
    Ok(())
}
