//! Ranges of the syntax tables (1.3): which values an element or a derived value may have.

use kn_bitstream::Rule;

use crate::expression::Expression;
use crate::value::Value;

/// Values that a table allows, and the rule that another value breaks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Range {
    /// The value is in one of them.
    pub(crate) parts: Vec<Part>,
    pub(crate) rule: Rule,
}

/// A part of a range.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Part {
    /// `low … high`, both included; without `high` there is no upper bound.
    Between(Expression, Option<Expression>),
    /// A bound that is not on a number.
    Word(Word),
}

/// A range in a word, for a value that is a float or a string of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Word {
    Finite,
    Positive,
    Characters,
    Whole,
}

impl Range {
    /// `0 … 5`, `1 …`, `7`, `1 … 5 or 9`, or a word; and the id of the rule.
    pub(crate) fn parse(text: &str, id: &str) -> Result<Self, String> {
        let rule = Rule::with_id(id).ok_or_else(|| format!("there is no rule {id}"))?;
        let parts = text.split(" or ").map(|part| Part::parse(part.trim()));
        let parts = parts.collect::<Option<_>>().ok_or_else(|| format!("{text:?} is no range"))?;
        Ok(Self { parts, rule })
    }
}

impl Part {
    fn parse(text: &str) -> Option<Self> {
        if let Some(word) = Word::parse(text) {
            return Some(Self::Word(word));
        }
        let (low, high) = text.split_once('…').unwrap_or((text, text));
        let high = high.trim();
        let high = if high.is_empty() { None } else { Some(Expression::parse(high)?) };
        Some(Self::Between(Expression::parse(low)?, high))
    }
}

impl Word {
    fn parse(text: &str) -> Option<Self> {
        Some(match text {
            "finite" => Self::Finite,
            "positive" => Self::Positive,
            "characters" => Self::Characters,
            "whole" => Self::Whole,
            _ => return None,
        })
    }

    pub(crate) fn allows(self, value: &Value) -> bool {
        match (self, value) {
            (Self::Finite, Value::Float(value)) => value.is_finite(),
            (Self::Positive, Value::Float(value)) => value.is_finite() && *value > 0.0,
            (Self::Characters, Value::Bytes(bytes)) => is_name(bytes),
            (Self::Whole, Value::Bytes(bytes)) => !matches!(&bytes[..], b"" | b"." | b".."),
            _ => false,
        }
    }
}

/// r[name.characters]
fn is_name(bytes: &[u8]) -> bool {
    let forbidden = |c: char| c.is_control() || matches!(c, '/' | '\\' | ':');
    std::str::from_utf8(bytes).is_ok_and(|name| !name.contains(forbidden))
}
