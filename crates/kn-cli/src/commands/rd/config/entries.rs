//! The entries of a configuration file.

use crate::arguments::FrameRange;
use crate::frames::FrameFiles;
use crate::nearest::nearest;
use anyhow::{Context, Result, anyhow, bail, ensure};
use kn_bitstream::params::{FrameRate, UpAxis};
use kn_codec::{NamedSetting, Preset};
use kn_io::Missing;
use kn_metrics::{CompareOptions, PointSampling};
use serde::de::Error;
use serde::{Deserialize, Deserializer};
use std::fmt::Display;
use std::num::NonZeroU16;
use std::str::FromStr;

/// Reads a value by its name.
fn by_name<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err: Display>,
{
    String::deserialize(deserializer)?.parse().map(Some).map_err(D::Error::custom)
}

/// Scans in files, or a performer.
#[derive(Debug, Deserialize)]
pub(crate) struct SequenceEntry {
    pub(crate) name: String,
    pub(crate) input: Option<String>,
    pub(crate) performer: Option<PerformerEntry>,
    /// A glob of label files, or `auto`.
    pub(crate) labels: Option<String>,
    pub(crate) frames: Option<String>,
    #[serde(default, deserialize_with = "by_name")]
    pub(crate) missing: Option<Missing>,
    pub(crate) every: Option<NonZeroU16>,
    pub(crate) fps: Option<toml::Value>,
    pub(crate) up: Option<String>,
    #[serde(flatten)]
    pub(crate) settings: toml::Table,
}

/// A synthetic performer; what is left out is as in `kn demo`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PerformerEntry {
    pub(crate) motion: Option<String>,
    pub(crate) frames: u32,
    pub(crate) vertices: Option<usize>,
    pub(crate) seed: Option<u64>,
    pub(crate) intensity: Option<f64>,
    pub(crate) noise: Option<f64>,
    pub(crate) holes: Option<u32>,
    pub(crate) ball: Option<bool>,
    pub(crate) tunic: Option<bool>,
}

/// A preset, perhaps with changes and a name of its own.
#[derive(Debug, Deserialize)]
pub(crate) struct CodecEntry {
    pub(crate) name: String,
    pub(crate) base: Option<String>,
    #[serde(default)]
    pub(crate) labels: CodecLabels,
    #[serde(flatten)]
    pub(crate) settings: toml::Table,
}

/// The labels that a codec is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum CodecLabels {
    /// Those of the sequence, if it has any; else what the preset does without.
    #[default]
    Sequence,
    /// Those that the encoder finds, whatever labels the sequence has.
    Auto,
    None,
}

/// A point of every curve.
#[derive(Debug, Deserialize)]
pub(crate) struct RateEntry {
    pub(crate) name: String,
    #[serde(flatten)]
    pub(crate) settings: toml::Table,
}

/// The metrics beside point-to-surface distances.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub(crate) struct MetricsEntry {
    pub(crate) msdm2: bool,
    pub(crate) d1d2: bool,
    /// Lines of MPEG's grid for D1 and D2; without it they are measured at vertices and samples.
    pub(crate) grid: Option<usize>,
}

impl Default for MetricsEntry {
    fn default() -> Self {
        Self { msdm2: true, d1d2: false, grid: None }
    }
}

impl MetricsEntry {
    pub(crate) fn options(&self) -> CompareOptions {
        let mut options = CompareOptions::default();
        options.msdm2 = self.msdm2;
        options.projected = false;
        let points = self.grid.map_or(PointSampling::Surface, PointSampling::Grid);
        options.points = self.d1d2.then_some(points);
        options
    }
}

/// A CSV table with points of other codecs.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableEntry {
    pub(crate) path: String,
    /// The codecs to take; all where it is left out.
    pub(crate) codecs: Option<Vec<String>>,
    #[serde(default)]
    pub(crate) columns: crate::commands::rd::tables::Columns,
}

/// Pictures of one frame of every sequence.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PicturesEntry {
    /// Counted from the first frame used.
    pub(crate) frame: u64,
    /// Degrees about the up axis.
    #[serde(default)]
    pub(crate) yaw: f32,
    /// The rate to compare at, kB a frame.
    pub(crate) rate: Option<f64>,
}

impl SequenceEntry {
    pub(super) fn check(&self) -> Result<()> {
        let own =
            ["name", "input", "performer", "labels", "frames", "missing", "every", "fps", "up"];
        check_keys(&self.settings, &own)?;
        ensure!(
            self.input.is_some() != self.performer.is_some(),
            "a sequence has either an input or a performer"
        );
        ensure!(
            self.performer.is_none() || self.label_files().is_none(),
            "a performer has labels of its own, or those of `labels = \"auto\"`"
        );
        self.frame_range()?;
        self.frame_rate()?;
        self.up_axis()?;
        Ok(())
    }

    /// Whether its own labels are not used.
    pub(crate) fn auto_labels(&self) -> bool {
        self.labels.as_deref() == Some("auto")
    }

    /// The label files that are named.
    pub(crate) fn label_files(&self) -> Option<&String> {
        self.labels.as_ref().filter(|_| !self.auto_labels())
    }

    /// The frames to use.
    pub(crate) fn frame_range(&self) -> Result<FrameRange> {
        let parse = |text: &String| text.parse().map_err(|reason: String| anyhow!(reason));
        self.frames.as_ref().map_or(Ok(FrameRange::default()), parse).context("frames")
    }

    /// The files that are frames.
    pub(crate) fn files(&self) -> FrameFiles {
        FrameFiles::new(self.missing, self.every)
    }

    /// Frames per second.
    pub(crate) fn frame_rate(&self) -> Result<FrameRate> {
        let text = match &self.fps {
            None => "30".into(),
            Some(toml::Value::String(text)) => text.clone(),
            Some(number) => number.to_string(),
        };
        // TOML writes whole floats as 30.0, which the flag takes too.
        text.parse().context("fps")
    }

    /// The axis that points up.
    pub(crate) fn up_axis(&self) -> Result<UpAxis> {
        let parse = |text: &String| text.parse();
        self.up.as_ref().map_or(Ok(UpAxis::default()), parse).context("up")
    }
}

impl CodecEntry {
    /// The preset that it starts from: `base`, or the one of its own name.
    pub(crate) fn preset(&self) -> Result<&'static Preset> {
        let name = self.base.as_ref().unwrap_or(&self.name);
        Preset::by_name(name).ok_or_else(|| {
            let names = Preset::all().iter().map(Preset::name);
            let known = names.clone().collect::<Vec<_>>().join(", ");
            anyhow!("there is no preset '{name}'{} (there are {known})", nearest(name, names))
        })
    }
}

/// Fields that an entry does not know must be settings.
pub(super) fn check_keys(settings: &toml::Table, own: &[&str]) -> Result<()> {
    let is_setting = |key: &&String| NamedSetting::by_name(key).is_some();
    let Some(unknown) = settings.keys().find(|key| !is_setting(key)) else { return Ok(()) };
    let known = own.iter().copied().chain(NamedSetting::all().iter().map(|named| named.name()));
    bail!("there is no key '{unknown}'{}", nearest(unknown, known))
}
