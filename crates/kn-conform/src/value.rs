//! Values of syntax elements, and the trace of a stream.

use kn_bitstream::Rule;
use std::fmt;

/// Value of a syntax element.
#[derive(Clone, Debug)]
pub enum Value {
    /// An integer.
    Integer(i64),
    /// A `u(n)` of 32 bits or more; in hexadecimal.
    Word(u64),
    /// An `f64`.
    Float(f64),
    /// A `bytes(n)`; `x` and hexadecimal digits.
    Bytes(Vec<u8>),
}

impl Value {
    /// The value as a number for conditions and array bounds; 0 for what is none.
    pub(crate) fn number(&self) -> i128 {
        match self {
            Self::Integer(value) => i128::from(*value),
            Self::Word(value) => i128::from(*value),
            Self::Float(_) | Self::Bytes(_) => 0,
        }
    }

    /// Reads a value as it is printed; decimal integers come back as [`Value::Integer`], what has
    /// a point or an exponent as [`Value::Float`].
    pub(crate) fn parse(text: &str) -> Option<Self> {
        if let Some(hex) = text.strip_prefix("0x") {
            return u64::from_str_radix(hex, 16).ok().map(Self::Word);
        }
        if let Some(hex) = text.strip_prefix('x') {
            return parse_hex(hex).map(Self::Bytes);
        }
        let integer = text.parse().ok().map(Self::Integer);
        integer.or_else(|| text.parse().ok().map(Self::Float))
    }
}

impl PartialEq for Value {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Float(a), Self::Float(b)) => a.to_bits() == b.to_bits(),
            (Self::Bytes(a), Self::Bytes(b)) => a == b,
            (Self::Integer(_) | Self::Word(_), Self::Integer(_) | Self::Word(_)) => {
                self.number() == other.number()
            }
            _ => false,
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Word(value) => write!(f, "0x{value:x}"),
            Self::Float(value) if value.is_finite() => write!(f, "{value:?}"),
            Self::Float(value) => write!(f, "0x{:x}", value.to_bits()),
            Self::Bytes(bytes) => {
                f.write_str("x")?;
                bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
            }
        }
    }
}

/// The bytes that pairs of hexadecimal digits stand for.
pub(crate) fn parse_hex(digits: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u32>> = digits.chars().map(|c| c.to_digit(16)).collect();
    let pairs = digits?;
    (pairs.len() % 2 == 0)
        .then(|| pairs.chunks_exact(2).map(|pair| (pair[0] << 4 | pair[1]) as u8).collect())
}

/// One syntax element of a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceLine {
    /// Offset of its first bit.
    pub bit: u64,
    /// Its name without indices.
    pub name: String,
    /// Its indices, outermost first.
    pub indices: Vec<u32>,
    /// Its value.
    pub value: Value,
}

impl From<&kn_bitstream::Element<'_>> for TraceLine {
    fn from(element: &kn_bitstream::Element<'_>) -> Self {
        let value = match element.value {
            kn_bitstream::Value::Unsigned(value) => Value::Integer(value as i64),
            kn_bitstream::Value::Word(value) => Value::Word(value),
            kn_bitstream::Value::Signed(value) => Value::Integer(value),
            kn_bitstream::Value::Float(value) => Value::Float(value),
            kn_bitstream::Value::Bytes(bytes) => Value::Bytes(bytes.to_vec()),
        };
        let name = element.name;
        Self {
            bit: element.bit,
            name: name.text().to_owned(),
            indices: name.indices().to_vec(),
            value,
        }
    }
}

impl fmt::Display for TraceLine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.bit, self.name)?;
        self.indices.iter().try_for_each(|index| write!(f, "[{index}]"))?;
        write!(f, " = {}", self.value)
    }
}

/// The place where a stream or a text cannot be read, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// Bit offset in the stream (for a text: in the stream assembled so far).
    pub bit: u64,
    /// The reason.
    pub reason: String,
    /// The rule that is broken, where the reader knows it.
    pub rule: Option<Rule>,
}

impl Failure {
    pub(crate) fn new(bit: u64, reason: impl Into<String>) -> Self {
        Self { bit, reason: reason.into(), rule: None }
    }

    pub(crate) fn of_rule(bit: u64, rule: Rule, reason: impl Into<String>) -> Self {
        Self { bit, reason: reason.into(), rule: Some(rule) }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "bit {}: {}", self.bit, self.reason)?;
        self.rule.map_or(Ok(()), |rule| write!(f, ": {rule}"))
    }
}

impl std::error::Error for Failure {}
