//! Pictures in rows and columns with titles and a scale.

use super::canvas::Canvas;
use super::{INK, PAPER, colour_map, font};

/// Pictures of equal size under column titles, each row under its own title.
pub(crate) struct Sheet {
    /// One line above everything.
    pub(crate) title: String,
    /// A title per column; may be empty.
    pub(crate) columns: Vec<String>,
    /// Title and pictures of each row.
    pub(crate) rows: Vec<(String, Vec<Canvas>)>,
    /// What the colours of the error map mean: start, middle, end of the scale.
    pub(crate) scale: Option<[String; 3]>,
}

/// Pixels around and between pictures.
const GAP: usize = 6;
/// Pixels of a line of titles.
const LINE: usize = font::LINE_HEIGHT + 5;

impl Sheet {
    /// Lays everything out on one canvas.
    pub(crate) fn draw(&self) -> Canvas {
        let cell = |pick: fn(&Canvas) -> usize| {
            self.rows.iter().flat_map(|row| &row.1).map(pick).max().unwrap_or(0)
        };
        let (cell_width, cell_height) = (cell(Canvas::width), cell(Canvas::height));
        let columns = self.rows.iter().map(|row| row.1.len()).max().unwrap_or(0);
        let width = (GAP + columns * (cell_width + GAP)).max(2 * GAP + self.widest_title());
        let row_height = LINE + cell_height + GAP;
        let foot = if self.scale.is_some() { 3 * LINE } else { 0 };
        let height = GAP + 3 * LINE + self.rows.len() * row_height + foot;

        let mut canvas = Canvas::new(width, height, PAPER);
        canvas.text([GAP, GAP], 2, INK, &self.title);
        let x_of = |column: usize| GAP + column * (cell_width + GAP);
        for (column, title) in self.columns.iter().enumerate() {
            canvas.text([x_of(column), GAP + 2 * LINE], 1, INK, title);
        }
        for (row, (title, pictures)) in self.rows.iter().enumerate() {
            let y = GAP + 3 * LINE + row * row_height;
            for (column, picture) in pictures.iter().enumerate() {
                canvas.paste(picture, [x_of(column), y + LINE]);
            }
            canvas.text([GAP, y], 1, INK, title);
        }
        if let Some(labels) = &self.scale {
            let at = [GAP, height - foot];
            let labels = labels.each_ref().map(String::as_str);
            colour_map::draw_scale(&mut canvas, at, width - 2 * GAP, labels);
        }
        canvas
    }

    fn widest_title(&self) -> usize {
        let rows = self.rows.iter().map(|row| font::text_width(&row.0));
        rows.chain([2 * font::text_width(&self.title)]).max().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_picture_is_on_the_sheet() {
        let picture = |grey: u8| Canvas::new(20, 10, [grey; 3]);
        let sheet = Sheet {
            title: "a title that is wider than the pictures".into(),
            columns: vec!["frame 0".into(), "frame 1".into()],
            rows: vec![
                ("original".into(), vec![picture(10), picture(20)]),
                ("decoded".into(), vec![picture(30), picture(40)]),
            ],
            scale: Some(["0".into(), "1".into(), "2 mm".into()]),
        };
        let canvas = sheet.draw();
        for grey in [10, 20, 30, 40] {
            let count = (0..canvas.height())
                .flat_map(|y| (0..canvas.width()).map(move |x| (x, y)))
                .filter(|&(x, y)| canvas.pixel(x, y) == [grey; 3])
                .count();
            assert_eq!(count, 200, "picture of grey {grey}");
        }
    }
}
