//! The key nodes of a group of frames.

use crate::encode::config::{AffineChoice, EncoderConfig, NodePlacement};
use crate::error::EncodeError;
use kn_bitstream::{AffineNodes, BitWriter, KeyNodes, LabelSet, NodeSites};
use kn_deform::{BindOptions, Influence, WeightScheme, bind};
use kn_fit::{
    FitError, FitOptions, FitTarget, GenerateOptions, NodeCount, NodeSource, RankBy,
    generate_nodes, place_farthest,
};
use kn_mesh::GridMesh;

/// Where in its group the key frame is: later frames have drifted more, earlier ones moved less.
const KEY_FRAME: f64 = 0.6;
/// Bytes of a key node: its place, and its share of a P-frame.
const PLACE_BYTES: f64 = 1.0;
const MOTION_BYTES: f64 = 3.5;
/// λ: bytes of a group that are worth one squared grid step of mean squared error.
const LAMBDA: f64 = 1000.0;

/// Chooses the key nodes of a group.
pub(crate) struct NodeChooser<'a> {
    config: &'a EncoderConfig,
    labels: &'a LabelSet,
    intra: &'a GridMesh,
    /// `#V × 3`, grid steps.
    positions: Vec<[f64; 3]>,
    /// `#V`, or empty without labels.
    regions: Vec<u8>,
}

impl<'a> NodeChooser<'a> {
    /// For a decoded I-frame.
    pub(crate) fn new(
        config: &'a EncoderConfig,
        labels: &'a LabelSet,
        intra: &'a GridMesh,
    ) -> Self {
        let region = |&label: &u8| labels.region(label).unwrap_or(0);
        Self {
            positions: intra.positions.iter().map(|p| p.map(f64::from)).collect(),
            regions: intra.labels.iter().map(region).collect(),
            config,
            labels,
            intra,
        }
    }

    /// Key nodes for a group with `predicted` P-frames; `target` prepares one of them.
    ///
    /// # Errors
    /// What `target` returns; a mesh without a surface, as `fail` words it.
    pub(crate) fn choose(
        &self,
        predicted: usize,
        target: impl Fn(usize) -> Result<FitTarget, EncodeError>,
        fail: impl Fn(FitError) -> EncodeError,
    ) -> Result<KeyNodes, EncodeError> {
        let vertices = match self.config.placement {
            NodePlacement::Farthest => None,
            NodePlacement::Generated => {
                self.generate(predicted, target, RankBy::Distance, &fail)?
            }
            NodePlacement::GeneratedByMsdm2 => {
                self.generate(predicted, target, RankBy::Msdm2, &fail)?
            }
        };
        let mut vertices = match vertices {
            Some(vertices) => vertices,
            None => self.farthest().map_err(fail)?,
        };
        vertices.sort_unstable();
        Ok(self.cheapest(&vertices))
    }

    fn regions(&self) -> Option<&[u8]> {
        (!self.regions.is_empty()).then_some(&self.regions[..])
    }

    fn farthest(&self) -> Result<Vec<u32>, FitError> {
        let affine = self.affine_vertices();
        let (faces, count) = (&self.intra.faces, self.config.nodes);
        place_farthest(&self.positions, faces, self.regions(), Some(&affine), count)
    }

    /// Nodes by the motion to the key frame; `None` where no frame can be tracked.
    fn generate(
        &self,
        predicted: usize,
        target: impl Fn(usize) -> Result<FitTarget, EncodeError>,
        rank_by: RankBy,
        fail: impl Fn(FitError) -> EncodeError,
    ) -> Result<Option<Vec<u32>>, EncodeError> {
        let bind = |vertices: &[u32]| self.bind(vertices);
        let affine = self.affine_vertices();
        let source = NodeSource {
            positions: &self.positions,
            faces: &self.intra.faces,
            regions: self.regions(),
            affine: &affine,
            bind: &bind,
        };
        let options = GenerateOptions {
            count: self.count(predicted),
            rank_by,
            fit: FitOptions { combination: self.config.combination, ..FitOptions::default() },
        };
        // A frame that is too far to be tracked gives way to one half as far.
        let mut ahead = (KEY_FRAME * predicted as f64).ceil() as usize;
        while ahead > 0 {
            let found = generate_nodes(&source, &target(ahead - 1)?, &options).map_err(&fail)?;
            if found.is_some() {
                return Ok(found);
            }
            ahead /= 2;
        }
        Ok(None)
    }

    fn count(&self, predicted: usize) -> NodeCount {
        if self.config.nodes_by_cost {
            let bytes = PLACE_BYTES + MOTION_BYTES * predicted as f64;
            NodeCount::Paying { most: self.config.nodes, price: bytes / LAMBDA }
        } else {
            NodeCount::Exactly(self.config.nodes)
        }
    }

    /// As the decoder will bind them.
    fn bind(&self, vertices: &[u32]) -> Result<Influence, FitError> {
        let options = BindOptions {
            nodes_per_vertex: self.config.nodes_per_vertex.into(),
            weights: self.config.weights,
            mode: self.config.influence,
        };
        let all = &self.intra.positions;
        let sites: Vec<[i32; 3]> = vertices.iter().map(|&v| all[v as usize]).collect();
        let region = |v: usize| self.regions.get(v).copied().unwrap_or(0);
        let regions: Vec<u8> = (0..all.len()).map(region).collect();
        let site_regions: Vec<u8> = vertices.iter().map(|&v| region(v as usize)).collect();
        let mut influence = Influence::default();
        bind(all, &regions, &sites, &site_regions, &options, &mut influence)?;
        Ok(influence)
    }

    /// `#V`, whether a node there would be affine.
    fn affine_vertices(&self) -> Vec<bool> {
        match affine_nodes(&self.config.affine, self.labels) {
            AffineNodes::Labels(flags) => {
                self.intra.labels.iter().map(|&label| flags[usize::from(label)]).collect()
            }
            AffineNodes::All => vec![true; self.positions.len()],
            AffineNodes::None | AffineNodes::Nodes(_) => vec![false; self.positions.len()],
        }
    }

    /// The nodes as indices of I-frame vertices or as differences of positions, whichever takes
    /// fewer bits.
    fn cheapest(&self, vertices: &[u32]) -> KeyNodes {
        let points = vertices.iter().map(|&v| self.intra.positions[v as usize]).collect();
        let coded = |sites: NodeSites| KeyNodes {
            sites,
            affine: affine_nodes(&self.config.affine, self.labels),
            weight_sigma: match self.config.weights {
                WeightScheme::Gaussian { sigma } => Some(sigma),
                WeightScheme::InverseSquare | WeightScheme::Sumner => None,
            },
        };
        let by_vertex = coded(NodeSites::Vertices(vertices.to_vec()));
        let by_point = coded(NodeSites::Points(points));
        if bytes(&by_point) < bytes(&by_vertex) { by_point } else { by_vertex }
    }
}

fn bytes(nodes: &KeyNodes) -> usize {
    let mut bits = BitWriter::new();
    nodes.write(&mut bits);
    bits.into_bytes().len()
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
