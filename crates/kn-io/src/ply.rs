//! Stanford PLY, read and written.
//!
//! ply-rs-bw takes fewer headers than are found, its value reader loops over elements without
//! properties, drops surplus values silently and names no vertex (see
//! `docs/notes/reading-scans.md`).

use super::parsed::Parsed;
use super::ply_header::{Element, Kind, Property, Scalar, read_header};
use super::ply_values::Values;
use super::{Fault, Place};
use kn_mesh::{Mesh, Precision};
use std::io::{self, Write};

/// Reads a PLY file's bytes: ascii, binary little-endian or binary big-endian.
pub(super) fn read_ply(bytes: &[u8]) -> Result<Parsed, Fault> {
    let (header, payload) = read_header(bytes)?;
    let mut values = Values::new(&header, payload);
    let mut parsed = Parsed::default();
    let vertices = vertex_count(&header.elements)?;
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(element, &mut values, &mut parsed)?,
            "face" => read_faces(element, vertices, &mut values, &mut parsed)?,
            "tristrips" => read_strips(element, vertices, &mut values, &mut parsed)?,
            _ => skip_element(element, &mut values, &mut parsed)?,
        }
    }
    parsed.notes.ignore("bytes after the last element", values.left_over() as u64);
    Ok(parsed)
}

fn vertex_count(elements: &[Element]) -> Result<usize, Fault> {
    let mut counts = elements.iter().filter(|element| element.name == "vertex").map(|e| e.count);
    let count = counts.next().unwrap_or(0);
    match counts.next() {
        Some(_) => Err(Place::File.malformed("PLY header: there are two elements \"vertex\"")),
        None => Ok(count),
    }
}

/// The use of a vertex property.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    Coordinate(usize),
    /// A colour channel.
    Colour(usize),
    Label,
    Ignored,
}

fn role_of(property: &Property) -> Role {
    match property.name.as_str() {
        "x" => Role::Coordinate(0),
        "y" => Role::Coordinate(1),
        "z" => Role::Coordinate(2),
        "red" | "diffuse_red" => Role::Colour(0),
        "green" | "diffuse_green" => Role::Colour(1),
        "blue" | "diffuse_blue" => Role::Colour(2),
        "label" => Role::Label,
        _ => Role::Ignored,
    }
}

/// The use of every vertex property. Of several with the same use, the first has it.
fn roles_of(element: &Element) -> Vec<(Kind, Role)> {
    let mut roles: Vec<(Kind, Role)> = Vec::new();
    for property in &element.properties {
        let role = match property.kind {
            Kind::Scalar(_) => role_of(property),
            Kind::List(..) => Role::Ignored,
        };
        let taken = roles.iter().any(|(_, other)| *other == role);
        roles.push((property.kind, if taken { Role::Ignored } else { role }));
    }
    roles
}

/// A vertex while its properties come in.
struct VertexReader {
    properties: Vec<(Kind, Role)>,
    has_colour: bool,
    position: [f64; 3],
    colour: [f32; 3],
}

fn read_vertices<'a>(
    element: &'a Element,
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
    note_properties(element, parsed, |at| reader.properties[at].1 != Role::Ignored);
    Ok(())
}

impl VertexReader {
    fn new(element: &Element) -> Result<Self, Fault> {
        let properties = roles_of(element);
        let has = |role: Role| properties.iter().any(|(_, found)| *found == role);
        if !(0..3).all(|axis| has(Role::Coordinate(axis))) {
            return Err(Place::File.malformed("PLY header: the vertices have no x, y and z"));
        }
        let has_colour = (0..3).all(|channel| has(Role::Colour(channel)));
        Ok(Self { properties, has_colour, position: [0.0; 3], colour: [0.0; 3] })
    }

    fn read(&mut self, values: &mut Values, place: Place, out: &mut Parsed) -> Result<(), Fault> {
        for &(kind, role) in &self.properties {
            let Kind::Scalar(scalar) = kind else {
                values.skip(kind)?;
                continue;
            };
            let value = values.scalar(scalar)?;
            match role {
                Role::Coordinate(axis) => self.position[axis] = value,
                Role::Colour(channel) => {
                    let full = if scalar.is_integer() { 1.0 } else { 255.0 };
                    self.colour[channel] = value as f32 * full;
                }
                Role::Label => out.labels.push(whole(value, place, "label")?),
                Role::Ignored => {}
            }
        }
        out.push_vertex(self.position, place);
        if self.has_colour {
            out.colours.push(self.colour);
        }
        Ok(())
    }
}

