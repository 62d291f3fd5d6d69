//! A rate-distortion figure as SVG: rate to the right on a logarithmic axis, better upwards.

use super::super::curves::{Curve, Quality};
use super::super::results::Share;
use super::html::esc;
use super::style;
use std::fmt::Write;

const WIDTH: f64 = 560.0;
const HEIGHT: f64 = 360.0;
/// Room for the axes: left, right, top, bottom.
const MARGINS: [f64; 4] = [62.0, 14.0, 12.0, 46.0];
/// A rate axis has at least so many ticks, and at most about twice as many.
const ENOUGH_TICKS: usize = 4;

/// A curve with its look.
pub(super) struct Line<'c> {
    pub(super) curve: &'c Curve,
    /// Number of its codec, which decides colour and marker.
    pub(super) look: usize,
}

/// The figure; `None` where no curve has the quality.
pub(super) fn draw(lines: &[Line<'_>], quality: Quality) -> Option<String> {
    let points: Vec<(f64, f64)> = lines
        .iter()
        .flat_map(|line| line.curve.line(quality, Share::All))
        .map(|(bytes, value, _)| (bytes / 1000.0, value))
        .collect();
    let axes = Axes::around(&points, quality)?;
    let mut svg = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" role=\"img\" aria-label=\"{} against kB a frame\">\n",
        quality.title()
    );
    axes.draw(&mut svg, quality);
    for line in lines {
        draw_line(&mut svg, line, quality, &axes);
    }
    svg.push_str("</svg>\n");
    Some(svg)
}

/// From kB a frame and quality to the picture.
struct Axes {
    /// Decimal logarithms of the rates at both ends.
    x: [f64; 2],
    /// Values at the bottom and at the top.
    y: [f64; 2],
    y_ticks: Vec<f64>,
}

impl Axes {
    fn around(points: &[(f64, f64)], quality: Quality) -> Option<Self> {
        let range = |pick: fn(&(f64, f64)) -> f64| {
            let values = || points.iter().map(pick);
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
        };
        if points.is_empty() {
            return None;
        }
        let (low, high) = range(|point| point.0.log10());
        let pad = (0.06 * (high - low)).max(0.04);
        let (least, most) = range(|point| point.1);
        let step = tick_step(most - least);
        let (bottom, top) = ((least / step).floor() * step, (most / step).ceil() * step);
        let top = if top > bottom { top } else { bottom + step };
        let count = ((top - bottom) / step).round() as usize;
        let y_ticks = (0..=count).map(|tick| bottom + tick as f64 * step).collect();
        let y = if quality.is_larger_better() { [bottom, top] } else { [top, bottom] };
        Some(Self { x: [low - pad, high + pad], y, y_ticks })
    }

    fn across(&self, kilobytes: f64) -> f64 {
        let share = (kilobytes.log10() - self.x[0]) / (self.x[1] - self.x[0]);
        MARGINS[0] + share * (WIDTH - MARGINS[0] - MARGINS[1])
    }

    fn down(&self, value: f64) -> f64 {
        let share = (value - self.y[0]) / (self.y[1] - self.y[0]);
        HEIGHT - MARGINS[3] - share * (HEIGHT - MARGINS[2] - MARGINS[3])
    }

    fn draw(&self, svg: &mut String, quality: Quality) {
        self.draw_grid(svg);
        let (right, bottom) = (WIDTH - MARGINS[1], HEIGHT - MARGINS[3]);
        let note = if quality.is_larger_better() { "" } else { ", smaller is better" };
        let (middle, height) = ((MARGINS[0] + right) / 2.0, (MARGINS[2] + bottom) / 2.0);
        push(
            svg,
            format_args!(
                "<text class=\"axis\" x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">kB a frame</text>\
             <text class=\"axis\" transform=\"translate(14 {height}) rotate(-90)\" \
             text-anchor=\"middle\">{}{}{note}</text>\n",
                HEIGHT - 8.0,
                quality.title(),
                quality.unit(),
            ),
        );
    }

    fn draw_grid(&self, svg: &mut String) {
        let (right, bottom) = (WIDTH - MARGINS[1], HEIGHT - MARGINS[3]);
        let digits = decimals(&self.y_ticks);
        for &tick in &self.y_ticks {
            let y = self.down(tick);
            push(
                svg,
                format_args!(
                    "<line class=\"grid\" x1=\"{}\" y1=\"{y:.1}\" x2=\"{right}\" y2=\"{y:.1}\"/>\
                 <text class=\"tick\" x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{tick:.digits$}</text>\n",
                    MARGINS[0],
                    MARGINS[0] - 6.0,
                    y + 4.0,
                ),
            );
        }
        for tick in rate_ticks(self.x) {
            let x = self.across(tick);
            push(
                svg,
                format_args!(
                    "<line class=\"grid\" x1=\"{x:.1}\" y1=\"{}\" x2=\"{x:.1}\" y2=\"{bottom}\"/>\
                 <text class=\"tick\" x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{tick}</text>\n",
                    MARGINS[2],
                    bottom + 16.0,
                ),
            );
        }
    }
}

