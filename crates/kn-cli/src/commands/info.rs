//! `kn info`: prints the header and the frames of a stream.

use crate::Outcome;
use crate::output::{print, print_json};
use crate::stream;
use crate::table::{counted, grouped, table};
use anyhow::{Context, Result};
use kn_bitstream::SequenceHeader;
use kn_bitstream::params::LabelSet;
use kn_codec::{Decoder, FrameInfo};
use kn_mesh::Mesh;
use serde::Serialize;
use std::io::{self, Write};
use std::path::PathBuf;

/// Show what a stream holds: settings, and kind and size of every frame
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kn info dance.knm
  kn info dance.knm --json | jq '.frames[] | select(.kind == \"P\") | .bytes'")]
pub(crate) struct InfoArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// Print JSON: {bytes, fps, step, origin, unit, up, group_length, nodes_per_vertex, weights,
    /// influence, labels, level, frames: [{index, kind, bytes, vertices, faces, nodes}]}
    #[arg(long)]
    json: bool,
}

/// The stream as --json prints it.
#[derive(Debug, Serialize)]
struct StreamInfo {
    bytes: u64,
    fps: f64,
    /// Of the grid, world units.
    step: f64,
    origin: [f64; 3],
    unit: String,
    up: String,
    /// Most frames in a GoF.
    group_length: u8,
    nodes_per_vertex: u8,
    weights: String,
    influence: String,
    /// `none`, `body` or `custom`.
    labels: &'static str,
    level: u8,
    frames: Vec<FrameRow>,
}

impl StreamInfo {
    fn new(bytes: u64, header: &SequenceHeader, frames: Vec<FrameRow>) -> Self {
        Self {
            bytes,
            fps: header.frame_rate.per_second(),
            step: header.grid_step,
            origin: header.grid_origin,
            unit: header.unit_of_length.to_string(),
            up: header.up_axis.to_string(),
            group_length: header.max_group_length,
            nodes_per_vertex: header.nodes_per_vertex,
            weights: header.weight_scheme.to_string(),
            influence: header.influence_mode.to_string(),
            labels: match &header.labels {
                LabelSet::None => "none",
                LabelSet::Body => "body",
                LabelSet::Custom(_) => "custom",
            },
            level: header.level,
            frames,
        }
    }
}

#[derive(Debug, Serialize)]
struct FrameRow {
    index: u64,
    kind: &'static str,
    bytes: u64,
    vertices: u32,
    faces: u32,
    nodes: u32,
}

impl From<FrameInfo> for FrameRow {
    fn from(info: FrameInfo) -> Self {
        Self {
            index: info.index,
            kind: stream::kind_letter(info.kind),
            bytes: info.bytes,
            vertices: info.vertices,
            faces: info.faces,
            nodes: info.nodes,
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &InfoArguments) -> Result<Outcome> {
    let name = stream::name_of(&arguments.input);
    let source = stream::open(&arguments.input)?;
    let bytes = source.size().with_context(|| name.clone())?;
    let mut decoder = Decoder::new(source).with_context(|| name.clone())?;
    let header = decoder.stream().header().cloned().context("the decoder has no header")?;
    let mut frames = Vec::new();
    let mut mesh = Mesh::default();
    while let Some(info) = decoder.next_frame(&mut mesh).with_context(|| name.clone())? {
        frames.push(FrameRow::from(info));
    }
    let info = StreamInfo::new(bytes, &header, frames);
    if arguments.json {
        print_json(&info)?;
    } else {
        print(|out| Ok(write_text(out, &name, &header, &info)?))?;
    }
    Ok(Outcome::Good)
}

fn write_text(
    out: &mut dyn Write,
    name: &str,
    header: &SequenceHeader,
    info: &StreamInfo,
) -> io::Result<()> {
    let frames = info.frames.len();
    let (count, bytes) = (counted(frames as u64, "frame"), grouped(info.bytes));
    let intra = info.frames.iter().filter(|frame| frame.kind == "I").count();
    let seconds = frames as f64 / info.fps;
    writeln!(
        out,
        "{name}: {count} ({intra} I, {} P), {bytes} bytes, {:.3} s at {} fps, {:.3} Mbit/s",
        frames - intra,
        seconds,
        info.fps,
        info.bytes as f64 * 8e-6 / seconds.max(f64::MIN_POSITIVE),
    )?;
    write_header(out, header, info)?;
    let mut table = table(&["frame", "kind", "bytes", "vertices", "faces", "nodes"]);
    for frame in &info.frames {
        let counts = [frame.vertices, frame.faces, frame.nodes].map(|n| grouped(n.into()));
        let mut row = vec![frame.index.to_string(), frame.kind.to_owned(), grouped(frame.bytes)];
        row.extend(counts);
        table.add_row(row);
    }
    writeln!(out, "{table}")
}

fn write_header(out: &mut dyn Write, header: &SequenceHeader, info: &StreamInfo) -> io::Result<()> {
    let labels = match &header.labels {
        LabelSet::None => "none".to_owned(),
        LabelSet::Body => "body parts".to_owned(),
        LabelSet::Custom(regions) => format!("{} of its own", regions.len()),
    };
    let origin = header.grid_origin.map(|c| format!("{c:.6}")).join(", ");
    writeln!(
        out,
        "grid: step {:.6e} {}, origin ({origin}), {} up",
        info.step,
        stream::unit_name(header.unit_of_length),
        info.up,
    )?;
    writeln!(
        out,
        "GoFs of up to {}; Q = {}, weights {}, influence {}, labels {labels}; level {}",
        counted(info.group_length.into(), "frame"),
        info.nodes_per_vertex,
        info.weights,
        info.influence,
        info.level,
    )
}
