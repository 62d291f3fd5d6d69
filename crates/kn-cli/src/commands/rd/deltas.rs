//! Bjøntegaard deltas of every codec against the anchors.

use super::curves::{self, Curve, Quality};
use super::results::Share;
use kn_metrics::{BdRate, bd_rate};
use serde::Serialize;

/// One codec against one anchor on one sequence.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Delta {
    pub(super) anchor: String,
    pub(super) codec: String,
    pub(super) sequence: String,
    #[serde(serialize_with = "quality_name")]
    pub(super) quality: Quality,
    pub(super) share: Share,
    #[serde(flatten)]
    pub(super) found: Found,
}

/// A delta rate, or why there is none.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Found {
    Rate {
        /// Per cent.
        pchip: f64,
        cubic: Option<f64>,
        overlap: f64,
        /// Points left out: of the anchor, of the codec.
        dominated: [usize; 2],
        /// The curves share too little for the value to be trusted.
        overlap_is_small: bool,
    },
    None {
        reason: String,
    },
}

impl From<BdRate> for Found {
    fn from(rate: BdRate) -> Self {
        Self::Rate {
            pchip: rate.pchip,
            cubic: rate.cubic,
            overlap: rate.overlap,
            dominated: [rate.dominated.anchor, rate.dominated.test],
            overlap_is_small: rate.overlap_is_small(),
        }
    }
}

impl Delta {
    /// The PCHIP value, per cent.
    pub(super) fn pchip(&self) -> Option<f64> {
        match self.found {
            Found::Rate { pchip, .. } => Some(pchip),
            Found::None { .. } => None,
        }
    }
}

fn quality_name<S: serde::Serializer>(quality: &Quality, out: S) -> Result<S::Ok, S::Error> {
    out.serialize_str(quality.metric().name())
}

/// All deltas: by anchor, share, quality, codec, sequence. Curves from tables have no P-frames of
/// their own, so that they are compared by all bytes only.
pub(super) fn all(curves: &[Curve], anchors: &[String]) -> Vec<Delta> {
    let qualities = curves::qualities(curves);
    let mut deltas = Vec::new();
    for anchor in anchors {
        for share in [Share::All, Share::Predicted] {
            for &quality in &qualities {
                for codec in curves::codecs(curves) {
                    deltas.extend(of_codec(curves, anchor, codec, quality, share));
                }
            }
        }
    }
    deltas
}

fn of_codec<'a>(
    curves: &'a [Curve],
    anchor: &'a str,
    codec: &'a str,
    quality: Quality,
    share: Share,
) -> impl Iterator<Item = Delta> + 'a {
    let tests = curves.iter().filter(move |curve| curve.codec == codec && codec != anchor);
    tests.filter_map(move |test| {
        let same = |curve: &&Curve| curve.codec == anchor && curve.sequence == test.sequence;
        let reference = curves.iter().find(same)?;
        let [a, b] = [reference, test].map(|curve| curve.rate_points(quality, share));
        if a.is_empty() || b.is_empty() {
            return None;
        }
        let found = match bd_rate(&a, &b) {
            Ok(rate) => Found::from(rate),
            Err(error) => Found::None { reason: error.to_string() },
        };
        Some(Delta {
            anchor: anchor.into(),
            codec: codec.into(),
            sequence: test.sequence.clone(),
            quality,
            share,
            found,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::curves::Point;
    use super::*;

    fn curve(codec: &str, points: &[(f64, f64)]) -> Curve {
        let point = |&(bytes, psnr)| {
            Point::foreign("p".into(), bytes, [Some(1.0 - psnr / 100.0), Some(psnr), None, None])
        };
        Curve {
            sequence: "s".into(),
            codec: codec.into(),
            foreign: false,
            points: points.iter().map(point).collect(),
        }
    }

    #[test]
    fn half_the_bytes_is_minus_fifty_per_cent_in_either_metric() {
        let anchor = curve("a", &[(100.0, 50.0), (200.0, 60.0), (400.0, 65.0)]);
        let half = curve("b", &[(50.0, 50.0), (100.0, 60.0), (200.0, 65.0)]);
        let apart = curve("c", &[(50.0, 80.0), (100.0, 90.0)]);
        let deltas = all(&[anchor, half, apart], &["a".into()]);
        let values: Vec<_> = deltas.iter().map(|delta| (delta.codec.as_str(), delta)).collect();
        assert_eq!(values.len(), 4, "two codecs, two metrics");
        for (codec, delta) in values {
            match (codec, &delta.found) {
                ("b", Found::Rate { pchip, overlap_is_small: false, .. }) => {
                    assert!((pchip + 50.0).abs() < 1e-9, "{pchip}");
                }
                ("c", Found::None { reason }) => assert!(reason.contains("do not overlap")),
                other => panic!("{other:?}"),
            }
        }
    }
}
