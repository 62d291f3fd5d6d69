//! The motion of a P-frame, in quantised values (chapter 3.7), and the quantiser steps (chapter 7).

use crate::error::Error;
use crate::frame::FrameHeader;
use crate::huffman::TABLE_COUNT;
use crate::params::{Combination, TranslationMode};
use crate::reader::BitReader;
use crate::rule;
use crate::symbol::{Bounds, EntropyMode, List, ValueList};
use crate::writer::BitWriter;

/// The values that the reader and the writer of a P-frame depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionContext {
    /// Number of key nodes of the GoF.
    pub node_count: u32,
    /// Number of affine nodes among them.
    pub affine_count: u32,
    /// Number of different labels that they have.
    pub part_count: u32,
    /// `translation_table` of the P-frame before; `None` in the first P-frame of a GoF.
    pub previous_table: Option<u8>,
}

/// The motion of a P-frame in quantised values.
///
/// The lists run over the nodes that carry the component, in node order: `translation` over all,
/// `rotation` over the rigid and, where enabled, the affine, `scale` and `shear` over the affine
/// where enabled. A step or table that no list needs is not in the stream and stays 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MotionFrame {
    /// Name and digest of the frame.
    pub header: FrameHeader,
    /// Entropy coding of the lists.
    pub entropy_mode: EntropyMode,
    /// Prediction of `translation`.
    pub translation_mode: TranslationMode,
    /// Components of the affine nodes.
    pub enabled: Combination,
    /// s of [`translation_step`], below 64.
    pub translation_step: u8,
    /// Huffman table of the translations.
    pub translation_table: u8,
    /// s of [`parameter_step`] for angles, below 64.
    pub rotation_step: u8,
    /// s of [`parameter_step`] for scale − 1, below 64.
    pub scale_step: u8,
    /// s of [`parameter_step`] for shear, below 64.
    pub shear_step: u8,
    /// Huffman table of rotation, scale and shear.
    pub parameter_table: u8,
    /// PartCount × 3 where the mode is [`TranslationMode::SpatioTemporal`], else empty; in the step
    /// and the table of the P-frame before.
    pub translation_change: Vec<[i32; 3]>,
    /// #N × 3, residuals of the translations.
    pub translation: Vec<[i32; 3]>,
    /// RotationCount × 3, about x, y, z.
    pub rotation: Vec<[i32; 3]>,
    /// ScaleCount × 3, scale − 1 along x, y, z.
    pub scale: Vec<[i32; 3]>,
    /// ShearCount × 3, xy, xz, yz.
    pub shear: Vec<[i32; 3]>,
}

impl TranslationMode {
    fn read(bits: &mut BitReader<'_, '_>, context: &MotionContext) -> Result<Self, Error> {
        let mode = match bits.u("translation_mode", 2)? {
            0 => Self::Direct,
            1 => Self::Spatial,
            2 => Self::SpatioTemporal,
            _ => return Err(Error::unsupported(rule::MOTION_TRANSLATION_KNOWN, bits.position())),
        };
        let known = mode != Self::SpatioTemporal || context.previous_table.is_some();
        bits.require(known, rule::MOTION_TRANSLATION_FIRST)?;
        Ok(mode)
    }
}

/// Reads the flags of the components that affine nodes have.
fn read_enabled(
    bits: &mut BitReader<'_, '_>,
    context: &MotionContext,
) -> Result<Combination, Error> {
    let mut enabled = |name| {
        let flag = bits.flag(name)?;
        bits.require(!flag || context.affine_count > 0, rule::MOTION_ENABLED_AFFINE)?;
        Ok(flag)
    };
    Ok(Combination {
        rotation: enabled("rotation_enabled")?,
        scale: enabled("scale_enabled")?,
        shear: enabled("shear_enabled")?,
    })
}

impl MotionContext {
    /// Numbers of nodes that carry rotation, scale and shear.
    pub fn carriers(&self, enabled: Combination) -> [u32; 3] {
        let affine = self.affine_count;
        let rigid = self.node_count - affine.min(self.node_count);
        let if_enabled = |flag: bool| if flag { affine } else { 0 };
        [rigid + if_enabled(enabled.rotation), if_enabled(enabled.scale), if_enabled(enabled.shear)]
    }
}

