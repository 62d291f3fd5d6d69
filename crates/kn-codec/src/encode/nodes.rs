//! The choice of the key nodes of a GoF.

use crate::encode::choices::{AffineChoice, CombinationChoice, NodeChoice, NodePlacement};
use crate::encode::config::EncoderConfig;
use crate::encode::failure::EarlierFrames;
use crate::encode::frame_settings::node_lambda;
use crate::encode::scan::Scans;
use crate::encode::tuning::Tuning;
use crate::error::EncodeError;
use kn_bitstream::params::LabelSet;
use kn_bitstream::{AffineNodes, BitWriter, KeyNodes, NodeSites};
use kn_deform::{BindOptions, Influence, bind};
use kn_fit::{
    FitError, FitOptions, FitReport, FitSource, GenerateOptions, NodeCount, NodeSource, RankBy,
    affine_gains, generate_nodes, place_farthest,
};
use kn_mesh::GridMesh;

/// Chooses the key nodes of a GoF.
pub(crate) struct NodeChooser<'a> {
    config: &'a EncoderConfig,
    tuning: &'a Tuning,
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
        tuning: &'a Tuning,
        labels: &'a LabelSet,
        intra: &'a GridMesh,
    ) -> Self {
        let region = |&label: &u8| labels.region(label).unwrap_or(0);
        Self {
            positions: intra.positions.iter().map(|p| p.map(f64::from)).collect(),
            regions: intra.labels.iter().map(region).collect(),
            config,
            tuning,
            labels,
            intra,
        }
    }

    /// Chooses the key nodes of a GoF with these P-frames.
    ///
    /// # Errors
    /// A scan cannot be used, or the mesh has no surface; `fail` makes the error.
    pub(crate) fn choose(
        &self,
        scans: &mut Scans,
        fail: impl Fn(FitError) -> EncodeError,
    ) -> Result<KeyNodes, EncodeError> {
        let vertices = match self.config.motion.placement {
            NodePlacement::Farthest => None,
            NodePlacement::Generated => self.generate(scans, RankBy::Distance, &fail)?,
            NodePlacement::GeneratedByMsdm2 => self.generate(scans, RankBy::Msdm2, &fail)?,
        };
        let mut vertices = match vertices {
            Some(vertices) => vertices,
            None => self.farthest().map_err(&fail)?,
        };
        vertices.sort_unstable();
        let affine = match self.config.motion.affine {
            AffineChoice::Cost => AffineNodes::Nodes(self.affine_by_cost(&vertices, scans, &fail)?),
            _ => affine_nodes(&self.config.motion.affine, self.labels),
        };
        Ok(self.cheapest(&vertices, affine))
    }

    fn regions(&self) -> Option<&[u8]> {
        (!self.regions.is_empty()).then_some(&self.regions[..])
    }

    fn farthest(&self) -> Result<Vec<u32>, FitError> {
        let affine = self.affine_vertices();
        let faces = &self.intra.faces;
        let count = match self.config.motion.nodes {
            NodeChoice::Fixed(count) => count,
            NodeChoice::Cost { most } => most.min(self.tuning.nodes.evenly),
        };
        place_farthest(&self.positions, faces, self.regions(), Some(&affine), count)
    }

    /// Places nodes by the motion to the key frame. Returns `None` where no frame can be tracked.
    fn generate(
        &self,
        scans: &mut Scans,
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
        let failure = self.tuning.failure;
        let explains =
            |report: &FitReport| failure.judge(report, &EarlierFrames::default()).is_none();
        let options = GenerateOptions {
            count: self.count(scans.len()),
            rank_by,
            fit: FitOptions { measures: Some(failure.measures), ..self.fit_options() },
            explains: &explains,
        };
        // A frame that is too far to be tracked gives way to one half as far.
        let mut ahead = self.key_frame(scans);
        while ahead > 0 {
            let key = scans.keep(ahead - 1)?;
            let found = generate_nodes(&source, &key.target, &options).map_err(&fail)?;
            if found.is_some() {
                return Ok(found);
            }
            ahead /= 2;
        }
        Ok(None)
    }

    /// `#N`, whether a node's scales and shears lower J = D + λR in the key frame: both fits share
    /// their matches, and what the affine one is nearer to the scan counts for the nodes that moved
    /// the vertices there.
    fn affine_by_cost(
        &self,
        vertices: &[u32],
        scans: &mut Scans,
        fail: &impl Fn(FitError) -> EncodeError,
    ) -> Result<Vec<bool>, EncodeError> {
        let key = scans.keep(self.key_frame(scans).max(1) - 1)?;
        let influence = self.bind(vertices).map_err(fail)?;
        let nodes: Vec<[f64; 3]> = vertices.iter().map(|&v| self.positions[v as usize]).collect();
        let source = FitSource {
            positions: &self.positions,
            faces: &self.intra.faces,
            influence: &influence,
            nodes: &nodes,
            affine: &vec![true; nodes.len()],
            labels: None,
        };
        let gains = affine_gains(&source, &key.target, &self.fit_options()).map_err(fail)?;
        let tuning = &self.tuning.nodes;
        let slope = tuning.distortion_slope / (2.0 * gains.rigid.sqrt());
        let price = node_lambda(self.config) * tuning.stretch_bytes / slope;
        Ok(gains.nodes.iter().map(|&gain| gain > price).collect())
    }

    /// Options of the generator's fits.
    fn fit_options(&self) -> FitOptions {
        match self.config.motion.combination {
            CombinationChoice::Fixed(combination) => {
                FitOptions { combination, ..FitOptions::default() }
            }
            _ => FitOptions::default(),
        }
    }

    fn count(&self, predicted: usize) -> NodeCount {
        match self.config.motion.nodes {
            NodeChoice::Fixed(count) => NodeCount::Exactly(count),
            NodeChoice::Cost { most } => {
                let tuning = &self.tuning.nodes;
                let bytes = tuning.place_bytes / predicted.max(1) as f64 + tuning.motion_bytes;
                NodeCount::Paying {
                    dense: self.positions.len() / tuning.vertices_per_node,
                    most,
                    price: node_lambda(self.config) * bytes / tuning.distortion,
                }
            }
        }
    }

    /// Number of frames from the I-frame to the key frame.
    fn key_frame(&self, scans: &Scans) -> usize {
        (self.tuning.nodes.key_frame * scans.len() as f64).ceil() as usize
    }

    /// As the decoder will bind them.
    fn bind(&self, vertices: &[u32]) -> Result<Influence, FitError> {
        let options = BindOptions {
            nodes_per_vertex: self.config.motion.nodes_per_vertex.into(),
            weights: self.config.motion.weights,
            mode: self.config.motion.influence,
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
        match affine_nodes(&self.config.motion.affine, self.labels) {
            AffineNodes::Labels(flags) => {
                self.intra.labels.iter().map(|&label| flags[usize::from(label)]).collect()
            }
            AffineNodes::All => vec![true; self.positions.len()],
            // Nodes by cost go where rigid ones fail.
            AffineNodes::None | AffineNodes::Nodes(_) => vec![false; self.positions.len()],
        }
    }

    /// The nodes as indices of I-frame vertices or as differences of positions, whichever takes
    /// fewer bits.
    fn cheapest(&self, vertices: &[u32], affine: AffineNodes) -> KeyNodes {
        let points = vertices.iter().map(|&v| self.intra.positions[v as usize]).collect();
        let coded = |sites: NodeSites| KeyNodes {
            sites,
            affine: affine.clone(),
            weight_sigma: self.config.motion.weights.sigma(),
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

/// The affine nodes of a choice by labels. Without labels all nodes are rigid.
fn affine_nodes(choice: &AffineChoice, labels: &LabelSet) -> AffineNodes {
    match choice {
        AffineChoice::All => AffineNodes::All,
        AffineChoice::Labels(affine) if *labels != LabelSet::None => {
            let flag = |label: u32| affine.iter().any(|part| u32::from(part.label()) == label);
            AffineNodes::Labels((0..labels.label_count()).map(flag).collect())
        }
        AffineChoice::None | AffineChoice::Labels(_) | AffineChoice::Cost => AffineNodes::None,
    }
}
