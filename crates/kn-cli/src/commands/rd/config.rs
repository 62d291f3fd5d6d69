//! The configuration file: its fields, and the checks of its values.

mod entries;

use crate::nearest::nearest;
use crate::settings::apply_table;
use anyhow::{Context, Result, anyhow, ensure};
pub(super) use entries::{
    CodecEntry, CodecLabels, PerformerEntry, PicturesEntry, RateEntry, SequenceEntry,
};
use entries::{MetricsEntry, TableEntry, check_keys};
use kn_codec::EncoderConfig;
use serde::Deserialize;
use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// A configuration of a study.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Config {
    /// Title of the report.
    pub(super) title: Option<String>,
    #[serde(rename = "sequence")]
    pub(super) sequences: Vec<SequenceEntry>,
    #[serde(rename = "preset")]
    pub(super) codecs: Vec<CodecEntry>,
    #[serde(rename = "rate")]
    pub(super) rates: Vec<RateEntry>,
    #[serde(default)]
    pub(super) metrics: MetricsEntry,
    /// Codecs that the others are compared with.
    #[serde(default)]
    pub(super) anchors: Vec<String>,
    /// Curves of other codecs.
    #[serde(default, rename = "csv")]
    pub(super) tables: Vec<TableEntry>,
    pub(super) pictures: Option<PicturesEntry>,
    /// The folder of the file, which relative paths start from.
    #[serde(skip)]
    pub(super) folder: PathBuf,
    /// The file as it is.
    #[serde(skip)]
    pub(super) text: String,
}

impl Config {
    /// Reads a file.
    ///
    /// # Errors
    /// The first mistake, with the file's name and the line or the entry.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let name = || path.display().to_string();
        let text = fs::read_to_string(path).with_context(name)?;
        let mut config = Self::parse(&text).with_context(name)?;
        config.folder = crate::output::folder_of(path).to_owned();
        config.text = text;
        Ok(config)
    }

    fn parse(text: &str) -> Result<Self> {
        let config: Self = toml::from_str(text).map_err(|error| toml_message(&error, text))?;
        config.check()?;
        Ok(config)
    }

    fn check(&self) -> Result<()> {
        check_names("sequence", self.sequences.iter().map(|entry| &entry.name))?;
        check_names("preset", self.codecs.iter().map(|entry| &entry.name))?;
        check_names("rate", self.rates.iter().map(|entry| &entry.name))?;
        for entry in &self.sequences {
            entry.check().with_context(|| format!("sequence '{}'", entry.name))?;
        }
        for entry in &self.codecs {
            let place = || format!("preset '{}'", entry.name);
            entry.preset().with_context(place)?;
            check_keys(&entry.settings, &["name", "base", "labels"]).with_context(place)?;
        }
        for entry in &self.rates {
            let place = || format!("rate '{}'", entry.name);
            check_keys(&entry.settings, &["name"]).with_context(place)?;
        }
        self.check_settings()
    }

    /// Every combination must make sense before any work begins.
    fn check_settings(&self) -> Result<()> {
        for sequence in &self.sequences {
            for codec in &self.codecs {
                for rate in &self.rates {
                    let table = merged(codec, sequence, rate);
                    apply_table(&table, &mut EncoderConfig::default()).with_context(|| {
                        format!("{}, {}, {}", sequence.name, codec.name, rate.name)
                    })?;
                }
            }
        }
        Ok(())
    }

    /// A path of the file: `${NAME}` is an environment variable, relative paths start from the
    /// file's folder.
    pub(super) fn path(&self, text: &str) -> Result<PathBuf> {
        Ok(self.folder.join(substituted(text, |name| std::env::var(name).ok())?))
    }
}

/// The settings of a cell: those of the preset's entry, then the sequence's, then the rate's.
pub(super) fn merged(
    codec: &CodecEntry,
    sequence: &SequenceEntry,
    rate: &RateEntry,
) -> toml::Table {
    let mut table = codec.settings.clone();
    table.extend(sequence.settings.clone());
    table.extend(rate.settings.clone());
    table
}

/// Names must be there, and each only once.
fn check_names<'n>(kind: &str, names: impl IntoIterator<Item = &'n String>) -> Result<()> {
    let mut seen = HashSet::new();
    for name in names {
        ensure!(!name.trim().is_empty(), "a {kind} has an empty name");
        ensure!(seen.insert(name), "there are two entries for the {kind} '{name}'");
    }
    ensure!(!seen.is_empty(), "there is no {kind}: write [[{kind}]]");
    Ok(())
}

