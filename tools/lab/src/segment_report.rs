//! Measures the segmenter: accuracy against true labels, flicker, time.
//!
//!     cargo run --release -p kn-lab -- segment-report [FRAMES [VERTICES [NAME]]]
//!
//! Runs on sequences of the performer (all, or those whose name holds NAME), and on
//! the sequence tshirt_turn where it exists (`docs/data.md`). Frames below 85 % are named.

use anyhow::Result;
use kn_io::{LabelSource, ReadOptions, read_mesh};
use kn_mesh::Mesh;
use kn_performer::{Action, Performer, PerformerConfig};
use kn_segment::{SegmentOptions, Segmenter};
use std::collections::HashMap;
use std::path::Path;
use std::time::Instant;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let mut arguments = arguments.iter();
    let frames: u32 = arguments.next().map_or(Ok(20), |text| text.parse())?;
    let vertices: usize = arguments.next().map_or(Ok(20_000), |text| text.parse())?;
    let chosen = arguments.next().map_or("", String::as_str);
    println!("sequence          right   worst   changes  of truth  returns  ms/frame  slowest");
    for (name, config) in sequences(vertices).into_iter().filter(|(name, _)| name.contains(chosen))
    {
        report_performer(name, config, frames)?;
    }
    let wanted = "tshirt_turn".contains(chosen);
    let capture = if wanted { kn_testdata::data("tshirt_turn") } else { None };
    capture.map_or(Ok(()), |folder| report_capture(&folder))
}

fn sequences(vertices: usize) -> Vec<(&'static str, PerformerConfig)> {
    let with = |action, seed, tunic, ball| PerformerConfig {
        vertices,
        action,
        seed,
        tunic,
        ball,
        ..PerformerConfig::default()
    };
    vec![
        ("dance, tunic", with(Action::Dance, 1, true, false)),
        ("dance, shirt", with(Action::Dance, 4, false, false)),
        ("dance, ball", with(Action::Dance, 4, false, true)),
        ("walk, tunic", with(Action::Walk, 2, true, false)),
        ("walk, ball", with(Action::Walk, 10, true, true)),
        ("turn, tunic", with(Action::Turn, 5, true, false)),
        ("stand, shirt", with(Action::Stand, 11, false, false)),
        ("dance, 21", with(Action::Dance, 21, true, false)),
        ("poses, tunic", with(Action::Poses, 6, true, false)),
        ("poses, shirt", with(Action::Poses, 7, false, false)),
    ]
}

/// Sums over the frames of a sequence.
#[derive(Default)]
struct Totals {
    right: Vec<f64>,
    times: Vec<f64>,
    /// Changed area between frames: our labels where the true ones agree, true labels, ours that
    /// change and change back; and what each is a share of.
    changed: f64,
    changed_truth: f64,
    followed: f64,
    returned: f64,
    followed_twice: f64,
}

impl Totals {
    fn segment(&mut self, segmenter: &mut Segmenter, mesh: &Mesh) -> Result<Vec<u8>> {
        let start = Instant::now();
        let labels = segmenter.segment(&mesh.positions, &mesh.faces)?.labels;
        self.times.push(1e3 * start.elapsed().as_secs_f64());
        let areas = areas(mesh);
        let right: f64 = areas
            .iter()
            .zip(&labels)
            .zip(&mesh.labels)
            .map(|((a, l), t)| if l == t { *a } else { 0.0 })
            .sum();
        let share = right / areas.iter().sum::<f64>();
        if share < 0.85 {
            println!("frame {}: {:.1} %", self.right.len(), 100.0 * share);
        }
        self.right.push(share);
        Ok(labels)
    }

    fn print(&self, name: &str) {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let percent = |part: f64, whole: f64| 100.0 * part / whole.max(1e-30);
        println!(
            "{name:16} {:6.2} % {:6.2} % {:6.2} %  {:6.2} % {:6.2} %  {:8.0} {:8.0}",
            100.0 * mean(&self.right),
            100.0 * self.right.iter().copied().fold(1.0, f64::min),
            percent(self.changed, self.followed),
            percent(self.changed_truth, self.followed),
            percent(self.returned, self.followed_twice),
            mean(&self.times),
            self.times.iter().copied().fold(0.0, f64::max),
        );
    }
}

