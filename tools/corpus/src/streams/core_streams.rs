//! Streams as the encoder writes them.

use anyhow::Result;
use kn_bitstream::params::{
    Combination, FileNames, FrameRate, InfluenceMode, UnitOfLength, UpAxis, Weights,
};

use kn_codec::{
    AffineChoice, DistortionMeasure, Encoder, EncoderConfig, GridChoice, LabelChoice,
    NodePlacement, PartStart, SmoothingChoice, StepChoice, TranslationChoice,
};
use kn_conform::{Spec, node_labels};
use kn_mesh::Mesh;

use super::Draft;
use super::core_translations::predicted;
use super::meshes::{ellipsoid, label, moved, opened, torus, twins};

/// Every setting, so that no default moves the corpus.
fn config() -> EncoderConfig {
    EncoderConfig::default()
        .with_grid(GridChoice::Bits { bits: 9, bounds: None })
        .with_decimation(None)
        .with_vertex_maps(false)
        .with_labels(LabelChoice::Given)
        .with_group_length(8)
        .with_nodes(12)
        .with_placement(NodePlacement::Generated)
        .with_frame_rate(FrameRate::default())
        .with_unit(UnitOfLength::Unspecified)
        .with_up_axis(UpAxis::Y)
        .with_fraction_bits(8)
        .with_smoothing(SmoothingChoice::Strength(0))
        .with_nodes_per_vertex(4)
        .with_weights(Weights::INVERSE_SQUARE)
        .with_influence(InfluenceMode::Fallback)
        .with_affine(AffineChoice::torso())
        .with_combination(Combination::RTSH)
        .with_distortion(DistortionMeasure::Surrogate)
        .with_lambda(3e-5)
        .with_part_start(PartStart::Off)
        .with_translation(TranslationChoice::Direct)
        .with_translation_step(StepChoice::Fixed(1.0))
        .with_rotation_step(None)
        .with_scale_step(Some(1.0))
        .with_shear_step(Some(1.0))
        .with_digests(true)
        .with_names(None)
}

/// The settings for a combination, with a step for each component that it has.
fn carrying(combination: Combination) -> EncoderConfig {
    config()
        .with_combination(combination)
        .with_scale_step(combination.scale.then_some(1.0))
        .with_shear_step(combination.shear.then_some(1.0))
}

pub(crate) fn drafts(spec: &Spec) -> Result<Vec<Draft>> {
    let plain = ellipsoid(9, 12);
    let mut body = plain.clone();
    label(&mut body);
    let mut core = Core { spec, plain, body, drafts: Vec::new() };
    core.frames_and_components()?;
    core.influence()?;
    core.smoothing_and_header()?;
    core.meshes()?;
    core.translations()?;
    Ok(core.drafts)
}

/// The streams so far, and the meshes that they are made of.
struct Core<'s> {
    spec: &'s Spec,
    plain: Mesh,
    /// The same with labels.
    body: Mesh,
    drafts: Vec<Draft>,
}

/// Three frames of a mesh that moves.
fn short(mesh: &Mesh) -> Vec<Mesh> {
    (0..3).map(|i| moved(mesh, f64::from(i))).collect()
}

