//! Pictures of the same frame for each codec.

use super::super::results::PictureRow;
use super::html::esc;
use crate::picture::colour_of;
use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::fs;
use std::path::Path;

/// The section; empty without pictures.
pub(super) fn section(pictures: &[PictureRow], output: &Path) -> Result<String> {
    if pictures.is_empty() {
        return Ok(String::new());
    }
    let mut html = String::from(
        "<h2>The same frame at nearly the same rate</h2>\n<p class=\"soft\">Each codec at its \
         point nearest to one rate. Below each decoded mesh, the distance of its vertices from \
         the scan.</p>\n",
    );
    let mut sequences: Vec<&str> = pictures.iter().map(|one| one.sequence.as_str()).collect();
    sequences.dedup();
    for sequence in sequences {
        let of_sequence = || pictures.iter().filter(|one| one.sequence == sequence);
        let Some(first) = of_sequence().next() else { continue };
        html.push_str(&format!("<h3>{}, frame {}</h3>\n", esc(sequence), first.frame));
        html.push_str(&scale(first.scale_end));
        html.push_str("<div class=\"pictures\">\n");
        for picture in of_sequence() {
            html.push_str(&figure(picture, output)?);
        }
        html.push_str("</div>\n");
    }
    Ok(html)
}

fn figure(picture: &PictureRow, output: &Path) -> Result<String> {
    let name = picture.codec.as_deref().unwrap_or("scan");
    let images = [Some(&picture.file), picture.error_file.as_ref()];
    let images: Result<Vec<String>> =
        images.into_iter().flatten().map(|file| image(file, name, output)).collect();
    let rate = picture.bytes_per_frame.map_or(String::new(), |bytes| {
        let point = picture.point.as_deref().unwrap_or_default();
        format!("<br>{}, {:.2} kB a frame", esc(point), bytes / 1000.0)
    });
    Ok(format!(
        "<figure>{}<figcaption><strong>{}</strong>{rate}</figcaption></figure>\n",
        images?.concat(),
        esc(name)
    ))
}

fn image(file: &str, name: &str, output: &Path) -> Result<String> {
    let path = output.join(file);
    let png = fs::read(&path).with_context(|| path.display().to_string())?;
    let data = STANDARD.encode(png);
    Ok(format!("<img alt=\"{}\" src=\"data:image/png;base64,{data}\">", esc(name)))
}

/// The colours of distances, from none to `end` world units.
fn scale(end: f64) -> String {
    const STOPS: u32 = 10;
    let stop = |index: u32| {
        let [r, g, b] = colour_of(index as f32 / STOPS as f32);
        format!("rgb({r},{g},{b})")
    };
    let stops: Vec<String> = (0..=STOPS).map(stop).collect();
    format!(
        "<div class=\"scale\" style=\"background:linear-gradient(to right,{})\"></div>\
         <div class=\"ends soft\"><span>0</span><span>{}</span><span>{end} and more</span></div>\n",
        stops.join(","),
        end / 2.0
    )
}
