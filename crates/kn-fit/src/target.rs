//! The mesh that a fit aims at, prepared once per frame.

use crate::error::{FitError, Side};
use crate::source::{check_length, check_mesh};

/// A target frame.
#[derive(Debug)]
pub struct FitTarget {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    labels: Option<Vec<u8>>,
}

impl FitTarget {
    /// Prepares a cleaned scan: `positions` is `#V × 3`, `faces` `#F × 3`.
    ///
    /// # Errors
    /// A mesh without a surface, a coordinate that is not finite, a face out of range.
    pub fn new(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, FitError> {
        check_mesh(positions, faces, Side::Target)?;
        Ok(Self { positions: positions.to_vec(), faces: faces.to_vec(), labels: None })
    }

    /// Adds body-part labels (`#V`) for part-wise starts.
    ///
    /// # Errors
    /// `labels` does not have one entry per vertex.
    pub fn with_labels(mut self, labels: &[u8]) -> Result<Self, FitError> {
        check_length("labels", labels.len(), self.positions.len())?;
        self.labels = Some(labels.to_vec());
        Ok(self)
    }
}
