//! The value rules of chapters 3, 6 and 7, as the text says them, for the second parser.

use kn_bitstream::rule::{self, Rule};

use crate::environment::Environment;
use crate::interpret::Place;
use crate::tables::Table;
use crate::value::{Failure, Value};

/// Refuses a value that the text does not allow. `environment` knows the element already.
pub(crate) fn check(
    environment: &mut Environment,
    levels: &Table,
    place: &Place<'_>,
    value: &Value,
    bit: u64,
) -> Result<(), Failure> {
    let known = Known { environment, levels };
    let broken = known
        .broken_in_header(place, value)
        .or_else(|| known.broken_in_frame(place, value))
        .or_else(|| known.broken_in_motion(place, value.number()))
        .or_else(|| known.broken_in_index(place.name, value.number(), bit))
        .or_else(|| broken_in_nodes(environment, levels, place, value.number()));
    match broken {
        Some(rule) => Err(Failure::of_rule(bit, rule, format!("{} cannot be {value}", place.name))),
        None => Ok(()),
    }
}

/// What was read before.
struct Known<'k> {
    environment: &'k Environment,
    levels: &'k Table,
}

impl Known<'_> {
    fn get(&self, name: &str) -> i128 {
        self.environment.get(name).unwrap_or(0)
    }

    fn broken_in_header(&self, place: &Place<'_>, value: &Value) -> Option<Rule> {
        let v = value.number();
        let finite = |value: &Value| matches!(value, Value::Float(value) if value.is_finite());
        let (holds, rule) = match place.name {
            "file_signature" => (v == 0x8B4B_4E4D_0D0A_1A0A, rule::FILE_SIGNATURE_VALUE),
            "version" => (v == 0, rule::HEADER_VERSION_VALUE),
            "profile" => (v == 0, rule::HEADER_PROFILE_KNOWN),
            "level" => (v < self.levels.rows.len() as i128, rule::HEADER_LEVEL_KNOWN),
            "frame_rate_numerator" | "frame_rate_denominator" => (v >= 1, rule::HEADER_RATE_RANGE),
            "up_axis" => (v <= 2, rule::HEADER_AXIS_RANGE),
            "unit_of_length" => (v <= 5, rule::HEADER_LENGTH_KNOWN),
            "fraction_bits" => (v <= 8, rule::HEADER_FRACTION_RANGE),
            "max_group_length" => {
                let most = limit(self.environment, self.levels, "max_group_frames");
                ((1..=most).contains(&v), rule::HEADER_GROUP_RANGE)
            }
            "nodes_per_vertex" => ((1..=8).contains(&v), rule::HEADER_NODES_RANGE),
            "weight_scheme" => (v <= 2, rule::HEADER_WEIGHT_KNOWN),
            "label_set" => (v <= 2, rule::HEADER_LABELS_KNOWN),
            "reserved_zero" if place.argument == 4 => (v == 0, rule::HEADER_RESERVED_ZERO),
            "grid_origin" => (finite(value), rule::HEADER_ORIGIN_FINITE),
            "grid_step" => {
                let positive = matches!(value, Value::Float(step) if *step > 0.0);
                (finite(value) && positive, rule::HEADER_STEP_POSITIVE)
            }
            "label_count" => ((1..=64).contains(&v), rule::HEADER_LABELS_COUNT),
            "label_region" => (v < 64, rule::HEADER_LABELS_REGION),
            "name_digits" => (v <= 9, rule::HEADER_NAMES_DIGITS),
            _ => return None,
        };
        (!holds).then_some(rule)
    }

    fn broken_in_frame(&self, place: &Place<'_>, value: &Value) -> Option<Rule> {
        let v = value.number();
        let whole = |value: &Value| !matches!(value, Value::Bytes(name) if matches!(&name[..], b"" | b"." | b".."));
        let (holds, rule) = match place.name {
            "reserved_zero" if place.argument == 6 => (v == 0, rule::FRAME_RESERVED_ZERO),
            "smoothing_strength" => (v <= 5, rule::INTRA_SMOOTHING_RANGE),
            "name" | "name_prefix" if !is_name(value) => (false, rule::NAME_CHARACTERS),
            "name" => (whole(value), rule::NAME_WHOLE),
            "unit_size" => {
                let of_level = limit(self.environment, self.levels, "max_unit_bytes");
                let highest = level_limit(self.levels, None, "max_unit_bytes");
                let is_header = self.get("unit_type") == 1;
                (v <= if is_header { highest } else { of_level }, rule::UNIT_SIZE_LIMIT)
            }
            _ => return None,
        };
        (!holds).then_some(rule)
    }

    fn broken_in_motion(&self, place: &Place<'_>, v: i128) -> Option<Rule> {
        // 7.2; angles, scales and shears in units of 2^(−16).
        let step = |name: &str| {
            let s = self.get(name);
            (4 + s % 4) << (s / 4)
        };
        const ONE: i128 = 1 << 16;
        let (holds, rule) = match place.name {
            "reference_mode" => (v == 0, rule::MOTION_REFERENCE_KNOWN),
            "entropy_mode" => (v == 0, rule::MOTION_ENTROPY_KNOWN),
            "residual_present" => (v == 0, rule::MOTION_RESIDUAL_KNOWN),
            "translation_mode" if v == 2 => (!self.is_first(), rule::MOTION_TRANSLATION_FIRST),
            "translation_mode" => (v <= 2, rule::MOTION_TRANSLATION_KNOWN),
            "shear_enabled" => {
                let flags = ["rotation_enabled", "scale_enabled", "shear_enabled"];
                let any = flags.iter().any(|flag| self.get(flag) == 1);
                (!any || self.get("AffineCount") > 0, rule::MOTION_ENABLED_AFFINE)
            }
            "translation_table" | "parameter_table" => (v < 48, rule::MOTION_TABLE_RANGE),
            "rotation" => {
                ((v * step("rotation_step")).abs() <= 4 * ONE, rule::MOTION_ROTATION_RANGE)
            }
            "scale" => {
                let scale = ONE + v * step("scale_step");
                (scale > 0 && scale <= 8 * ONE, rule::MOTION_SCALE_RANGE)
            }
            "shear" => ((v * step("shear_step")).abs() <= 8 * ONE, rule::MOTION_SHEAR_RANGE),
            _ => return None,
        };
        (!holds).then_some(rule)
    }

    /// Whether a P-frame is the first of its GoF; an example says so by what it gives.
    fn is_first(&self) -> bool {
        let known = |name| self.environment.get(name).is_some();
        !known("translation_table") && (known("node_count") || !known("PreviousTable"))
    }

    fn broken_in_index(&self, name: &str, v: i128, bit: u64) -> Option<Rule> {
        let (holds, rule) = match name {
            "group_count" => (v >= 1, rule::INDEX_COUNT_RANGE),
            "group_frames" => {
                ((1..=self.get("max_group_length")).contains(&v), rule::INDEX_FRAMES_RANGE)
            }
            "index_size" => {
                let payload = (i128::from(bit) - self.get("UnitStart")) / 8 + 4;
                let size_bytes = (1..).find(|&n| payload < 1 << (7 * n)).unwrap_or(5);
                (v == 1 + size_bytes + payload + 4, rule::INDEX_SIZE_VALUE)
            }
            _ => return None,
        };
        (!holds).then_some(rule)
    }
}

