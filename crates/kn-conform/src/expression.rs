//! Expressions of the syntax tables (1.3).

use std::fmt;

use crate::syntax::split_indices;

/// An expression over names and numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expression {
    Number(i128),
    Name(Variable),
    /// `more_data()`, `position()`, `min(a, b)`, `P(s)`.
    Function(String, Vec<Expression>),
    Binary(&'static str, Box<Expression>, Box<Expression>),
}

/// A name with the counters that index it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) indices: Vec<String>,
}

impl Variable {
    pub(crate) fn parse(text: &str) -> Self {
        let (name, indices) = split_indices(text);
        Self { name: name.to_owned(), indices: indices.map(str::to_owned).collect() }
    }

    /// Derived values are kept by their indices; of an element the one read last is kept.
    pub(crate) fn is_kept_by_index(&self) -> bool {
        !self.indices.is_empty() && self.name.starts_with(|c: char| c.is_ascii_uppercase())
    }
}

impl fmt::Display for Variable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)?;
        self.indices.iter().try_for_each(|index| write!(f, "[{index}]"))
    }
}

impl fmt::Display for Expression {
    /// As in a table; parentheses that only repeat the precedence are left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Name(variable) => write!(f, "{variable}"),
            Self::Function(name, arguments) => {
                let arguments: Vec<_> = arguments.iter().map(Self::to_string).collect();
                write!(f, "{name}({})", arguments.join(", "))
            }
            Self::Binary(operator, left, right) => write!(f, "{left} {operator} {right}"),
        }
    }
}

impl Expression {
    /// The expression that the whole text is, `None` where it is none.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let tokens = tokenise(text)?;
        let mut rest = tokens.as_slice();
        let expression = parse_level(&mut rest, 0)?;
        rest.is_empty().then_some(expression)
    }
}

/// Operators from the loosest to the tightest; those of one row bind alike, from left to right.
const OPERATORS: [&[&str]; 6] =
    [&["||"], &["&&"], &["==", "!=", ">=", "<=", ">", "<"], &["<<"], &["+", "-"], &["*", "/"]];

fn tokenise(text: &str) -> Option<Vec<&str>> {
    let symbols = OPERATORS.concat();
    let symbols = symbols.iter().chain(&["(", ")", ","]);
    let is_word = |c: char| c.is_ascii_alphanumeric() || "_[]".contains(c);
    let mut tokens = Vec::new();
    let mut rest = text.trim();
    while let Some(first) = rest.chars().next() {
        let length = if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            let found = symbols.clone().filter(|symbol| rest.starts_with(**symbol));
            found.map(|symbol| symbol.len()).max()?
        };
        let (token, after) = rest.split_at(length);
        tokens.push(token);
        rest = after.trim_start();
    }
    Some(tokens)
}

fn parse_level(tokens: &mut &[&str], level: usize) -> Option<Expression> {
    let Some(operators) = OPERATORS.get(level) else { return parse_atom(tokens) };
    let mut left = parse_level(tokens, level + 1)?;
    while let Some(operator) = tokens.first().and_then(|t| operators.iter().find(|o| *o == t)) {
        *tokens = &tokens[1..];
        let right = parse_level(tokens, level + 1)?;
        left = Expression::Binary(operator, Box::new(left), Box::new(right));
    }
    Some(left)
}

fn parse_atom(tokens: &mut &[&str]) -> Option<Expression> {
    let (first, rest) = tokens.split_first()?;
    *tokens = rest;
    if *first == "(" {
        let inner = parse_level(tokens, 0)?;
        *tokens = tokens.strip_prefix(&[")"])?;
        return Some(inner);
    }
    if *first == "-" {
        let of = parse_atom(tokens)?;
        return Some(Expression::Binary("-", Box::new(Expression::Number(0)), Box::new(of)));
    }
    if let Some(digits) = first.strip_prefix("0x") {
        return i128::from_str_radix(digits, 16).ok().map(Expression::Number);
    }
    if first.starts_with(|c: char| c.is_ascii_digit()) {
        return first.parse().ok().map(Expression::Number);
    }
    if let Some(rest) = tokens.strip_prefix(&["("]) {
        *tokens = rest;
        return Some(Expression::Function((*first).to_owned(), parse_arguments(tokens)?));
    }
    let is_name = first.starts_with(|c: char| c.is_ascii_alphabetic());
    is_name.then(|| Expression::Name(Variable::parse(first)))
}

/// The arguments of a function up to its closing parenthesis.
fn parse_arguments(tokens: &mut &[&str]) -> Option<Vec<Expression>> {
    let mut arguments = Vec::new();
    loop {
        if let Some(rest) = tokens.strip_prefix(&[")"]) {
            *tokens = rest;
            return Some(arguments);
        }
        if !arguments.is_empty() {
            *tokens = tokens.strip_prefix(&[","])?;
        }
        arguments.push(parse_level(tokens, 0)?);
    }
}

/// The value of an operation; `None` where it has none.
pub(crate) fn apply(operator: &str, left: i128, right: i128) -> Option<i128> {
    Some(match operator {
        "||" => i128::from(left != 0 || right != 0),
        "&&" => i128::from(left != 0 && right != 0),
        "==" => i128::from(left == right),
        "!=" => i128::from(left != right),
        ">=" => i128::from(left >= right),
        "<=" => i128::from(left <= right),
        ">" => i128::from(left > right),
        "<" => i128::from(left < right),
        "<<" => left.checked_shl(u32::try_from(right).ok()?)?,
        "+" => left.checked_add(right)?,
        "-" => left.checked_sub(right)?,
        "*" => left.checked_mul(right)?,
        _ => left.checked_div(right)?,
    })
}

/// The value of a function that depends on its arguments alone; `None` for another.
pub(crate) fn call(name: &str, arguments: &[i128]) -> Option<i128> {
    match (name, arguments) {
        ("min", &[a, b]) => Some(a.min(b)),
        // 7.2
        ("P", &[s]) => apply("<<", 4 + s % 4, s / 4),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Option<i128> {
        fn of(expression: &Expression) -> Option<i128> {
            match expression {
                Expression::Number(value) => Some(*value),
                Expression::Name(_) => None,
                Expression::Function(name, arguments) => {
                    call(name, &arguments.iter().map(of).collect::<Option<Vec<_>>>()?)
                }
                Expression::Binary(operator, left, right) => apply(operator, of(left)?, of(right)?),
            }
        }
        of(&Expression::parse(text)?)
    }

    #[test]
    fn operators_bind_as_in_c() {
        assert_eq!(value("1 + 2 * 3 - 8 / 4"), Some(5));
        assert_eq!(value("1 << 2 + 1 <= 8 && 3 > 2"), Some(1));
        assert_eq!(value("-(4 << 16) + min(7, 2)"), Some(2 - (4 << 16)));
        assert_eq!(value("0x1f == 31"), Some(1));
        assert_eq!([0, 1, 4, 63].map(|s| value(&format!("P({s})"))), [4, 5, 8, 229_376].map(Some));
    }

    #[test]
    fn what_is_no_expression_is_refused() {
        for text in ["", "1 +", "(1", "min(1 2)", "1 2", "a ? b"] {
            assert_eq!(Expression::parse(text), None, "{text}");
        }
    }
}
