//! Scans as they are coded: cleaned, each fault with its file and frame.

use anyhow::{Result, anyhow, ensure};
use kn_io::InputFrame;
use kn_mesh::{Cleaned, clean};

/// Welded and freed of degenerate and duplicate faces; every vertex of the file has its place.
///
/// # Errors
/// A mesh that is broken, or of which nothing is left.
pub(crate) fn cleaned(frame: &InputFrame) -> Result<Cleaned> {
    let cleaned = clean(&frame.mesh).map_err(|fault| anyhow!("{}: {fault}", named(frame)))?;
    ensure!(
        frame.mesh.faces.is_empty() || !cleaned.mesh.faces.is_empty(),
        "{}: all faces are degenerate: none has three corners at different places",
        named(frame)
    );
    Ok(cleaned)
}

/// Likewise, without the vertices that no face uses.
///
/// # Errors
/// As for [`cleaned`].
pub(crate) fn surface(frame: &InputFrame) -> Result<Cleaned> {
    Ok(cleaned(frame)?.drop_isolated())
}

fn named(frame: &InputFrame) -> String {
    format!("{}: frame {}", frame.path.display(), frame.index)
}
