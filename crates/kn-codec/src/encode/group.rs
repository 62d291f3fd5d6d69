//! Encoding of one GoF in a closed loop: each coded frame is decoded by the decoder's own
//! reconstruction, and later frames refer to the decoded frame.

use crate::decode::{Reconstruction, Slot};
use crate::digest::{faces_digest, positions_digest};
use crate::encode::choices::{CombinationChoice, DistortionMeasure, SmoothingChoice};
use crate::encode::config::{EncoderConfig, GridChoice};
use crate::encode::cost::cheapest;
use crate::encode::decimate::decimate;
use crate::encode::failure::FitFailure;
use crate::encode::fault::InputFault;
use crate::encode::frame_error::ErrorBound;
use crate::encode::frame_settings::{FramePlace, FrameSettings, frame_settings};
use crate::encode::motion::{CodedMotion, MotionEncoder};
use crate::encode::nodes::NodeChooser;
use crate::encode::report::{
    CodedFrame, CostReport, FrameReport, IntraReport, PredictedReport, StepReport,
};
use crate::encode::scan::{Frames, Scan, ScanOptions, Scans, to_grid_steps};
use crate::encode::smoothing::choose_smoothing;
use crate::encode::tuning::Tuning;
use crate::error::EncodeError;
use crate::intra::{IntraDecoder, IntraLimits, decode_intra, encode_intra};
use crate::order::FrameNumbers;
use kn_bitstream::params::{BodyPart, Combination, LabelSet};
use kn_bitstream::rule::HEADER_LEVEL_KNOWN;
use kn_bitstream::unit::{self, write_unit};
use kn_bitstream::{BitWriter, FrameHeader, IntraFrame, IntraPayload, SequenceHeader};
use kn_deform::BindError;
use kn_fit::FitError;
use kn_mesh::{Grid, GridMesh, Mesh, compose};
use kn_metrics::TriangleTree;

mod bound;

/// Encodes GoFs of one sequence, one after the other.
pub(crate) struct GroupEncoder {
    config: EncoderConfig,
    tuning: Tuning,
    header: SequenceHeader,
    grid: Grid,
    reconstruction: Reconstruction,
    intra_decoder: IntraDecoder,
    motion: MotionEncoder,
    bound: ErrorBound,
    /// The reason why the last GoF ended early.
    reason: Option<FitFailure>,
}

impl GroupEncoder {
    pub(crate) fn new(config: EncoderConfig, header: SequenceHeader) -> Self {
        let tuning = Tuning::default();
        Self {
            grid: Grid { origin: header.grid_origin, step: header.grid_step },
            reconstruction: Reconstruction::new(&header),
            motion: MotionEncoder::new(&config, tuning, &header),
            bound: ErrorBound::new(config.motion.max_error, tuning.error),
            config,
            tuning,
            header,
            intra_decoder: IntraDecoder::default(),
            reason: None,
        }
    }

    /// Appends the units of a GoF to `out` and a report per frame to `reports`, both in decode
    /// order; returns the number of frames in the GoF, which ends before a frame that its motion
    /// does not explain.
    ///
    /// # Errors
    /// A frame that cannot be coded.
    pub(crate) fn encode(
        &mut self,
        frames: Frames<'_>,
        out: &mut Vec<u8>,
        reports: &mut Vec<FrameReport>,
    ) -> Result<usize, EncodeError> {
        let Some((intra, predicted)) = frames.split_first() else { return Ok(0) };
        let first = frames.first;
        let coded = EncodeError::of_frame(first, || self.encode_intra_frame(intra, first, out));
        reports.push(coded?);
        if predicted.meshes.is_empty() {
            return Ok(1);
        }
        let mut scans = Scans::new(predicted, self.scan_options());
        let input = |fault: InputFault| EncodeError::Input { frame: first, fault };
        if scans.len() == 0 || !self.can_move().map_err(input)? {
            self.reason = Some(FitFailure::NoArea);
            return Ok(1);
        }
        self.measure_intra(intra.0).map_err(input)?;
        let mut units = Vec::new();
        let nodes = || self.encode_key_nodes(&mut scans, &mut units);
        let node_bytes = EncodeError::of_frame(first, nodes)?;
        let mut pass = self.encode_predicted(&scans)?;
        let cut_short = scans.len() < predicted.meshes.len();
        self.reason = pass.reason.or(cut_short.then_some(FitFailure::NoArea));
        // Key nodes without a P-frame would be of no use.
        if let Some(first) = pass.reports.first_mut() {
            first.node_bytes = node_bytes;
            first.frame.bytes += node_bytes;
            out.append(&mut units);
            out.append(&mut pass.units);
        }
        let coded = 1 + pass.reports.len();
        reports.extend(pass.reports.into_iter().map(FrameReport::Predicted));
        Ok(coded)
    }

