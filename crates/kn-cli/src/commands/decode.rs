//! `kn decode`: a .knm file in, meshes out.

mod sink;

use crate::arguments::{FrameRange, Global};
use crate::stream::{self, Source};
use crate::{Outcome, progress};
use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use kn_codec::{DecodeErrorKind, Decoder};
use kn_mesh::Mesh;
use sink::Sink;
use std::path::PathBuf;

/// Decode a .knm file into meshes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Files are called like the encoder's input where the stream knows those names, else frame_0000 and
so on. The files appear together at the end: after an error none is there.

Examples:
  kn decode dance.knm -o out/
  kn decode dance.knm -o out/ --format ply --frames 3..7
  kn decode dance.knm -o dance.glb
  kn decode half.knm -o out/ --partial
  curl -s https://example.org/dance.knm | kn decode - -o out/")]
pub(crate) struct DecodeArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// The folder for the meshes, made where it does not exist; or a .glb file for all frames
    #[arg(short, long, value_name = "FOLDER|FILE.glb")]
    output: PathBuf,
    /// Format of the meshes; PLY carries the labels
    #[arg(long, value_enum, default_value_t = Format::Obj)]
    format: Format,
    /// Decode these frames only: 5, 3..7 (both included), 3.. or ..7
    #[arg(long, value_name = "RANGE", default_value = "..")]
    frames: FrameRange,
    /// Take all whole frames of a file that ends early
    #[arg(long)]
    partial: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Wavefront OBJ
    Obj,
    /// Stanford PLY, binary
    Ply,
    /// glTF 2.0, binary
    Glb,
}

impl Format {
    fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Glb => "glb",
        }
    }
}

/// Runs the command.
pub(crate) fn run(arguments: &DecodeArguments, global: &Global) -> Result<Outcome> {
    let mut decoder = stream::open(&arguments.input)?;
    let mut sink = arguments.sink(&decoder)?;
    let bar = progress::bar(global, "decoding", None);
    let mut frames = 0;
    arguments.decode(&mut decoder, global, |index, name, mesh| {
        sink.push(index, name, mesh)?;
        frames += 1;
        bar.step();
        Ok(())
    })?;
    drop(bar);
    let files = sink.finish()?;
    let output = arguments.output.display();
    global.note(format_args!("{output}: {frames} frames in {files} files"));
    Ok(Outcome::Good)
}

impl DecodeArguments {
    fn sink(&self, decoder: &Decoder<Source>) -> Result<Sink> {
        let is_glb = self.output.extension().is_some_and(|e| e.eq_ignore_ascii_case("glb"));
        if is_glb && !self.output.is_dir() {
            let rate = decoder.stream().header().map_or([30, 1], |header| header.frame_rate);
            return Sink::animation(&self.output, f64::from(rate[0]) / f64::from(rate[1]));
        }
        Sink::files(&self.output, self.format.extension())
    }

    /// Hands the frames that were asked for to `take`: index, name in the stream, mesh.
    fn decode(
        &self,
        decoder: &mut Decoder<Source>,
        global: &Global,
        mut take: impl FnMut(u64, Option<String>, &Mesh) -> Result<()>,
    ) -> Result<()> {
        let name = stream::name_of(&self.input);
        // A file that ends early has no index to seek by.
        if self.frames.first() > 0 && !self.partial {
            decoder.seek(self.frames.first()).with_context(|| name.clone())?;
        }
        let mut mesh = Mesh::default();
        let mut last = None;
        while last.is_none_or(|last| last < self.frames.last()) {
            let info = match decoder.next_frame(&mut mesh) {
                Ok(Some(info)) => info,
                Ok(None) => break,
                Err(error) if self.partial && is_early_end(error.kind()) => {
                    global.note(format_args!("{name}: {error}"));
                    break;
                }
                Err(error) => return Err(error).context(name),
            };
            last = Some(info.index);
            if self.frames.contains(info.index) {
                take(info.index, decoder.stream().frame_name(), &mesh)?;
            }
        }
        let found = last.is_some_and(|last| last >= self.frames.first());
        ensure!(found, "{name}: there is no frame {}", self.frames.first());
        Ok(())
    }
}

fn is_early_end(kind: &DecodeErrorKind) -> bool {
    matches!(kind, DecodeErrorKind::Truncated { .. })
}
