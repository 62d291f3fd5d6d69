//! The mesh that a fit deforms.

use crate::error::{FitError, Side};
use kn_deform::Influence;

/// The most key nodes that a fit takes.
pub const MAX_NODES: usize = 4096;

/// A reference mesh with its key nodes. Faces, influence and `affine` stay the same through a
/// GoF; positions and nodes move.
#[derive(Clone, Copy, Debug)]
pub struct FitSource<'a> {
    /// `#V × 3`, any unit (the codec: grid steps).
    pub positions: &'a [[f64; 3]],
    /// `#F × 3` indices into `positions`.
    pub faces: &'a [[u32; 3]],
    /// Ranks and weights, `#V × Q`, as bound on the GoF's I-frame.
    pub influence: &'a Influence,
    /// `#N × 3` node positions in this frame.
    pub nodes: &'a [[f64; 3]],
    /// `#N`, whether a node is affine.
    pub affine: &'a [bool],
    /// `#V` body-part labels for part-wise starts.
    pub labels: Option<&'a [u8]>,
}

impl FitSource<'_> {
    /// Whether all arrays fit together.
    pub(crate) fn check(&self) -> Result<(), FitError> {
        check_mesh(self.positions, self.faces, Side::Source)?;
        let vertices = self.positions.len();
        let nodes = self.nodes.len();
        let entries = vertices * self.influence.nodes_per_vertex;
        check_length("influence.nodes", self.influence.nodes.len(), entries)?;
        check_length("influence.weights", self.influence.weights.len(), entries)?;
        check_length("affine", self.affine.len(), nodes)?;
        if let Some(labels) = self.labels {
            check_length("labels", labels.len(), vertices)?;
        }
        if nodes > MAX_NODES {
            return Err(FitError::TooManyNodes { nodes });
        }
        let outside = self.influence.nodes.iter().position(|&node| usize::from(node) >= nodes);
        match outside {
            Some(entry) => {
                Err(FitError::BadInfluence { vertex: entry / self.influence.nodes_per_vertex })
            }
            None if entries == 0 => Err(FitError::BadInfluence { vertex: 0 }),
            None => Ok(()),
        }
    }
}

pub(crate) fn check_length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), FitError> {
    if found == expected { Ok(()) } else { Err(FitError::Length { what, found, expected }) }
}

/// Finite positions, faces in range, and at least one of each.
pub(crate) fn check_mesh(
    positions: &[[f64; 3]],
    faces: &[[u32; 3]],
    mesh: Side,
) -> Result<(), FitError> {
    if positions.is_empty() || faces.is_empty() {
        return Err(FitError::NoSurface { mesh });
    }
    let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
    if let Some(vertex) = positions.iter().position(|p| !finite(p)) {
        return Err(FitError::NotFinite { mesh, vertex });
    }
    let outside = |face: &[u32; 3]| face.iter().any(|&v| v as usize >= positions.len());
    match faces.iter().position(outside) {
        Some(face) => Err(FitError::BadFace { mesh, face }),
        None => Ok(()),
    }
}
