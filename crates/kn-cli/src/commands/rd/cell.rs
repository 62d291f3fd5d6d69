//! A cell of the matrix: one sequence, one codec, one rate point.

use super::clock::timed;
use super::config::{CodecEntry, CodecLabels, RateEntry, SequenceEntry, merged};
use super::results::{CellResult, FrameResult};
use super::sequences::{Sequence, hex};
use super::store::Store;
use crate::output::write_file;
use crate::settings::{apply_table, check_settings, flags_of};
use crate::stream::{self, kind_letter};
use anyhow::{Context, Result, ensure};
use kn_bitstream::params::is_frame_name;
use kn_codec::{Encoder, EncoderConfig, LabelChoice};
use kn_mesh::Mesh;
use kn_metrics::CompareOptions;
use kn_sequence::compare_frames;
use sha2::{Digest, Sha256};
use std::path::Path;

/// The settings of a cell before its sequence is opened, checked.
///
/// # Errors
/// Settings that contradict each other, named by their flags and by the cell.
pub(super) fn encoder_config(
    entry: &SequenceEntry,
    codec: &CodecEntry,
    rate: &RateEntry,
) -> Result<EncoderConfig> {
    let mut config = codec.preset()?.config();
    apply_table(&merged(codec, entry, rate), &mut config)?;
    check_settings(&config)
        .with_context(|| format!("{}, {}, {}", entry.name, codec.name, rate.name))?;
    Ok(config)
}

/// Changes when the same cell would be measured or written differently.
const FORMAT: u32 = 1;

/// The sequence and the settings of a cell.
pub(super) struct Cell<'p> {
    pub(super) sequence: &'p Sequence,
    pub(super) codec: &'p CodecEntry,
    pub(super) rate: &'p RateEntry,
    labels: CodecLabels,
    config: EncoderConfig,
    metrics: CompareOptions,
    pub(super) key: String,
}

impl<'p> Cell<'p> {
    /// # Errors
    /// Settings that contradict each other.
    pub(super) fn new(
        (sequence, entry): (&'p Sequence, &SequenceEntry),
        codec: &'p CodecEntry,
        rate: &'p RateEntry,
        metrics: CompareOptions,
    ) -> Result<Self> {
        let mut config = encoder_config(entry, codec, rate)?
            .with_frame_rate(sequence.rate)
            .with_up_axis(sequence.up_axis)
            .with_names(sequence.pattern.clone());
        config.sequence.grid = config.sequence.grid.with_bounds(Some(sequence.bounds));
        check_settings(&config)?;
        let labels = match codec.labels {
            CodecLabels::Sequence if entry.auto_labels() => CodecLabels::Auto,
            labels => labels,
        };
        config.intra.labels = match labels {
            CodecLabels::Sequence => config.intra.labels,
            CodecLabels::Auto => LabelChoice::Auto,
            CodecLabels::None => LabelChoice::Given,
        };
        let key = String::new();
        let metrics = metrics.with_bounds(sequence.bounds);
        let mut cell = Self { sequence, codec, rate, labels, config, metrics, key };
        cell.key = cell.digest();
        Ok(cell)
    }

    /// The key of the cache: whatever the result depends on but the program itself.
    fn digest(&self) -> String {
        let mut digest = Sha256::new();
        let (version, labels) = (env!("CARGO_PKG_VERSION"), self.labels);
        let (config, metrics, frames) = (&self.config, &self.metrics, &self.sequence.info.digest);
        // Debug prints every field, those of later versions too.
        let names = &self.sequence.names;
        digest.update(format!(
            "{FORMAT} {version} {labels:?} {config:?} {metrics:?} {frames} {names:?}"
        ));
        hex(digest)
    }

    /// A command that writes the same stream.
    pub(super) fn command(&self, entry: &SequenceEntry) -> Result<String> {
        let mut words = vec!["kn".to_owned(), "encode".into()];
        words.extend(self.sequence.arguments(self.labels));
        words.extend(["-o".into(), format!("{}.knm", &self.key[..16])]);
        words.extend(["--preset".into(), self.codec.preset()?.name().into()]);
        words.extend(flags_of(&merged(self.codec, entry, self.rate)));
        Ok(words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" "))
    }

    /// Encodes, decodes and measures with the threads of the current pool. The stream is kept.
    ///
    /// # Errors
    /// A frame that cannot be coded or measured, a file that cannot be written.
    pub(super) fn run(&self, store: &Store, build: &str) -> Result<CellResult> {
        let path = store.stream(&self.key);
        let encode_seconds = self.encode(&path)?;
        let mut result = CellResult {
            key: self.key.clone(),
            version: env!("CARGO_PKG_VERSION").into(),
            build: build.into(),
            settings: format!("{:?}", self.config),
            bytes: std::fs::metadata(&path).with_context(|| stream::name_of(&path))?.len(),
            threads: rayon::current_num_threads(),
            encode_seconds,
            decode_seconds: 0.0,
            measure_seconds: 0.0,
            frames: Vec::new(),
        };
        self.measure(&path, &mut result)?;
        store.save(&result)?;
        Ok(result)
    }

    /// Writes the stream; returns the processor seconds inside the encoder.
    fn encode(&self, path: &Path) -> Result<f64> {
        let mut seconds = 0.0;
        write_file(path, |out| {
            let named = |error| self.sequence.name_file(error);
            let mut encoder = Encoder::new(out, self.config.clone())?;
            for index in 0..self.sequence.len() {
                let mesh = self.sequence.frame(index, self.labels)?;
                let name = Some(&self.sequence.names[index][..]).filter(|name| is_frame_name(name));
                let name = name.unwrap_or_default();
                timed(&mut seconds, || encoder.push_named(&mesh, name)).map_err(named)?;
                encoder.drain_reports();
            }
            timed(&mut seconds, || encoder.finish()).map_err(named)?;
            Ok(())
        })?;
        Ok(seconds)
    }

    fn measure(&self, path: &Path, result: &mut CellResult) -> Result<()> {
        let mut decoder = stream::decoder(path)?;
        let mut mesh = Mesh::default();
        for index in 0..self.sequence.len() {
            let decoded = timed(&mut result.decode_seconds, || decoder.next_frame(&mut mesh));
            let info = decoded.with_context(|| stream::name_of(path))?;
            let info = info.with_context(|| format!("frame {index} is not in the stream"))?;
            let scan = self.sequence.frame(index, CodecLabels::None)?;
            let comparison =
                timed(&mut result.measure_seconds, || compare_frames(&scan, &mesh, &self.metrics));
            result.frames.push(FrameResult {
                index: info.index,
                kind: kind_letter(info.kind).into(),
                bytes: info.bytes,
                vertices: info.vertices,
                nodes: info.nodes,
                comparison: comparison.with_context(|| format!("frame {index}"))?,
            });
        }
        let more = decoder.next_frame(&mut mesh).with_context(|| stream::name_of(path))?;
        ensure!(more.is_none(), "the stream has more frames than the sequence");
        Ok(())
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:,+%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("--gof=8"), "--gof=8");
        assert_eq!(quoted("scan/*.obj"), "'scan/*.obj'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