/// Quantiser step of translations in units of 2^-`fraction_bits` grid steps, for s below 64.
pub fn translation_step(s: u8) -> i64 {
    (i64::from(4 + s % 4) << (s / 4)) >> 2
}

/// Quantiser step of angles (radians), scale − 1 and shear, in units of 2^-16, for s below 64.
pub fn parameter_step(s: u8) -> i64 {
    i64::from(4 + s % 4) << (s / 4)
}

/// 1 in units of [`parameter_step`].
const ONE: i64 = 1 << 16;

impl MotionFrame {
    /// Reads the frame into `self`, whose buffers are reused; the caller calls
    /// [`BitReader::finish`]. After an error `self` holds part of the frame.
    pub fn read(
        &mut self,
        bits: &mut BitReader<'_, '_>,
        context: &MotionContext,
    ) -> Result<(), Error> {
        self.header.read(bits)?;
        let reference_mode = bits.u("reference_mode", 2)?;
        bits.require_supported(reference_mode == 0, rule::MOTION_REFERENCE_KNOWN)?;
        self.entropy_mode = EntropyMode::read(bits)?;
        let residual_present = bits.flag("residual_present")?;
        bits.require_supported(!residual_present, rule::MOTION_RESIDUAL_KNOWN)?;
        self.translation_mode = TranslationMode::read(bits, context)?;
        self.enabled = read_enabled(bits, context)?;
        self.read_steps(bits, context.carriers(self.enabled))?;
        let lists = self.lists(context);
        self.entropy_mode.read_lists(
            bits,
            &lists,
            [
                &mut self.translation_change,
                &mut self.translation,
                &mut self.rotation,
                &mut self.scale,
                &mut self.shear,
            ],
        )
    }

    fn read_steps(&mut self, bits: &mut BitReader<'_, '_>, counts: [u32; 3]) -> Result<(), Error> {
        let [rotations, scales, shears] = counts;
        self.translation_step = bits.u8("translation_step", 6)?;
        self.translation_table = read_table(bits, "translation_table")?;
        self.rotation_step = if rotations > 0 { bits.u8("rotation_step", 6)? } else { 0 };
        self.scale_step = if scales > 0 { bits.u8("scale_step", 6)? } else { 0 };
        self.shear_step = if shears > 0 { bits.u8("shear_step", 6)? } else { 0 };
        let any = counts != [0; 3];
        self.parameter_table = if any { read_table(bits, "parameter_table")? } else { 0 };
        Ok(())
    }

    /// The lists of the frame in the order of the stream.
    fn lists(&self, context: &MotionContext) -> [List; 5] {
        let [rotations, scales, shears] = context.carriers(self.enabled);
        let (parts, change_table) = self.changes(context);
        let translation = |list, count, table| List { list, count, table, bounds: None };
        let parameter = |list, count, step, range, rule| {
            let bounds = Some(Bounds { step: parameter_step(step), range, rule });
            List { list, count, table: self.parameter_table, bounds }
        };
        let (angles, scaled, sheared) = (-4 * ONE..=4 * ONE, 1 - ONE..=7 * ONE, -8 * ONE..=8 * ONE);
        let (r, s, h) = (self.rotation_step, self.scale_step, self.shear_step);
        [
            translation(ValueList::TranslationChange, parts, change_table),
            translation(ValueList::Translation, context.node_count, self.translation_table),
            parameter(ValueList::Rotation, rotations, r, angles, rule::MOTION_ROTATION_RANGE),
            parameter(ValueList::Scale, scales, s, scaled, rule::MOTION_SCALE_RANGE),
            parameter(ValueList::Shear, shears, h, sheared, rule::MOTION_SHEAR_RANGE),
        ]
    }

    /// The number of changes in the frame, and their Huffman table.
    fn changes(&self, context: &MotionContext) -> (u32, u8) {
        match (self.translation_mode, context.previous_table) {
            (TranslationMode::SpatioTemporal, Some(table)) => (context.part_count, table),
            _ => (0, 0),
        }
    }