    /// The GoF's P-frames, in the way that costs least.
    fn encode_predicted(&mut self, scans: &Scans) -> Result<Pass, EncodeError> {
        let looks_ahead = self.config.motion.combination == CombinationChoice::LookAhead;
        if !looks_ahead || self.reconstruction.nodes().affine_count() == 0 {
            return self.encode_pass(scans, None);
        }
        let start = self.reconstruction.clone();
        let mut passes = Vec::with_capacity(Combination::ALL.len());
        for combination in Combination::ALL {
            self.reconstruction.clone_from(&start);
            passes.push(self.encode_pass(scans, Some(combination))?);
        }
        // A GoF that goes on for longer has fewer I-frames.
        let longest = passes.iter().map(|pass| pass.reports.len()).max();
        passes.retain(|pass| Some(pass.reports.len()) == longest);
        Ok(cheapest(passes, Pass::cost).unwrap_or_default())
    }

    /// The GoF's P-frames, one after the other, all with `combination` where there is one.
    fn encode_pass(
        &mut self,
        scans: &Scans,
        combination: Option<Combination>,
    ) -> Result<Pass, EncodeError> {
        self.motion.begin(combination);
        let mut pass = Pass::default();
        let of = scans.len();
        let mut scan = scans.get(0)?;
        for number in 0..of {
            let next = number + 1;
            let task = FrameTask {
                numbers: FrameNumbers::in_order(scans.frame(number).0),
                name: scans.name(number),
                from: self.reconstruction.last(),
                settings: frame_settings(&self.config, FramePlace { number, of }),
                scan: &scan,
                input_faces: scans.frame(number).1,
            };
            // The next scan is prepared while this one is fitted to.
            let frame = task.numbers.display;
            let (report, next_scan) = rayon::join(
                || {
                    let encode = || self.encode_motion_frame(task, &mut pass.units);
                    EncodeError::of_frame(frame, encode)
                },
                || (next < of).then(|| scans.get(next)).transpose(),
            );
            match report? {
                Ok(report) => pass.reports.push(report),
                Err(failure) => {
                    pass.reason = Some(failure);
                    break;
                }
            }
            if let Some(next_scan) = next_scan? {
                scan = next_scan;
            }
        }
        Ok(pass)
    }

    fn encode_intra_frame(
        &mut self,
        (mesh, name): (&Mesh, &str),
        first: u64,
        out: &mut Vec<u8>,
    ) -> Result<FrameReport, EncodeError> {
        let numbers = FrameNumbers::in_order(first);
        let input = |fault: InputFault| EncodeError::Input { frame: numbers.display, fault };
        let tuning = &self.tuning.decimation;
        let decimated = self.config.intra.decimation.and_then(|how| decimate(mesh, how, tuning));
        let coarse = decimated.as_ref().map_or(mesh, |decimated| &decimated.mesh);
        let coded = self.on_grid(coarse).map_err(input)?;
        let mut encoding = encode_intra(&coded).map_err(|error| input(error.into()))?;
        // An empty frame has no label to show that the sequence has labels.
        encoding.header.has_labels = self.header.labels != LabelSet::None;
        self.decode_payload(&encoding.payload()).map_err(input)?;
        let smoothing = self.smoothing(mesh);
        self.reconstruction.smooth(smoothing);
        let decoded = self.reconstruction.intra();
        let digests = self.config.sequence.digests;
        let positions_digest =
            digests.then(|| positions_digest(self.reconstruction.last_positions()));
        let frame = IntraFrame {
            header: FrameHeader { name: name.to_owned(), positions_digest },
            faces_digest: digests.then(|| faces_digest(&decoded.faces)),
            smoothing,
            payload: encoding.payload(),
        };
        let mut bits = BitWriter::new();
        frame.write(&mut bits);
        let vertex_map = self.config.intra.vertex_maps.then(|| match &decimated {
            Some(decimated) => compose(&decimated.vertex_map, &encoding.vertex_map),
            None => encoding.vertex_map,
        });
        let frame = CodedFrame {
            index: numbers.display,
            decode_index: numbers.decode,
            bytes: append_unit(out, unit::INTRA_FRAME, bits),
            vertices: decoded.positions.len() as u32,
            faces: decoded.faces.len() as u32,
            input_faces: mesh.faces.len() as u32,
            parts: None,
        };
        Ok(FrameReport::Intra(IntraReport {
            frame,
            decimation_error: decimated.as_ref().map_or(0.0, |decimated| decimated.error),
            vertex_map,
            reason: self.reason.take(),
        }))
    }

