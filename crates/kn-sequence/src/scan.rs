//! Scans as they are coded: cleaned.

use kn_io::InputFrame;
use kn_mesh::{Cleaned, clean};

use crate::error::{ScanFault, SequenceError};

/// Welds a scan and drops degenerate and duplicate faces; every vertex of the file keeps a place in the
/// vertex map.
///
/// # Errors
/// A mesh that is not valid, or of which no face is left.
pub fn clean_scan(frame: &InputFrame) -> Result<Cleaned, SequenceError> {
    let fault = |fault| SequenceError::Scan { file: frame.path.clone(), frame: frame.index, fault };
    let cleaned = clean(&frame.mesh).map_err(|error| fault(error.into()))?;
    if !frame.mesh.faces.is_empty() && cleaned.mesh.faces.is_empty() {
        return Err(fault(ScanFault::Degenerate));
    }
    Ok(cleaned)
}

/// The same without the vertices that no face uses.
///
/// # Errors
/// As for [`clean_scan`].
pub fn clean_surface(frame: &InputFrame) -> Result<Cleaned, SequenceError> {
    Ok(clean_scan(frame)?.drop_isolated())
}
