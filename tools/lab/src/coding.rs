//! Code that the tables of measurements share.

use anyhow::Result;
use kn_codec::{Decoder, Encoder, EncoderConfig, StepChoice};
use kn_mesh::Mesh;
use kn_metrics::{CompareOptions, Interpolation, P2s, msdm2, p2s};
use std::io::Cursor;

/// Settings in which nothing is chosen by cost, so that rows differ in what they name alone.
pub(crate) fn without_choices() -> EncoderConfig {
    EncoderConfig::default()
        .with_labels(kn_codec::LabelChoice::Given)
        .with_combination(kn_codec::params::Combination::RTSH)
        .with_translation_step(StepChoice::Fixed(2.0))
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

/// A mesh prepared for measuring.
pub(crate) struct Surface(kn_metrics::Surface);

impl Surface {
    pub(crate) fn new(mesh: &Mesh) -> Result<Self> {
        Ok(Self(kn_metrics::Surface::new(mesh.into(), &CompareOptions::perceptual())?))
    }

    /// Distances between two surfaces, with so many area-uniform samples on each.
    pub(crate) fn distance(&self, other: &Self, samples: usize) -> Result<P2s> {
        Ok(p2s(self.0.indexed(), other.0.indexed(), samples)?)
    }

    /// Symmetric MSDM2; no number where a surface was prepared without it, which none is.
    pub(crate) fn msdm2(&self, other: &Self) -> f64 {
        let both = self.0.perceptual().zip(other.0.perceptual());
        both.map_or(f64::NAN, |(a, b)| msdm2(a, b, Interpolation::AtVertex).symmetric)
    }
}
