//! What the tables of measurements share.

use anyhow::Result;
use kn_codec::{Decoder, Encoder, EncoderConfig, StepChoice};
use kn_mesh::Mesh;
use kn_metrics::{DEFAULT_LEVELS, Interpolation, Msdm2Surface, P2s, TriangleTree, msdm2, p2s};
use std::io::Cursor;

/// Settings in which nothing is chosen by cost, so that rows differ in what they name alone.
pub(crate) fn without_choices() -> EncoderConfig {
    EncoderConfig {
        labels: kn_codec::LabelChoice::Given,
        combination: kn_codec::params::Combination::RTSH.into(),
        motion_step: StepChoice::Fixed(2.0),
        ..EncoderConfig::default()
    }
}

/// The bytes of the P-frames, and all frames as they are decoded.
pub(crate) fn code(frames: &[Mesh], config: EncoderConfig) -> Result<(u64, Vec<Mesh>)> {
    let mut encoder = Encoder::new(Vec::new(), config)?;
    for frame in frames {
        encoder.push(frame)?;
    }
    let finished = encoder.finish()?;
    let mut decoder = Decoder::new(Cursor::new(finished.writer))?;
    let (mut decoded, mut mesh) = (Vec::new(), Mesh::default());
    while decoder.next_frame(&mut mesh)?.is_some() {
        decoded.push(mesh.clone());
    }
    Ok((finished.summary.predicted_bytes, decoded))
}

/// A mesh with what its distortion is measured on.
pub(crate) struct Surface {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    tree: TriangleTree,
    perceptual: Msdm2Surface,
}

impl Surface {
    pub(crate) fn new(mesh: &Mesh) -> Result<Self> {
        let (positions, faces) = (mesh.positions_f64(), mesh.faces.clone());
        Ok(Self {
            tree: TriangleTree::new(&positions, &faces)?,
            perceptual: Msdm2Surface::new(&positions, &faces, DEFAULT_LEVELS)?,
            positions,
            faces,
        })
    }

    /// Distances between two surfaces, with so many area-uniform samples on each.
    pub(crate) fn distance(&self, other: &Self, samples: usize) -> Result<P2s> {
        Ok(p2s(self.side(), other.side(), samples)?)
    }

    /// Symmetric MSDM2.
    pub(crate) fn msdm2(&self, other: &Self) -> f64 {
        msdm2(&self.perceptual, &other.perceptual, Interpolation::AtVertex).symmetric
    }

    fn side(&self) -> (&[[f64; 3]], &[[u32; 3]], &TriangleTree) {
        (&self.positions, &self.faces, &self.tree)
    }
}
