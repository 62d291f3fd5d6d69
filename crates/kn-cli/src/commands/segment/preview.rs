//! The sheet that shows body parts: some frames from two sides, and a legend.

use crate::heatmap::PICTURE;
use crate::picture::{Canvas, Legend, Paint, Sheet, View, render};
use anyhow::{Context, Result};
use kn_bitstream::params::UpAxis;
use kn_bitstream::params::{BodyPart, Named};
use kn_mesh::{BoundingBox, Mesh};

/// Number of frames in the picture.
const COLUMNS: usize = 8;
/// From where, degrees about the up axis.
const SIDES: [f32; 2] = [0.0, 180.0];

/// Keeps the frames that will be drawn.
pub(super) struct Preview {
    chosen: Vec<usize>,
    frames: Vec<(String, Mesh)>,
}

impl Preview {
    /// Shows some of `count` frames, evenly spread, the first and the last among them.
    pub(super) fn new(count: usize) -> Self {
        let shown = count.min(COLUMNS);
        let at = |column: usize| column * (count - 1) / (shown - 1).max(1);
        Self { chosen: (0..shown).map(at).collect(), frames: Vec::new() }
    }

    /// Takes a frame, with labels, if it is to be shown.
    pub(super) fn push(&mut self, index: usize, name: &str, mesh: Mesh) {
        if self.chosen.contains(&index) && !mesh.is_empty() {
            self.frames.push((name.to_owned(), mesh));
        }
    }

    /// Draws the sheet.
    pub(super) fn draw(&self, up_axis: UpAxis) -> Result<Canvas> {
        let boxes: Option<Vec<BoundingBox>> =
            self.frames.iter().map(|(_, mesh)| mesh.bounding_box()).collect();
        let boxes = boxes.filter(|boxes| !boxes.is_empty()).context("there is nothing to draw")?;
        let row = |degrees: f32| {
            let pictures = self.frames.iter().zip(&boxes).map(|((_, mesh), own)| {
                let view = View::new(&as_large_as_all(own, &boxes), up_axis, degrees);
                coloured(mesh, &view)
            });
            (format!("turned by {degrees} degrees"), pictures.collect())
        };
        let names = BodyPart::all().into_iter().map(|part| (part.colour(), part.to_string()));
        let sheet = Sheet {
            title: "body parts".into(),
            columns: self.frames.iter().map(|(name, _)| name.clone()).collect(),
            rows: SIDES.into_iter().map(row).collect(),
            legend: Some(Legend::Names(names.collect())),
        };
        Ok(sheet.draw())
    }
}

/// A box around the same middle that has the largest side of any: all frames are drawn alike.
fn as_large_as_all(own: &BoundingBox, all: &[BoundingBox]) -> BoundingBox {
    let side = |one: &BoundingBox, axis: usize| one.max[axis] - one.min[axis];
    let half = |axis: usize| 0.5 * all.iter().map(|one| side(one, axis)).fold(0.0, f64::max);
    let middle = |axis: usize| 0.5 * (own.min[axis] + own.max[axis]);
    BoundingBox {
        min: [0, 1, 2].map(|axis| middle(axis) - half(axis)),
        max: [0, 1, 2].map(|axis| middle(axis) + half(axis)),
    }
}

fn coloured(mesh: &Mesh, view: &View) -> Canvas {
    let colour = |label: &u8| BodyPart::from_label(*label).unwrap_or(BodyPart::Other).colour();
    let colours: Vec<_> = mesh.labels.iter().map(colour).collect();
    render(mesh, Paint::PerVertex(&colours), view, PICTURE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_and_the_last_frame_are_shown() {
        assert_eq!(Preview::new(200).chosen, [0, 28, 56, 85, 113, 142, 170, 199]);
        assert_eq!(Preview::new(3).chosen, [0, 1, 2]);
        assert_eq!(Preview::new(1).chosen, [0]);
    }
}
