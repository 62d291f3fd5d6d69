//! Text in pictures, in DejaVu Sans.

use ab_glyph::{Font, FontRef, GlyphId, Point, PxScaleFont, ScaleFont, point};
use std::sync::LazyLock;

/// Pixels from the top of the highest letter to the bottom of the lowest one, in captions.
pub(super) const CAPTION: usize = 13;
/// Likewise in titles.
pub(super) const TITLE: usize = 19;

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    FontRef::try_from_slice(dejavu::sans::regular()).expect("the font is part of the program")
});

fn font(height: usize) -> PxScaleFont<&'static FontRef<'static>> {
    FONT.as_scaled(height as f32)
}

/// Calls `glyph` with each glyph of a line and its horizontal position, and returns the width of the
/// line in pixels. A character that the font does not have becomes its box.
fn lay_out(text: &str, height: usize, mut glyph: impl FnMut(GlyphId, f32)) -> f32 {
    let font = font(height);
    let (mut x, mut last) = (0.0, None);
    for character in text.chars() {
        let id = font.glyph_id(character);
        x += last.map_or(0.0, |last| font.kern(last, id));
        glyph(id, x);
        x += font.h_advance(id);
        last = Some(id);
    }
    x
}

/// Width of a line of text in pixels.
pub(super) fn text_width(text: &str, height: usize) -> usize {
    lay_out(text, height, |_, _| ()).ceil() as usize
}

/// Calls `paint` with each pixel that a line of text covers, from its top left corner, and with how
/// much of the pixel it covers, above 0 and up to 1.
pub(super) fn rasterise(text: &str, height: usize, mut paint: impl FnMut([usize; 2], f32)) {
    let baseline = font(height).ascent().round();
    lay_out(text, height, |id, x| {
        let glyph = id.with_scale_and_position(height as f32, point(x, baseline));
        let Some(outline) = FONT.outline_glyph(glyph) else { return };
        let Point { x: left, y: top } = outline.px_bounds().min;
        outline.draw(|column, row, coverage| {
            let (x, y) = (left + column as f32, top + row as f32);
            // A letter that leans over the line's start is cut off there.
            if coverage > 0.0 && x >= 0.0 && y >= 0.0 {
                paint([x as usize, y as usize], coverage.min(1.0));
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(text: &str) -> Vec<([usize; 2], u32)> {
        let mut pixels = Vec::new();
        rasterise(text, CAPTION, |at, coverage| pixels.push((at, (coverage * 255.0) as u32)));
        pixels
    }

    #[test]
    fn text_stays_within_its_width_and_height() {
        for text in ["Xylophone (j, q) %", "dancer 17", "λ = 3e-5, 2 × 3 µm"] {
            let width = text_width(text, CAPTION);
            let inside = |&([x, y], _): &([usize; 2], u32)| x <= width && y <= CAPTION;
            assert!(pixels(text).iter().all(inside), "{text}");
            assert!(!pixels(text).is_empty(), "{text}");
        }
        assert_eq!((text_width("", TITLE), pixels(" ").len()), (0, 0));
    }

    #[test]
    fn characters_differ_and_unknown_ones_show() {
        assert_ne!(pixels("O"), pixels("0"));
        assert_ne!(pixels("I"), pixels("1"));
        assert!(!pixels("\u{10FFFD}").is_empty());
    }
}
