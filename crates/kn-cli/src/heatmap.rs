//! Meshes coloured by their local error.

use crate::picture::{CLAY, Canvas, Legend, Paint, Sheet, View, colour_of, render};
use anyhow::{Context, Result};
use kn_bitstream::params::UpAxis;
use kn_mesh::{BoundingBox, Mesh};
use std::io::Write;

/// Width and height of one picture on a sheet.
pub(crate) const PICTURE: [usize; 2] = [170, 215];

/// A round number of world units that the largest of nearly all errors stays below: the end of
/// the colour scale. A few outliers must not make the rest look perfect.
pub(crate) fn scale_end<'e>(errors: impl Iterator<Item = &'e [f64]>) -> f64 {
    const SHARE: f64 = 0.97;
    let mut all: Vec<f64> = errors.flatten().copied().filter(|error| error.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let at = (SHARE * all.len() as f64) as usize;
    round_up(all.get(at.min(all.len().saturating_sub(1))).copied().unwrap_or(0.0))
}

/// The next of 1, 2, 5, 10, ... times a power of ten.
pub(crate) fn round_up(value: f64) -> f64 {
    if value <= 0.0 || !value.is_finite() {
        return 1.0;
    }
    let power = 10.0_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    steps.into_iter().find(|&step| step >= value).unwrap_or(value)
}

/// The mesh as it is.
pub(crate) fn plain(mesh: &Mesh, view: &View, size: [usize; 2]) -> Canvas {
    render(mesh, Paint::Plain(CLAY), view, size)
}

/// The mesh coloured by `errors` (`#V`, world units) from 0 to `end`.
pub(crate) fn coloured(
    mesh: &Mesh,
    errors: &[f64],
    end: f64,
    view: &View,
    size: [usize; 2],
) -> Canvas {
    let colours: Vec<_> = errors.iter().map(|error| colour_of((error / end) as f32)).collect();
    render(mesh, Paint::PerVertex(&colours), view, size)
}

/// Text at the colour scale.
pub(crate) fn scale_labels(end: f64, unit: &str) -> Legend {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let [start, middle] = [0.0, end / 2.0].map(|value| format!("{value}{unit}"));
    Legend::Scale([start, middle, format!("{end}{unit} and more")])
}

/// Two meshes side by side, each coloured by its difference from the other, from four sides.
pub(crate) fn turntable(
    out: &mut dyn Write,
    title: String,
    sides: [(&str, &Mesh, &[f64]); 2],
) -> Result<()> {
    const TURNS: [[f32; 2]; 2] = [[0.0, 90.0], [180.0, 270.0]];
    const HEIGHT: usize = 320;
    const UP_AXIS: UpAxis = UpAxis::Y;
    let boxes = sides.iter().filter_map(|side| side.1.bounding_box());
    let bounds = boxes.reduce(BoundingBox::union).context("there is nothing to draw")?;
    let end = scale_end(sides.iter().map(|side| side.2));
    let views = TURNS.map(|row| row.map(|degrees| View::new(&bounds, UP_AXIS, degrees)));
    let width = |view: &View| view.size_of_height(HEIGHT)[0];
    let size = [views.as_flattened().iter().map(width).max().unwrap_or(HEIGHT), HEIGHT];
    let row = |(degrees, views): ([f32; 2], &[View; 2])| {
        let pictures = views.iter().flat_map(|view| {
            sides.map(|(_, mesh, errors)| coloured(mesh, errors, end, view, size))
        });
        (format!("turned by {} and by {} degrees", degrees[0], degrees[1]), pictures.collect())
    };
    let names = sides.map(|side| side.0.to_owned());
    let sheet = Sheet {
        title,
        columns: [names.clone(), names].concat(),
        rows: TURNS.into_iter().zip(&views).map(row).collect(),
        legend: Some(scale_labels(end, "")),
    };
    Ok(sheet.draw().write_png(out)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_ends_at_a_round_number_above_nearly_all() {
        let mut errors = vec![0.0031; 980];
        errors.extend([7.0; 20]);
        assert_eq!(scale_end([&errors[..]].into_iter()), 0.005);
        assert_eq!(scale_end([&[0.0][..], &[]].into_iter()), 1.0);
        assert_eq!(round_up(0.2), 0.2);
        assert_eq!(round_up(730.0), 1000.0);
    }
}
