//! Runs `kn encode` on odd and broken mesh files of every format, one process each, and checks how
//! it ends: `cargo run --release -p kn-lab -- mutations target/release/kn 10000`.
//!
//! Each run has to end with exit code 0 and a stream that `kn verify` accepts, or with exit code 2,
//! an error and no stream: no panic, no signal, at most [`MOST_KILOBYTES`] of memory (address space,
//! one thread), at most [`MOST_SECONDS`]. `kn compare`, `kn register` and `kn segment` get the meshes that
//! were coded, within the same bounds.

use anyhow::{Context, Result, bail, ensure};
use kn_testdata::mutation::{FORMATS, files};
use rayon::prelude::*;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// The files are small: this is what the program itself needs, several times over.
const MOST_KILOBYTES: u32 = 1 << 20;
const MOST_SECONDS: u64 = 30;

pub(crate) fn run(arguments: &[String]) -> Result<()> {
    let (program, numbers) = arguments.split_first().context("the path of kn is missing")?;
    let program = Path::new(program).canonicalize().context("the path of kn")?;
    let number = |at: usize, default: u64| numbers.get(at).map_or(Ok(default), |text| text.parse());
    let (count, first) = (number(0, 100)?, number(1, 0)?);
    let mut failed = 0;
    for format in FORMATS {
        let ends: Vec<Result<End>> = (first..first + count)
            .into_par_iter()
            .map(|seed| try_one(&program, format, seed))
            .collect();
        let coded = ends.iter().filter(|end| matches!(end, Ok(End::Coded))).count();
        let refused = ends.iter().filter(|end| matches!(end, Ok(End::Refused))).count();
        println!("{format:4}  {coded} coded, {refused} refused");
        for (seed, fault) in
            (first..).zip(&ends).filter_map(|(seed, end)| Some((seed, end.as_ref().err()?)))
        {
            failed += 1;
            println!("{format:4}  mutation {seed}: {fault:#}");
        }
    }
    ensure!(failed == 0, "{failed} mutations failed");
    Ok(())
}

/// A proper end.
enum End {
    Coded,
    Refused,
}

fn try_one(program: &Path, format: &str, seed: u64) -> Result<End> {
    let folder = tempfile::tempdir()?;
    let files = files(format, seed);
    for (name, bytes) in &files {
        std::fs::write(folder.path().join(name), bytes)?;
    }
    let kn = |arguments: &[&str]| limited(program, folder.path(), arguments);
    let done = kn(&["encode", &files[0].0, "-o", "x.knm", "--threads", "1"])?;
    let said = String::from_utf8_lossy(&done.stderr);
    let last = said.lines().last().unwrap_or_default();
    ensure!(!said.contains("panicked at"), "{}", said.trim());
    let written = folder.path().join("x.knm").exists();
    match done.status.code() {
        Some(0) => {
            let verified = kn(&["verify", "x.knm", "--threads", "1"])?;
            ensure!(verified.status.success(), "the stream does not verify");
            use_elsewhere(kn, &files[0].0)?;
            Ok(End::Coded)
        }
        Some(2) => {
            ensure!(said.contains("error"), "exit code 2 without an error");
            ensure!(!written, "refused, but a stream is left: {last}");
            Ok(End::Refused)
        }
        _ => bail!("{}: {last}", done.status),
    }
}

/// Gives a mesh that was coded to the other commands that read meshes. They end with 0, 1 (a difference)
/// or 2.
fn use_elsewhere(kn: impl Fn(&[&str]) -> Result<Output>, mesh: &str) -> Result<()> {
    let commands: [&[&str]; 3] = [
        &["compare", mesh, "x.knm", "--threads", "1"],
        &["register", mesh, mesh, "-o", "y.obj", "--threads", "1"],
        &["segment", mesh, "-o", "labels", "--threads", "1"],
    ];
    for command in commands {
        let done = kn(command).with_context(|| format!("kn {}", command[0]))?;
        let said = String::from_utf8_lossy(&done.stderr);
        let ended = matches!(done.status.code(), Some(0..=2)) && !said.contains("panicked at");
        ensure!(ended, "kn {}: {}: {}", command[0], done.status, said.trim());
    }
    Ok(())
}

/// Runs a command in a folder, with an end to its memory and its time.
fn limited(program: &Path, folder: &Path, arguments: &[&str]) -> Result<Output> {
    let script = format!("ulimit -v {MOST_KILOBYTES}; exec \"$0\" \"$@\"");
    let mut child = Command::new("sh")
        .args(["-c", &script])
        .arg(program)
        .args(arguments)
        .current_dir(folder)
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()?;
    let start = Instant::now();
    // What it prints fits the pipes, so that it ends without being read.
    while child.try_wait()?.is_none() {
        if start.elapsed() > Duration::from_secs(MOST_SECONDS) {
            child.kill()?;
            child.wait()?;
            bail!("no end after {MOST_SECONDS} s");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Ok(child.wait_with_output()?)
}
