//! The streaming encoder: frames are pushed in, and a stream is written.

use crate::encode::config::EncoderConfig;
use crate::encode::fault::InputFault;
use crate::encode::group::GroupEncoder;
use crate::encode::labels::Labeller;
use crate::encode::report::{FrameReport, Summary};
use crate::encode::scan::Frames;
use crate::encode::sequence::sequence_header;
use crate::error::EncodeError;
use kn_bitstream::params::{BodyPart, is_frame_name};
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
    /// The name that each of them carries, or none.
    names: Vec<String>,
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
            names: Vec::new(),
            frame: 0,
            units: Vec::new(),
            index: Index::default(),
            reports: Vec::new(),
            summary: Summary::default(),
        })
    }

    /// Adds a frame, which is a cleaned scan. A GoF that is full is encoded and written.
    ///
    /// A mesh without vertices is an empty frame: nothing is there at that time. A frame without
    /// faces ends the GoF before it and is a GoF of its own.
    ///
    /// # Errors
    /// The mesh is broken or cannot be coded (the error has its index), or the writer fails. After
    /// an error the encoder is of no more use.
    pub fn push(&mut self, mesh: &Mesh) -> Result<(), EncodeError> {
        self.push_named(mesh, "")
    }

    /// Adds a frame like [`Self::push`], with the name of its file, without folder and extension.
    /// The stream carries names that the pattern [`SequenceConfig::names`] does not give. An empty
    /// name is none.
    ///
    /// # Errors
    /// The errors of [`Self::push`]; or the name is none that a stream can carry, see
    /// [`is_frame_name`].
    ///
    /// [`SequenceConfig::names`]: crate::SequenceConfig::names
    /// [`is_frame_name`]: kn_bitstream::params::is_frame_name
    pub fn push_named(&mut self, mesh: &Mesh, name: &str) -> Result<(), EncodeError> {
        check_mesh(mesh).map_err(|fault| self.input(fault))?;
        let name = self.name_to_code(name)?;
        let labelled = !mesh.labels.is_empty();
        self.check_labelled(mesh)?;
        let mut mesh = mesh.clone();
        let labeller = self.labeller.as_mut().filter(|_| !labelled && !mesh.is_empty());
        let parts = EncodeError::of_frame(self.frame, || {
            Ok(labeller.map(|labeller| labeller.label(&mut mesh)))
        })?;
        let has_surface = !mesh.faces.is_empty();
        if has_surface && self.groups.is_none() {
            self.begin(&mesh, self.frame)?;
        }
        // Frames without faces that wait for the header, or a GoF that such a frame ends.
        let waits_alone = self.pending.last().is_some_and(|last| last.faces.is_empty());
        if waits_alone || !has_surface {
            self.encode_pending()?;
        }
        self.pending.push(mesh);
        self.parts.push(parts);
        self.names.push(name);
        self.frame += 1;
        let is_full = self.pending.len() == usize::from(self.config.sequence.group_length);
        if is_full || !has_surface { self.encode_pending() } else { Ok(()) }
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
        if self.groups.is_none() {
            // No frame has a face: the settings have to say what the grid is.
            let first = self.pending.first().cloned().ok_or(EncodeError::NoFrames)?;
            self.begin(&first, 0)?;
        }
        while !self.pending.is_empty() {
            self.encode_group()?;
        }
        let mut bits = BitWriter::new();
        self.index.write(&mut bits);
        write_unit(&mut self.units, unit::INDEX, &bits.into_bytes());
        self.write_units()?;
        self.writer.flush()?;
        Ok(Finished { writer: self.writer, summary: self.summary, reports: self.reports })
    }

    /// The error of the frame that is being pushed.
    fn input(&self, fault: InputFault) -> EncodeError {
        EncodeError::Input { frame: self.frame, fault }
    }

    /// The name that the frame's header has to carry: none where the pattern gives it.
    fn name_to_code(&self, name: &str) -> Result<String, EncodeError> {
        if !name.is_empty() && !is_frame_name(name) {
            return Err(self.input(InputFault::Name(name.to_owned())));
        }
        let pattern = self.config.sequence.names.as_ref();
        let given =
            pattern.zip(u32::try_from(self.frame).ok()).map(|(names, at)| names.of_frame(at));
        Ok(if given.as_deref() == Some(name) { String::new() } else { name.to_owned() })
    }

    /// Checks that all frames have labels, or none; an empty frame has both.
    fn check_labelled(&mut self, mesh: &Mesh) -> Result<(), EncodeError> {
        let labelled = !mesh.labels.is_empty();
        if mesh.is_empty() || *self.labelled.get_or_insert(labelled) == labelled {
            return Ok(());
        }
        Err(self.input(if labelled { InputFault::LabelsAppear } else { InputFault::LabelsEnd }))
    }

    /// Makes the sequence header, which suits the first frame that has faces.
    fn begin(&mut self, first: &Mesh, frame: u64) -> Result<(), EncodeError> {
        let header = sequence_header(&self.config, first)
            .map_err(|fault| EncodeError::Input { frame, fault })?;
        self.units.extend_from_slice(&FILE_SIGNATURE);
        let mut bits = BitWriter::new();
        header.write(&mut bits);
        write_unit(&mut self.units, unit::SEQUENCE_HEADER, &bits.into_bytes());
        self.groups = Some(GroupEncoder::new(self.config.clone(), header));
        Ok(())
    }

    /// Encodes the pending frames. They wait on where there is no header yet.
    fn encode_pending(&mut self) -> Result<(), EncodeError> {
        while self.groups.is_some() && !self.pending.is_empty() {
            self.encode_group()?;
        }
        Ok(())
    }

    /// Encodes and writes a GoF that begins with the first pending frame. It ends before a frame
    /// that its motion does not explain, which then stays pending with those after it. A frame
    /// without faces is alone.
    fn encode_group(&mut self) -> Result<(), EncodeError> {
        let (Some(groups), Some(first)) = (&mut self.groups, self.pending.first()) else {
            return Ok(());
        };
        let count = if first.faces.is_empty() { 1 } else { self.pending.len() };
        let frames = Frames {
            meshes: &self.pending[..count],
            names: &self.names[..count],
            first: self.frame - self.pending.len() as u64,
        };
        let first_index = frames.first;
        let start = self.units.len();
        let reported = self.reports.len();
        let coded = groups.encode(frames, &mut self.units, &mut self.reports)?;
        let bytes = u32::try_from(self.units.len() - start).map_err(|_| EncodeError::Input {
            frame: first_index,
            fault: InputFault::GroupTooLarge,
        })?;
        self.index.groups.push(IndexGroup { bytes, frames: coded as u8 });
        self.pending.drain(..coded);
        self.names.drain(..coded);
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
        self.units.clear();
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
    mesh.check()?;
    match mesh.labels.iter().position(|&label| BodyPart::from_label(label).is_none()) {
        Some(vertex) => Err(InputFault::Label { label: mesh.labels[vertex], vertex }),
        None => Ok(()),
    }
}