impl Core<'_> {
    fn add(
        &mut self,
        (name, danger): (&str, &str),
        covers: &'static [&'static str],
        meshes: &[Mesh],
        config: EncoderConfig,
    ) -> Result<()> {
        let text = encoded(self.spec, meshes, config)?;
        let (name, danger) = (name.into(), danger.into());
        self.drafts.push(Draft { name, text, danger, rule: None, covers });
        Ok(())
    }

    /// I-frames alone, components of affine nodes, GoFs.
    fn frames_and_components(&mut self) -> Result<()> {
        let still = [self.plain.clone()];
        self.add(
            ("one_frame", "A file may be one I-frame: no key nodes, no P-frame."),
            &[
                "intra.payload",
                "intra.counts.meaning",
                "conformance.frame.sha256",
                "conformance.profile.main",
                "conformance.levels",
                "conformance.exact",
                "conformance.own_limits",
                "conformance.contract",
                "descriptor.order",
                "syntax.tables",
            ],
            &still,
            config(),
        )?;
        for (name, danger, combination) in COMBINATIONS {
            let config = carrying(combination).with_affine(AffineChoice::torso());
            let covers = &[
                "nodes.affine",
                "nodes.label.nearest",
                "motion.counts",
                "motion.order",
                "deform.matrix",
                "deform.node",
                "deform.blend",
                "deform.arithmetic",
                "deform.reference",
                "conventions.binary64",
                "intra.labels.order",
                "intra.labels.vote",
                "intra.labels.code",
                "intra.labels.border",
            ];
            self.add((name, danger), covers, &short(&self.body), config)?;
        }
        self.add(
            (
                "rigid",
                "Without affine nodes the component flags are zero, and rigid nodes still rotate.",
            ),
            &[
                "motion.absent",
                "deform.rotation",
                "deform.sincos",
                "deform.constants",
                "deform.weights.inverse",
                "header.labels.meaning",
            ],
            &short(&self.plain),
            carrying(Combination::RT).with_affine(AffineChoice::None),
        )?;
        self.add(
            ("all_affine", "With affine nodes only, a disabled rotation leaves no angles at all."),
            &["motion.counts"],
            &short(&self.plain),
            carrying(Combination::new(false, true, false)).with_affine(AffineChoice::All),
        )?;
        let long: Vec<Mesh> = (0..7).map(|i| moved(&self.plain, 0.5 * f64::from(i))).collect();
        self.add(
            ("groups", "Nothing of a GoF is left in the next; the last GoF is short."),
            &["conformance.access", "conformance.stages", "deform.influence.bound"],
            &long,
            config().with_group_length(3),
        )?;
        Ok(())
    }

    /// Weights and influence.
    fn influence(&mut self) -> Result<()> {
        self.add(
            (
                "weights_sumner",
                "The distance to the first node that is not used shapes these weights.",
            ),
            &["header.weight.meaning", "deform.weights.sumner"],
            &short(&self.body),
            config().with_weights(Weights::SUMNER),
        )?;
        self.add(
            (
                "weights_gaussian",
                "The exponential is the polynomial of 8.1, and sigma is in grid steps.",
            ),
            &["nodes.sigma.meaning", "deform.weights.gaussian", "deform.exp"],
            &short(&self.body),
            config().with_weights(Weights::gaussian(40)),
        )?;
        self.add(
            (
                "strict",
                "In strict mode a region's own nodes move it, fewer than Q of them replicated.",
            ),
            &["deform.influence.replication", "header.influence.meaning"],
            &short(&self.body),
            config().with_influence(InfluenceMode::Strict).with_nodes_per_vertex(8),
        )?;
        self.add(
            ("one_node_per_vertex", "With Q = 1 the weight is exactly 1."),
            &["header.nodes.meaning", "deform.weights.normalise"],
            &short(&self.plain),
            config().with_nodes_per_vertex(1),
        )?;
        Ok(())
    }

    /// Smoothing, and settings of the header.
    fn smoothing_and_header(&mut self) -> Result<()> {
        self.add(
            ("smoothed_weakly", "A sum of neighbours starts at 0 and adds them by rising index, not as faces name them."),
            &[
                "intra.smoothing.meaning",
                "smooth.input",
                "smooth.strength",
                "smooth.neighbours",
                "smooth.operator",
                "smooth.pass",
            ],
            &short(&self.plain),
            config().with_smoothing(SmoothingChoice::Strength(1)),
        )?;
        self.add(
            (
                "smoothed_strongly",
                "No coordinate moves by more than half a grid step; borders stay.",
            ),
            &["smooth.strength", "smooth.neighbours", "smooth.clamp"],
            &short(&self.body),
            config().with_smoothing(SmoothingChoice::Strength(5)),
        )?;
        self.add(
            ("no_fraction", "With fraction_bits 0 positions are whole grid steps, and smoothing changes nothing."),
            &[
                "header.fraction.meaning",
                "deform.round",
                "deform.output",
                "motion.step.translation",
                "conventions.conversion",
            ],
            &short(&self.plain),
            config().with_fraction_bits(0).with_smoothing(SmoothingChoice::Strength(2)),
        )?;
        self.add(
            ("names", "Frames are named by the pattern; the header is longer by it."),
            &["header.names.meaning", "conventions.tables", "conventions.ranges"],
            &short(&self.plain),
            config().with_names(Some(FileNames { prefix: "figure_".into(), digits: 4, first: 9 })),
        )?;
        self.add(
            ("no_digests", "Without digests the faces_digest is absent too."),
            &["frame.name.meaning", "conventions.names"],
            &short(&self.plain),
            config().with_digests(false),
        )?;
        Ok(())
    }

    /// Meshes of other shapes.
    fn meshes(&mut self) -> Result<()> {
        self.add(
            ("torus", "A hole through the mesh: the conquest splits its loop and joins it again."),
            INTRA,
            &short(&torus(12, 8)),
            config(),
        )?;
        self.add(
            ("open", "A mesh with a boundary, and a vertex that no face uses."),
            &[
                "intra.decoded.order",
                "intra.connectivity.new",
                "intra.geometry.isolated",
                "intra.faces.number",
            ],
            &short(&opened(&self.plain)),
            config(),
        )?;
        self.add(
            ("two_components", "A mesh of two parts."),
            &["intra.connectivity.seed", "intra.geometry.unsupported"],
            &short(&twins(&self.body)),
            config(),
        )?;
        let (empty, at) = (Mesh::default(), |step| moved(&self.body, step));
        let frames = [empty.clone(), at(0.0), at(1.0), empty.clone(), empty, at(3.0), at(4.0)];
        self.add(
            (
                "empty_frames",
                "Nothing is shown at first, and again between two GoFs that have labels: each empty \
                 frame is a GoF of its own, with a name and digests.",
            ),
            &["intra.frame.empty", "intra.labels.present"],
            &frames,
            config().with_names(Some(FileNames { prefix: "figure ".into(), digits: 1, first: 8 })),
        )?;
        Ok(())
    }

    /// Predictions of translations.
    fn translations(&mut self) -> Result<()> {
        for stream in predicted(&self.body) {
            let config = config().with_nodes(30).with_translation(stream.choice);
            let config = config.with_up_axis(stream.up_axis).with_group_length(5);
            self.add((stream.name, stream.danger), stream.covers, &stream.frames, config)?;
        }
        Ok(())
    }
}

