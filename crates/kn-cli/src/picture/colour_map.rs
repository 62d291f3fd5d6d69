//! Numbers as colours, and the bar that explains them.

use super::canvas::{Canvas, Colour};
use super::font::{CAPTION, text_width};

/// From none (pale grey) over blue, green and yellow to much (dark red): luminance falls at both
/// ends of the yellow, so that good surfaces stay quiet and bad spots stand out.
const STOPS: [[f32; 3]; 6] = [
    [222.0, 226.0, 230.0],
    [116.0, 169.0, 207.0],
    [84.0, 174.0, 120.0],
    [240.0, 205.0, 70.0],
    [226.0, 105.0, 45.0],
    [128.0, 10.0, 30.0],
];

/// The colour of `value`, 0 to 1; outside it is the colour of the end, NaN is black.
pub(crate) fn colour_of(value: f32) -> Colour {
    if value.is_nan() {
        return [0; 3];
    }
    let at = value.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let low = (at as usize).min(STOPS.len() - 2);
    let t = at - low as f32;
    std::array::from_fn(|i| (STOPS[low][i] * (1.0 - t) + STOPS[low + 1][i] * t).round() as u8)
}

/// Draws a horizontal scale with its ends and middle written below it.
pub(super) fn draw_scale(canvas: &mut Canvas, at: [usize; 2], width: usize, labels: [&str; 3]) {
    const HEIGHT: usize = 10;
    for x in 0..width {
        let colour = colour_of(x as f32 / (width.max(2) - 1) as f32);
        canvas.fill([at[0] + x, at[1]], [1, HEIGHT], colour);
    }
    let starts = [
        at[0],
        (at[0] + width / 2).saturating_sub(text_width(labels[1], CAPTION) / 2),
        (at[0] + width).saturating_sub(text_width(labels[2], CAPTION)),
    ];
    for (label, x) in labels.into_iter().zip(starts) {
        canvas.text([x, at[1] + HEIGHT + 4], CAPTION, super::INK, label);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_clamped_and_nan_is_black() {
        assert_eq!(colour_of(-1.0), colour_of(0.0));
        assert_eq!(colour_of(f32::INFINITY), [128, 10, 30]);
        assert_eq!(colour_of(f32::NAN), [0; 3]);
        assert_eq!(colour_of(0.2), [116, 169, 207]);
    }
}
