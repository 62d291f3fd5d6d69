//! The real binary, scans to feed it, and what it must not leave behind.

#![allow(dead_code, reason = "every test binary uses a part of this")]

use kn_io::write_mesh;
use kn_mesh::Mesh;
use kn_performer::{Performer, PerformerConfig};
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Frames of [`Scans::new`].
pub(crate) const FRAMES: usize = 5;

/// The binary with its arguments.
pub(crate) fn command<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kn"));
    command.args(arguments);
    command
}

/// Runs the binary.
pub(crate) fn kn<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Output {
    command(arguments).output().expect("the binary starts")
}

/// Runs the binary, which must succeed; its standard output.
#[track_caller]
pub(crate) fn succeeds<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> String {
    let output = kn(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// Runs the binary, which must end with exit code 2; its one line of error.
#[track_caller]
pub(crate) fn fails<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> String {
    let output = kn(arguments);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    let line = message.strip_prefix("kn: error: ").unwrap_or_else(|| panic!("{message}"));
    assert_eq!(line.trim_end().lines().count(), 1, "{message}");
    line.trim_end().to_owned()
}

pub(crate) fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// File names in a folder, sorted; hidden ones too.
pub(crate) fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> = entries
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// A folder of scans `scan/f_08.obj` to `scan/f_12.obj`, labels beside them, and room for output.
pub(crate) struct Scans {
    folder: TempDir,
}

impl Scans {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::create_dir(folder.path().join("scan")).expect("made");
        let scans = Self { folder };
        for (index, mesh) in performer().iter().enumerate() {
            write_mesh(&scans.file(index), mesh).expect("written");
            let lines: String = mesh.labels.iter().map(|label| format!("{label}\n")).collect();
            fs::write(scans.file(index).with_extension("labels"), lines).expect("written");
        }
        scans
    }

    /// Scan number `index`.
    pub(crate) fn file(&self, index: usize) -> PathBuf {
        self.path(&format!("scan/f_{:02}.obj", index + 8))
    }

    /// A path in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A path in the folder as text.
    pub(crate) fn text(&self, name: &str) -> String {
        self.path(name).to_string_lossy().into_owned()
    }

    /// Arguments that encode `input` into `a.knm` with few nodes and short GoFs.
    pub(crate) fn encode(&self, input: &str, more: &[&str]) -> Vec<String> {
        let mut arguments =
            vec!["encode".into(), self.text(input), "-o".into(), self.text("a.knm")];
        arguments.extend(["--nodes", "24", "--gof", "3"].map(String::from));
        arguments.extend(more.iter().map(|&argument| argument.into()));
        arguments
    }

    /// Encodes the scans into `a.knm`.
    #[track_caller]
    pub(crate) fn encoded(&self) -> PathBuf {
        succeeds(self.encode("scan/*.obj", &[]));
        self.path("a.knm")
    }

    /// Asserts that only the scans are there.
    #[track_caller]
    /// Runs a command on sixty frames and interrupts it once it has begun to write.
    pub(crate) fn interrupt(&self, arguments: impl IntoIterator<Item = String>) {
        // Enough work that the interrupt comes in the middle: the frames again and again.
        for index in FRAMES..60 {
            let copy = self.path(&format!("scan/f_{:02}.obj", index + 8));
            fs::copy(self.file(index % FRAMES), copy).expect("copied");
        }
        let mut child = command(arguments).stderr(Stdio::null()).spawn().expect("starts");
        let has_begun = || {
            let folders = names_in(self.folder.path()).into_iter().map(|name| self.path(&name));
            let inside = folders.filter(|path| path.is_dir()).flat_map(|path| names_in(&path));
            names_in(self.folder.path()).into_iter().chain(inside).any(|n| n.ends_with(".part"))
        };
        let deadline = Instant::now() + Duration::from_secs(60);
        while !has_begun() && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(has_begun(), "work has begun");
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(kill.expect("kill runs").success());
        assert_eq!(child.wait().expect("ends").code(), Some(130));
    }

    pub(crate) fn assert_untouched(&self) {
        assert_eq!(names_in(self.folder.path()), ["scan"]);
        let hidden = names_in(&self.path("scan")).into_iter().any(|name| name.starts_with('.'));
        assert!(!hidden, "something was left beside the scans");
    }
}

/// The frames that every test starts from, made once.
fn performer() -> &'static [Mesh] {
    static FRAMES_ONCE: OnceLock<Vec<Mesh>> = OnceLock::new();
    FRAMES_ONCE.get_or_init(|| {
        let config = PerformerConfig { vertices: 1_200, ..PerformerConfig::default() };
        let performer = Performer::new(config).expect("valid settings");
        (0..FRAMES as u32).map(|index| performer.frame(index)).collect()
    })
}