/// 6.5; sums of gaps and deltas are kept in the environment.
fn broken_in_nodes(
    environment: &mut Environment,
    levels: &Table,
    place: &Place<'_>,
    v: i128,
) -> Option<Rule> {
    const SUMS: [&str; 3] = ["NodeX", "NodeY", "NodeZ"];
    let (holds, rule) = match place.name {
        "node_count" => {
            SUMS.iter().for_each(|sum| environment.set(sum, 0));
            environment.set("NodeVertex", -1);
            let most = limit(environment, levels, "max_nodes");
            ((1..=most).contains(&v), rule::NODES_COUNT_RANGE)
        }
        "weight_sigma" => ((1..1 << 20).contains(&v), rule::NODES_SIGMA_RANGE),
        "node_vertex_gap" => {
            let vertex = environment.get("NodeVertex").unwrap_or(-1) + 1 + v;
            environment.set("NodeVertex", vertex);
            let count = environment.get("VertexCount");
            (count.is_none_or(|count| vertex < count), rule::NODES_VERTEX_RANGE)
        }
        "node_delta" => {
            let sum = SUMS[place.indices.last().map_or(0, |&axis| axis as usize)];
            let coordinate = environment.get(sum).unwrap_or(0) + v;
            environment.set(sum, coordinate);
            (coordinate.abs() < 1 << 20, rule::NODES_POSITION_RANGE)
        }
        _ => return None,
    };
    (!holds).then_some(rule)
}

/// A limit of the stream's level.
fn limit(environment: &Environment, levels: &Table, column: &str) -> i128 {
    level_limit(levels, environment.get("level"), column)
}

/// A limit of a level; the highest level's where it is not known.
pub(crate) fn level_limit(levels: &Table, level: Option<i128>, column: &str) -> i128 {
    let at = levels.columns.iter().position(|name| name == column).unwrap_or(0);
    let row = level.and_then(|level| levels.rows.get(usize::try_from(level).ok()?));
    let row = row.or(levels.rows.last());
    row.map_or(0, |row| i128::from(row[at]))
}

/// r[name.characters]
fn is_name(value: &Value) -> bool {
    let Value::Bytes(bytes) = value else { return false };
    let forbidden = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    std::str::from_utf8(bytes).is_ok_and(|name| !name.contains(forbidden))
}
