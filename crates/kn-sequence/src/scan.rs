//! Cleaning of scans.

use kn_io::InputFrame;
use kn_mesh::{Cleaned, caught, clean};

use crate::error::{ScanFault, SequenceError};

/// Cleans a scan: welds vertices, and drops degenerate and duplicate faces. The vertex map has an
/// entry for every vertex of the file. An empty scan stays empty.
///
/// # Errors
/// The mesh is not valid, or no face is left.
pub fn clean_scan(frame: &InputFrame) -> Result<Cleaned, SequenceError> {
    let fault = |fault| SequenceError::Scan { file: frame.path.clone(), frame: frame.index, fault };
    let cleaned = caught(|| clean(&frame.mesh)).map_err(|message| SequenceError::Internal {
        file: frame.path.display().to_string(),
        frame: frame.index as u64,
        message,
    })?;
    let cleaned = cleaned.map_err(|error| fault(error.into()))?;
    if !frame.mesh.faces.is_empty() && cleaned.mesh.faces.is_empty() {
        return Err(fault(ScanFault::Degenerate));
    }
    Ok(cleaned)
}

/// Cleans a scan like [`clean_scan`], and drops the vertices that no face uses: of a scan without
/// faces an empty frame is left.
///
/// # Errors
/// The errors of [`clean_scan`].
pub fn clean_surface(frame: &InputFrame) -> Result<Cleaned, SequenceError> {
    Ok(clean_scan(frame)?.drop_isolated())
}
