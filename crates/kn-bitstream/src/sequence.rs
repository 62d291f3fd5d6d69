//! The sequence header: parameters of the whole file (chapter 3.3).

use crate::error::Error;
use crate::level::Level;
use crate::params::{
    FileNames, FrameRate, InfluenceMode, LabelSet, UnitOfLength, UpAxis, WeightScheme, name_text,
};
use crate::reader::BitReader;
use crate::rule;
use crate::writer::BitWriter;

/// The version of the syntax that this crate reads and writes.
pub const VERSION: u8 = 0;
/// The Huffman profile.
pub const PROFILE_MAIN: u8 = 0;

/// The sequence header: parameters of the whole file.
#[derive(Clone, Debug, PartialEq)]
pub struct SequenceHeader {
    /// Number of the level whose limits the stream keeps.
    pub level: u8,
    /// Frames per second.
    pub frame_rate: FrameRate,
    /// The axis that points up.
    pub up_axis: UpAxis,
    /// Unit of world coordinates.
    pub unit_of_length: UnitOfLength,
    /// Fractional bits of a reference position, 0 to 8.
    pub fraction_bits: u8,
    /// Largest number of frames of a GoF.
    pub max_group_length: u8,
    /// Q: number of nodes that influence a vertex, 1 to 8.
    pub nodes_per_vertex: u8,
    /// Weights of the nodes by their distance from the vertex.
    pub weight_scheme: WeightScheme,
    /// Influence in a region without nodes.
    pub influence_mode: InfluenceMode,
    /// Labels of the vertices, and their regions.
    pub labels: LabelSet,
    /// World position of the grid's origin.
    pub grid_origin: [f64; 3],
    /// World distance between neighbouring grid points.
    pub grid_step: f64,
    /// Names of the input files, where they follow a pattern.
    pub names: Option<FileNames>,
}

impl SequenceHeader {
    /// The limits of the stream's level.
    pub fn limits(&self) -> Option<Level> {
        Level::numbered(self.level)
    }

    /// Reads the header from a unit's payload; the caller calls [`BitReader::finish`].
    pub fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        let version = bits.u8("version", 8)?;
        bits.require_supported(version == VERSION, rule::HEADER_VERSION_VALUE)?;
        let profile = bits.u8("profile", 8)?;
        bits.require_supported(profile == PROFILE_MAIN, rule::HEADER_PROFILE_KNOWN)?;
        let level = bits.u8("level", 8)?;
        let limits = Level::numbered(level);
        let limits = limits.ok_or(Error::unsupported(rule::HEADER_LEVEL_KNOWN, bits.position()))?;
        let numerator = bits.uleb("frame_rate_numerator")?;
        bits.require(numerator > 0, rule::HEADER_RATE_RANGE)?;
        let denominator = bits.uleb("frame_rate_denominator")?;
        bits.require(denominator > 0, rule::HEADER_RATE_RANGE)?;
        let up_axis = UpAxis::read(bits)?;
        let unit_of_length = UnitOfLength::read(bits)?;
        let fraction_bits = bits.u8("fraction_bits", 4)?;
        bits.require(fraction_bits <= 8, rule::HEADER_FRACTION_RANGE)?;
        let max_group_length = bits.u8("max_group_length", 8)?;
        let in_range = (1..=limits.max_group_frames).contains(&u32::from(max_group_length));
        bits.require(in_range, rule::HEADER_GROUP_RANGE)?;
        let nodes_per_vertex = bits.u8("nodes_per_vertex", 4)?;
        bits.require((1..=8).contains(&nodes_per_vertex), rule::HEADER_NODES_RANGE)?;
        let weight_scheme = WeightScheme::read(bits)?;
        let influence_mode = InfluenceMode::read(bits)?;
        let label_set = bits.u8("label_set", 2)?;
        bits.require_supported(label_set < 3, rule::HEADER_LABELS_KNOWN)?;
        let names_present = bits.flag("names_present")?;
        let reserved = bits.u8("reserved_zero", 4)?;
        bits.require_supported(reserved == 0, rule::HEADER_RESERVED_ZERO)?;
        let mut grid_origin = [0.0; 3];
        for axis in 0..3 {
            grid_origin[axis] = bits.f64(("grid_origin", axis as u32))?;
            bits.require(grid_origin[axis].is_finite(), rule::HEADER_ORIGIN_FINITE)?;
        }
        let grid_step = bits.f64("grid_step")?;
        let positive = grid_step.is_finite() && grid_step > 0.0;
        bits.require(positive, rule::HEADER_STEP_POSITIVE)?;
        let labels = LabelSet::read(bits, label_set)?;
        let names = if names_present { Some(FileNames::read(bits)?) } else { None };
        Ok(Self {
            level,
            frame_rate: FrameRate { numerator, denominator },
            up_axis,
            unit_of_length,
            fraction_bits,
            max_group_length,
            nodes_per_vertex,
            weight_scheme,
            influence_mode,
            labels,
            grid_origin,
            grid_step,
            names,
        })
    }

    /// Writes the header; the mirror of [`Self::read`].
    pub fn write(&self, bits: &mut BitWriter) {
        bits.u(u64::from(VERSION), 8);
        bits.u(u64::from(PROFILE_MAIN), 8);
        bits.u(u64::from(self.level), 8);
        bits.uleb(self.frame_rate.numerator);
        bits.uleb(self.frame_rate.denominator);
        bits.u(self.up_axis as u64, 2);
        bits.u(self.unit_of_length as u64, 4);
        bits.u(u64::from(self.fraction_bits), 4);
        bits.u(u64::from(self.max_group_length), 8);
        bits.u(u64::from(self.nodes_per_vertex), 4);
        bits.u(self.weight_scheme as u64, 2);
        bits.u(self.influence_mode as u64, 1);
        bits.u(self.labels.code(), 2);
        bits.flag(self.names.is_some());
        bits.u(0, 4);
        self.grid_origin.iter().for_each(|&origin| bits.f64(origin));
        bits.f64(self.grid_step);
        self.labels.write(bits);
        if let Some(names) = &self.names {
            names.write(bits);
        }
    }
}