    /// The strength of smoothing of the I-frame that the reconstruction has decoded; `mesh` is the
    /// scan.
    fn smoothing(&mut self, mesh: &Mesh) -> u8 {
        match self.config.intra.smoothing {
            // Positions are the input's to the last bit.
            _ if matches!(self.config.sequence.grid, GridChoice::Lossless(_)) => 0,
            _ if mesh.faces.is_empty() => 0,
            SmoothingChoice::Strength(strength) => strength,
            SmoothingChoice::Auto => {
                let unit = f64::from(1_u32 << self.header.fraction_bits);
                let positions = to_grid_steps(&mesh.positions, self.grid);
                let Ok(scan) = TriangleTree::new(&positions, &mesh.faces) else { return 0 };
                choose_smoothing(&mut self.reconstruction, &scan, unit, &self.tuning.smoothing)
            }
        }
    }

    fn scan_options(&self) -> ScanOptions {
        ScanOptions {
            grid: self.grid,
            measure: measure_of(&self.config),
            tuning: self.tuning.surrogate,
        }
    }

    /// The mesh on the sequence's grid; in lossless mode, a mesh that is there already.
    fn on_grid(&self, mesh: &Mesh) -> Result<GridMesh, InputFault> {
        let positions = self.grid.quantise(&mesh.positions)?;
        if let GridChoice::Lossless(grid) = self.config.sequence.grid {
            let world = grid.to_world();
            // A binary32 number may stand for the decimal that it is nearest to.
            let kept = |(own, coded): (&f64, f64)| *own == coded || *own == f64::from(coded as f32);
            let moved =
                |(own, coded): (&[f64; 3], &[i32; 3])| !own.iter().zip(world.at(*coded)).all(kept);
            if let Some(vertex) = mesh.positions.iter().zip(&positions).position(moved) {
                return Err(InputFault::OffGrid { vertex });
            }
        }
        Ok(mesh.with_positions(positions))
    }

    /// The decoder's view of the I-frame that was just coded.
    fn decode_payload(&mut self, payload: &IntraPayload<'_>) -> Result<(), InputFault> {
        let level = self.header.limits().ok_or(HEADER_LEVEL_KNOWN)?;
        let limits = IntraLimits { max_vertices: level.max_vertices, max_faces: level.max_faces };
        let decoder = &mut self.intra_decoder;
        self.reconstruction.begin(0, |decoded| decode_intra(payload, &limits, decoder, decoded))?;
        Ok(())
    }

    /// Chooses, codes and places the GoF's key nodes; returns the bytes of their unit.
    fn encode_key_nodes(
        &mut self,
        scans: &mut Scans,
        out: &mut Vec<u8>,
    ) -> Result<u64, EncodeError> {
        let frame = scans.frame(0).0;
        let input = |fault: InputFault| EncodeError::Input { frame, fault };
        let intra = self.reconstruction.intra();
        let chooser = NodeChooser::new(&self.config, &self.tuning, &self.header.labels, intra);
        let fail = |error: FitError| match error {
            FitError::Bind(BindError::RegionWithoutNodes { vertex, .. }) => {
                input(without_nodes(intra.labels.get(vertex)))
            }
            other => input(other.into()),
        };
        let nodes = chooser.choose(scans, fail)?;
        self.reconstruction.place(&nodes).map_err(|refused| match self.bare_label() {
            Some(label) => input(without_nodes(Some(label))),
            None => input(refused.into()),
        })?;
        let mut bits = BitWriter::new();
        nodes.write(&mut bits);
        Ok(append_unit(out, unit::KEY_NODES, bits))
    }

