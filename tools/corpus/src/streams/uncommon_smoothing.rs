//! I-frames whose smoothing (8.5) hangs on which vertices have neighbours, or on a last bit.

use anyhow::Result;

use super::Draft;
use super::shapes::{Noise, curled, knotted, mesh, sphere, together, torus, without_vertex};
use super::texts::{HEADER, INDEX, Text, intra_unit, payload_of};

/// Of each frame the size, the noise and the strength.
const FRAMES: [(f64, i32, u8); 5] =
    [(9.0, 0, 1), (900.0, 3, 2), (3000.0, 400, 3), (1e6, 40_000, 4), (40.0, 1, 5)];

pub(crate) fn drafts() -> Result<Vec<Draft>> {
    [8, 1].into_iter().map(stream).collect()
}

fn stream(fraction_bits: u8) -> Result<Draft> {
    let mut text = Text::new(HEADER)
        .set("fraction_bits", 0, &fraction_bits.to_string())
        .set("label_set", 0, "0")
        .build();
    for (frame, (size, noise, strength)) in (0..).zip(FRAMES) {
        let mut random = Noise::new(frame);
        let open = without_vertex(&torus(5, 6), 7);
        let mut faces = knotted(together(&[open, sphere(5, 3), torus(6, 7)]), &[2, 3], &mut random);
        faces.extend([[0, 0, 1], [5, 5, 5], [30, 31, 31], [60, 61, 61]]);
        let mut mesh = mesh(faces, |v| curled(v, size, noise), None);
        mesh.positions.push([7, 5, -3]);
        let unit = Text::new(&intra_unit(&payload_of(&mesh)?));
        text += &unit.set("smoothing_strength", 0, &strength.to_string()).build();
    }
    Ok(Draft {
        name: format!("smoothing_{fraction_bits}"),
        text: text + INDEX,
        danger: "Holes, joined points, an isolated vertex and faces that repeat a vertex; noise beyond half a step."
            .into(),
        rule: None,
        covers: &[
            "smooth.neighbours",
            "smooth.operator",
            "smooth.pass",
            "smooth.clamp",
            "intra.faces.raw",
        ],
    })
}
