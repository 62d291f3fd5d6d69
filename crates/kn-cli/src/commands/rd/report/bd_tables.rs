//! Tables of Bjøntegaard deltas.

use super::super::curves::{self, Quality};
use super::super::deltas::{Delta, Found};
use super::super::results::Share;
use super::Material;
use super::html::{esc, number, table};

/// The section; empty without anchors.
pub(super) fn section(material: &Material<'_>) -> String {
    if material.config.anchors.is_empty() {
        return String::new();
    }
    let mut html = String::from(
        "<h2>Bjøntegaard delta rate</h2>\n<p class=\"soft\">Per cent more bytes than the anchor \
         for the same quality, piecewise cubic (PCHIP) over the logarithm of the rate; negative \
         is fewer. MSDM2 enters as 1 − MSDM2, and points that another one of the same codec beats \
         are dropped. <span class=\"doubt\">Dotted</span>: the curves share less than three \
         quarters of their range, which makes the value a rough one.</p>\n",
    );
    for anchor in &material.config.anchors {
        html.push_str(&format!("<h3>Against {}</h3>\n<div class=\"columns\">\n", esc(anchor)));
        for share in [Share::All, Share::Predicted] {
            for quality in curves::qualities(material.curves) {
                html.push_str(&one_table(material, anchor, share, quality));
            }
        }
        html.push_str("</div>\n");
        html.push_str(&notes(material.deltas, anchor));
    }
    html
}

fn one_table(material: &Material<'_>, anchor: &str, share: Share, quality: Quality) -> String {
    let deltas: Vec<&Delta> = material
        .deltas
        .iter()
        .filter(|d| d.anchor == anchor && d.share == share && d.quality == quality)
        .collect();
    if deltas.is_empty() {
        return String::new();
    }
    let mut codecs: Vec<&str> = deltas.iter().map(|delta| delta.codec.as_str()).collect();
    codecs.dedup();
    let sequences = material.study.sequences.iter().map(|sequence| sequence.name.as_str());
    let mut titles = vec![String::new()];
    titles.extend(codecs.iter().map(|codec| esc(codec).to_string()));
    let mut rows: Vec<Vec<String>> = sequences
        .map(|sequence| {
            let cell = |codec: &&str| {
                let same = |delta: &&&Delta| delta.codec == *codec && delta.sequence == sequence;
                deltas.iter().find(same).map_or(number(None, 0), |delta| value(delta))
            };
            let mut row = vec![esc(sequence).to_string()];
            row.extend(codecs.iter().map(cell));
            row
        })
        .collect();
    if rows.len() > 1 {
        let mut row = vec!["mean".to_owned()];
        row.extend(codecs.iter().map(|codec| mean(&deltas, codec)));
        rows.push(row);
    }
    let what = match share {
        Share::All => "all bytes",
        Share::Predicted => "P-frames alone, key nodes included",
    };
    let title = quality.title();
    format!("<figure><figcaption>{title}, {what}</figcaption>{}</figure>\n", table(&titles, &rows))
}

fn value(delta: &Delta) -> String {
    match &delta.found {
        Found::Rate { pchip, cubic, overlap, dominated, overlap_is_small } => {
            let hint = format!(
                "cubic {} %, overlap {overlap:.2}, points left out: {} of the anchor, {} of {}",
                number(*cubic, 2),
                dominated[0],
                dominated[1],
                delta.codec,
            );
            let doubt = if *overlap_is_small { " doubt" } else { "" };
            format!(
                "<span class=\"{}{doubt}\" title=\"{}\">{}</span>",
                class(*pchip),
                esc(&hint),
                per_cent(*pchip)
            )
        }
        Found::None { reason } => {
            format!("<span class=\"doubt\" title=\"{}\">{}</span>", esc(reason), number(None, 0))
        }
    }
}

/// The mean over the sequences that have a value, and how many lack one.
fn mean(deltas: &[&Delta], codec: &str) -> String {
    let of_codec: Vec<_> = deltas.iter().filter(|delta| delta.codec == codec).collect();
    let values: Vec<f64> = of_codec.iter().filter_map(|delta| delta.pchip()).collect();
    if values.is_empty() {
        return number(None, 0);
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let part = if values.len() < of_codec.len() {
        format!(" ({} of {})", values.len(), of_codec.len())
    } else {
        String::new()
    };
    format!("<strong class=\"{}\">{}</strong>{part}", class(mean), per_cent(mean))
}

fn class(per_cent: f64) -> &'static str {
    if per_cent < 0.0 { "good" } else { "bad" }
}

fn per_cent(value: f64) -> String {
    let sign = if value >= 0.0 { "+" } else { "" };
    format!("{sign}{} %", number(Some(value), 1))
}

/// In words what the tables can only hint at.
fn notes(deltas: &[Delta], anchor: &str) -> String {
    let note = |delta: &Delta| {
        let share = if delta.share == Share::Predicted { ", P-frames alone" } else { "" };
        let what = match &delta.found {
            Found::None { reason } => reason.clone(),
            Found::Rate { overlap, overlap_is_small: true, .. } => {
                format!("the curves share only {:.0} % of their range", 100.0 * overlap)
            }
            Found::Rate { .. } => return None,
        };
        Some(format!(
            "<li>{} on {}, {}{share}: {}</li>\n",
            esc(&delta.codec),
            esc(&delta.sequence),
            delta.quality.title(),
            esc(&what)
        ))
    };
    let notes: Vec<String> =
        deltas.iter().filter(|delta| delta.anchor == anchor).filter_map(note).collect();
    match notes.len() {
        0 => String::new(),
        count => format!(
            "<details class=\"note\"><summary>{count} values that are rough or missing</summary>\
             <ul>\n{}</ul></details>\n",
            notes.concat()
        ),
    }
}