impl UpAxis {
    fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        Ok(match bits.u("up_axis", 2)? {
            0 => Self::X,
            1 => Self::Y,
            2 => Self::Z,
            _ => return Err(Error::malformed(rule::HEADER_AXIS_RANGE, bits.position())),
        })
    }
}

impl UnitOfLength {
    fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        Ok(match bits.u("unit_of_length", 4)? {
            0 => Self::Unspecified,
            1 => Self::Metre,
            2 => Self::Centimetre,
            3 => Self::Millimetre,
            4 => Self::Inch,
            5 => Self::Foot,
            _ => return Err(Error::unsupported(rule::HEADER_LENGTH_KNOWN, bits.position())),
        })
    }
}

impl WeightScheme {
    fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        Ok(match bits.u("weight_scheme", 2)? {
            0 => Self::InverseSquare,
            1 => Self::Sumner,
            2 => Self::Gaussian,
            _ => return Err(Error::unsupported(rule::HEADER_WEIGHT_KNOWN, bits.position())),
        })
    }
}

impl InfluenceMode {
    fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        Ok(if bits.flag("influence_mode")? { Self::Fallback } else { Self::Strict })
    }
}

impl LabelSet {
    fn code(&self) -> u64 {
        match self {
            Self::None => 0,
            Self::Body => 1,
            Self::Custom(_) => 2,
        }
    }

    fn read(bits: &mut BitReader<'_, '_>, label_set: u8) -> Result<Self, Error> {
        match label_set {
            0 => return Ok(Self::None),
            1 => return Ok(Self::Body),
            _ => {}
        }
        let label_count = bits.u8("label_count", 8)?;
        bits.require((1..=64).contains(&label_count), rule::HEADER_LABELS_COUNT)?;
        let mut regions = Vec::with_capacity(usize::from(label_count));
        for label in 0..label_count {
            let region = bits.u8(("label_region", u32::from(label)), 8)?;
            bits.require(region < 64, rule::HEADER_LABELS_REGION)?;
            regions.push(region);
        }
        Ok(Self::Custom(regions))
    }

    fn write(&self, bits: &mut BitWriter) {
        if let Self::Custom(regions) = self {
            bits.u(regions.len() as u64, 8);
            bits.bytes(regions);
        }
    }
}

impl FileNames {
    fn read(bits: &mut BitReader<'_, '_>) -> Result<Self, Error> {
        let length = bits.u("name_prefix_length", 8)? as u32;
        let prefix = bits.bytes("name_prefix", length)?;
        let prefix = name_text(prefix);
        let prefix = prefix.ok_or(Error::malformed(rule::NAME_CHARACTERS, bits.position()))?;
        let digits = bits.u8("name_digits", 8)?;
        bits.require(digits <= 9, rule::HEADER_NAMES_DIGITS)?;
        let first = bits.uleb("name_first")?;
        Ok(Self { prefix: prefix.to_owned(), digits, first })
    }

