//! Registration of one mesh to another by the fit, without a codec.

use crate::constants::sampling::GRID;
use crate::error::{FitError, Side};
use crate::fitter::Fitter;
use crate::options::FitOptions;
use crate::place::place_farthest;
use crate::report::FitReport;
use crate::source::{FitSource, check_mesh};
use crate::target::FitTarget;
use kn_bitstream::params::{InfluenceMode, Weights};
use kn_deform::{BindOptions, Influence, NodeTransform, bind};

/// Options of a registration.
#[derive(Clone, Copy, Debug)]
pub struct RegisterOptions {
    /// Number of key nodes.
    pub nodes: usize,
    /// Options of the fit.
    pub fit: FitOptions,
}

impl Default for RegisterOptions {
    fn default() -> Self {
        Self { nodes: 200, fit: FitOptions::default() }
    }
}

/// The result of a registration.
#[derive(Clone, Debug)]
pub struct Registration {
    /// `#V × 3` deformed source positions, in the source's order.
    pub positions: Vec<[f64; 3]>,
    /// `#N × 3` key nodes on the source.
    pub nodes: Vec<[f64; 3]>,
    /// `#N` transforms.
    pub transforms: Vec<NodeTransform>,
    /// Report of the fit.
    pub report: FitReport,
}

/// Deforms `source` onto `target` with rigid key nodes that are placed by farthest points.
///
/// # Errors
/// A mesh has no surface or is not valid, see [`FitError`].
pub fn register(
    source_positions: &[[f64; 3]],
    source_faces: &[[u32; 3]],
    target_positions: &[[f64; 3]],
    target_faces: &[[u32; 3]],
    options: &RegisterOptions,
) -> Result<Registration, FitError> {
    check_mesh(source_positions, source_faces, Side::Source)?;
    let (target, placed) = rayon::join(
        || FitTarget::new(target_positions, target_faces),
        || {
            let chosen = place_farthest(source_positions, source_faces, None, None, options.nodes)?;
            let place = |&v: &u32| source_positions[v as usize];
            let nodes: Vec<[f64; 3]> = chosen.iter().map(place).collect();
            influence(source_positions, &nodes).map(|influence| (nodes, influence))
        },
    );
    let ((nodes, influence), target) = (placed?, target?);
    let affine = vec![false; nodes.len()];
    let source = FitSource {
        positions: source_positions,
        faces: source_faces,
        influence: &influence,
        nodes: &nodes,
        affine: &affine,
        labels: None,
    };
    let mut fitter = Fitter::new(&source)?;
    let fit = fitter.fit_frame(&source, &target, &options.fit)?;
    let positions = fitter.deformed().to_vec();
    Ok(Registration { positions, nodes, transforms: fit.transforms, report: fit.report })
}

/// Q = 4 and weights 1/d², bound on a grid as the codec does.
fn influence(positions: &[[f64; 3]], nodes: &[[f64; 3]]) -> Result<Influence, FitError> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for position in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    let side = (0..3).map(|axis| high[axis] - low[axis]).fold(f64::MIN_POSITIVE, f64::max);
    let on_grid = |p: &[f64; 3]| -> [i32; 3] {
        std::array::from_fn(|axis| ((p[axis] - low[axis]) / side * GRID).round() as i32)
    };
    let positions: Vec<[i32; 3]> = positions.iter().map(on_grid).collect();
    let nodes: Vec<[i32; 3]> = nodes.iter().map(on_grid).collect();
    let one_region = (vec![0; positions.len()], vec![0; nodes.len()]);
    let options = BindOptions {
        nodes_per_vertex: 4,
        weights: Weights::INVERSE_SQUARE,
        mode: InfluenceMode::Fallback,
    };
    let mut influence = Influence::default();
    bind(&positions, &one_region.0, &nodes, &one_region.1, &options, &mut influence)?;
    Ok(influence)
}
