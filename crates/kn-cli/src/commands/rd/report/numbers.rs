//! Tables of all numbers, and what is needed to get them again.

use super::super::curves::{self, Quality};
use super::super::export::megabits;
use super::super::results::{CellRow, Share, Study};
use super::Material;
use super::html::{esc, number, table};
use crate::table::grouped;

/// Bytes, quality and time of every cell.
pub(super) fn cells(material: &Material<'_>) -> String {
    let qualities = curves::qualities(material.curves);
    let mut html = String::from(
        "<h2>All streams</h2>\n<p class=\"soft\">Bytes are means over frames: all (with header \
         and index), I-frames, P-frames with their key nodes. Seconds are processor \
         time inside the encoder and the decoder, summed over the given number of threads.</p>\n",
    );
    let titles = ["codec", "point", "bytes a frame", "Mbit/s", "I-frame", "P-frame"];
    let mut titles: Vec<String> = titles.map(String::from).into();
    titles.extend(qualities.iter().map(|quality| quality.title().into()));
    titles.extend(["encode, CPU s a frame", "decode, CPU ms a frame", "threads"].map(String::from));
    for sequence in &material.study.sequences {
        let label = if sequence.labelled { "labels" } else { "no labels" };
        html.push_str(&format!(
            "<h3>{}</h3>\n<p class=\"soft\">{} frames from {} on, {:.0} vertices and {:.0} faces \
             on average, {label}; box {:.5} long, diagonal {:.5}</p>\n",
            esc(&sequence.name),
            sequence.frames,
            sequence.first,
            sequence.vertices,
            sequence.faces,
            sequence.side,
            sequence.diagonal,
        ));
        let of_sequence = material.study.cells.iter().filter(|c| c.sequence == sequence.name);
        let rows: Vec<Vec<String>> =
            of_sequence.map(|cell| cell_row(cell, sequence.fps, &qualities)).collect();
        html.push_str(&table(&titles, &rows));
    }
    html
}

fn cell_row(cell: &CellRow, fps: f64, qualities: &[Quality]) -> Vec<String> {
    let result = &cell.result;
    let bytes =
        |value: Option<f64>| value.map_or(number(None, 0), |value| grouped(value.round() as u64));
    let all = result.bytes_per_frame(Share::All);
    let frames = result.frames.len().max(1) as f64;
    let mut row = vec![
        esc(&cell.codec).to_string(),
        esc(&cell.point).to_string(),
        bytes(all),
        number(all.map(|bytes| megabits(bytes, fps)), 3),
        bytes(result.intra_bytes()),
        bytes(result.bytes_per_frame(Share::Predicted)),
    ];
    row.extend(
        qualities
            .iter()
            .map(|quality| number(result.mean(quality.metric(), Share::All), quality.digits())),
    );
    row.extend([
        number(Some(result.encode_seconds / frames), 3),
        number(Some(1e3 * result.decode_seconds / frames), 2),
        result.threads.to_string(),
    ]);
    row
}

/// The cells without a result, with their reasons.
pub(super) fn failures(study: &Study) -> String {
    if study.failures.is_empty() {
        return String::new();
    }
    let titles = ["sequence", "codec", "point", "reason"].map(String::from);
    let row = |failure: &super::super::results::Failure| {
        [&failure.sequence, &failure.codec, &failure.point, &failure.reason]
            .map(|text| esc(text).to_string())
            .into()
    };
    let rows: Vec<Vec<String>> = study.failures.iter().map(row).collect();
    format!("<h2>Without result</h2>\n{}", table(&titles, &rows))
}

/// Versions, commands, configuration.
pub(super) fn reproduction(material: &Material<'_>) -> String {
    let study = material.study;
    let mut builds: Vec<&str> = study.cells.iter().map(|c| c.result.build.as_str()).collect();
    builds.sort_unstable();
    builds.dedup();
    let warning = if builds.len() > 1 {
        "<p><strong>The streams come from several builds of kn</strong> (--keep); run with \
         --fresh for one.</p>\n"
    } else {
        ""
    };
    let facts = [
        ("kn", study.version.clone()),
        ("program, SHA-256", builds.join(", ")),
        ("processors", study.cores.to_string()),
        ("streams at a time", study.jobs.to_string()),
        ("command", study.command.clone()),
    ];
    let facts: String = facts
        .iter()
        .map(|(name, value)| format!("<dt>{name}</dt><dd>{}</dd>\n", esc(value)))
        .collect();
    format!(
        "<h2>How to get these numbers again</h2>\n{warning}<dl>\n{facts}</dl>\n{}{}\
         <details><summary>The configuration</summary><pre>{}</pre></details>\n",
        inputs(study),
        commands(study),
        esc(&material.config.text)
    )
}

fn inputs(study: &Study) -> String {
    let titles = ["sequence", "input", "SHA-256 of the cleaned frames"].map(String::from);
    let code = |text: &str| format!("<code>{}</code>", esc(text));
    let rows: Vec<Vec<String>> = study
        .sequences
        .iter()
        .map(|one| vec![esc(&one.name).to_string(), code(&one.input), code(&one.digest[..16])])
        .collect();
    table(&titles, &rows)
}

/// A command per stream with all settings of its encoder.
fn commands(study: &Study) -> String {
    let lines: String = study
        .cells
        .iter()
        .map(|cell| {
            format!(
                "# {}, {}, {}\n# {}\n{}\n\n",
                esc(&cell.sequence),
                esc(&cell.codec),
                esc(&cell.point),
                esc(&cell.result.settings),
                esc(&cell.command)
            )
        })
        .collect();
    format!("<details><summary>A command for each stream</summary><pre>{lines}</pre></details>\n")
}