/// A line through the points that no other dominates, and a marker for each point.
fn draw_line(svg: &mut String, line: &Line<'_>, quality: Quality, axes: &Axes) {
    let points = line.curve.line(quality, Share::All);
    let front = quality.front(&points);
    let place = |point: &(f64, f64, &str)| (axes.across(point.0 / 1000.0), axes.down(point.1));
    let path: Vec<String> = points
        .iter()
        .zip(&front)
        .filter(|(_, front)| **front)
        .map(|(point, _)| place(point))
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    let (colour, dashes) = (style::colour(line.look), style::dashes(line.curve.foreign));
    push(
        svg,
        format_args!(
            "<polyline class=\"curve\" stroke=\"{colour}\"{dashes} points=\"{}\"/>\n",
            path.join(" ")
        ),
    );
    for (point, front) in points.iter().zip(front) {
        let (x, y) = place(point);
        let faint = if front { "" } else { " opacity=\"0.4\"" };
        push(
            svg,
            format_args!(
                "<g{faint}>{}<title>{} {}: {:.3} kB, {:.*}{}</title></g>\n",
                style::marker(line.look, x, y),
                esc(&line.curve.codec),
                esc(point.2),
                point.0 / 1000.0,
                quality.digits(),
                point.1,
                quality.unit(),
            ),
        );
    }
}

/// Writing to a string cannot fail.
fn push(svg: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = svg.write_fmt(text);
}

/// 1, 2 or 5 times a power of ten that divides `range` into about six parts.
fn tick_step(range: f64) -> f64 {
    let rough = (range / 6.0).max(1e-9);
    let power = 10.0_f64.powf(rough.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|&step| step >= rough)
        .unwrap_or(rough)
}

/// Round numbers between two logarithms: 1, 2 and 5 times the powers of ten, more digits where
/// those are few.
fn rate_ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let with = |digits: &[f64]| -> Vec<f64> {
        let powers = (low.floor() as i32..=high.floor() as i32).map(|power| 10.0_f64.powi(power));
        let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * power));
        // Decimal digits of a product such as 3 · 0.1 end in noise.
        let clean = all.map(|tick| format!("{tick:.3e}").parse().unwrap_or(tick));
        clean.filter(|tick: &f64| (low..=high).contains(&tick.log10())).collect()
    };
    for digits in [&[1.0, 2.0, 5.0][..], &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]] {
        let ticks = with(digits);
        if ticks.len() >= ENOUGH_TICKS {
            return ticks;
        }
    }
    let tenths: Vec<f64> = (10..100).map(|tenth| f64::from(tenth) / 10.0).collect();
    let ticks = with(&tenths);
    let skip = ticks.len().div_ceil(2 * ENOUGH_TICKS).max(1);
    ticks.into_iter().step_by(skip).collect()
}

/// Decimals that tell the ticks apart.
fn decimals(ticks: &[f64]) -> usize {
    let step = match ticks {
        [first, second, ..] => (second - first).abs(),
        _ => 1.0,
    };
    (0..9).find(|&digits| step * 10.0_f64.powi(digits) >= 0.999).unwrap_or(9) as usize
}

#[cfg(test)]
mod tests {
    use super::super::super::curves::Point;
    use super::*;

    #[test]
    fn ticks_are_round() {
        assert_eq!(tick_step(6.0), 1.0);
        assert_eq!(tick_step(0.31), 0.1);
        assert_eq!(rate_ticks([0.0, 1.0]), [1.0, 2.0, 5.0, 10.0]);
        assert!(rate_ticks([0.31, 0.32]).len() <= 8);
        assert_eq!(decimals(&[0.0, 0.05]), 2);
    }

    #[test]
    fn better_points_are_higher_whatever_the_metric() {
        for (quality, worse, better) in [(Quality::Msdm2, 0.5, 0.1), (Quality::P2s, 50.0, 70.0)] {
            let axes = Axes::around(&[(1.0, worse), (2.0, better)], quality).expect("points");
            assert!(axes.down(better) < axes.down(worse), "{quality:?}");
            assert!(axes.across(2.0) > axes.across(1.0));
        }
    }

    #[test]
    fn one_point_and_none_make_no_trouble() {
        let point = Point::foreign("<p>".into(), 1000.0, [Some(0.5), None, None, None]);
        let curve = Curve {
            sequence: "s".into(),
            codec: "a&b".into(),
            foreign: false,
            points: vec![point],
        };
        let lines = [Line { curve: &curve, look: 0 }];
        let svg = draw(&lines, Quality::Msdm2).expect("one point");
        assert!(svg.contains("a&amp;b &lt;p&gt;: 1.000 kB, 0.5000"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(draw(&lines, Quality::P2s).is_none());
    }
}
