//! The bound on the error of P-frames: decoded frames are measured against their scans.

use super::GroupEncoder;
use crate::encode::failure::FitFailure;
use crate::encode::fault::InputFault;
use crate::encode::frame_error::Measured;
use crate::encode::motion::reference_to_grid_steps;
use crate::encode::scan::{Scan, has_area, to_grid_steps};
use kn_fit::{FitError, Side};
use kn_mesh::Mesh;
use kn_metrics::{MeshRef, TreeError};

impl GroupEncoder {
    /// Whether the decoded I-frame has an area: without one, nothing moves.
    ///
    /// # Errors
    /// No face is left on the grid.
    pub(super) fn can_move(&self) -> Result<bool, InputFault> {
        let intra = self.reconstruction.intra();
        // All vertices in one or two places: the scan is smaller than a step.
        let mut places = intra.positions.iter();
        let one = places.next();
        let two = places.find(|&place| Some(place) != one);
        if places.all(|place| Some(place) == one || Some(place) == two) {
            return Err(InputFault::NothingLeft { step: self.grid.step });
        }
        Ok(has_area(&intra.faces, |v| intra.positions[v as usize].map(f64::from)))
    }

    /// Measures the I-frame that was decoded last against its scan, for the bound of its P-frames.
    ///
    /// # Errors
    /// A mesh that cannot be searched.
    pub(super) fn measure_intra(&mut self, mesh: &Mesh) -> Result<(), InputFault> {
        let scan = to_grid_steps(&mesh.positions, self.grid);
        let decoded = self.decoded_positions();
        let faces = &self.reconstruction.intra().faces;
        let (scan, decoded) = (MeshRef::new(&scan, &mesh.faces), MeshRef::new(&decoded, faces));
        self.bound.begin(scan, decoded).map_err(fault)
    }

    /// The error of the P-frame that was decoded last, or a failure where it is beyond the bound.
    ///
    /// # Errors
    /// A mesh that cannot be searched.
    pub(super) fn judge(&self, scan: &Scan) -> Result<Result<Measured, FitFailure>, InputFault> {
        let decoded = self.decoded_positions();
        let decoded = MeshRef::new(&decoded, &self.reconstruction.intra().faces);
        self.bound.judge(scan.target.surface(), decoded).map_err(fault)
    }

    /// `#V × 3`: the frame that was decoded last, in grid steps.
    fn decoded_positions(&self) -> Vec<[f64; 3]> {
        let unit = f64::from(1_u32 << self.header.fraction_bits);
        let mut positions = Vec::new();
        reference_to_grid_steps(self.reconstruction.last_positions(), unit, &mut positions);
        positions
    }
}

fn fault(source: TreeError) -> InputFault {
    FitError::Tree { mesh: Side::Source, source }.into()
}
