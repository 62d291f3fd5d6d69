//! Assembling of streams from text by the syntax tables, and the text of a stream.
//!
//! A text has lines `name = values` in the order of the syntax. A line gives one element or the
//! next ones of an array (`translation = 1 0 -2 0*12`). Sizes, the signature, reserved bits, the
//! CRC and the index may be left out: then their correct values are written. `value as x8500`
//! writes other bits than the value's own. `pad = 0 as 0b1` at the end of a structure puts bits
//! after it. `@append x00`, `@cut 3` (bytes) and `@flip 70` (a bit) change the stream after it is
//! done. `#` begins a comment.

use std::collections::VecDeque;

use crate::bits::{BitSink, crc32};
use crate::huffman::Codes;
use crate::interpret::{Elements, OpenUnit, Place};
use crate::syntax::{Descriptor, split_indices};
use crate::value::{Failure, TraceLine, Value, parse_hex};

/// Values that a line still has to give.
struct Line {
    number: usize,
    name: String,
    values: VecDeque<Given>,
}

/// A value, and the bits to write for it where they are not its own.
#[derive(Clone)]
struct Given {
    value: Value,
    bits: Option<Vec<bool>>,
}

/// A change of the stream after it is assembled.
enum Change {
    Append(Vec<u8>),
    Cut(usize),
    Flip(usize),
}

/// Gives elements from the lines of a text and writes them.
pub(crate) struct TextElements<'c> {
    lines: VecDeque<Line>,
    changes: Vec<Change>,
    codes: &'c Codes,
    sink: BitSink,
    unit_start: u64,
    /// Place of `unit_size`, if it was left out.
    size_at: Option<usize>,
    /// Place of `intra_size`, if it was left out.
    intra_size_at: Option<usize>,
    /// Place of `index_size`, if it was left out.
    index_size_at: Option<usize>,
    /// Start and number of frames of every GoF so far.
    groups: Vec<(u64, u64)>,
}

impl<'c> TextElements<'c> {
    pub(crate) fn new(text: &str, codes: &'c Codes) -> Result<Self, Failure> {
        let mut elements = Self {
            lines: VecDeque::new(),
            changes: Vec::new(),
            codes,
            sink: BitSink::default(),
            unit_start: 0,
            size_at: None,
            intra_size_at: None,
            index_size_at: None,
            groups: Vec::new(),
        };
        for (number, line) in (1..).zip(text.lines()) {
            let line = line.split('#').next().unwrap_or("").trim();
            if line.starts_with('@') {
                let change = parse_change(line);
                elements.changes.push(change.ok_or_else(|| bad_line(number, line))?);
            } else if !line.is_empty() {
                let parsed = parse_line(number, line);
                elements.lines.push_back(parsed.ok_or_else(|| bad_line(number, line))?);
            }
        }
        Ok(elements)
    }

    /// The stream, once the tables have been walked.
    pub(crate) fn finish(self) -> Result<Vec<u8>, Failure> {
        if let Some(line) = self.lines.front() {
            let reason = format!("line {}: {} does not belong here", line.number, line.name);
            return Err(Failure::new(self.sink.position(), reason));
        }
        let mut bytes = self.sink.as_bytes().to_vec();
        for change in self.changes {
            match change {
                Change::Append(more) => bytes.extend_from_slice(&more),
                Change::Cut(count) => bytes.truncate(bytes.len().saturating_sub(count)),
                Change::Flip(bit) => {
                    if let Some(byte) = bytes.get_mut(bit / 8) {
                        *byte ^= 0x80 >> (bit % 8);
                    }
                }
            }
        }
        Ok(bytes)
    }

    /// The text's value for an element, `None` where it was left out.
    fn given(&mut self, name: &str) -> Option<Given> {
        let line = self.lines.front_mut().filter(|line| line.name == name)?;
        let given = line.values.pop_front();
        if line.values.is_empty() {
            self.lines.pop_front();
        }
        given
    }

    /// The value of an element that was left out.
    fn automatic(&mut self, name: &str) -> Option<Value> {
        let next_bytes = |element: &str| {
            let mut of_unit = self.lines.iter().take_while(|line| line.name != "unit_type");
            let line = of_unit.find(|line| line.name == element)?;
            let Value::Bytes(bytes) = &line.values.front()?.value else { return None };
            Some(Value::Integer(bytes.len() as i64))
        };
        match name {
            "file_signature" => Some(Value::Word(0x8B4B_4E4D_0D0A_1A0A)),
            "reserved_zero" => Some(Value::Integer(0)),
            "unit_size" => {
                self.size_at = Some((self.sink.position() / 8) as usize);
                Some(Value::Integer(0))
            }
            "unit_crc" => {
                let unit = &self.sink.as_bytes()[(self.unit_start / 8) as usize..];
                Some(Value::Word(u64::from(crc32(unit))))
            }
            "index_size" => {
                self.index_size_at = Some((self.sink.position() / 8) as usize);
                Some(Value::Word(0))
            }
            "intra_size" => {
                self.intra_size_at = Some((self.sink.position() / 8) as usize);
                Some(Value::Integer(0))
            }
            "connectivity_size" => next_bytes("connectivity_section"),
            "geometry_size" => next_bytes("geometry_section"),
            "label_size" => next_bytes("label_section"),
            "name_length" => next_bytes("name"),
            "name_prefix_length" => next_bytes("name_prefix"),
            "group_count" => Some(Value::Integer(self.groups.len() as i64)),
            _ => None,
        }
    }

