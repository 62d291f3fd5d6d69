//! Motion of P-frames: fit, then quantise.

use crate::decode::Reconstruction;
use crate::encode::config::EncoderConfig;
use crate::encode::quantise::{Steps, quantise_parameters};
use crate::encode::translation::code_translations;
use crate::error::EncodeError;
use kn_bitstream::{MotionFrame, SequenceHeader};
use kn_deform::NodeTransform;
use kn_fit::{Fit, FitOptions, FitSource, FitTarget, Fitter};
use kn_mesh::{Grid, Mesh};

/// Fits and quantises the P-frames of a group; buffers are reused.
pub(crate) struct MotionEncoder {
    config: EncoderConfig,
    /// Reference units in a grid step.
    unit: f64,
    fitter: Option<Fitter>,
    /// `#V × 3`, the reference in grid steps.
    reference: Vec<[f64; 3]>,
    /// `#N × 3`, the nodes in grid steps.
    nodes: Vec<[f64; 3]>,
    /// `#N`, fitted transforms in reference units.
    transforms: Vec<NodeTransform>,
    motion: MotionFrame,
}

impl MotionEncoder {
    pub(crate) fn new(config: &EncoderConfig, header: &SequenceHeader) -> Self {
        let unit = f64::from(1_u32 << header.fraction_bits);
        Self {
            config: config.clone(),
            unit,
            fitter: None,
            reference: Vec::new(),
            nodes: Vec::new(),
            transforms: Vec::new(),
            motion: MotionFrame::default(),
        }
    }

    /// Begins a group of frames.
    pub(crate) fn begin(&mut self) {
        self.fitter = None;
    }

    /// Fits the last decoded frame to `target`; transforms are in grid steps.
    ///
    /// # Errors
    /// What the fit says.
    pub(crate) fn fit(
        &mut self,
        decoded: &Reconstruction,
        target: &FitTarget,
    ) -> Result<Fit, String> {
        to_grid_steps(decoded.reference(), self.unit, &mut self.reference);
        to_grid_steps(&decoded.nodes().positions, self.unit, &mut self.nodes);
        let intra = decoded.intra();
        let source = FitSource {
            positions: &self.reference,
            faces: &intra.faces,
            influence: decoded.influence(),
            nodes: &self.nodes,
            affine: &decoded.nodes().affine,
            labels: (!intra.labels.is_empty()).then_some(&intra.labels[..]),
        };
        let fitter = match &mut self.fitter {
            Some(fitter) => fitter,
            none => none.insert(Fitter::new(&source).map_err(|error| error.to_string())?),
        };
        let options = FitOptions {
            combination: self.config.combination,
            part_start: self.config.part_start,
            ..FitOptions::default()
        };
        fitter.fit_frame(&source, target, &options).map_err(|error| error.to_string())
    }

    /// The frame's syntax structure.
    pub(crate) fn quantise(&mut self, decoded: &Reconstruction, fit: &Fit) -> &mut MotionFrame {
        self.transforms.clear();
        self.transforms.extend(fit.transforms.iter().map(|transform| NodeTransform {
            translation: transform.translation.map(|t| t * self.unit),
            ..*transform
        }));
        let steps = Steps::new(&self.config, self.unit, reach(decoded));
        let affine = &decoded.nodes().affine;
        let (transforms, motion) = (&self.transforms, &mut self.motion);
        code_translations(
            transforms,
            decoded.translations(),
            self.config.translation,
            steps.translation,
            motion,
        );
        quantise_parameters(transforms, affine, self.config.combination, steps, motion);
        &mut self.motion
    }
}

/// A scan in grid steps, ready to be fitted to.
///
/// # Errors
/// A mesh that no fit can use.
pub(crate) fn fit_target(mesh: &Mesh, grid: Grid, frame: u64) -> Result<FitTarget, EncodeError> {
    let input = |error: kn_fit::FitError| EncodeError::Input { frame, reason: error.to_string() };
    let to_grid = |p: &[f32; 3]| -> [f64; 3] {
        std::array::from_fn(|axis| (f64::from(p[axis]) - grid.origin[axis]) / grid.step)
    };
    let positions: Vec<[f64; 3]> = mesh.positions.iter().map(to_grid).collect();
    let target = FitTarget::new(&positions, &mesh.faces).map_err(input)?;
    if mesh.labels.is_empty() {
        Ok(target)
    } else {
        target.with_labels(&mesh.labels).map_err(input)
    }
}

fn to_grid_steps(reference: &[[i32; 3]], unit: f64, positions: &mut Vec<[f64; 3]>) {
    positions.clear();
    positions.extend(reference.iter().map(|p| p.map(|c| f64::from(c) / unit)));
}

/// How far from its node a vertex is moved by it, in reference units: the weighted mean distance
/// over every sixteenth vertex and its nodes.
fn reach(decoded: &Reconstruction) -> f64 {
    let influence = decoded.influence();
    let nodes = &decoded.nodes().positions;
    let q = influence.nodes_per_vertex;
    let (mut sum, mut total) = (0.0, 0.0);
    for (vertex, position) in decoded.reference().iter().enumerate().step_by(16) {
        for slot in vertex * q..(vertex + 1) * q {
            let node = nodes[usize::from(influence.nodes[slot])];
            let squared: f64 =
                (0..3).map(|k| f64::from(position[k] - node[k])).map(|d| d * d).sum();
            sum += influence.weights[slot] * squared.sqrt();
            total += influence.weights[slot];
        }
    }
    if total > 0.0 { sum / total } else { 1.0 }
}