    /// A label of vertices whose region has no key node: what strict mode refuses.
    fn bare_label(&self) -> Option<&u8> {
        let region = |&label: &u8| self.header.labels.region(label);
        let nodes: Vec<_> = self.reconstruction.nodes().labels.iter().map(region).collect();
        let labels = &self.reconstruction.intra().labels;
        labels.iter().find(|label| !nodes.contains(&region(label)))
    }

    /// A P-frame, or why the motion does not explain it: then nothing is coded.
    fn encode_motion_frame(
        &mut self,
        task: FrameTask<'_>,
        out: &mut Vec<u8>,
    ) -> Result<Result<PredictedReport, FitFailure>, EncodeError> {
        let FrameTask { numbers, name, from, settings, scan, input_faces } = task;
        let input = |fault: InputFault| EncodeError::Input { frame: numbers.display, fault };
        let decoded = &mut self.reconstruction;
        let CodedMotion { mut motion, combination, cost, fit_rms } = match self
            .motion
            .encode(decoded, from, scan, &settings)
            .map_err(|error| input(error.into()))?
        {
            Ok(coded) => coded,
            Err(failure) => return Ok(Err(failure)),
        };
        let context = self.reconstruction.motion_context();
        self.reconstruction.apply(&motion, from).map_err(|rule| input(rule.into()))?;
        let measured = match self.judge(scan).map_err(input)? {
            Ok(measured) => measured,
            Err(failure) => return Ok(Err(failure)),
        };
        let positions = self.reconstruction.last_positions();
        motion.header.name = name.to_owned();
        motion.header.positions_digest =
            self.config.sequence.digests.then(|| positions_digest(positions));
        let mut bits = BitWriter::new();
        motion.write(&mut bits, &context);
        let intra = self.reconstruction.intra();
        let frame = CodedFrame {
            index: numbers.display,
            decode_index: numbers.decode,
            bytes: append_unit(out, unit::MOTION_FRAME, bits),
            vertices: intra.positions.len() as u32,
            faces: intra.faces.len() as u32,
            input_faces,
            parts: None,
        };
        Ok(Ok(PredictedReport {
            frame,
            node_bytes: 0,
            nodes: self.reconstruction.nodes().positions.len() as u32,
            affine_nodes: self.reconstruction.nodes().affine_count(),
            combination,
            translation: motion.translation_mode,
            steps: StepReport::new(&motion, self.header.fraction_bits),
            cost,
            fit_rms: fit_rms * self.grid.step,
            error: measured.error,
            error_bound: measured.bound,
        }))
    }
}

/// A P-frame that is to be coded.
struct FrameTask<'a> {
    numbers: FrameNumbers,
    name: &'a str,
    /// The reference that it is deformed from.
    from: Slot,
    settings: FrameSettings,
    scan: &'a Scan,
    input_faces: u32,
}

/// The P-frames of a GoF, coded with one combination or with one choice of it.
#[derive(Default)]
struct Pass {
    units: Vec<u8>,
    reports: Vec<PredictedReport>,
    /// The reason why the pass ends early.
    reason: Option<FitFailure>,
}

impl Pass {
    /// The sums over its frames.
    fn cost(&self) -> CostReport {
        let costs = self.reports.iter().filter_map(|report| report.cost);
        costs.reduce(|a, b| a + b).unwrap_or_default()
    }
}

/// The measure of D; `None` where nothing is chosen by cost.
fn measure_of(config: &EncoderConfig) -> Option<DistortionMeasure> {
    config.motion.is_by_cost().then_some(config.rate.distortion)
}

/// Appends a unit with a structure. Returns its number of bytes.
fn append_unit(out: &mut Vec<u8>, unit_type: u8, bits: BitWriter) -> u64 {
    let before = out.len();
    write_unit(out, unit_type, &bits.into_bytes());
    (out.len() - before) as u64
}

/// The fault of a GoF that strict mode refuses: the region of this label has no key node.
fn without_nodes(label: Option<&u8>) -> InputFault {
    InputFault::WithoutNodes { part: label.and_then(|&label| BodyPart::from_label(label)) }
}