    /// `group_bytes` and `group_frames` that were left out.
    fn automatic_group(&self, place: &Place<'_>) -> Option<Value> {
        let group = *place.indices.first()? as usize;
        let (start, frames) = *self.groups.get(group)?;
        let end = self.groups.get(group + 1).map_or(self.unit_start, |&(start, _)| start);
        match place.name {
            "group_bytes" => Some(Value::Integer(((end - start) / 8) as i64)),
            "group_frames" => Some(Value::Integer(frames as i64)),
            _ => None,
        }
    }

    fn note_unit(&mut self, unit_type: i128) {
        let start = self.unit_start;
        match unit_type {
            2 => self.groups.push((start, 1)),
            4 => {
                if let Some((_, frames)) = self.groups.last_mut() {
                    *frames += 1;
                }
            }
            _ => {}
        }
    }
}

impl Elements for TextElements<'_> {
    fn element(&mut self, place: &Place<'_>) -> Result<Value, Failure> {
        let at = self.sink.position();
        if place.name == "unit_type" {
            self.unit_start = at;
        }
        let given = self.given(place.name);
        let value = match &given {
            Some(given) => given.value.clone(),
            None => {
                let automatic = self.automatic(place.name).or_else(|| self.automatic_group(place));
                automatic.ok_or_else(|| self.missing(place))?
            }
        };
        match given.and_then(|given| given.bits) {
            Some(bits) => bits.iter().for_each(|&bit| self.sink.bit(bit)),
            // The sizes are put in when they are known.
            None if place.name == "unit_size" && self.size_at.is_some() => {}
            None if place.name == "intra_size" && self.intra_size_at.is_some() => {}
            None => write_element(&mut self.sink, self.codes, place, &value)?,
        }
        if place.name == "unit_type" {
            self.note_unit(value.number());
        }
        Ok(value)
    }

    fn more_data(&mut self) -> bool {
        !self.lines.is_empty()
    }

    fn position(&self) -> u64 {
        self.sink.position()
    }

    fn end_structure(&mut self, unit: OpenUnit) -> Result<(), Failure> {
        if let Some(at) = self.intra_size_at.take() {
            let mut uleb = BitSink::default();
            write_uleb(&mut uleb, self.sink.position() / 8 - at as u64);
            self.sink.insert(at, uleb.as_bytes());
        }
        if let Some(bits) = self.given("pad").and_then(|given| given.bits) {
            bits.iter().for_each(|&bit| self.sink.bit(bit));
        }
        self.sink.align();
        let size = (self.sink.position() - unit.start) / 8;
        let mut uleb = BitSink::default();
        if let Some(at) = self.size_at.take() {
            write_uleb(&mut uleb, size);
            self.sink.insert(at, uleb.as_bytes());
        }
        if let Some(at) = self.index_size_at.take() {
            let whole = (self.sink.position() - self.unit_start) / 8 + 4;
            self.sink.replace(at + uleb.as_bytes().len(), &(whole as u32).to_be_bytes());
        }
        Ok(())
    }
}

impl TextElements<'_> {
    fn missing(&self, place: &Place<'_>) -> Failure {
        let found = match self.lines.front() {
            Some(line) => format!("line {}: {} stands", line.number, line.name),
            None => "the text ends".to_owned(),
        };
        let indices: String = place.indices.iter().map(|index| format!("[{index}]")).collect();
        let reason = format!("{found} where {}{indices} belongs", place.name);
        Failure::new(self.sink.position(), reason)
    }
}

