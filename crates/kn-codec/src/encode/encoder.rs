//! The streaming encoder: frames are pushed in, and a stream is written.

use crate::encode::config::EncoderConfig;
use crate::encode::fault::InputFault;
use crate::encode::group::GroupEncoder;
use crate::encode::labels::Labeller;
use crate::encode::report::{FrameReport, Summary};
use crate::encode::sequence::sequence_header;
use crate::error::EncodeError;
use kn_bitstream::params::BodyPart;
use kn_bitstream::unit::{self, FILE_SIGNATURE, write_unit};
use kn_bitstream::{BitWriter, Index, IndexGroup};
use kn_mesh::Mesh;
use kn_segment::Segmentation;
use std::io::Write;

/// Encodes a sequence frame by frame. It holds at most one GoF.
///
/// The same frames and settings give the same file, whatever the number of threads.
pub struct Encoder<W: Write> {
    writer: W,
    config: EncoderConfig,
    groups: Option<GroupEncoder>,
    labeller: Option<Labeller>,
    /// Whether the frames came with labels, from the first on.
    labelled: Option<bool>,
    /// Frames of the GoF that is being collected.
    pending: Vec<Mesh>,
    /// Result of the segmentation of each of them.
    parts: Vec<Option<Segmentation>>,
    frame: u64,
    units: Vec<u8>,
    index: Index,
    reports: Vec<FrameReport>,
    summary: Summary,
}

impl<W: Write> Encoder<W> {
    /// Makes an encoder that writes to `writer`. It writes nothing before the first GoF is full.
    ///
    /// # Errors
    /// A setting is out of its range, or two settings contradict each other; see
    /// [`EncoderConfig::validate`].
    pub fn new(writer: W, config: EncoderConfig) -> Result<Self, EncodeError> {
        config.validate()?;
        Ok(Self {
            writer,
            labeller: Labeller::new(&config),
            config,
            groups: None,
            labelled: None,
            pending: Vec::new(),
            parts: Vec::new(),
            frame: 0,
            units: Vec::new(),
            index: Index::default(),
            reports: Vec::new(),
            summary: Summary::default(),
        })
    }

    /// Adds a frame, which is a cleaned scan. A GoF that is full is encoded and written.
    ///
    /// # Errors
    /// The mesh is broken or cannot be coded (the error has its index), or the writer fails.
    pub fn push(&mut self, mesh: &Mesh) -> Result<(), EncodeError> {
        check_mesh(mesh).map_err(|fault| EncodeError::Input { frame: self.frame, fault })?;
        let labelled = !mesh.labels.is_empty();
        if *self.labelled.get_or_insert(labelled) != labelled {
            let fault = if labelled { InputFault::LabelsAppear } else { InputFault::LabelsEnd };
            return Err(EncodeError::Input { frame: self.frame, fault });
        }
        let mut mesh = mesh.clone();
        let labeller = self.labeller.as_mut().filter(|_| !labelled);
        self.parts.push(labeller.map(|labeller| labeller.label(&mut mesh)));
        self.pending.push(mesh);
        self.frame += 1;
        if self.pending.len() == usize::from(self.config.sequence.group_length) {
            self.encode_group()?;
        }
        Ok(())
    }

    /// Reports of the frames that were encoded since the last call.
    pub fn drain_reports(&mut self) -> std::vec::Drain<'_, FrameReport> {
        self.reports.drain(..)
    }

    /// Encodes the frames that are left, writes the index and flushes the writer. Returns the
    /// writer, the summary and the last reports.
    ///
    /// # Errors
    /// No frame was pushed, or a frame or the writer fails as in [`Self::push`].
    pub fn finish(mut self) -> Result<Finished<W>, EncodeError> {
        while !self.pending.is_empty() {
            self.encode_group()?;
        }
        if self.groups.is_none() {
            return Err(EncodeError::NoFrames);
        }
        let mut bits = BitWriter::new();
        self.index.write(&mut bits);
        self.units.clear();
        write_unit(&mut self.units, unit::INDEX, &bits.into_bytes());
        self.write_units()?;
        self.writer.flush()?;
        Ok(Finished { writer: self.writer, summary: self.summary, reports: self.reports })
    }

    /// Encodes and writes a GoF that begins with the first pending frame. It ends before a frame
    /// that its motion does not explain, which then stays pending with those after it.
    fn encode_group(&mut self) -> Result<(), EncodeError> {
        let Some(first) = self.pending.first() else { return Ok(()) };
        self.units.clear();
        let groups = match &mut self.groups {
            Some(groups) => groups,
            none => {
                let header = sequence_header(&self.config, first)?;
                self.units.extend_from_slice(&FILE_SIGNATURE);
                let mut bits = BitWriter::new();
                header.write(&mut bits);
                write_unit(&mut self.units, unit::SEQUENCE_HEADER, &bits.into_bytes());
                none.insert(GroupEncoder::new(self.config.clone(), header))
            }
        };
        let start = self.units.len();
        let reported = self.reports.len();
        let first_index = self.frame - self.pending.len() as u64;
        let coded =
            groups.encode(&self.pending, first_index, &mut self.units, &mut self.reports)?;
        let bytes = u32::try_from(self.units.len() - start).map_err(|_| EncodeError::Input {
            frame: first_index,
            fault: InputFault::GroupTooLarge,
        })?;
        self.index.groups.push(IndexGroup { bytes, frames: coded as u8 });
        self.pending.drain(..coded);
        for (report, parts) in self.reports[reported..].iter_mut().zip(self.parts.drain(..coded)) {
            report.frame_mut().parts = parts;
            self.summary.frames += 1;
            match report {
                FrameReport::Intra(report) => {
                    self.summary.intra_frames += 1;
                    self.summary.intra_bytes += report.frame.bytes;
                }
                FrameReport::Predicted(report) => {
                    self.summary.predicted_bytes += report.frame.bytes;
                }
            }
        }
        self.write_units()
    }

    fn write_units(&mut self) -> Result<(), EncodeError> {
        self.writer.write_all(&self.units)?;
        self.summary.bytes += self.units.len() as u64;
        Ok(())
    }
}

/// The result of [`Encoder::finish`].
#[derive(Debug)]
pub struct Finished<W> {
    /// The writer, flushed.
    pub writer: W,
    /// Totals of the sequence.
    pub summary: Summary,
    /// Reports that were not drained.
    pub reports: Vec<FrameReport>,
}

/// Checks that a frame can be coded.
fn check_mesh(mesh: &Mesh) -> Result<(), InputFault> {
    if mesh.positions.is_empty() {
        return Err(InputFault::NoVertices);
    }
    if mesh.faces.is_empty() {
        return Err(InputFault::NoFaces);
    }
    mesh.check()?;
    match mesh.labels.iter().position(|&label| BodyPart::from_label(label).is_none()) {
        Some(vertex) => Err(InputFault::Label { label: mesh.labels[vertex], vertex }),
        None => Ok(()),
    }
}
