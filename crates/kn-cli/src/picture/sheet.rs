//! Pictures in rows and columns with titles and a legend.

use super::canvas::{Canvas, Colour};
use super::font::{self, CAPTION, TITLE};
use super::{INK, PAPER, colour_map};

/// Pictures of equal size under column titles, each row under its own title.
pub(crate) struct Sheet {
    /// One line above everything.
    pub(crate) title: String,
    /// A title per column; may be empty.
    pub(crate) columns: Vec<String>,
    /// Title and pictures of each row.
    pub(crate) rows: Vec<(String, Vec<Canvas>)>,
    /// Meaning of the colours.
    pub(crate) legend: Option<Legend>,
}

/// Meaning of colours.
pub(crate) enum Legend {
    /// Start, middle and end of the error map's scale.
    Scale([String; 3]),
    /// A name for each colour.
    Names(Vec<(Colour, String)>),
}

impl Legend {
    /// Pixels from the start of a name's colour to the start of the name.
    const PATCH: usize = 16;

    /// Height in pixels within a width.
    fn height(&self, width: usize) -> usize {
        match self {
            Self::Scale(_) => 3 * LINE,
            Self::Names(names) => names.len().div_ceil(self.columns(width)) * LINE + GAP,
        }
    }

    /// Pixels from one name to the next.
    fn advance(&self) -> usize {
        match self {
            Self::Scale(_) => 0,
            Self::Names(names) => {
                let widest = names.iter().map(|(_, name)| font::text_width(name, CAPTION)).max();
                Self::PATCH + widest.unwrap_or(0) + 2 * GAP
            }
        }
    }

    fn columns(&self, width: usize) -> usize {
        (width / self.advance().max(1)).max(1)
    }

    fn draw(&self, canvas: &mut Canvas, [x, y]: [usize; 2], width: usize) {
        match self {
            Self::Scale(labels) => {
                let labels = labels.each_ref().map(String::as_str);
                colour_map::draw_scale(canvas, [x, y], width, labels);
            }
            Self::Names(names) => {
                let columns = self.columns(width);
                for (index, (colour, name)) in names.iter().enumerate() {
                    let x = x + index % columns * self.advance();
                    let y = y + index / columns * LINE;
                    canvas.fill([x, y], [Self::PATCH - 4, CAPTION], *colour);
                    canvas.text([x + Self::PATCH, y], CAPTION, INK, name);
                }
            }
        }
    }
}

/// Pixels around and between pictures.
const GAP: usize = 6;
/// Pixels of a line of titles.
const LINE: usize = CAPTION + 4;

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
        let inside = width - 2 * GAP;
        let foot = self.legend.as_ref().map_or(0, |legend| legend.height(inside));
        let height = GAP + 3 * LINE + self.rows.len() * row_height + foot;

        let mut canvas = Canvas::new(width, height, PAPER);
        canvas.text([GAP, GAP], TITLE, INK, &self.title);
        let x_of = |column: usize| GAP + column * (cell_width + GAP);
        for (column, title) in self.columns.iter().enumerate() {
            canvas.text([x_of(column), GAP + 2 * LINE], CAPTION, INK, title);
        }
        for (row, (title, pictures)) in self.rows.iter().enumerate() {
            let y = GAP + 3 * LINE + row * row_height;
            for (column, picture) in pictures.iter().enumerate() {
                canvas.paste(picture, [x_of(column), y + LINE]);
            }
            canvas.text([GAP, y], CAPTION, INK, title);
        }
        if let Some(legend) = &self.legend {
            legend.draw(&mut canvas, [GAP, height - foot], inside);
        }
        canvas
    }

    fn widest_title(&self) -> usize {
        let rows = self.rows.iter().map(|row| font::text_width(&row.0, CAPTION));
        rows.chain([font::text_width(&self.title, TITLE)]).max().unwrap_or(0)
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
            legend: Some(Legend::Scale(["0".into(), "1".into(), "2 mm".into()])),
        };
        let canvas = sheet.draw();
        for grey in [10, 20, 30, 40] {
            assert_eq!(count(&canvas, [grey; 3]), 200, "picture of grey {grey}");
        }
    }

    fn count(canvas: &Canvas, colour: Colour) -> usize {
        let pixels = (0..canvas.height()).flat_map(|y| (0..canvas.width()).map(move |x| (x, y)));
        pixels.filter(|&(x, y)| canvas.pixel(x, y) == colour).count()
    }

    #[test]
    fn every_name_of_a_legend_has_its_colour_on_the_sheet() {
        let names: Vec<(Colour, String)> =
            (1..=15).map(|grey| ([grey; 3], format!("part {grey}"))).collect();
        for width in [10, 100, 400] {
            let picture = Canvas::new(width, 10, [200; 3]);
            let sheet = Sheet {
                title: String::new(),
                columns: Vec::new(),
                rows: vec![(String::new(), vec![picture])],
                legend: Some(Legend::Names(names.clone())),
            };
            let canvas = sheet.draw();
            for (colour, name) in &names {
                assert!(count(&canvas, *colour) > 0, "{name} in {width} pixels");
            }
        }
    }
}
