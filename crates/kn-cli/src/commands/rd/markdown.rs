//! report.md: the numbers of the report as Markdown, to be kept beside a project's notes.

use super::config::Config;
use super::curves::{self, Curve, Quality};
use super::deltas::{Delta, Found};
use super::results::{CellRow, Share, Study};
use std::fmt::Write;

/// The metrics in the tables of deltas. The other metrics are in results.json.
const QUALITIES: [Quality; 2] = [Quality::Msdm2, Quality::P2s];

/// The whole file.
pub(super) fn render(config: &Config, study: &Study, curves: &[Curve], deltas: &[Delta]) -> String {
    let mut text = String::new();
    line(&mut text, format_args!("# {}\n", config.title.as_deref().unwrap_or("Study")));
    line(&mut text, format_args!("kn {}, `{}`\n", study.version, study.command));
    let sequences: Vec<&str> = study.sequences.iter().map(|one| one.name.as_str()).collect();
    for anchor in &config.anchors {
        for share in [Share::All, Share::Predicted] {
            for quality in QUALITIES {
                let of_table = |delta: &&Delta| {
                    delta.anchor == *anchor && delta.share == share && delta.quality == quality
                };
                let rows: Vec<&Delta> = deltas.iter().filter(of_table).collect();
                deltas_table(&mut text, anchor, (share, quality), &rows, &sequences);
            }
        }
    }
    for sequence in &sequences {
        let cells = study.cells.iter().filter(|cell| cell.sequence == *sequence);
        cells_table(&mut text, sequence, cells, &curves::qualities(curves));
    }
    text
}

fn deltas_table(
    text: &mut String,
    anchor: &str,
    (share, quality): (Share, Quality),
    deltas: &[&Delta],
    sequences: &[&str],
) {
    if deltas.is_empty() {
        return;
    }
    let bytes = match share {
        Share::All => "all bytes",
        Share::Predicted => "P-frames alone",
    };
    line(text, format_args!("## BD-rate against {anchor}: {}, {bytes}, %\n", quality.title()));
    header(text, sequences.iter().copied().chain(["mean"]));
    let mut codecs: Vec<&str> = deltas.iter().map(|delta| delta.codec.as_str()).collect();
    codecs.dedup();
    for codec in codecs {
        let of_codec = deltas.iter().filter(|delta| delta.codec == codec);
        let found: Vec<Option<&&Delta>> = sequences
            .iter()
            .map(|sequence| of_codec.clone().find(|delta| delta.sequence == *sequence))
            .collect();
        let known: Vec<f64> = found.iter().flatten().filter_map(|delta| delta.pchip()).collect();
        let cells = found.iter().map(|delta| delta.map_or_else(|| "–".into(), |delta| rate(delta)));
        let cells: Vec<String> = cells.chain([mean(&known, sequences.len())]).collect();
        line(text, format_args!("| {codec} | {} |", cells.join(" | ")));
    }
    text.push_str(
        "\nIn brackets: how much of their range two curves share, where that is less than 75 % and the \
         value little to be trusted. –: nothing, or a single point is left.\n\n",
    );
}

fn rate(delta: &Delta) -> String {
    match delta.found {
        Found::Rate { pchip, overlap, overlap_is_small: true, .. } => {
            format!("{} ({:.0} %)", number(Some(pchip), 1), 100.0 * overlap)
        }
        _ => number(delta.pchip(), 1),
    }
}

/// The mean of what is known of so many sequences.
fn mean(known: &[f64], sequences: usize) -> String {
    if known.is_empty() {
        return "–".into();
    }
    let mean = number(Some(known.iter().sum::<f64>() / known.len() as f64), 1);
    if known.len() == sequences { mean } else { format!("{mean} (of {})", known.len()) }
}

fn cells_table<'a>(
    text: &mut String,
    sequence: &str,
    cells: impl Iterator<Item = &'a CellRow>,
    qualities: &[Quality],
) {
    line(text, format_args!("## {sequence}: bytes a frame, quality, CPU seconds a frame\n"));
    let titles = ["point", "bytes", "I-frame", "P-frame"].into_iter();
    header(text, titles.chain(qualities.iter().map(|quality| quality.title())).chain(["encode"]));
    for CellRow { codec, point, result, .. } in cells {
        let bytes = [
            result.bytes_per_frame(Share::All),
            result.intra_bytes(),
            result.bytes_per_frame(Share::Predicted),
        ];
        let seconds = result.encode_seconds / result.frames.len().max(1) as f64;
        let quality =
            |quality: &Quality| number(result.mean(quality.metric(), Share::All), quality.digits());
        let row: Vec<String> = bytes
            .into_iter()
            .map(|bytes| number(bytes, 0))
            .chain(qualities.iter().map(quality))
            .chain([number(Some(seconds), 2)])
            .collect();
        line(text, format_args!("| {codec} | {point} | {} |", row.join(" | ")));
    }
    text.push('\n');
}

fn header<'a>(text: &mut String, titles: impl Iterator<Item = &'a str>) {
    let titles: Vec<&str> = titles.collect();
    line(text, format_args!("| | {} |", titles.join(" | ")));
    line(text, format_args!("|{}", "---|".repeat(titles.len() + 1)));
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".into(), |value| format!("{value:.digits$}"))
}

fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{arguments}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delta_that_is_little_to_be_trusted_says_so() {
        let delta = |overlap, overlap_is_small| Delta {
            anchor: "a".into(),
            codec: "b".into(),
            sequence: "s".into(),
            quality: Quality::Msdm2,
            share: Share::Predicted,
            found: Found::Rate {
                pchip: -47.04,
                cubic: None,
                overlap,
                dominated: [0, 0],
                overlap_is_small,
            },
        };
        assert_eq!(rate(&delta(0.095, true)), "-47.0 (10 %)");
        assert_eq!(rate(&delta(0.8, false)), "-47.0");
        assert_eq!(mean(&[1.0, 2.0], 2), "1.5");
        assert_eq!(mean(&[1.0, 2.0], 6), "1.5 (of 2)");
        assert_eq!(mean(&[], 6), "–");
    }
}
