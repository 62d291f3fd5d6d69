//! The state of one group of frames and every step from syntax to positions. The encoder owns the
//! same type and calls the same methods for its reference: there is no second copy.

use crate::decode::key_nodes::{NodeSet, decode_key_nodes};
use crate::decode::path::{Sites, trace_path};
use crate::decode::transforms::decode_transforms;
use crate::decode::translation::Translations;
use kn_bitstream::params::{InfluenceMode, LabelSet, UpAxis, WeightScheme, Weights};
use kn_bitstream::{
    KeyNodes, MotionContext, MotionFrame, SequenceHeader,
    rule::{self, Rule},
};
use kn_deform::{BindError, BindOptions, Deformer, Influence, NodeTransform, Smoother, bind};
use kn_mesh::{Grid, GridMesh};

/// Decodes the frames of a group, one after the other. Buffers are reused from group to group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reconstruction {
    up_axis: UpAxis,
    fraction_bits: u32,
    nodes_per_vertex: usize,
    weight_scheme: WeightScheme,
    influence_mode: InfluenceMode,
    labels: LabelSet,
    /// The decoded I-frame, in grid steps.
    intra: GridMesh,
    vertex_regions: Vec<u8>,
    /// `#V × 3`, the last decoded frame in reference units.
    reference: Vec<[i32; 3]>,
    /// `#V × 3`, the frame being deformed.
    next: Vec<[i32; 3]>,
    nodes: NodeSet,
    influence: Influence,
    translations: Translations,
    transforms: Vec<NodeTransform>,
    smoother: Smoother,
    deformer: Deformer,
}

impl Reconstruction {
    /// A reconstruction under the settings of a sequence.
    pub(crate) fn new(header: &SequenceHeader) -> Self {
        Self {
            up_axis: header.up_axis,
            fraction_bits: u32::from(header.fraction_bits),
            nodes_per_vertex: usize::from(header.nodes_per_vertex),
            weight_scheme: header.weight_scheme,
            influence_mode: header.influence_mode,
            labels: header.labels.clone(),
            ..Self::default()
        }
    }

    /// Begins a group: `decode` fills the I-frame, which is then smoothed as [`Self::smooth`] says.
    pub(crate) fn begin<E>(
        &mut self,
        smoothing: u8,
        decode: impl FnOnce(&mut GridMesh) -> Result<(), E>,
    ) -> Result<(), E> {
        decode(&mut self.intra)?;
        self.smoother.begin_mesh();
        self.smooth(smoothing);
        self.nodes.clear();
        Ok(())
    }

    /// The first reference of a group: the decoded I-frame in reference units, smoothed
    /// (`smooth.strength`).
    pub(crate) fn smooth(&mut self, strength: u8) {
        let fraction_bits = self.fraction_bits;
        self.reference.clear();
        self.reference.extend(self.intra.positions.iter().map(|p| p.map(|c| c << fraction_bits)));
        let half_step = (1 << fraction_bits) >> 1;
        self.smoother.smooth(&mut self.reference, &self.intra.faces, strength, half_step);
    }

    /// Whether every label of the I-frame is one of the sequence's (`intra.labels.range`).
    pub(crate) fn labels_in_range(&self) -> bool {
        self.intra.labels.iter().all(|&label| self.labels.region(label).is_some())
    }

    /// Places the group's key nodes and binds influence on the I-frame.
    ///
    /// # Errors
    /// The rule that is broken.
    pub(crate) fn place(&mut self, key_nodes: &KeyNodes) -> Result<(), Rule> {
        decode_key_nodes(key_nodes, &self.intra, &mut self.nodes);
        // Labels are in range: the I-frame was checked.
        let region = |&label: &u8| self.labels.region(label).unwrap_or(0);
        self.vertex_regions.clear();
        self.vertex_regions.extend(self.intra.labels.iter().map(region));
        self.vertex_regions.resize(self.intra.positions.len(), region(&0));
        let node_regions: Vec<u8> = self.nodes.labels.iter().map(region).collect();
        let weights = Weights::of_stream(self.weight_scheme, key_nodes.weight_sigma);
        let options = BindOptions {
            nodes_per_vertex: self.nodes_per_vertex,
            weights: weights.ok_or(rule::NODES_SIGMA_RANGE)?,
            mode: self.influence_mode,
        };
        let (vertices, nodes) = (&self.intra.positions, &self.nodes.positions);
        bind(vertices, &self.vertex_regions, nodes, &node_regions, &options, &mut self.influence)
            .map_err(bind_rule)?;
        let path = trace_path(&Sites {
            positions: nodes,
            body_labels: (self.labels == LabelSet::Body).then_some(&self.nodes.labels),
            influence: &self.influence,
            up_axis: self.up_axis.index(),
        });
        self.translations.begin(&self.nodes.labels, path);
        for position in &mut self.nodes.positions {
            *position = position.map(|c| c << self.fraction_bits);
        }
        Ok(())
    }