/// A segmented frame, and where its vertices land in the next.
struct Frame {
    mesh: Mesh,
    labels: Vec<u8>,
    next: Vec<Option<usize>>,
}

fn report_performer(name: &str, config: PerformerConfig, frames: u32) -> Result<()> {
    let performer = Performer::new(config)?;
    let mut segmenter = Segmenter::new(SegmentOptions::default());
    let mut totals = Totals::default();
    let mut before: Option<Frame> = None;
    let mut last: Option<Frame> = None;
    for index in 0..frames {
        let mesh = performer.frame(index);
        let labels = totals.segment(&mut segmenter, &mesh)?;
        if let Some(last) = &mut last {
            let moved = performer.transport(&last.mesh, index - 1, index);
            last.next = nearest(&mesh.positions, &moved);
            follow(&mut totals, before.as_ref(), last, &mesh, &labels);
        }
        before = last.replace(Frame { mesh, labels, next: Vec::new() });
    }
    totals.print(name);
    Ok(())
}

/// Counts the surface points of the last frame whose label changes, and those of the frame before
/// whose label changes and changes back.
fn follow(totals: &mut Totals, before: Option<&Frame>, last: &Frame, mesh: &Mesh, labels: &[u8]) {
    for (v, area) in areas(&last.mesh).into_iter().enumerate() {
        let Some(u) = last.next[v] else { continue };
        totals.followed += area;
        if last.mesh.labels[v] != mesh.labels[u] {
            totals.changed_truth += area;
        } else if last.labels[v] != labels[u] {
            totals.changed += area;
        }
    }
    let Some(before) = before else { return };
    for (v, area) in areas(&before.mesh).into_iter().enumerate() {
        let Some(u) = before.next[v] else { continue };
        let Some(w) = last.next[u] else { continue };
        let truth = [before.mesh.labels[v], last.mesh.labels[u], mesh.labels[w]];
        if truth[0] == truth[1] && truth[1] == truth[2] {
            totals.followed_twice += area;
            if before.labels[v] != last.labels[u] && before.labels[v] == labels[w] {
                totals.returned += area;
            }
        }
    }
}

fn report_capture(folder: &Path) -> Result<()> {
    let mut segmenter = Segmenter::new(SegmentOptions::default());
    let mut totals = Totals::default();
    for index in 0..24 {
        let labels = LabelSource::File(folder.join(format!("frame_{index:04}.labels")));
        let options = ReadOptions { labels, ..ReadOptions::default() };
        let mesh = read_mesh(&folder.join(format!("frame_{index:04}.obj")), &options)?.mesh;
        totals.segment(&mut segmenter, &mesh)?;
    }
    totals.print("tshirt_turn");
    Ok(())
}

/// `#V`, a third of the area of the faces around each vertex.
fn areas(mesh: &Mesh) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.positions.len()];
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| mesh.positions[v as usize]);
        let [u, w] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
        let cross =
            [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
        let area = cross.iter().map(|x| x * x).sum::<f64>().sqrt() / 2.0;
        face.iter().for_each(|&v| areas[v as usize] += area / 3.0);
    }
    areas
}

/// The vertex closest to each point, if any is within 15 mm.
fn nearest(vertices: &[[f64; 3]], points: &[[f64; 3]]) -> Vec<Option<usize>> {
    const REACH: f64 = 0.015;
    let cell = |p: &[f64; 3]| p.map(|x| (x / REACH).floor() as i32);
    let mut cells: HashMap<[i32; 3], Vec<usize>> = HashMap::new();
    for (v, position) in vertices.iter().enumerate() {
        cells.entry(cell(position)).or_default().push(v);
    }
    let find = |point: &[f64; 3]| {
        let [x, y, z] = cell(point);
        let mut best = (REACH * REACH, None);
        for i in 0..27 {
            let key = [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1];
            for &v in cells.get(&key).into_iter().flatten() {
                let far = (0..3).map(|k| (vertices[v][k] - point[k]).powi(2)).sum::<f64>();
                if far < best.0 {
                    best = (far, Some(v));
                }
            }
        }
        best.1
    };
    points.iter().map(find).collect()
}
