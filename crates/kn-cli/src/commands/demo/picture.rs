//! The demo's picture: scans, decoded frames and their error, side by side.

use super::DecodedFrame;
use crate::heatmap::{self, PICTURE};
use crate::picture::{Canvas, Sheet, View};
use crate::stream::kind_letter;
use crate::table::grouped;
use anyhow::Result;
use kn_bitstream::params::UpAxis;
use kn_mesh::{BoundingBox, Mesh};
use kn_metrics::{CompareOptions, Surface};

/// Number of frames in the picture.
const COLUMNS: usize = 5;
/// The performer faces along z at first; half from the side, arms and stride show better.
const YAW_DEGREES: f32 = 25.0;

/// Draws a few frames: an I-frame, and P-frames at growing distance from one.
pub(super) fn draw(
    scans: &[Mesh],
    decoded: &[DecodedFrame],
    bounds: &BoundingBox,
) -> Result<Canvas> {
    let count = scans.len().min(decoded.len());
    let shown = chosen(count);
    let view = View::new(bounds, UpAxis::Y, YAW_DEGREES);
    let millimetres = |distance: f64| 1e3 * distance;
    let options = CompareOptions::distances();
    let mut errors = Vec::new();
    for &index in &shown {
        let reference = Surface::new((&scans[index]).into(), &options)?;
        let surface = Surface::new((&decoded[index].mesh).into(), &options)?;
        errors.push(surface.vertex_distances(&reference).into_iter().map(millimetres).collect());
    }
    let end = heatmap::scale_end(errors.iter().map(|error: &Vec<f64>| &error[..]));

    let title = |&index: &usize| {
        let info = &decoded[index].info;
        format!("{} {index}: {} bytes", kind_letter(info.kind), grouped(info.bytes))
    };
    let original = shown.iter().map(|&index| heatmap::plain(&scans[index], &view, PICTURE));
    let result = shown.iter().map(|&index| heatmap::plain(&decoded[index].mesh, &view, PICTURE));
    let coloured = shown
        .iter()
        .zip(&errors)
        .map(|(&index, error)| heatmap::coloured(&decoded[index].mesh, error, end, &view, PICTURE));
    let sheet = Sheet {
        title: "kn: scans, decoded meshes, what was lost".into(),
        columns: shown.iter().map(title).collect(),
        rows: vec![
            ("scan".into(), original.collect()),
            ("decoded".into(), result.collect()),
            ("distance of the decoded vertices from the scan".into(), coloured.collect()),
        ],
        legend: Some(heatmap::scale_labels(end, "mm")),
    };
    Ok(sheet.draw())
}

/// Frames 0, 3, 7 and two later ones, as far as they exist.
fn chosen(count: usize) -> Vec<usize> {
    let mut shown = vec![0, 3, 7, 15, count.saturating_sub(1)];
    shown.retain(|&index| index < count);
    shown.sort_unstable();
    shown.dedup();
    shown.truncate(COLUMNS);
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_frames_that_exist_are_shown() {
        assert_eq!(chosen(24), [0, 3, 7, 15, 23]);
        assert_eq!(chosen(8), [0, 3, 7]);
        assert_eq!(chosen(1), [0]);
        assert!(chosen(0).is_empty());
    }
}
