//! The state of one GoF and every step from syntax to positions. The encoder owns the same type and
//! calls the same methods for its references: there is no second copy.

use crate::decode::key_nodes::{NodeSet, decode_key_nodes};
use crate::decode::path::{Sites, trace_path};
#[cfg(feature = "encode")]
use crate::decode::references::Reference;
use crate::decode::references::{ReferencePool, Slot};
use crate::decode::transforms::decode_transforms;
use crate::decode::translation::Translations;
use kn_bitstream::params::{InfluenceMode, LabelSet, UpAxis, WeightScheme, Weights};
use kn_bitstream::{
    KeyNodes, MotionContext, MotionFrame, SequenceHeader,
    rule::{self, Rule},
};
use kn_deform::{BindError, BindOptions, Deformer, Influence, NodeTransform, Smoother, bind};
use kn_mesh::{Grid, GridMesh};

/// The state of a GoF while its frames are decoded in decode order. Buffers are reused by the next
/// GoF.
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
    references: ReferencePool,
    nodes: NodeSet,
    influence: Influence,
    translations: Translations,
    transforms: Vec<NodeTransform>,
    smoother: Smoother,
    deformer: Deformer,
}

impl Reconstruction {
    /// Makes a reconstruction with the settings in the header of a sequence.
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

    /// Begins a GoF: `decode` fills the I-frame, which is then smoothed as [`Self::smooth`] says.
    pub(crate) fn begin<E>(
        &mut self,
        smoothing: u8,
        decode: impl FnOnce(&mut GridMesh) -> Result<(), E>,
    ) -> Result<(), E> {
        decode(&mut self.intra)?;
        self.nodes.clear();
        self.references.clear();
        let slot = self.references.free();
        self.references.get_mut(slot).nodes.clear();
        self.references.keep(slot);
        self.smoother.begin_mesh();
        self.smooth(smoothing);
        Ok(())
    }

    /// The first reference of a GoF: the decoded I-frame in reference units, smoothed
    /// (`smooth.strength`).
    pub(crate) fn smooth(&mut self, strength: u8) {
        let fraction_bits = self.fraction_bits;
        let slot = self.references.last();
        let positions = &mut self.references.get_mut(slot).positions;
        positions.clear();
        positions.extend(self.intra.positions.iter().map(|p| p.map(|c| c << fraction_bits)));
        let half_step = (1 << fraction_bits) >> 1;
        self.smoother.smooth(positions, &self.intra.faces, strength, half_step);
    }

    /// Whether every label of the I-frame is one of the sequence's (`intra.labels.range`).
    pub(crate) fn labels_in_range(&self) -> bool {
        self.intra.labels.iter().all(|&label| self.labels.region(label).is_some())
    }

