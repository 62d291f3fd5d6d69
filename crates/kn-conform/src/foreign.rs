//! Runs any decoder by its command line, under the contract of 9.7.

use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use crate::corpus::Outcome;

/// Largest output of a decoder that is read: more than any stream of the corpus needs.
const MAX_OUTPUT: u64 = 16 << 20;

/// Time between two looks at a running decoder.
const PATIENCE: Duration = Duration::from_millis(5);

/// Runs a foreign decoder: `command`, split at spaces, and the file. A decoder that takes longer
/// than `limit` is killed.
pub fn run_foreign(command: &str, path: &Path, limit: Duration) -> Outcome {
    let mut words = command.split_whitespace();
    let Some(program) = words.next() else { return Outcome::NotRun("no command".into()) };
    let child = Command::new(program)
        .args(words)
        .arg(path)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let mut child = match child {
        Ok(child) => child,
        Err(error) => return Outcome::NotRun(format!("{program}: {error}")),
    };
    let (out, err) = (collect(child.stdout.take()), collect(child.stderr.take()));
    match wait(&mut child, limit) {
        Err(error) => Outcome::NotRun(format!("{program}: {error}")),
        Ok(None) => Outcome::NotRun(format!("no answer in {} s", limit.as_secs_f64())),
        Ok(Some(status)) => {
            let text = |stream: mpsc::Receiver<String>| stream.recv().unwrap_or_default();
            match status.code() {
                Some(0) => {
                    Outcome::Frames(text(out).lines().map(|line| line.trim().to_owned()).collect())
                }
                Some(_) => Outcome::Refused { rule: None, message: text(err).trim().to_owned() },
                // A decoder that dies has not judged the stream.
                None => Outcome::NotRun(format!("{program} was ended by a signal ({status})")),
            }
        }
    }
}

/// Reads on a thread of its own, so that a decoder never waits for us.
fn collect(stream: Option<impl Read + Send + 'static>) -> mpsc::Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(stream) = stream {
            // What was read before an error is judged like any output.
            let _ = stream.take(MAX_OUTPUT).read_to_end(&mut bytes);
        }
        let _ = sender.send(String::from_utf8_lossy(&bytes).into_owned());
    });
    receiver
}

/// `None` where the time ran out.
fn wait(child: &mut Child, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() > limit {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        thread::sleep(PATIENCE);
    }
}
