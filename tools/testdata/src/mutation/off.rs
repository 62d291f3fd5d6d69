//! OFF, text and binary.

use super::damage::{decimal, with_line_ends};
use super::random::Random;
use super::shape::Shape;
use std::fmt::Write;

pub(super) fn write(shape: &Shape, random: &mut Random) -> Vec<u8> {
    let keyword = random.pick(&["OFF", "OFF", "COFF", "NOFF", "STCN4OFF", "4OFF", "off", "nOFF"]);
    let wrong = random.pick(&[0, 0, 0, 0, 0, 1, -1, 1 << 30]);
    let counts = [shape.positions.len() as i64, shape.faces.len() as i64 + wrong, 0];
    if random.chance(3) {
        return binary(keyword, counts, shape);
    }
    let [vertices, faces, edges] = counts;
    let mut text = keyword.to_owned();
    text += random.pick(&["\n", "\n", " ", "", " # a comment\n\n"]);
    writeln!(text, "{vertices} {faces} {edges}").expect("memory");
    let further = random.pick(&["", "", " 1", " 255 0 0", " 0 0 1 x"]);
    for position in &shape.positions {
        let [x, y, z] = position.map(|coordinate| decimal(coordinate, random));
        writeln!(text, "{x} {y} {z}{further}").expect("memory");
    }
    let colour = random.pick(&["", "", " 255 0 0", " 0.5"]);
    for face in &shape.faces {
        let corners: Vec<String> = face.iter().map(i64::to_string).collect();
        writeln!(text, "{} {}{colour}", face.len(), corners.join(" ")).expect("memory");
    }
    with_line_ends(&text, random)
}

fn binary(keyword: &str, counts: [i64; 3], shape: &Shape) -> Vec<u8> {
    let mut bytes = format!("{keyword} BINARY\n").into_bytes();
    let integer = |value: i64| (value as i32).to_be_bytes();
    bytes.extend(counts.map(integer).as_flattened());
    let further = 4 * usize::from(keyword.contains('C'))
        + 3 * usize::from(keyword.contains('N'))
        + 2 * usize::from(keyword.contains("ST"))
        + usize::from(keyword.contains('4'));
    for position in &shape.positions {
        position.iter().for_each(|x| bytes.extend((*x as f32).to_be_bytes()));
        (0..further).for_each(|_| bytes.extend(1f32.to_be_bytes()));
    }
    for face in &shape.faces {
        bytes.extend(integer(face.len() as i64));
        face.iter().for_each(|&corner| bytes.extend(integer(corner)));
        bytes.extend(integer(0));
    }
    bytes
}
