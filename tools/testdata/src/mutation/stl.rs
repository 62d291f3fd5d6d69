//! STL, text and binary.

use super::damage::{decimal, with_line_ends};
use super::random::Random;
use super::shape::Shape;
use std::fmt::Write;

pub(super) fn write(shape: &Shape, random: &mut Random) -> Vec<u8> {
    let facets: Vec<Vec<[f64; 3]>> = shape.faces.iter().map(|face| corners(face, shape)).collect();
    if random.chance(2) { text(&facets, random) } else { binary(&facets, random) }
}

fn corners(face: &[i64], shape: &Shape) -> Vec<[f64; 3]> {
    let at = |&index: &i64| usize::try_from(index).ok().and_then(|at| shape.positions.get(at));
    face.iter().filter_map(at).copied().collect()
}

fn text(facets: &[Vec<[f64; 3]>], random: &mut Random) -> Vec<u8> {
    let name = random.pick(&["", " a b", " facet", " SOLID"]);
    let mut text = format!("solid{name}\n");
    for facet in facets {
        let normal = random.pick(&["0 0 1", "nan nan nan", "", "0 0"]);
        writeln!(text, " facet normal {normal}\n  outer loop").expect("memory");
        for position in facet {
            let [x, y, z] = position.map(|coordinate| decimal(coordinate, random));
            writeln!(text, "   vertex {x} {y} {z}").expect("memory");
        }
        text += "  endloop\n endfacet\n";
        if random.chance(30) {
            text +=
                random.pick(&["endsolid\nsolid b\n", "facet\n", "vertex 0 0 0\n", "endfacet\n"]);
        }
    }
    text += random.pick(&["endsolid\n", "endsolid a b\n", "end solid", "", "endsolid\n\0"]);
    let text = if random.chance(4) { text.to_uppercase() } else { text };
    with_line_ends(&text, random)
}

fn binary(facets: &[Vec<[f64; 3]>], random: &mut Random) -> Vec<u8> {
    let mut bytes = random.pick(&["solid x", "binary", ""]).as_bytes().to_vec();
    bytes.resize(80, random.pick(&[0, b' ']));
    let triangles: Vec<_> = facets.iter().filter(|facet| facet.len() == 3).collect();
    let count = random.pick(&[triangles.len() as u32; 6]);
    bytes.extend(random.pick(&[count, count, count, 0, u32::MAX, count + 1]).to_le_bytes());
    for triangle in triangles {
        bytes.extend([0; 12]);
        triangle.as_flattened().iter().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
        bytes.extend(random.pick(&[[0, 0], [0, 0], [1, 2]]));
    }
    bytes
}
