//! PLY in its three encodings, with the headers that are found.

use super::damage::decimal;
use super::random::Random;
use super::shape::Shape;

/// How the values are written.
#[derive(Clone, Copy, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

struct Writer<'a> {
    shape: &'a Shape,
    encoding: Encoding,
    /// The type of coordinates.
    real: &'static str,
    /// The types of the lengths and of the items of lists.
    list: (&'static str, &'static str),
    /// Properties before and after the position, of type `uchar`.
    padding: (usize, usize),
    bytes: Vec<u8>,
}

pub(super) fn write(shape: &Shape, random: &mut Random) -> Vec<u8> {
    let mut writer = Writer {
        shape,
        encoding: random.pick(&[Encoding::Ascii, Encoding::Little, Encoding::Big]),
        real: random.pick(&["float", "float", "double", "float32", "int", "Float64"]),
        list: random.pick(&[
            ("uchar", "int"),
            ("uint8", "uint"),
            ("int", "int"),
            ("short", "uint64"),
            ("float", "ushort"),
        ]),
        padding: random.pick(&[(0, 0), (0, 0), (1, 3)]),
        bytes: Vec::new(),
    };
    let strips = random.chance(5);
    let faces_first = random.chance(6);
    writer.header(strips, faces_first, random);
    if faces_first {
        writer.faces(strips, random);
        writer.vertices(random);
    } else {
        writer.vertices(random);
        writer.faces(strips, random);
    }
    writer.bytes
}

impl Writer<'_> {
    fn header(&mut self, strips: bool, faces_first: bool, random: &mut Random) {
        let encoding = match self.encoding {
            Encoding::Ascii => "ascii",
            Encoding::Little => "binary_little_endian",
            Encoding::Big => "binary_big_endian",
        };
        let wrong = random.pick(&[0, 0, 0, 0, 0, 0, 1, 1 << 40]);
        let pad = |count: usize| "property uchar pad\n".repeat(count);
        let real = self.real;
        let axes =
            random.pick(&[["x", "y", "z"], ["x", "y", "z"], ["X", "Y", "Z"], ["x", "y", "x"]]);
        let axes = axes.map(|axis| format!("property {real} {axis}\n")).concat();
        let count = self.shape.positions.len() + wrong;
        let vertices =
            format!("element vertex {count}\n{}{axes}{}", pad(self.padding.0), pad(self.padding.1));
        let name =
            random.pick(&["vertex_indices", "vertex_index", "vertex_list", "Vertex_Indices"]);
        let (length, item) = self.list;
        let faces = match strips {
            true => format!("element tristrips 1\nproperty list int {item} {name}\n"),
            false => {
                let count = self.shape.faces.len();
                format!("element face {count}\nproperty list {length} {item} {name}\n")
            }
        };
        let (first, second) = if faces_first { (faces, vertices) } else { (vertices, faces) };
        let odd = random.pick(&["", "", "comment a\n", "obj_info b\n", "\n", "author c\n"]);
        let space = random.pick(&["", "", " ", "\t"]);
        let text = format!("ply\n{space}format {encoding} 1.0\n{odd}{first}{second}end_header\n");
        let end = random.pick(&["\n", "\n", "\r\n", "\r"]);
        self.bytes.extend(text.replace('\n', end).bytes());
    }

    fn vertices(&mut self, random: &mut Random) {
        for position in &self.shape.positions {
            (0..self.padding.0).for_each(|_| self.number("uchar", 7.0, random));
            position.iter().for_each(|x| self.number(self.real, *x, random));
            (0..self.padding.1).for_each(|_| self.number("uchar", 7.0, random));
            self.end_line();
        }
    }

    fn faces(&mut self, strips: bool, random: &mut Random) {
        let (length, item) = self.list;
        if strips {
            let strips: Vec<i64> =
                self.shape.faces.iter().flat_map(|face| face.iter().copied().chain([-1])).collect();
            self.number("int", strips.len() as f64, random);
            strips.iter().for_each(|&index| self.number(item, index as f64, random));
            return self.end_line();
        }
        for face in &self.shape.faces {
            self.number(length, face.len() as f64, random);
            face.iter().for_each(|&index| self.number(item, index as f64, random));
            self.end_line();
        }
    }

    fn number(&mut self, kind: &str, value: f64, random: &mut Random) {
        let little: Vec<u8> = match (self.encoding, kind) {
            (Encoding::Ascii, "float" | "double" | "float32" | "Float64") => {
                return self.bytes.extend(format!("{} ", decimal(value, random)).bytes());
            }
            (Encoding::Ascii, _) => {
                return self.bytes.extend(format!("{} ", value as i64).bytes());
            }
            (_, "uchar" | "uint8") => vec![value as u8],
            (_, "short" | "ushort") => (value as i16).to_le_bytes().into(),
            (_, "float" | "float32") => (value as f32).to_le_bytes().into(),
            (_, "double" | "Float64") => value.to_le_bytes().into(),
            (_, "uint64") => (value as i64).to_le_bytes().into(),
            _ => (value as i64 as i32).to_le_bytes().into(),
        };
        match self.encoding {
            Encoding::Big => self.bytes.extend(little.iter().rev()),
            _ => self.bytes.extend(little),
        }
    }

    fn end_line(&mut self) {
        if self.encoding == Encoding::Ascii {
            self.bytes.push(b'\n');
        }
    }
}
