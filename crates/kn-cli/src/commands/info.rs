//! `kn info`: what a stream holds.

use crate::Outcome;
use crate::stream::{self, Source};
use crate::table::{grouped, table};
use anyhow::{Context, Result};
use kn_bitstream::{InfluenceMode, LabelSet, SequenceHeader, WeightScheme};
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
    /// Print JSON: {bytes, fps, frames: [{index, kind, bytes, vertices, faces, nodes}]}
    #[arg(long)]
    json: bool,
}

/// The stream as --json prints it.
#[derive(Debug, Serialize)]
struct StreamInfo {
    bytes: u64,
    fps: f64,
    frames: Vec<FrameRow>,
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
    let source = Source::open(&arguments.input)?;
    let bytes = source.size().with_context(|| name.clone())?;
    let mut decoder = Decoder::new(source).with_context(|| name.clone())?;
    let header = decoder.stream().header().cloned().context("the decoder has no header")?;
    let mut frames = Vec::new();
    let mut mesh = Mesh::default();
    while let Some(info) = decoder.next_frame(&mut mesh).with_context(|| name.clone())? {
        frames.push(FrameRow::from(info));
    }
    let fps = f64::from(header.frame_rate[0]) / f64::from(header.frame_rate[1]);
    let info = StreamInfo { bytes, fps, frames };
    let mut out = io::stdout().lock();
    if arguments.json {
        serde_json::to_writer_pretty(&mut out, &info)?;
        writeln!(out)?;
    } else {
        print(&mut out, &name, &header, &info)?;
    }
    Ok(Outcome::Good)
}

fn print(
    out: &mut impl Write,
    name: &str,
    header: &SequenceHeader,
    info: &StreamInfo,
) -> io::Result<()> {
    let frames = info.frames.len();
    let intra = info.frames.iter().filter(|frame| frame.kind == "I").count();
    let seconds = frames as f64 / info.fps;
    writeln!(
        out,
        "{name}: {frames} frames ({intra} I, {} P), {} bytes, {:.3} s at {} fps, {:.3} Mbit/s",
        frames - intra,
        grouped(info.bytes),
        seconds,
        info.fps,
        info.bytes as f64 * 8e-6 / seconds.max(f64::MIN_POSITIVE),
    )?;
    print_header(out, header)?;
    let mut table = table(&["frame", "kind", "bytes", "vertices", "faces", "nodes"]);
    for frame in &info.frames {
        let counts = [frame.vertices, frame.faces, frame.nodes].map(|n| grouped(n.into()));
        let mut row = vec![frame.index.to_string(), frame.kind.to_owned(), grouped(frame.bytes)];
        row.extend(counts);
        table.add_row(row);
    }
    writeln!(out, "{table}")
}

fn print_header(out: &mut impl Write, header: &SequenceHeader) -> io::Result<()> {
    let weights = match header.weight_scheme {
        WeightScheme::InverseSquare => "1/d²",
        WeightScheme::Sumner => "(1 − d/d')²",
        WeightScheme::Gaussian => "Gaussian",
    };
    let influence = match header.influence_mode {
        InfluenceMode::Strict => "strict",
        InfluenceMode::Fallback => "fallback",
    };
    let labels = match &header.labels {
        LabelSet::None => "none".to_owned(),
        LabelSet::Body => "body parts".to_owned(),
        LabelSet::Custom(regions) => format!("{} of its own", regions.len()),
    };
    let origin = header.grid_origin.map(|c| format!("{c:.6}")).join(", ");
    writeln!(
        out,
        "grid: step {:.6e} {}, origin ({origin}), {} up",
        header.grid_step,
        stream::unit_name(header.unit_of_length),
        ["x", "y", "z"][usize::from(header.up_axis.min(2))],
    )?;
    writeln!(
        out,
        "groups of up to {} frames; Q = {}, weights {weights}, influence {influence}, \
         labels {labels}; level {}",
        header.max_group_length, header.nodes_per_vertex, header.level,
    )
}
