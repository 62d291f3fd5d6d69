//! The key nodes of a group of frames.

use crate::encode::config::{AffineChoice, EncoderConfig};
use kn_bitstream::{AffineNodes, KeyNodes, LabelSet, NodeSites, SequenceHeader};
use kn_deform::WeightScheme;
use kn_fit::{FitError, place_farthest};
use kn_mesh::GridMesh;

/// Spreads the nodes over the decoded I-frame; each region has at least one.
///
/// # Errors
/// A mesh without a surface.
pub(crate) fn choose_key_nodes(
    config: &EncoderConfig,
    header: &SequenceHeader,
    intra: &GridMesh,
) -> Result<KeyNodes, FitError> {
    let positions: Vec<[f64; 3]> = intra.positions.iter().map(|p| p.map(f64::from)).collect();
    let region = |&label: &u8| header.labels.region(label).unwrap_or(0);
    let regions: Vec<u8> = intra.labels.iter().map(region).collect();
    let regions = (!regions.is_empty()).then_some(&regions[..]);
    let mut vertices = place_farthest(&positions, &intra.faces, regions, config.nodes)?;
    vertices.sort_unstable();
    Ok(KeyNodes {
        sites: NodeSites::Vertices(vertices),
        affine: affine_nodes(&config.affine, &header.labels),
        weight_sigma: match config.weights {
            WeightScheme::Gaussian { sigma } => Some(sigma),
            WeightScheme::InverseSquare | WeightScheme::Sumner => None,
        },
    })
}

/// Without labels no part is known to wear cloth: all nodes are rigid.
fn affine_nodes(choice: &AffineChoice, labels: &LabelSet) -> AffineNodes {
    match choice {
        AffineChoice::All => AffineNodes::All,
        AffineChoice::Labels(affine) if *labels != LabelSet::None => {
            let flag = |label: u32| affine.iter().any(|&one| u32::from(one) == label);
            AffineNodes::Labels((0..labels.label_count()).map(flag).collect())
        }
        AffineChoice::None | AffineChoice::Labels(_) => AffineNodes::None,
    }
}
