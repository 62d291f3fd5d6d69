//! Draco's mesh coder as a process that does one step when told to, so that its times and ours are
//! taken by turns. Needs a C++ compiler and Draco's library (Debian: `libdraco-dev`).

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

/// The compiled program.
pub(crate) struct Draco {
    directory: tempfile::TempDir,
}

impl Draco {
    /// Compiles it; `None` where the compiler or the library is missing.
    pub(crate) fn build() -> Option<Self> {
        let directory = tempfile::tempdir().ok()?;
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/draco/clock.cpp");
        let mut compiler = Command::new("c++");
        compiler.args(["-O2", "-std=c++17", source, "-o"]);
        compiler.arg(directory.path().join("clock")).arg("-ldraco").stderr(Stdio::null());
        compiler.status().ok()?.success().then_some(Self { directory })
    }

    /// Has it read a mesh, to be coded with so many bits for the longest side of its box.
    pub(crate) fn open(&self, mesh: &Path, bits: u32) -> Option<DracoMesh> {
        let mut program = Command::new(self.directory.path().join("clock"));
        program.arg(mesh).arg(bits.to_string()).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut process = program.spawn().ok()?;
        let (steps, laps) = (process.stdin.take()?, BufReader::new(process.stdout.take()?));
        Some(DracoMesh { process, steps, laps })
    }
}

/// A mesh that Draco holds.
pub(crate) struct DracoMesh {
    process: Child,
    steps: ChildStdin,
    laps: BufReader<ChildStdout>,
}

impl DracoMesh {
    /// Does one step, `encode` or `decode`: bytes of the stream, and seconds that the thread worked.
    pub(crate) fn step(&mut self, step: &str) -> Option<(usize, f64)> {
        writeln!(self.steps, "{step}").ok()?;
        let mut lap = String::new();
        self.laps.read_line(&mut lap).ok()?;
        let (bytes, nanoseconds) = lap.trim().split_once(' ')?;
        Some((bytes.parse().ok()?, 1e-9 * nanoseconds.parse::<f64>().ok()?))
    }
}

impl Drop for DracoMesh {
    fn drop(&mut self) {
        // It may have ended by itself; either way it is gone afterwards.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
