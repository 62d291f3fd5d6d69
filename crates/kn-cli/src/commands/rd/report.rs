//! The report: one HTML file that needs nothing beside itself.

mod bd_tables;
mod chart;
mod gallery;
mod html;
mod numbers;
mod style;

use super::config::Config;
use super::curves::{self, Curve, Quality};
use super::deltas::Delta;
use super::results::Study;
use anyhow::Result;
use html::esc;
use std::path::Path;

/// The data of a report.
pub(super) struct Material<'m> {
    pub(super) config: &'m Config,
    pub(super) study: &'m Study,
    pub(super) curves: &'m [Curve],
    pub(super) deltas: &'m [Delta],
}

impl Material<'_> {
    /// The page; pictures are read from `output`.
    ///
    /// # Errors
    /// A picture cannot be read.
    pub(super) fn render(&self, output: &Path) -> Result<String> {
        let title = self.config.title.as_deref().unwrap_or("Rate and distortion");
        let sections = [
            self.summary(),
            self.figures(),
            bd_tables::section(self),
            gallery::section(&self.study.pictures, output)?,
            numbers::cells(self),
            numbers::failures(self.study),
            numbers::reproduction(self),
        ];
        Ok(format!(
            "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{0}</title>\n<style>\n{1}</style></head>\n<body>\n<h1>{0}</h1>\n{2}\
             </body></html>\n",
            esc(title),
            style::CSS,
            sections.concat(),
        ))
    }

    fn summary(&self) -> String {
        let count = |count: usize, what: &str| {
            format!("{count} {what}{}", if count == 1 { "" } else { "s" })
        };
        let study = self.study;
        let codecs = curves::codecs(self.curves).len();
        let frames: u64 = study.sequences.iter().map(|sequence| sequence.frames).sum();
        format!(
            "<p class=\"soft\">{}, {}, {}, {}; kn {}.</p>\n",
            count(study.sequences.len(), "sequence"),
            count(frames as usize, "frame"),
            count(codecs, "codec"),
            count(study.cells.len(), "stream"),
            esc(&study.version),
        )
    }

    /// A figure for every sequence and metric.
    fn figures(&self) -> String {
        let mut html = String::from(
            "<h2>Rate and distortion</h2>\n<p class=\"soft\">Up and to the left is better. \
             Lines join the points that no other point of the codec beats in both; the others are \
             faint. Dashed: from a table.</p>\n",
        );
        html.push_str(&self.legend());
        for sequence in &self.study.sequences {
            html.push_str(&format!("<h3>{}</h3>\n<div class=\"columns\">\n", esc(&sequence.name)));
            for quality in curves::qualities(self.curves) {
                html.push_str(&self.figure(&sequence.name, quality));
            }
            html.push_str("</div>\n");
        }
        html
    }

    fn figure(&self, sequence: &str, quality: Quality) -> String {
        let codecs = curves::codecs(self.curves);
        let look = |curve: &Curve| codecs.iter().position(|name| *name == curve.codec);
        let of_sequence = self.curves.iter().filter(|curve| curve.sequence == sequence);
        let lines: Vec<chart::Line<'_>> = of_sequence
            .filter_map(|curve| Some(chart::Line { curve, look: look(curve)? }))
            .collect();
        match chart::draw(&lines, quality) {
            Some(svg) => format!(
                "<figure>{svg}<figcaption>{}: {} against rate</figcaption></figure>\n",
                esc(sequence),
                quality.title()
            ),
            None => String::new(),
        }
    }

    fn legend(&self) -> String {
        let item = |(look, codec): (usize, &&str)| {
            let foreign = self.curves.iter().any(|c| c.codec == **codec && c.foreign);
            let dashes = style::dashes(foreign);
            format!(
                "<li><svg viewBox=\"0 0 34 14\" aria-hidden=\"true\"><line class=\"curve\" \
                 stroke=\"{}\"{dashes} x1=\"1\" x2=\"33\" y1=\"7\" y2=\"7\"/>{}</svg>{}</li>\n",
                style::colour(look),
                style::marker(look, 17.0, 7.0),
                esc(codec)
            )
        };
        let codecs = curves::codecs(self.curves);
        let items: String = codecs.iter().enumerate().map(item).collect();
        format!("<ul class=\"legend\">\n{items}</ul>\n")
    }
}