fn read_faces<'a>(
    element: &'a Element,
    vertices: usize,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let list = corner_list(element)?;
    let mut corners = Vec::new();
    for face in 0..element.count {
        values.begin(element, face)?;
        let place = values.place(Place::Face(face));
        corners.clear();
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List(length, index) if at == list => {
                    for _ in 0..values.list_length(length)? {
                        let index = whole(values.scalar(index)?, place, "face index")?;
                        corners.push(place.vertex(index, vertices)?);
                    }
                }
                kind => values.skip(kind)?,
            }
        }
        values.end()?;
        parsed.push_polygon(&corners);
    }
    note_properties(element, parsed, |at| at == list);
    Ok(())
}

/// The list that holds the corners of faces or the vertices of strips: the first of the usual names,
/// else the only list of integers.
fn corner_list(element: &Element) -> Result<usize, Fault> {
    let lists = || {
        let of_integers = |property: &Property| match property.kind {
            Kind::List(_, item) => item.is_integer(),
            Kind::Scalar(_) => false,
        };
        element.properties.iter().enumerate().filter(move |(_, p)| of_integers(p))
    };
    let usual = |property: &Property| {
        let list = matches!(property.kind, Kind::List(..));
        list && matches!(property.name.as_str(), "vertex_indices" | "vertex_index")
    };
    let only = || lists().next().filter(|_| lists().count() == 1).map(|(at, _)| at);
    element.properties.iter().position(usual).or_else(only).ok_or_else(|| {
        let name = &element.name;
        let what = format!("PLY header: no list of element \"{name}\" is called vertex_indices");
        Place::File.malformed(what)
    })
}

/// Triangle strips, parted by negative numbers. Every second triangle of a strip is turned.
fn read_strips<'a>(
    element: &'a Element,
    vertices: usize,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let list = corner_list(element)?;
    for at in 0..element.count {
        values.begin(element, at)?;
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List(length, index) if at == list => {
                    let length = values.list_length(length)?;
                    read_strip(length, index, vertices, values, parsed)?;
                }
                kind => values.skip(kind)?,
            }
        }
        values.end()?;
    }
    note_properties(element, parsed, |at| at == list);
    Ok(())
}

fn read_strip(
    length: u64,
    scalar: Scalar,
    vertices: usize,
    values: &mut Values,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    let place = values.place(Place::File);
    // The last two vertices, and how many the strip has so far.
    let (mut last, mut count) = ([0; 2], 0u64);
    for _ in 0..length {
        let index = whole(values.scalar(scalar)?, place, "strip index")?;
        // A strip of unsigned numbers ends in −1 all the same.
        if index < 0 || (scalar == Scalar::Uint32 && index == i64::from(u32::MAX)) {
            count = 0;
            continue;
        }
        let vertex = place.vertex(index, vertices)?;
        count += 1;
        if count > 2 {
            let [a, b] = last;
            let turned = count.is_multiple_of(2);
            parsed.push_polygon(&if turned { [b, a, vertex] } else { [a, b, vertex] });
        }
        last = [last[1], vertex];
    }
    Ok(())
}

fn skip_element<'a>(
    element: &'a Element,
    values: &mut Values<'a>,
    parsed: &mut Parsed,
) -> Result<(), Fault> {
    for at in 0..element.count {
        values.begin(element, at)?;
        for property in &element.properties {
            values.skip(property.kind)?;
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

/// Lists the properties of an element that were read over.
fn note_properties(element: &Element, parsed: &mut Parsed, carried: impl Fn(usize) -> bool) {
    for (at, property) in element.properties.iter().enumerate() {
        if !carried(at) {
            parsed.notes.ignore(group_of(&element.name, &property.name), element.count as u64);
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

/// Writes binary little-endian PLY: positions as floats or doubles, labels where the mesh has them, and one scalar per
/// vertex (`#V`), for instance an error, under the given name.
pub(super) fn write_ply(
    mesh: &Mesh,
    precision: Precision,
    scalar: Option<(&str, &[f32])>,
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    let real = match precision {
        Precision::Single => "float",
        Precision::Double => "double",
    };
    writeln!(out, "property {real} x\nproperty {real} y\nproperty {real} z")?;
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
            match precision {
                Precision::Single => out.write_all(&(*coordinate as f32).to_le_bytes())?,
                Precision::Double => out.write_all(&coordinate.to_le_bytes())?,
            }
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
