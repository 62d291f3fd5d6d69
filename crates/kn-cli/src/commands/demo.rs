//! `kn demo`: encodes, decodes and measures the synthetic performer. It needs no data.

mod picture;
mod result;

use crate::arguments::Global;
use crate::output::{print, write_file};
use crate::outputs::Outputs;
use crate::stream::kind_letter;
use crate::{Outcome, progress};
use anyhow::{Context, Result};
use kn_bitstream::params::UnitOfLength;
use kn_codec::{Decoder, Encoder, EncoderConfig, FrameInfo, FrameKind, GridChoice};
use kn_mesh::{BoundingBox, Mesh};
use kn_metrics::{CompareOptions, Metric, Surface, compare_surfaces};
use kn_performer::{Performer, PerformerConfig};
use result::{DemoResult, FrameRow, Seconds};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Show the whole way: generate a performer, encode, decode, verify, measure
#[derive(Debug, clap::Args)]
#[command(after_help = "\
The performer is a synthetic clothed dancer who is meshed anew in every frame, like a scan.
The command writes demo.knm, demo.png (scans, decoded frames and their error) and demo.json.

Exit codes: 0 the stream verifies, 1 it does not, 2 an error.

Examples:
  kn demo
  kn demo --output /tmp --frames 60 --vertices 20000 --seed 7")]
pub(crate) struct DemoArguments {
    /// The folder for the three files
    #[arg(short, long, value_name = "FOLDER", default_value = ".")]
    output: PathBuf,
    /// Number of frames
    #[arg(long, value_name = "N", default_value_t = 24)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Vertices of a frame
    #[arg(long, value_name = "N", default_value_t = 12_000)]
    #[arg(value_parser = clap::value_parser!(u32).range(1_000..=200_000))]
    vertices: u32,
    /// Decides the performer's proportions, dance and noise
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
}

/// A decoded frame.
struct DecodedFrame {
    info: FrameInfo,
    mesh: Mesh,
}

/// Runs the command.
pub(crate) fn run(arguments: &DemoArguments, global: &Global) -> Result<Outcome> {
    fs::create_dir_all(&arguments.output)
        .with_context(|| arguments.output.display().to_string())?;
    let place = |name: &str| arguments.output.join(name);
    let files = ["demo.knm", "demo.png", "demo.json"].map(place);
    let mut outputs = Outputs::default();
    files.iter().try_for_each(|file| outputs.file("demo", file))?;
    let [stream, png, json] = files;
    let mut seconds = Seconds::default();

    let scans = timed(&mut seconds.generate, || arguments.generate(global))?;
    let bounds = common_box(&scans).context("the performer has no frames")?;
    timed(&mut seconds.encode, || encode(&scans, bounds, &stream, global))?;
    let decoded = timed(&mut seconds.decode, || decode(&stream, false))?;
    let verified = timed(&mut seconds.verify, || decode(&stream, true)).is_ok();
    let rows = timed(&mut seconds.measure, || measure(&scans, &decoded, bounds, global))?;

    let bytes = fs::metadata(&stream).with_context(|| stream.display().to_string())?.len();
    let result = DemoResult::new(bytes, verified, rows, seconds);
    let picture = picture::draw(&scans, &decoded, &bounds)?;
    write_file(&png, |out| Ok(picture.write_png(out)?))?;
    write_file(&json, |out| Ok(serde_json::to_writer_pretty(out, &result)?))?;
    print(|out| Ok(result.write_table(out)?))?;
    Ok(if verified { Outcome::Good } else { Outcome::Bad })
}

/// Runs a step and adds its duration to `seconds`.
fn timed<T>(seconds: &mut f64, step: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let value = step();
    *seconds += start.elapsed().as_secs_f64();
    value
}

impl DemoArguments {
    fn generate(&self, global: &Global) -> Result<Vec<Mesh>> {
        let config = PerformerConfig {
            seed: self.seed,
            vertices: self.vertices as usize,
            ..PerformerConfig::default()
        };
        let performer = Performer::new(config)?;
        let bar = progress::bar(global, "generating", Some(self.frames.into()));
        let frame = |index| {
            bar.step();
            performer.frame(index)
        };
        Ok((0..self.frames).map(frame).collect())
    }
}

fn common_box(scans: &[Mesh]) -> Option<BoundingBox> {
    scans.iter().filter_map(Mesh::bounding_box).reduce(BoundingBox::union)
}

fn encode(scans: &[Mesh], bounds: BoundingBox, stream: &Path, global: &Global) -> Result<()> {
    let config = EncoderConfig::default()
        .with_grid(GridChoice::Bits { bits: 11, bounds: Some(bounds) })
        .with_unit(UnitOfLength::Metre);
    let bar = progress::bar(global, "encoding", Some(scans.len() as u64));
    write_file(stream, |out| {
        let mut encoder = Encoder::new(out, config)?;
        for scan in scans {
            encoder.push(scan)?;
            bar.step();
        }
        encoder.finish()?;
        Ok(())
    })
}

fn decode(stream: &Path, check_digests: bool) -> Result<Vec<DecodedFrame>> {
    let name = || stream.display().to_string();
    let file = File::open(stream).with_context(name)?;
    let mut decoder = Decoder::new(BufReader::new(file)).with_context(name)?;
    decoder.check_digests(check_digests);
    let mut frames = Vec::new();
    let mut mesh = Mesh::default();
    while let Some(info) = decoder.next_frame(&mut mesh).with_context(name)? {
        frames.push(DecodedFrame { info, mesh: std::mem::take(&mut mesh) });
    }
    Ok(frames)
}

/// Measures every frame, and the I-frame held still as what P-frames have to be better than.
fn measure(
    scans: &[Mesh],
    decoded: &[DecodedFrame],
    bounds: BoundingBox,
    global: &Global,
) -> Result<Vec<FrameRow>> {
    let perceptual = CompareOptions::perceptual().with_bounds(bounds);
    let distances = CompareOptions::distances().with_bounds(bounds);
    let bar = progress::bar(global, "measuring", Some(scans.len() as u64));
    let mut rows = Vec::new();
    let mut still: Option<Surface> = None;
    for (scan, DecodedFrame { info, mesh }) in scans.iter().zip(decoded) {
        let reference = Surface::new(scan.into(), &perceptual)?;
        let surface = Surface::new(mesh.into(), &perceptual)?;
        let comparison = compare_surfaces(&reference, &surface, &perceptual)?;
        let held_still = match (info.kind, &still) {
            (FrameKind::Predicted, Some(still)) => {
                compare_surfaces(&reference, still, &distances)?.get(Metric::P2sRmsWorld)
            }
            _ => None,
        };
        if info.kind == FrameKind::Intra {
            still = Some(surface);
        }
        rows.push(FrameRow::new(info, kind_letter(info.kind), comparison, held_still));
        bar.step();
    }
    Ok(rows)
}