/// One line with the place, and the nearest known key for an unknown one.
fn toml_message(error: &toml::de::Error, text: &str) -> anyhow::Error {
    let message = error.message().lines().collect::<Vec<_>>().join(" ");
    // serde: unknown field `x`, expected one of `a`, `b`
    let mut quoted = message.split('`').skip(1).step_by(2);
    let hint = match quoted.next() {
        Some(unknown) if message.starts_with("unknown") => nearest(unknown, quoted),
        _ => String::new(),
    };
    match error.span() {
        Some(span) => {
            let line = text[..span.start.min(text.len())].matches('\n').count() + 1;
            anyhow!("line {line}: {message}{hint}")
        }
        None => anyhow!("{message}{hint}"),
    }
}

/// Replaces every `${NAME}` by what `variable` says.
fn substituted(text: &str, variable: impl Fn(&str) -> Option<String>) -> Result<String> {
    let mut result = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("${") {
        let (name, after) = after.split_once('}').with_context(|| format!("{text}: no }}"))?;
        let value = variable(name);
        result.push_str(before);
        result.push_str(&value.with_context(|| format!("{text}: {name} is not set"))?);
        rest = after;
    }
    Ok(result + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "
        anchors = ['baseline']
        [[sequence]]
        name = 'a'
        input = '${HOME}/*.obj'
        fps = 29.97
        bits = 10
        [[preset]]
        name = 'bimodal'
        [[preset]]
        name = 'many'
        base = 'baseline'
        nodes = 400
        [[rate]]
        name = 'gof4'
        gof = 4
        bits = 9
    ";

    fn message(from: &str, to: &str) -> String {
        assert!(GOOD.contains(from));
        let error = Config::parse(&GOOD.replace(from, to)).expect_err("a mistake");
        error.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ")
    }

    #[test]
    fn later_entries_win() {
        let config = Config::parse(GOOD).expect("sound");
        let table = merged(&config.codecs[1], &config.sequences[0], &config.rates[0]);
        let flags = crate::settings::flags_of(&table);
        assert_eq!(flags, ["--bits=9", "--gof=4", "--nodes=400"]);
        assert_eq!(config.codecs[1].preset().expect("known").name(), "baseline");
    }

    #[test]
    fn mistakes_are_named_with_what_was_meant() {
        let preset = message("base = 'baseline'", "base = 'basline'");
        assert!(preset.starts_with("preset 'many': there is no preset 'basline'; did you mean"));
        let key = message("nodes = 400", "node = 400");
        assert_eq!(key, "preset 'many': there is no key 'node'; did you mean 'nodes'?");
        let top = message("anchors", "anchor");
        assert!(top.starts_with("line 2: unknown field `anchor`"), "{top}");
        assert!(top.ends_with("did you mean 'anchors'?"), "{top}");
        let value = message("gof = 4", "gof = 400");
        assert!(value.starts_with("a, bimodal, gof4: invalid value '400'"), "{value}");
        assert!(message("name = 'many'", "name = 'bimodal'").contains("two entries"));
        assert!(message("input = '${HOME}/*.obj'", "").contains("either an input or a performer"));
        assert!(message("29.97", "0").starts_with("sequence 'a': fps: a frame rate"));
    }

    #[test]
    fn the_configurations_of_the_repository_are_sound() {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/rd"));
        if !folder.exists() {
            eprintln!("skipped: docs/rd is absent");
            return;
        }
        let read = |name: &str| Config::read(&folder.join(name)).expect("sound");
        assert!(read("example.toml").sequences.iter().all(|one| one.performer.is_some()));
        assert_eq!(read("ablation.toml").rates.len(), 4);
    }

    #[test]
    fn variables_are_put_in() {
        let variable = |name: &str| (name == "A").then(|| "x y".to_owned());
        assert_eq!(substituted("${A}/b${A}", variable).expect("set"), "x y/bx y");
        assert_eq!(substituted("$A{}", variable).expect("none"), "$A{}");
        let error = substituted("/${B}/c", variable).expect_err("not set");
        assert_eq!(error.to_string(), "/${B}/c: B is not set");
        assert!(substituted("${A", variable).is_err());
    }
}