    /// Places the GoF's key nodes and binds influence on the I-frame.
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
        let fraction_bits = self.fraction_bits;
        let slot = self.references.last();
        let placed = &mut self.references.get_mut(slot).nodes;
        placed.clear();
        placed.extend(nodes.iter().map(|p| p.map(|c| c << fraction_bits)));
        Ok(())
    }

    /// The values that the syntax of the next P-frame depends on.
    pub(crate) fn motion_context(&self) -> MotionContext {
        MotionContext {
            node_count: self.nodes.positions.len() as u32,
            affine_count: self.nodes.affine_count(),
            part_count: self.translations.part_count(),
            previous_table: self.translations.dictionary().map(|last| last.table),
        }
    }

    /// Decodes a P-frame from the reference in `from`, which no later frame refers to: this frame
    /// is the last decoded one then.
    ///
    /// # Errors
    /// The rule that is broken; the state is then undefined until the next GoF.
    pub(crate) fn apply(&mut self, motion: &MotionFrame, from: Slot) -> Result<(), Rule> {
        let into = self.decode_motion(motion, from)?;
        self.references.keep(into);
        self.references.release(from);
        Ok(())
    }

    /// Calls `look` with the positions that [`Self::apply`] would decode, and with the faces. The
    /// state does not change.
    ///
    /// # Errors
    /// The rule that is broken.
    #[cfg(feature = "encode")]
    pub(crate) fn preview<T>(
        &mut self,
        motion: &MotionFrame,
        from: Slot,
        look: impl FnOnce(&[[i32; 3]], &[[u32; 3]]) -> T,
    ) -> Result<T, Rule> {
        let before = self.translations.clone();
        let decoded = self.decode_motion(motion, from);
        self.translations = before;
        decoded.map(|slot| look(&self.references.get(slot).positions, &self.intra.faces))
    }

    /// Deforms the frame in `from` by `motion` into a free slot, and returns that slot.
    fn decode_motion(&mut self, motion: &MotionFrame, from: Slot) -> Result<Slot, Rule> {
        let limit = self.limit();
        self.translations.decode(motion, i64::from(limit))?;
        let translations = self.translations.decoded();
        decode_transforms(motion, &self.nodes.affine, translations, &mut self.transforms);
        let into = self.references.free();
        // The buffers are out of the pool while it lends the reference.
        let mut frame = std::mem::take(self.references.get_mut(into));
        let reference = self.references.get(from);
        let (vertices, nodes) = (&reference.positions, &reference.nodes);
        let deformed = self
            .deformer
            .deform(vertices, &self.influence, nodes, &self.transforms, limit, &mut frame.positions)
            .map_err(|_| rule::DEFORM_POSITION_RANGE)
            .and_then(|()| move_nodes(nodes, &self.transforms, limit, &mut frame.nodes));
        *self.references.get_mut(into) = frame;
        deformed.map(|()| into)
    }

    /// The bound of coordinates and translations: all are smaller in magnitude, in reference units.
    pub(crate) fn limit(&self) -> i32 {
        Grid::LIMIT << self.fraction_bits
    }

    /// The decoded I-frame of the GoF, in grid steps.
    pub(crate) fn intra(&self) -> &GridMesh {
        &self.intra
    }

    /// The GoF's key nodes, positions on the I-frame in grid steps.
    pub(crate) fn nodes(&self) -> &NodeSet {
        &self.nodes
    }

    /// The slot of the last decoded frame, which P-frames of this version are deformed from.
    pub(crate) fn last(&self) -> Slot {
        self.references.last()
    }

    /// The decoded frame in a slot.
    #[cfg(feature = "encode")]
    pub(crate) fn reference(&self, slot: Slot) -> &Reference {
        self.references.get(slot)
    }

    /// The last decoded frame in reference units (`#V × 3`; `deform.output`).
    pub(crate) fn last_positions(&self) -> &[[i32; 3]] {
        &self.references.get(self.references.last()).positions
    }

    /// Translations of the last P-frame.
    #[cfg(feature = "encode")]
    pub(crate) fn translations(&self) -> &Translations {
        &self.translations
    }

    /// Influence of the GoF.
    #[cfg(feature = "encode")]
    pub(crate) fn influence(&self) -> &Influence {
        &self.influence
    }
}

/// Moves the nodes of the reference by their translations: they are the nodes of the new frame
/// (`#N × 3`, reference units; `deform.nodes.move`).
fn move_nodes(
    nodes: &[[i32; 3]],
    transforms: &[NodeTransform],
    limit: i32,
    moved: &mut Vec<[i32; 3]>,
) -> Result<(), Rule> {
    moved.clear();
    // Both summands are below 2^28, so the sum fits.
    let sum = |(node, transform): (&[i32; 3], &NodeTransform)| -> [i32; 3] {
        std::array::from_fn(|axis| node[axis] + transform.translation[axis] as i32)
    };
    moved.extend(nodes.iter().zip(transforms).map(sum));
    let inside = moved.as_flattened().iter().all(|c| c.abs() < limit);
    if inside { Ok(()) } else { Err(rule::DEFORM_NODES_MOVE) }
}

fn bind_rule(error: BindError) -> Rule {
    match error {
        BindError::RegionWithoutNodes { .. } => rule::DEFORM_INFLUENCE_STRICT,
        BindError::NoNodes | BindError::Arguments(_) => rule::NODES_COUNT_RANGE,
    }
}
