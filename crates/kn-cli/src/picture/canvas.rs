//! A picture in memory: fill, paste, write text, save as PNG.

use super::font;
use std::io::{self, Write};

/// 8-bit sRGB.
pub(crate) type Colour = [u8; 3];

/// A picture of opaque pixels, row by row from the top left. Drawing outside is clipped.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    /// `width · height` colours.
    pixels: Vec<Colour>,
}

impl Canvas {
    /// A canvas of one colour.
    pub(crate) fn new(width: usize, height: usize, colour: Colour) -> Self {
        Self { width, height, pixels: vec![colour; width * height] }
    }

    pub(crate) fn width(&self) -> usize {
        self.width
    }

    pub(crate) fn height(&self) -> usize {
        self.height
    }

    pub(crate) fn set(&mut self, x: usize, y: usize, colour: Colour) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = colour;
        }
    }

    /// Fills a rectangle.
    pub(crate) fn fill(&mut self, at: [usize; 2], size: [usize; 2], colour: Colour) {
        for y in at[1]..(at[1] + size[1]).min(self.height) {
            for x in at[0]..(at[0] + size[0]).min(self.width) {
                self.pixels[y * self.width + x] = colour;
            }
        }
    }

    /// Copies `other` with its top left corner to `at`.
    pub(crate) fn paste(&mut self, other: &Canvas, at: [usize; 2]) {
        for (row, line) in other.pixels.chunks_exact(other.width.max(1)).enumerate() {
            for (column, &colour) in line.iter().enumerate() {
                self.set(at[0] + column, at[1] + row, colour);
            }
        }
    }

    /// Writes a line of text of this height, its top left corner at `at`.
    pub(crate) fn text(&mut self, at: [usize; 2], height: usize, colour: Colour, text: &str) {
        font::rasterise(text, height, |[x, y], coverage| {
            self.blend([at[0] + x, at[1] + y], coverage, colour);
        });
    }

    /// Mixes a colour into a pixel: 0 leaves the pixel as it is, 1 replaces it.
    fn blend(&mut self, [x, y]: [usize; 2], share: f32, colour: Colour) {
        if x < self.width && y < self.height {
            let pixel = &mut self.pixels[y * self.width + x];
            *pixel = std::array::from_fn(|i| {
                let (under, over) = (f32::from(pixel[i]), f32::from(colour[i]));
                (under + share * (over - under)).round() as u8
            });
        }
    }

    /// Saves the picture as an RGB PNG.
    pub(crate) fn write_png(&self, writer: impl Write) -> io::Result<()> {
        let size = |length: usize| u32::try_from(length).map_err(io::Error::other);
        let mut encoder = png::Encoder::new(writer, size(self.width)?, size(self.height)?);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::Adaptive);
        let mut stream = encoder.write_header()?;
        stream.write_image_data(self.pixels.as_flattened())?;
        Ok(stream.finish()?)
    }
}

#[cfg(test)]
impl Canvas {
    pub(super) fn pixel(&self, x: usize, y: usize) -> Colour {
        self.pixels[y * self.width + x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_outside_is_clipped() {
        let mut canvas = Canvas::new(8, 8, [0; 3]);
        canvas.fill([6, 6], [9, 9], [1; 3]);
        canvas.paste(&Canvas::new(3, 3, [2; 3]), [7, 0]);
        canvas.text([5, 5], 30, [3; 3], "clipped");
        assert_eq!(canvas.pixel(0, 0), [0; 3]);
        assert_eq!(canvas.pixel(7, 0), [2; 3]);
    }

    #[test]
    fn a_png_holds_the_same_pixels() {
        let mut canvas = Canvas::new(5, 3, [10, 20, 30]);
        canvas.set(4, 2, [200, 100, 50]);
        let mut file = Vec::new();
        canvas.write_png(&mut file).expect("in memory");
        let mut reader = png::Decoder::new(io::Cursor::new(file)).read_info().expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("whole");
        assert_eq!(pixels, canvas.pixels.as_flattened());
    }
}