/// Writes an element by its descriptor.
pub(crate) fn write_element(
    sink: &mut BitSink,
    codes: &Codes,
    place: &Place<'_>,
    value: &Value,
) -> Result<(), Failure> {
    let at = sink.position();
    let argument = u32::try_from(place.argument).unwrap_or(0);
    let wrong = || Failure::new(at, format!("{} cannot be {value}", place.name));
    let number = value.number();
    let unsigned = u64::try_from(number).map_err(|_| wrong());
    match (place.descriptor, value) {
        (Descriptor::F64, &Value::Float(value)) => sink.bits(value.to_bits(), 64),
        (Descriptor::F64, &Value::Integer(value)) => {
            sink.bits((value as f64).to_bits(), 64);
        }
        (Descriptor::F64, &Value::Word(bits)) => sink.bits(bits, 64),
        (Descriptor::Bytes, Value::Bytes(bytes)) => {
            bytes.iter().for_each(|&byte| sink.bits(u64::from(byte), 8));
        }
        (_, Value::Float(_) | Value::Bytes(_)) | (Descriptor::Bytes, _) => return Err(wrong()),
        (Descriptor::U, _) => sink.bits(unsigned?, argument),
        (Descriptor::Uleb, _) => write_uleb(sink, unsigned?),
        (Descriptor::Rice, _) => write_rice(sink, unsigned?, argument),
        (Descriptor::Srice, _) => {
            let code = if number < 0 { -2 * number - 1 } else { 2 * number };
            write_rice(sink, code as u64, argument);
        }
        (Descriptor::Huffman, _) => {
            let code = codes.code(place.argument).ok_or_else(wrong)?;
            let value = number as i64;
            let (length, bits) = code.of_value(value);
            sink.bits(bits, length);
            if value.abs() > code.max_magnitude {
                write_ue(sink, (value.abs() - code.max_magnitude - 1) as u64, code.escape_order);
                sink.bit(value < 0);
            }
        }
    }
    Ok(())
}

fn write_uleb(sink: &mut BitSink, mut value: u64) {
    while value >= 128 {
        sink.bits(value % 128 + 128, 8);
        value /= 128;
    }
    sink.bits(value, 8);
}

fn write_unary(sink: &mut BitSink, ones: u64) {
    (0..ones).for_each(|_| sink.bit(true));
    sink.bit(false);
}

fn write_rice(sink: &mut BitSink, value: u64, k: u32) {
    write_unary(sink, value >> k);
    sink.bits(value, k);
}

fn write_ue(sink: &mut BitSink, value: u64, k: u32) {
    // The groups of an Exp-Golomb code begin at (2^ones − 1)·2^k.
    let ones = (0..).take_while(|ones| value >= (((2_u64 << ones) - 1) << k)).count();
    write_unary(sink, ones as u64);
    sink.bits(value - (((1 << ones) - 1) << k), ones as u32 + k);
}

fn bad_line(number: usize, line: &str) -> Failure {
    Failure::new(0, format!("line {number}: {line:?} cannot be understood"))
}

fn parse_change(line: &str) -> Option<Change> {
    let (verb, argument) = line.split_once(' ')?;
    let argument = argument.trim();
    match verb {
        "@append" => parse_hex(argument.strip_prefix('x')?).map(Change::Append),
        "@cut" => argument.parse().ok().map(Change::Cut),
        "@flip" => argument.parse().ok().map(Change::Flip),
        _ => None,
    }
}

fn parse_line(number: usize, line: &str) -> Option<Line> {
    let (name, values) = line.split_once('=')?;
    let (name, _) = split_indices(name.trim());
    let values = match values.split_once(" as ") {
        Some((value, bits)) => {
            let value = Value::parse(value.trim())?;
            VecDeque::from([Given { value, bits: Some(parse_bits(bits.trim())?) }])
        }
        None => parse_values(values)?,
    };
    (!values.is_empty()).then(|| Line { number, name: name.to_owned(), values })
}

/// `1 -2 0*9`
fn parse_values(text: &str) -> Option<VecDeque<Given>> {
    let mut values = VecDeque::new();
    for word in text.split_whitespace() {
        let (value, times) = word.split_once('*').unwrap_or((word, "1"));
        let given = Given { value: Value::parse(value)?, bits: None };
        values.extend(std::iter::repeat_n(given, times.parse().ok()?));
    }
    Some(values)
}

/// `x8500` or `0b101`
fn parse_bits(text: &str) -> Option<Vec<bool>> {
    if let Some(digits) = text.strip_prefix("0b") {
        return digits.chars().map(|c| c.to_digit(2).map(|bit| bit == 1)).collect();
    }
    let bytes = parse_hex(text.strip_prefix('x')?)?;
    Some(bytes.iter().flat_map(|byte| (0..8).rev().map(move |i| byte >> i & 1 == 1)).collect())
}

/// The text of a stream: what may be left out is left out, arrays stand on one line.
pub(crate) fn text_of(trace: &[TraceLine]) -> String {
    const LEFT_OUT: [&str; 14] = [
        "file_signature",
        "reserved_zero",
        "unit_size",
        "unit_crc",
        "index_size",
        "intra_size",
        "connectivity_size",
        "geometry_size",
        "label_size",
        "name_length",
        "name_prefix_length",
        "group_count",
        "group_bytes",
        "group_frames",
    ];
    let mut text = String::new();
    let mut last = "";
    for line in trace.iter().filter(|line| !LEFT_OUT.contains(&line.name.as_str())) {
        if line.name == last && !line.indices.is_empty() {
            text.push(' ');
        } else {
            text.push('\n');
            if line.name == "unit_type" {
                text.push('\n');
            }
            text.push_str(&line.name);
            text.push_str(" = ");
        }
        text.push_str(&line.value.to_string());
        last = &line.name;
    }
    text.push('\n');
    text.trim_start().to_owned()
}
