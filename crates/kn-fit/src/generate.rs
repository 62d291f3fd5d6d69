//! The key-node generator: it puts nodes where the motion needs them (bi-modal paper, section on
//! the bi-modal key node generator).
//!
//! A dense set is fitted to the key frame once; then nodes are removed and inserted between
//! continued fits, so that refinement happens inside the deformation loop.

mod trial;

use crate::constants::generator::{
    DENSITY, FEW, MAX_ROUNDS, MOVED_SHARE, MOVING_ROUNDS, REMOVED_SHARE,
};
use crate::error::FitError;
use crate::options::FitOptions;
use crate::report::FitReport;
use crate::source::check_length;
use crate::target::FitTarget;
use kn_deform::Influence;
use trial::{Setting, Trial};

/// The reference mesh that nodes are chosen on.
pub struct NodeSource<'a> {
    /// `#V × 3`, in the unit of the target.
    pub positions: &'a [[f64; 3]],
    /// `#F × 3` indices into `positions`.
    pub faces: &'a [[u32; 3]],
    /// `#V` regions of influence, where there are any: each keeps a node.
    pub regions: Option<&'a [u8]>,
    /// `#V`, whether a node at this vertex is affine.
    pub affine: &'a [bool],
    /// Binds every vertex to nodes at the given vertices, as the decoder will.
    pub bind: &'a dyn Fn(&[u32]) -> Result<Influence, FitError>,
}

/// The number of nodes that the generator chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NodeCount {
    /// This number, as far as the mesh has vertices.
    Exactly(usize),
    /// The number of nodes that pay for their bytes, at least one for every region.
    Paying {
        /// The number that the search begins with: those that do not pay go. At least one for every
        /// region, at most `most`.
        dense: usize,
        /// The largest number, regions or not.
        most: usize,
        /// The share by which the mean squared distance to the key frame must rise when a node is
        /// removed and its neighbours do not change. A node below it does not pay.
        price: f64,
    },
}

/// The measure that says where a node is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RankBy {
    /// The squared distance between the surfaces, both ways, averaged over the neighbourhood.
    #[default]
    Distance,
    /// MSDM2 of each vertex, as in the paper.
    Msdm2,
}

/// Options of the generator.
#[derive(Clone, Copy)]
pub struct GenerateOptions<'a> {
    /// The number of nodes.
    pub count: NodeCount,
    /// Measure of the places where nodes are inserted.
    pub rank_by: RankBy,
    /// Options of the fit to the key frame.
    pub fit: FitOptions,
    /// Judges whether the motion of a fit explains the key frame.
    pub explains: &'a dyn Fn(&FitReport) -> bool,
}

/// Chooses nodes (`#N` vertex indices, rising) such that their motion explains `key`, a frame of
/// the GoF with much motion. `None` where even the dense set cannot track it.
///
/// # Errors
/// The errors of [`place_farthest`], of [`Fitter::new`] and of `bind`.
///
/// [`place_farthest`]: crate::place_farthest
/// [`Fitter::new`]: crate::Fitter::new
pub fn generate_nodes(
    source: &NodeSource,
    key: &FitTarget,
    options: &GenerateOptions,
) -> Result<Option<Vec<u32>>, FitError> {
    check_length("affine", source.affine.len(), source.positions.len())?;
    let setting = Setting::new(source, key, options);
    let setting = match options.rank_by {
        RankBy::Distance => setting,
        RankBy::Msdm2 => setting.with_msdm2()?,
    };
    let count = match options.count {
        NodeCount::Exactly(count) => count,
        NodeCount::Paying { dense, most, price } => match paying(&setting, [dense, most], price)? {
            Some(count) => count,
            None => return Ok(None),
        },
    };
    let mut trial = Trial::dense(&setting, (DENSITY * count as f64).ceil() as usize)?;
    if trial.failed {
        return Ok(None);
    }
    let mut moving_rounds = 0;
    for _ in 0..MAX_ROUNDS {
        let surplus = trial.nodes.len().saturating_sub(count);
        let (removed, inserted) = if surplus > 0 {
            (trial.removable(surplus.min(trial.share(REMOVED_SHARE))), Vec::new())
        } else if moving_rounds < MOVING_ROUNDS {
            moving_rounds += 1;
            let removed = trial.removable(trial.share(MOVED_SHARE));
            let inserted = trial.insertable(count + removed.len() - trial.nodes.len())?;
            (removed, inserted)
        } else {
            break;
        };
        if removed.is_empty() && inserted.is_empty() {
            break;
        }
        trial = trial.changed(&removed, &inserted)?;
    }
    let mut nodes = trial.nodes;
    nodes.sort_unstable();
    Ok(Some(nodes))
}

/// Finds the number of nodes that pay: nodes that do not pay are removed from a dense set, until
/// all that are left pay. Returns `None` where the key frame cannot be tracked.
fn paying(
    setting: &Setting,
    [dense, most]: [usize; 2],
    price: f64,
) -> Result<Option<usize>, FitError> {
    // A region without a node would follow those of another.
    let least = setting.regions().min(most);
    let mut trial = Trial::dense(setting, dense.clamp(least, most))?;
    if trial.failed {
        return Ok(None);
    }
    for _ in 0..MAX_ROUNDS {
        let surplus = trial.nodes.len() - trial.paying(price);
        let removed = trial.removable(surplus.min(trial.share(REMOVED_SHARE)));
        // A few that stand in each other's way are not worth another round.
        if removed.len() < trial.share(FEW) {
            break;
        }
        trial = trial.changed(&removed, &[])?;
    }
    Ok(Some(trial.paying(price).max(least)))
}
