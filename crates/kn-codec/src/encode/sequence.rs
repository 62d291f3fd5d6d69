//! From the settings and the first frame to the sequence header.

use crate::encode::choices::{Decimation, SmoothingChoice, StepChoice};
use crate::encode::config::{EncoderConfig, GridChoice, step_of_bits};
use crate::error::EncodeError;
use kn_bitstream::params::{FrameRate, LabelSet, name_text};
use kn_bitstream::{Level, SequenceHeader};
use kn_mesh::{Grid, Mesh};

/// The header of a sequence that begins with `first`, which is sound and has a vertex.
///
/// # Errors
/// Settings that no header can carry.
pub(crate) fn sequence_header(
    config: &EncoderConfig,
    first: &Mesh,
) -> Result<SequenceHeader, EncodeError> {
    let grid = choose_grid(&config.grid, first)?;
    let header = SequenceHeader {
        level: choose_level(config, first)?,
        frame_rate: config.frame_rate,
        up_axis: config.up_axis,
        unit_of_length: config.unit,
        fraction_bits: config.fraction_bits,
        max_group_length: config.group_length,
        nodes_per_vertex: config.nodes_per_vertex,
        weight_scheme: config.weights.scheme(),
        influence_mode: config.influence,
        labels: if first.labels.is_empty() { LabelSet::None } else { LabelSet::Body },
        grid_origin: grid.origin,
        grid_step: grid.step,
        names: config.names.clone(),
    };
    check(&header, config)?;
    Ok(header)
}

/// What the types let through and the specification does not.
fn check(header: &SequenceHeader, config: &EncoderConfig) -> Result<(), EncodeError> {
    let require = |holds: bool, what: &str| {
        if holds { Ok(()) } else { Err(EncodeError::Config(what.to_owned())) }
    };
    let FrameRate { numerator, denominator } = header.frame_rate;
    require(numerator > 0 && denominator > 0, "the frame rate is zero")?;
    require(header.fraction_bits <= 8, "more than 8 fraction bits")?;
    require(header.max_group_length > 0, "a group of frames has at least one frame")?;
    require((1..=8).contains(&header.nodes_per_vertex), "nodes per vertex are 1 to 8")?;
    require(config.nodes.most() > 0, "there must be a key node")?;
    if let SmoothingChoice::Strength(strength) = config.smoothing {
        require(strength <= kn_bitstream::MAX_SMOOTHING, "smoothing is 0 to 5")?;
    }
    let parameters = [config.rotation_step, config.scale_step, config.shear_step];
    let motion = match config.motion_step {
        StepChoice::Fixed(step) => Some(step),
        StepChoice::Cost => None,
    };
    let steps = parameters.into_iter().flatten().chain(motion);
    require(steps.into_iter().all(|step| step > 0.0), "a quantiser step is not positive")?;
    let lambda = config.lambda;
    require(lambda >= 0.0 && lambda.is_finite(), "lambda is not 0 or more")?;
    let lossless = matches!(config.grid, GridChoice::Lossless(_));
    require(!lossless || config.group_length == 1, "only groups of one frame are lossless")?;
    require(!lossless || config.decimation.is_none(), "a decimated mesh is not lossless")?;
    require(config.decimation.is_none_or(is_sound), "nothing is left of a decimated mesh")?;
    if let Some(sigma) = config.weights.sigma() {
        require((1..1 << 20).contains(&sigma), "sigma is not 1 to 2^20 − 1 grid steps")?;
    }
    if let Some(names) = &header.names {
        let text = name_text(names.prefix.as_bytes());
        require(names.prefix.len() < 256 && text.is_some(), "the name prefix cannot be coded")?;
        require(names.digits <= 9, "names have at most 9 digits")?;
    }
    Ok(())
}

fn is_sound(decimation: Decimation) -> bool {
    match decimation {
        Decimation::Faces(faces) => faces > 0,
        Decimation::Share(share) => share > 0.0 && share <= 1.0,
        Decimation::Error(error) => error > 0.0 && error.is_finite(),
    }
}

/// The lowest level, from 1 on, that holds twice the first frame: later frames may be larger.
fn choose_level(config: &EncoderConfig, first: &Mesh) -> Result<u8, EncodeError> {
    let fits = |level: &Level| {
        level.max_vertices as usize >= 2 * first.positions.len()
            && level.max_faces as usize >= 2 * first.faces.len()
            && level.max_nodes as usize >= config.nodes.most()
            && level.max_group_frames >= u32::from(config.group_length)
    };
    let level = Level::all().find(|(number, level)| *number > 0 && fits(level));
    level.map(|(number, _)| number).ok_or_else(|| {
        let (vertices, nodes) = (first.positions.len(), config.nodes.most());
        EncodeError::Config(format!("no level holds {vertices} vertices and {nodes} key nodes"))
    })
}

/// The grid that the settings ask for: its origin is the lowest corner of the box.
fn choose_grid(choice: &GridChoice, first: &Mesh) -> Result<Grid, EncodeError> {
    let bounds = match choice {
        GridChoice::Lossless(grid) => return sound(*grid),
        GridChoice::Bits { bounds, .. } | GridChoice::Step { bounds, .. } => bounds,
    };
    let bounds = match bounds.or_else(|| first.bounding_box()) {
        Some(bounds) => bounds,
        None => return Err(EncodeError::Config("the first frame has no box".into())),
    };
    let step = match *choice {
        GridChoice::Bits { bits, .. } if !(4..=20).contains(&bits) => {
            return Err(EncodeError::Config(format!("{bits} bits are not 4 to 20")));
        }
        GridChoice::Bits { bits, .. } => step_of_bits(bits, &bounds),
        GridChoice::Step { step, .. } | GridChoice::Lossless(Grid { step, .. }) => step,
    };
    sound(Grid { origin: bounds.min, step })
}

/// A grid that positions can be put on.
fn sound(grid: Grid) -> Result<Grid, EncodeError> {
    if grid.step.is_finite() && grid.step > 0.0 && grid.origin.iter().all(|c| c.is_finite()) {
        return Ok(grid);
    }
    Err(EncodeError::Config(format!("the grid step {} is not positive", grid.step)))
}
