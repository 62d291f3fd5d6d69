//! Makes the sequence header from the settings and the first frame.

use crate::encode::config::{EncoderConfig, GridChoice, step_of_bits};
use crate::encode::fault::InputFault;
use kn_bitstream::params::LabelSet;
use kn_bitstream::{Level, SequenceHeader};
use kn_mesh::{BoundingBox, Grid, Mesh};

/// Makes the header of a sequence; `first` is its first frame with faces, or its first frame.
///
/// # Errors
/// The first frame is too large for every level, or has no grid, as a sentence.
pub(crate) fn sequence_header(
    config: &EncoderConfig,
    first: &Mesh,
) -> Result<SequenceHeader, InputFault> {
    let grid = choose_grid(&config.sequence.grid, first)?;
    Ok(SequenceHeader {
        level: choose_level(config, first)?,
        frame_rate: config.sequence.frame_rate,
        up_axis: config.sequence.up_axis,
        unit_of_length: config.sequence.unit,
        fraction_bits: match config.sequence.grid {
            // Decoded vertices are grid points, so that their decimals are those of the scan.
            GridChoice::Lossless(_) => 0,
            GridChoice::Bits { .. } | GridChoice::Step { .. } => config.sequence.fraction_bits,
        },
        max_group_length: config.sequence.group_length,
        nodes_per_vertex: config.motion.nodes_per_vertex,
        weight_scheme: config.motion.weights.scheme(),
        influence_mode: config.motion.influence,
        labels: if first.labels.is_empty() { LabelSet::None } else { LabelSet::Body },
        grid_origin: grid.origin,
        grid_step: grid.step,
        names: config.sequence.names.clone(),
    })
}

/// The lowest level, from 1 on, that holds twice the first frame: later frames may be larger.
fn choose_level(config: &EncoderConfig, first: &Mesh) -> Result<u8, InputFault> {
    let fits = |level: &Level| {
        level.max_vertices as usize >= 2 * first.positions.len()
            && level.max_faces as usize >= 2 * first.faces.len()
            && level.max_nodes as usize >= config.motion.nodes.most()
            && level.max_group_frames >= u32::from(config.sequence.group_length)
    };
    let level = Level::all().find(|(number, level)| *number > 0 && fits(level));
    level.map(|(number, _)| number).ok_or_else(|| {
        let (vertices, faces) = (first.positions.len(), first.faces.len());
        InputFault::Level { vertices, faces }
    })
}

/// The grid that the settings ask for: its origin is the lowest corner of the box.
fn choose_grid(choice: &GridChoice, first: &Mesh) -> Result<Grid, InputFault> {
    let bounds = |bounds: Option<BoundingBox>| {
        let bounds = bounds.or_else(|| first.bounding_box());
        bounds.ok_or(InputFault::NoBox)
    };
    match *choice {
        GridChoice::Lossless(grid) => Ok(grid),
        GridChoice::Bits { bits, bounds: given } => {
            let bounds = bounds(given)?;
            Ok(Grid { origin: bounds.min, step: step_of_bits(bits, &bounds) })
        }
        GridChoice::Step { step, bounds: given } => Ok(Grid { origin: bounds(given)?.min, step }),
    }
}