/// The rules of chapters 1, 4 and 5 that every mesh needs.
const INTRA: &[&str] = &[
    "conventions.integers",
    "conventions.floor",
    "range.reads",
    "range.model",
    "range.model.probability",
    "range.model.adapt",
    "range.state",
    "range.decision",
    "range.raw",
    "range.renormalise",
    "range.end",
    "range.gamma",
    "intra.mesh",
    "intra.models",
    "intra.connectivity.terms",
    "intra.connectivity.seed",
    "intra.connectivity.gate",
    "intra.connectivity.add",
    "intra.connectivity.symbol",
    "intra.connectivity.new",
    "intra.connectivity.valence.code",
    "intra.faces.number",
    "intra.geometry.order",
    "intra.geometry.around",
    "intra.geometry.ring",
    "intra.geometry.blend",
    "intra.geometry.logarithm",
    "intra.geometry.spread",
    "intra.geometry.frame",
    "intra.geometry.coordinate",
    "intra.geometry.error",
    "intra.geometry.learn",
    "intra.geometry.unsupported",
];

const COMBINATIONS: [(&str, &str, Combination); 8] = [
    (
        "combination_t",
        "Affine nodes without rotation, scale and shear.",
        Combination::new(false, false, false),
    ),
    ("combination_rt", "Affine nodes with rotation.", Combination::new(true, false, false)),
    ("combination_ts", "Affine nodes with scale only.", Combination::new(false, true, false)),
    ("combination_th", "Affine nodes with shear only.", Combination::new(false, false, true)),
    (
        "combination_rts",
        "Rotation before scale: the order of the product.",
        Combination::new(true, true, false),
    ),
    (
        "combination_rth",
        "Rotation before shear: the order of the product.",
        Combination::new(true, false, true),
    ),
    (
        "combination_tsh",
        "Scale before shear: the order of the product.",
        Combination::new(false, true, true),
    ),
    ("combination_rtsh", "All components.", Combination::new(true, true, true)),
];

/// The text of what the encoder makes of some meshes.
fn encoded(spec: &Spec, meshes: &[Mesh], config: EncoderConfig) -> Result<String> {
    let mut encoder = Encoder::new(Vec::new(), config)?;
    for mesh in meshes {
        encoder.push(mesh)?;
    }
    let stream = encoder.finish()?.writer;
    Ok(spec.disassemble(&stream, &node_labels)?)
}
