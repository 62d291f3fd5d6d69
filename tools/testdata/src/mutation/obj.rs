//! OBJ, with the corners, comments, colours and material libraries that are found.

use super::File;
use super::damage::{decimal, with_line_ends};
use super::random::Random;
use super::shape::Shape;
use std::fmt::Write;

pub(super) fn write(shape: &Shape, random: &mut Random) -> (Vec<u8>, Vec<File>) {
    let mut text = String::new();
    let mut beside = Vec::new();
    if random.chance(3) {
        text += "mtllib mesh.mtl\nusemtl skin\n";
        beside.push(("mesh.mtl".to_owned(), library(random)));
    }
    for _ in 0..random.below(3) {
        text += random.pick(ODD_LINES);
    }
    let colour = random.pick(&["", "", " 0.5 1 0", " nan nan nan", " 1.0", " 1 2 3 4 5", " x y z"]);
    let mut vertices = String::new();
    for position in &shape.positions {
        let [x, y, z] = position.map(|coordinate| decimal(coordinate, random));
        writeln!(vertices, "v {x} {y} {z}{colour}").expect("memory");
    }
    let mut faces = String::new();
    let style = random.below(9);
    for face in &shape.faces {
        faces += random.pick(&["f", "f", "f", "f", "fo"]);
        for &index in face {
            let corner = corner(style, index, shape.positions.len());
            write!(faces, " {corner}").expect("memory");
            if random.chance(40) {
                faces += " \\\n";
            }
        }
        faces += "\n";
    }
    // Faces may come before the vertices that they use.
    text += &if random.chance(6) { faces + &vertices } else { vertices + &faces };
    text += random.pick(&["", "", "\0", "\x1a", "f\n", "f 1\n", "l 1 2\n"]);
    (with_line_ends(&text, random), beside)
}

const ODD_LINES: &[&str] = &[
    "# a comment \\\n",
    "$ made by hand\n",
    "\0\n",
    "o name \\\n",
    "s off\n",
    "vt 0 0\nvn 0 0 1\n",
    "curv 0 1 1 2\n",
    "v\n",
    "vp 1 2\n",
    "\u{2026}\n",
    "g\n",
    "mtllib\n",
    "mtllib ../../etc/passwd\n",
];

fn corner(style: usize, index: i64, vertices: usize) -> String {
    let one = index.saturating_add(1);
    match style {
        0 => format!("{one}/"),
        1 => format!("{one}//"),
        2 => format!("{one}/1"),
        3 => format!("{one}/1/"),
        4 => format!("{one}/1/1"),
        5 => format!("{one}//1"),
        6 => format!("{}", index.saturating_sub(vertices as i64)),
        _ => format!("{one}"),
    }
}

fn library(random: &mut Random) -> Vec<u8> {
    let mut text = String::from("newmtl skin\n");
    for _ in 0..random.below(6) {
        text += random.pick(&[
            "Kd 0.8\n",
            "Ks 1 1\n",
            "Ka\n",
            "Kd spectral a.rfl 1\n",
            "Ns x\n",
            "d\n",
            "map_Kd -o\n",
            "illum 99999999999\n",
            "newmtl\n",
            "\0\0\n",
            "Tf xyz 1 1 1\n",
        ]);
    }
    text.into_bytes()
}