    /// What the syntax of the next P-frame depends on.
    pub(crate) fn motion_context(&self) -> MotionContext {
        MotionContext {
            node_count: self.nodes.positions.len() as u32,
            affine_count: self.nodes.affine_count(),
            part_count: self.translations.part_count(),
            previous_table: self.translations.dictionary().map(|last| last.table),
        }
    }

    /// Decodes a P-frame: the reference becomes this frame, the nodes move.
    ///
    /// # Errors
    /// The rule that is broken; the state is then undefined until the next group.
    pub(crate) fn apply(&mut self, motion: &MotionFrame) -> Result<(), Rule> {
        self.deform(motion)?;
        std::mem::swap(&mut self.reference, &mut self.next);
        let limit = self.limit();
        for (position, transform) in self.nodes.positions.iter_mut().zip(&self.transforms) {
            for axis in 0..3 {
                // Both are below 2^28, so the sum fits.
                position[axis] += transform.translation[axis] as i32;
                if position[axis].abs() >= limit {
                    return Err(rule::DEFORM_NODES_MOVE);
                }
            }
        }
        Ok(())
    }

    /// Shows `look` the positions that [`Self::apply`] would make the reference, and its faces; the
    /// state stays as it is.
    ///
    /// # Errors
    /// The rule that is broken.
    #[cfg(feature = "encode")]
    pub(crate) fn preview<T>(
        &mut self,
        motion: &MotionFrame,
        look: impl FnOnce(&[[i32; 3]], &[[u32; 3]]) -> T,
    ) -> Result<T, Rule> {
        let before = self.translations.clone();
        let deformed = self.deform(motion);
        self.translations = before;
        deformed.map(|()| look(&self.next, &self.intra.faces))
    }

    /// The next frame from its motion, into `self.next`.
    fn deform(&mut self, motion: &MotionFrame) -> Result<(), Rule> {
        let limit = self.limit();
        self.translations.decode(motion, i64::from(limit))?;
        let translations = self.translations.decoded();
        decode_transforms(motion, &self.nodes.affine, translations, &mut self.transforms);
        let (nodes, transforms) = (&self.nodes.positions, &self.transforms);
        self.deformer
            .deform(&self.reference, &self.influence, nodes, transforms, limit, &mut self.next)
            .map_err(|_| rule::DEFORM_POSITION_RANGE)
    }

    /// Reference units that no coordinate reaches, nor any translation.
    pub(crate) fn limit(&self) -> i32 {
        Grid::LIMIT << self.fraction_bits
    }

    /// The decoded I-frame of the group, in grid steps.
    pub(crate) fn intra(&self) -> &GridMesh {
        &self.intra
    }

    /// The group's key nodes, positions in reference units.
    pub(crate) fn nodes(&self) -> &NodeSet {
        &self.nodes
    }

    /// The last decoded frame in reference units (`#V × 3`; `deform.output`).
    pub(crate) fn reference(&self) -> &[[i32; 3]] {
        &self.reference
    }

    /// Translations of the last P-frame.
    #[cfg(feature = "encode")]
    pub(crate) fn translations(&self) -> &Translations {
        &self.translations
    }

    /// Influence of the group.
    #[cfg(feature = "encode")]
    pub(crate) fn influence(&self) -> &Influence {
        &self.influence
    }
}

fn bind_rule(error: BindError) -> Rule {
    match error {
        BindError::RegionWithoutNodes { .. } => rule::DEFORM_INFLUENCE_STRICT,
        BindError::NoNodes | BindError::Arguments(_) => rule::NODES_COUNT_RANGE,
    }
}
