//! Pictures of meshes for people: a small software rasteriser, colour maps, captions, PNG.
//!
//! Nothing here needs a GPU or a window, so that a picture can be made wherever `kn` runs.

mod canvas;
mod colour_map;
mod font;
mod rasteriser;
mod sheet;
mod view;

pub(crate) use canvas::{Canvas, Colour};
pub(crate) use colour_map::colour_of;
pub(crate) use rasteriser::{Paint, render};
pub(crate) use sheet::{Legend, Sheet};
pub(crate) use view::View;

/// Background of every picture.
const PAPER: Colour = [255; 3];
/// Captions.
const INK: Colour = [40, 44, 52];
/// Colour of scans.
pub(crate) const CLAY: Colour = [214, 190, 170];
