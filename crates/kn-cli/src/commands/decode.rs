//! `kn decode`: decodes a .knm file into meshes.

mod sink;

use crate::arguments::{FrameRange, Global};
use crate::output::is_dash;
use crate::outputs::{Outputs, ends_with_separator};
use crate::stream;
use crate::table::counted;
use crate::{Outcome, progress};
use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use kn_codec::{DecodeErrorKind, Decoder};
use kn_mesh::Mesh;
use kn_sequence::StreamReader;
use sink::{Files, Sink};
use std::path::PathBuf;

/// Decode a .knm file into meshes
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Files have the names of the encoder's input where the stream has these names, else frame_0000 and
so on. Each frame is checked against the digest that it carries. All files are put in place at the
end: after an error there are none. Files that are in the folder already are kept and named in an
error, unless --overwrite is given.

Examples:
  kn decode dance.knm -o out/
  kn decode dance.knm -o out/ --format ply --frames 3..7
  kn decode dance.knm -o dance.glb
  kn decode half.knm -o half/ --partial
  cat dance.knm | kn decode - -o out/")]
pub(crate) struct DecodeArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// The folder for the meshes, made where it does not exist; or a .glb file for all frames, with
    /// the coordinates as they are: neither turned upright nor brought to metres, as glTF has them
    #[arg(short, long, value_name = "FOLDER|FILE.glb")]
    output: PathBuf,
    /// Format of the meshes in a folder; PLY carries the labels [default: obj]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Decode these frames only: 5, 3..7 (both included), 3.. or ..7
    #[arg(long, value_name = "RANGE", default_value = "..")]
    frames: FrameRange,
    /// Take all whole frames of a file that ends early
    #[arg(long)]
    partial: bool,
    /// Replace files that are in the folder already
    #[arg(long)]
    overwrite: bool,
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
    let target = arguments.target()?;
    let mut decoder = stream::decoder(&arguments.input)?;
    let mut sink = arguments.sink(target, &decoder)?;
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
    let (frames, files) = (counted(frames, "frame"), counted(files as u64, "file"));
    global.note(format_args!("{}: {frames} in {files}", arguments.output.display()));
    Ok(Outcome::Good)
}

impl DecodeArguments {
    /// Finds the kind of the output before any work: a folder, which may not exist yet, or a GLB
    /// file.
    fn target(&self) -> Result<Target> {
        let (output, name) = (&self.output, self.output.display());
        ensure!(
            !is_dash(output),
            "standard output: meshes are not written there; name a folder or a .glb file"
        );
        let folder = Target::Folder(self.format.unwrap_or(Format::Obj).extension());
        if output.is_dir() || ends_with_separator(output) {
            return Ok(folder);
        }
        let extension = output.extension().unwrap_or_default().to_ascii_lowercase();
        match extension.to_str() {
            Some("glb") => {
                let fits = self.format.is_none_or(|format| format == Format::Glb);
                ensure!(fits, "{name}: a .glb file has no other --format; name a folder for files");
                Ok(Target::Glb)
            }
            Some("obj" | "ply" | "off" | "gltf" | "knm") => bail!(
                "{name}: frames go to a folder, a file each, or all to one .glb file; for a folder \
                 of this name write {name}/"
            ),
            _ => Ok(folder),
        }
    }

    fn sink(&self, target: Target, decoder: &Decoder<StreamReader>) -> Result<Sink> {
        let mut outputs = Outputs::beside([self.input.as_path()]);
        match target {
            Target::Glb => {
                outputs.file("--output", &self.output)?;
                let rate = decoder.stream().header().map(|header| header.frame_rate);
                Sink::animation(&self.output, rate.unwrap_or_default().per_second())
            }
            Target::Folder(extension) => {
                let precision = decoder.stream().precision().unwrap_or_default();
                let overwrite = self.overwrite;
                Files::create(&self.output, extension, precision, outputs, overwrite)
                    .map(|files| Sink::Files(Box::new(files)))
            }
        }
    }

    /// Hands the frames that were asked for to `take`: index, name in the stream, mesh.
    fn decode(
        &self,
        decoder: &mut Decoder<StreamReader>,
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
        let asked = self.frames.first();
        match last {
            Some(last) if last >= asked => Ok(()),
            Some(last) => {
                let there = counted(last + 1, "whole frame");
                bail!("{name}: there is no frame {asked}: the file holds {there}")
            }
            None => bail!("{name}: there is no whole frame in this file"),
        }
    }
}

/// The kind of the output.
enum Target {
    /// Files of this extension.
    Folder(&'static str),
    Glb,
}

fn is_early_end(kind: &DecodeErrorKind) -> bool {
    matches!(kind, DecodeErrorKind::Truncated { .. })
}
