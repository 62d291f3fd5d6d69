//! `kn decode`: a .knm file in, meshes out.

use crate::arguments::{FrameRange, Global};
use crate::output::OutputFolder;
use crate::stream::{self, Source};
use crate::{Outcome, progress};
use anyhow::{Context, Result, ensure};
use clap::ValueEnum;
use kn_codec::{DecodeErrorKind, Decoder};
use kn_mesh::Mesh;
use kn_mesh::io::write_mesh;
use std::collections::HashSet;
use std::path::PathBuf;

/// Decode a .knm file into meshes, one file a frame
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Files are called like the encoder's input where the stream knows those names, else frame_0000 and
so on. The files appear together at the end: after an error none is there.

Examples:
  kn decode dance.knm -o out/
  kn decode dance.knm -o out/ --format ply --frames 3..7
  kn decode half.knm -o out/ --partial
  curl -s https://example.org/dance.knm | kn decode - -o out/")]
pub(crate) struct DecodeArguments {
    /// The stream; - is standard input
    #[arg(value_name = "FILE")]
    input: PathBuf,
    /// The folder for the meshes; made where it does not exist
    #[arg(short, long, value_name = "FOLDER")]
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
    Obj,
    Ply,
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
    let mut folder = OutputFolder::create(&arguments.output)?;
    arguments.decode(&mut decoder, &mut folder, global)?;
    let files = folder.publish()?;
    global.note(format_args!("{}: {files} files written", arguments.output.display()));
    Ok(Outcome::Good)
}

impl DecodeArguments {
    /// Writes the frames that were asked for.
    fn decode(
        &self,
        decoder: &mut Decoder<Source>,
        folder: &mut OutputFolder,
        global: &Global,
    ) -> Result<()> {
        let name = stream::name_of(&self.input);
        // A file that ends early has no index to seek by.
        if self.frames.first() > 0 && !self.partial {
            decoder.seek(self.frames.first()).with_context(|| name.clone())?;
        }
        let bar = progress::bar(global, "decoding", None);
        let mut names = FileNames::new(self.format);
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
                let file = names.name(decoder.stream().frame_name(), info.index);
                write_mesh(&folder.place(&file), &mesh)
                    .with_context(|| format!("{}: frame {}", self.output.display(), info.index))?;
                bar.step();
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

/// Gives every frame a file name of its own.
struct FileNames {
    format: Format,
    taken: HashSet<String>,
}

impl FileNames {
    fn new(format: Format) -> Self {
        Self { format, taken: HashSet::new() }
    }

    /// The name in the stream, where it has one that no other frame has; else by the index.
    fn name(&mut self, in_stream: Option<String>, index: u64) -> String {
        let plain = format!("frame_{index:04}");
        let usable = in_stream.filter(|name| !name.is_empty() && !self.taken.contains(name));
        let name = usable.unwrap_or(plain);
        let file = format!("{name}.{}", self.format.extension());
        self.taken.insert(name);
        file
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_one_name_do_not_overwrite_each_other() {
        let mut names = FileNames::new(Format::Ply);
        assert_eq!(names.name(Some("walk_7".into()), 0), "walk_7.ply");
        assert_eq!(names.name(Some("walk_7".into()), 1), "frame_0001.ply");
        assert_eq!(names.name(Some(String::new()), 2), "frame_0002.ply");
        assert_eq!(names.name(None, 3), "frame_0003.ply");
    }
}