    /// Writes the frame; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter, context: &MotionContext) {
        self.header.write(bits);
        // reference_mode.
        bits.u(0, 2);
        self.entropy_mode.write(bits);
        // residual_present.
        bits.flag(false);
        bits.u(self.translation_mode as u64, 2);
        bits.flag(self.enabled.rotation);
        bits.flag(self.enabled.scale);
        bits.flag(self.enabled.shear);
        bits.u(u64::from(self.translation_step), 6);
        bits.u(u64::from(self.translation_table), 6);
        let parameters = [
            (&self.rotation, self.rotation_step),
            (&self.scale, self.scale_step),
            (&self.shear, self.shear_step),
        ];
        let sent = parameters.iter().filter(|(list, _)| !list.is_empty());
        sent.clone().for_each(|&(_, step)| bits.u(u64::from(step), 6));
        if sent.count() > 0 {
            bits.u(u64::from(self.parameter_table), 6);
        }
        self.entropy_mode.write_lists(
            bits,
            &self.lists(context),
            [&self.translation_change, &self.translation, &self.rotation, &self.scale, &self.shear],
        );
    }
}

fn read_table(bits: &mut BitReader<'_, '_>, name: &'static str) -> Result<u8, Error> {
    let table = bits.u8(name, 6)?;
    bits.require(table < TABLE_COUNT, rule::MOTION_TABLE_RANGE)?;
    Ok(table)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn triples(limit: i32, count: u32) -> impl Strategy<Value = Vec<[i32; 3]>> {
        prop::collection::vec(prop::array::uniform3(-limit..=limit), count as usize)
    }

    fn components() -> impl Strategy<Value = Combination> {
        any::<[bool; 3]>().prop_map(|[rotation, scale, shear]| Combination {
            rotation,
            scale,
            shear,
        })
    }

    prop_compose! {
        fn context()(
            node_count in 1..30_u32,
            affine in 0..30_u32,
            parts in 1..9_u32,
            previous_table in prop::option::of(0..TABLE_COUNT),
        ) -> MotionContext {
            let (affine_count, part_count) = (affine.min(node_count), parts.min(node_count));
            MotionContext { node_count, affine_count, part_count, previous_table }
        }
    }

    /// Modes that a frame may have in this place.
    fn modes(context: &MotionContext) -> Vec<TranslationMode> {
        let mut modes = vec![TranslationMode::Direct, TranslationMode::Spatial];
        modes.extend(context.previous_table.map(|_| TranslationMode::SpatioTemporal));
        modes
    }

    fn motion() -> impl Strategy<Value = (MotionContext, MotionFrame)> {
        let context = context()
            .prop_flat_map(|context| (Just(context), prop::sample::select(modes(&context))));
        (context, components()).prop_flat_map(|((context, translation_mode), enabled)| {
            let enabled = if context.affine_count > 0 { enabled } else { Combination::default() };
            let [rotations, scales, shears] = context.carriers(enabled);
            let temporal = translation_mode == TranslationMode::SpatioTemporal;
            let lists = (
                triples(1 << 12, if temporal { context.part_count } else { 0 }),
                triples(1 << 19, context.node_count),
                triples(900, rotations),
                triples(200, scales),
                triples(900, shears),
            );
            let tables = (0..TABLE_COUNT, 0..TABLE_COUNT);
            (lists, tables, 0..30_u8).prop_map(move |(lists, tables, step)| {
                let any = |count| if count > 0 { step } else { 0 };
                let table = if rotations + scales + shears > 0 { tables.1 } else { 0 };
                let frame = MotionFrame {
                    header: FrameHeader { name: String::new(), positions_digest: Some(7) },
                    entropy_mode: EntropyMode::Huffman,
                    translation_mode,
                    enabled,
                    translation_step: step,
                    translation_table: tables.0,
                    rotation_step: any(rotations),
                    scale_step: any(scales),
                    shear_step: any(shears),
                    parameter_table: table,
                    translation_change: lists.0,
                    translation: lists.1,
                    rotation: lists.2,
                    scale: lists.3,
                    shear: lists.4,
                };
                (context, frame)
            })
        })
    }

    fn read(bytes: &[u8], context: &MotionContext) -> Result<MotionFrame, Error> {
        let mut frame = MotionFrame::default();
        let mut bits = BitReader::new(bytes);
        frame.read(&mut bits, context)?;
        bits.finish()?;
        Ok(frame)
    }

    fn written(frame: &MotionFrame, context: &MotionContext) -> Vec<u8> {
        let mut bits = BitWriter::new();
        frame.write(&mut bits, context);
        bits.into_bytes()
    }

    proptest! {
        #[test]
        fn reads_what_it_writes((context, frame) in motion()) {
            let fits = |list: &[[i32; 3]], low: i64, high: i64| {
                let step = parameter_step(frame.rotation_step.max(frame.scale_step).max(frame.shear_step));
                list.as_flattened().iter().all(|&q| (low..=high).contains(&(i64::from(q) * step)))
            };
            prop_assume!(fits(&frame.rotation, -4 * ONE, 4 * ONE));
            prop_assume!(fits(&frame.scale, 1 - ONE, 7 * ONE));
            prop_assume!(fits(&frame.shear, -8 * ONE, 8 * ONE));
            prop_assert_eq!(read(&written(&frame, &context), &context), Ok(frame));
        }
    }

    #[test]
    fn a_reused_frame_forgets_the_last_one() {
        let one = MotionContext { node_count: 1, ..MotionContext::default() };
        let three = MotionContext { node_count: 3, ..MotionContext::default() };
        let still = |count| MotionFrame {
            translation: vec![[0; 3]; count],
            rotation: vec![[0; 3]; count],
            ..MotionFrame::default()
        };
        let mut frame = MotionFrame::default();
        for (context, count) in [(three, 3), (one, 1)] {
            let bytes = written(&still(count), &context);
            frame.read(&mut BitReader::new(&bytes), &context).expect("sound");
            assert_eq!(frame, still(count));
        }
    }

    #[test]
    fn a_scale_never_reflects() {
        let context = MotionContext { node_count: 1, affine_count: 1, ..MotionContext::default() };
        let frame = |q| MotionFrame {
            enabled: Combination { scale: true, ..Combination::default() },
            scale_step: 40, // 2^12 units of 2^-16: q = -16 takes the scale to zero.
            translation: vec![[0; 3]],
            scale: vec![[q, 0, 0]],
            ..MotionFrame::default()
        };
        assert!(read(&written(&frame(-15), &context), &context).is_ok());
        let error = read(&written(&frame(-16), &context), &context).expect_err("a flat node");
        assert_eq!(error.rule(), Some(rule::MOTION_SCALE_RANGE));
    }

    #[test]
    fn rigid_nodes_enable_nothing() {
        let context = MotionContext { node_count: 1, ..MotionContext::default() };
        let frame = MotionFrame {
            enabled: Combination { shear: true, ..Combination::default() },
            translation: vec![[0; 3]],
            rotation: vec![[0; 3]],
            ..MotionFrame::default()
        };
        let error = read(&written(&frame, &context), &context).expect_err("nothing to shear");
        assert_eq!(error.rule(), Some(rule::MOTION_ENABLED_AFFINE));
    }

    #[test]
    fn the_first_frame_has_no_frame_before_it() {
        let context = MotionContext { node_count: 1, part_count: 1, ..MotionContext::default() };
        let frame = MotionFrame {
            translation_mode: TranslationMode::SpatioTemporal,
            translation: vec![[0; 3]],
            rotation: vec![[0; 3]],
            ..MotionFrame::default()
        };
        let error =
            read(&written(&frame, &context), &context).expect_err("nothing to predict from");
        assert_eq!(error.rule(), Some(rule::MOTION_TRANSLATION_FIRST));
    }

    #[test]
    fn steps_rise_by_quarter_octaves() {
        assert_eq!([0, 4, 8, 13, 63].map(translation_step), [1, 2, 4, 10, 57_344]);
        assert_eq!([0, 1, 4, 63].map(parameter_step), [4, 5, 8, 229_376]);
    }
}
