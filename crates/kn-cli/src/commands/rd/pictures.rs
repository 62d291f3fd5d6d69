//! Pictures of one frame of every sequence, each codec at the point nearest to one rate.

use super::config::{CodecLabels, PicturesEntry};
use super::results::{CellRow, PictureRow, Share};
use super::sequences::Sequence;
use super::store::Store;
use crate::heatmap;
use crate::output::write_file;
use crate::picture::{Canvas, View};
use crate::stream;
use anyhow::{Context, Result};
use kn_mesh::Mesh;
use kn_metrics::{CompareOptions, Surface};
use std::fs;
use std::path::{Path, PathBuf};

/// Height of a picture in pixels.
const HEIGHT: usize = 360;
/// The scale of errors ends near this share of the box's diagonal.
const SCALE_END: f64 = 0.002;

/// Draws what is not there yet, in `output/pictures`.
pub(super) struct Artist<'a> {
    entry: PicturesEntry,
    store: &'a Store,
    output: &'a Path,
}

impl<'a> Artist<'a> {
    /// # Errors
    /// The folder cannot be made.
    pub(super) fn new(entry: PicturesEntry, store: &'a Store, output: &'a Path) -> Result<Self> {
        let folder = output.join("pictures");
        fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        Ok(Self { entry, store, output })
    }

    /// The pictures of a sequence: the scan first, then each codec. `cells` are the finished ones
    /// of the sequence.
    ///
    /// # Errors
    /// A scan or a stream cannot be read, a picture cannot be written.
    pub(super) fn draw(&self, sequence: &Sequence, cells: &[&CellRow]) -> Result<Vec<PictureRow>> {
        // A sequence that is too short shows its last frame.
        let frame = (self.entry.frame as usize).min(sequence.len() - 1);
        let view = View::new(sequence.box_of_all(), sequence.up_axis, self.entry.yaw);
        let scale_end = heatmap::round_up(SCALE_END * sequence.info.diagonal);
        let scene = Scene { artist: self, sequence, frame, view, scale_end };
        let mut pictures = vec![scene.scan()?];
        for cell in nearest_to_rate(cells, self.entry.rate) {
            pictures.push(scene.decoded(cell)?);
        }
        Ok(pictures)
    }

    fn file(&self, key: &str, frame: usize, kind: &str) -> String {
        format!("pictures/{}-{frame}-{}-{kind}.png", &key[..16], self.entry.yaw)
    }

    fn write(&self, file: &str, picture: &Canvas) -> Result<()> {
        write_file(&self.output.join(file), |out| Ok(picture.write_png(out)?))
    }

    fn place(&self, file: &str) -> PathBuf {
        self.output.join(file)
    }
}

/// One frame of one sequence, seen from one side.
struct Scene<'s> {
    artist: &'s Artist<'s>,
    sequence: &'s Sequence,
    frame: usize,
    view: View,
    scale_end: f64,
}

impl Scene<'_> {
    fn size(&self) -> [usize; 2] {
        self.view.size_of_height(HEIGHT)
    }

    fn scan(&self) -> Result<PictureRow> {
        let file = self.artist.file(&self.sequence.info.digest, self.frame, "scan");
        if !self.artist.place(&file).is_file() {
            let mesh = self.sequence.frame(self.frame, CodecLabels::None)?;
            self.artist.write(&file, &heatmap::plain(&mesh, &self.view, self.size()))?;
        }
        Ok(PictureRow {
            sequence: self.sequence.info.name.clone(),
            codec: None,
            point: None,
            frame: self.frame as u64,
            bytes_per_frame: None,
            file,
            error_file: None,
            scale_end: self.scale_end,
        })
    }

    fn decoded(&self, cell: &CellRow) -> Result<PictureRow> {
        let [file, error_file] =
            ["decoded", "error"].map(|kind| self.artist.file(&cell.result.key, self.frame, kind));
        let is_there = |file: &String| self.artist.place(file).is_file();
        if !(is_there(&file) && is_there(&error_file)) {
            let mesh = self.decode(&cell.result.key)?;
            let scan = self.sequence.frame(self.frame, CodecLabels::None)?;
            let options = CompareOptions::distances();
            let reference = Surface::new((&scan).into(), &options)?;
            let errors = Surface::new((&mesh).into(), &options)?.vertex_distances(&reference);
            let (view, size) = (&self.view, self.size());
            let map = heatmap::coloured(&mesh, &errors, self.scale_end, view, size);
            self.artist.write(&file, &heatmap::plain(&mesh, view, size))?;
            self.artist.write(&error_file, &map)?;
        }
        Ok(PictureRow {
            sequence: cell.sequence.clone(),
            codec: Some(cell.codec.clone()),
            point: Some(cell.point.clone()),
            frame: self.frame as u64,
            bytes_per_frame: cell.result.bytes_per_frame(Share::All),
            file,
            error_file: Some(error_file),
            scale_end: self.scale_end,
        })
    }

    fn decode(&self, key: &str) -> Result<Mesh> {
        let path = self.artist.store.stream(key);
        let named = || stream::name_of(&path);
        let mut decoder = stream::decoder(&path)?;
        decoder.seek(self.frame as u64).with_context(named)?;
        let mut mesh = Mesh::default();
        let info = decoder.next_frame(&mut mesh).with_context(named)?;
        info.with_context(|| format!("{}: there is no frame {}", named(), self.frame))?;
        Ok(mesh)
    }
}

/// For each codec the cell nearest to `rate` (kB a frame), or to the middle one of the first
/// codec. Near is by ratio.
fn nearest_to_rate<'c>(cells: &[&'c CellRow], rate: Option<f64>) -> Vec<&'c CellRow> {
    let bytes = |cell: &CellRow| cell.result.bytes_per_frame(Share::All).unwrap_or(f64::MAX);
    let Some(first) = cells.first() else { return Vec::new() };
    let of_first = cells.iter().filter(|cell| cell.codec == first.codec);
    let mut rates: Vec<f64> = of_first.map(|cell| bytes(cell)).collect();
    rates.sort_by(f64::total_cmp);
    let target = rate.map_or(rates[rates.len() / 2], |kilobytes| 1000.0 * kilobytes);
    let distance = |cell: &CellRow| (bytes(cell) / target).ln().abs();
    let mut chosen: Vec<&CellRow> = Vec::new();
    for &cell in cells {
        match chosen.iter_mut().find(|other| other.codec == cell.codec) {
            Some(other) if distance(cell) < distance(other) => *other = cell,
            Some(_) => {}
            None => chosen.push(cell),
        }
    }
    chosen
}