    fn write(&self, bits: &mut BitWriter) {
        bits.u(self.prefix.len() as u64, 8);
        bits.bytes(self.prefix.as_bytes());
        bits.u(u64::from(self.digits), 8);
        bits.uleb(self.first);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::error::ErrorKind;

    pub(crate) fn example() -> SequenceHeader {
        SequenceHeader {
            level: 1,
            frame_rate: FrameRate::new(30_000, 1001),
            up_axis: UpAxis::Y,
            unit_of_length: UnitOfLength::Metre,
            fraction_bits: 8,
            max_group_length: 8,
            nodes_per_vertex: 4,
            weight_scheme: WeightScheme::Gaussian,
            influence_mode: InfluenceMode::Fallback,
            labels: LabelSet::Custom(vec![0, 3, 63]),
            grid_origin: [-1.5, 0.0, 1e-3],
            grid_step: 0.001,
            names: Some(FileNames { prefix: "scan_".into(), digits: 4, first: 17 }),
        }
    }

    fn written(header: &SequenceHeader) -> Vec<u8> {
        let mut bits = BitWriter::new();
        header.write(&mut bits);
        bits.into_bytes()
    }

    fn read(bytes: &[u8]) -> Result<SequenceHeader, Error> {
        let mut bits = BitReader::new(bytes);
        let header = SequenceHeader::read(&mut bits)?;
        bits.finish()?;
        Ok(header)
    }

    #[test]
    fn reads_what_it_writes() {
        let plain = SequenceHeader { labels: LabelSet::Body, names: None, ..example() };
        for header in [example(), plain] {
            assert_eq!(read(&written(&header)), Ok(header));
        }
    }

    #[test]
    fn breaking_a_rule_is_refused_by_that_rule() {
        let broken = |change: fn(&mut SequenceHeader)| {
            let mut header = example();
            change(&mut header);
            read(&written(&header)).expect_err("it is broken").rule()
        };
        assert_eq!(broken(|h| h.level = 3), Some(rule::HEADER_LEVEL_KNOWN));
        assert_eq!(broken(|h| h.frame_rate.denominator = 0), Some(rule::HEADER_RATE_RANGE));
        assert_eq!(broken(|h| h.fraction_bits = 9), Some(rule::HEADER_FRACTION_RANGE));
        assert_eq!(broken(|h| h.max_group_length = 0), Some(rule::HEADER_GROUP_RANGE));
        assert_eq!(broken(|h| h.nodes_per_vertex = 9), Some(rule::HEADER_NODES_RANGE));
        assert_eq!(broken(|h| h.grid_origin[2] = f64::NAN), Some(rule::HEADER_ORIGIN_FINITE));
        assert_eq!(broken(|h| h.grid_step = 0.0), Some(rule::HEADER_STEP_POSITIVE));
        let custom = |regions: &[u8]| {
            let labels = LabelSet::Custom(regions.to_vec());
            read(&written(&SequenceHeader { labels, ..example() })).expect_err("broken").rule()
        };
        assert_eq!(custom(&[]), Some(rule::HEADER_LABELS_COUNT));
        assert_eq!(custom(&[64]), Some(rule::HEADER_LABELS_REGION));
    }

    #[test]
    fn there_is_no_fourth_axis() {
        let mut bytes = written(&example());
        // Version, profile, level, and the frame rate in three and two bytes come before the axis.
        bytes[8] |= 0xc0;
        assert_eq!(read(&bytes).expect_err("broken").rule(), Some(rule::HEADER_AXIS_RANGE));
    }

    #[test]
    fn a_name_cannot_leave_its_folder() {
        for prefix in ["../up", "c:", "a\\b", "bell\u{7}"] {
            let names = Some(FileNames { prefix: prefix.into(), digits: 0, first: 0 });
            let error = read(&written(&SequenceHeader { names, ..example() }));
            let kind = error.expect_err("not a name").kind;
            assert_eq!(kind, ErrorKind::Malformed { rule: rule::NAME_CHARACTERS });
        }
    }

    #[test]
    fn frames_are_named_by_the_pattern() {
        let names = FileNames { prefix: "dancer_".into(), digits: 5, first: 98 };
        assert_eq!(names.of_frame(2), "dancer_00100");
    }
}
