//! Any small meshes encode, and decode to the encoder's own reconstruction, or the encoder says why
//! not.
#![no_main]

use kn_bitstream::params::{BodyPart, Combination, InfluenceMode, Weights};
use std::io::Cursor;

use kn_bitstream::MAX_SMOOTHING;
use kn_codec::{AffineChoice, CombinationChoice, Decoder, Encoder, EncoderConfig, GridChoice};
use kn_codec::{LabelChoice, NodeChoice, SmoothingChoice, StepChoice};
use kn_mesh::Mesh;
use libfuzzer_sys::arbitrary::{self, Arbitrary};
use libfuzzer_sys::fuzz_target;

#[derive(Arbitrary, Debug)]
struct Case {
    combination: u8,
    affine: u8,
    weights: u8,
    strict: bool,
    labelled: bool,
    /// Whether labels are found where there are none.
    found: bool,
    bits: u8,
    nodes: u8,
    nodes_per_vertex: u8,
    fraction_bits: u8,
    group_length: u8,
    motion_step: u8,
    frames: Vec<Frame>,
}

#[derive(Arbitrary, Debug)]
struct Frame {
    /// Coordinates on a small lattice, so that vertices and distances coincide; label.
    vertices: Vec<([i8; 3], u8)>,
    faces: Vec<[u8; 3]>,
}

impl Frame {
    /// Corners are taken modulo the number of vertices.
    fn mesh(&self, labelled: bool) -> Mesh {
        let vertices = &self.vertices[..self.vertices.len().min(48)];
        let count = vertices.len().max(1) as u32;
        let corner = |&corner: &u8| u32::from(corner) % count;
        let faces = self.faces.iter().take(64).filter(|_| !vertices.is_empty());
        let positions = vertices.iter().map(|(p, _)| p.map(|c| f64::from(c) / 16.0)).collect();
        let labels = vertices.iter().filter(|_| labelled).map(|(_, label)| label % 15).collect();
        Mesh::new(positions, faces.map(|face| face.each_ref().map(corner)).collect()).with_labels(labels)
    }
}

impl Case {
    fn config(&self) -> EncoderConfig {
        EncoderConfig::default().with_grid(GridChoice::Bits { bits: 4 + self.bits % 17, bounds: None }).with_group_length(1 + self.group_length % 5).with_nodes(match 1 + usize::from(self.nodes % 24) {
                most if self.nodes >= 192 => NodeChoice::Cost { most },
                count => NodeChoice::Fixed(count),
            }).with_nodes_per_vertex(1 + self.nodes_per_vertex % 8).with_fraction_bits(self.fraction_bits % 9).with_combination(match self.combination % 11 {
                8 => CombinationChoice::FirstP,
                9 => CombinationChoice::PerFrame,
                10 => CombinationChoice::LookAhead,
                fixed => CombinationChoice::Fixed(Combination::ALL[usize::from(fixed)]),
            }).with_labels(if self.found { LabelChoice::Auto } else { LabelChoice::Given }).with_affine(match self.affine % 4 {
                0 => AffineChoice::None,
                1 => AffineChoice::All,
                2 => AffineChoice::Cost,
                _ => AffineChoice::Labels(BodyPart::from_label(self.affine % 15).into_iter().collect()),
            }).with_smoothing(match self.affine / 4 % 8 {
                strength if strength <= MAX_SMOOTHING => SmoothingChoice::Strength(strength),
                _ => SmoothingChoice::Auto,
            }).with_weights(match self.weights % 3 {
                0 => Weights::INVERSE_SQUARE,
                1 => Weights::SUMNER,
                _ => Weights::gaussian(1 + u32::from(self.weights)),
            }).with_influence(if self.strict { InfluenceMode::Strict } else { InfluenceMode::Fallback }).with_translation_step(match self.motion_step {
                0 => StepChoice::Cost,
                step => StepChoice::Fixed(f64::from(step) / 16.0),
            })
    }
}

fuzz_target!(init: kn_fuzz::one_thread(), |case: Case| {
    let Ok(mut encoder) = Encoder::new(Vec::new(), case.config()) else { return };
    let frames = &case.frames[..case.frames.len().min(4)];
    for frame in frames {
        if encoder.push(&frame.mesh(case.labelled)).is_err() {
            return;
        }
    }
    let Ok(finished) = encoder.finish() else { return };
    // The digests in the stream are those of the encoder's reconstruction.
    let mut decoder = Decoder::new(Cursor::new(finished.writer)).expect("our own stream");
    decoder.check_digests(true);
    let mut mesh = Mesh::default();
    let mut count = 0;
    while decoder.next_frame(&mut mesh).expect("our own stream").is_some() {
        count += 1;
    }
    assert_eq!(count, frames.len());
});
