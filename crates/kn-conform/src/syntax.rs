//! The syntax tables of chapter 3 as a tree.

use std::collections::BTreeMap;
use std::fmt;

/// All tables by name.
#[derive(Clone, Debug, Default)]
pub struct Syntax {
    tables: BTreeMap<String, Vec<Statement>>,
}

/// A line that is no syntax, with what is wrong.
#[derive(Clone, Debug, thiserror::Error)]
#[error("syntax line {line:?}: {reason}")]
pub struct SyntaxError {
    line: String,
    reason: String,
}

/// One line or block of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Statement {
    /// `name[i][j]  descriptor(argument)`
    Element { name: String, indices: Vec<String>, descriptor: Descriptor, argument: Expression },
    /// `Name = expression`
    Assign(String, Expression),
    /// `if (condition) { … }`
    If(Expression, Vec<Statement>),
    /// `while (condition) { … }`
    While(Expression, Vec<Statement>),
    /// `for (variable = 0; variable < bound; variable++) { … }`
    For(String, Expression, Vec<Statement>),
    /// `name()`
    Call(String),
}

/// Descriptors of chapter 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Descriptor {
    U,
    Uleb,
    F64,
    Bytes,
    Rice,
    Srice,
    Huffman,
}

/// An expression over names and numbers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expression {
    Number(i128),
    Name(String),
    /// A function without arguments: `more_data()`, `position()`.
    Function(String),
    Binary(&'static str, Box<Expression>, Box<Expression>),
}

impl fmt::Display for Expression {
    /// As in a table; parentheses that only repeat the precedence are left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "{value}"),
            Self::Name(name) => f.write_str(name),
            Self::Function(name) => write!(f, "{name}()"),
            Self::Binary(operator, left, right) => write!(f, "{left} {operator} {right}"),
        }
    }
}

impl Syntax {
    /// Adds the tables of one ```` ```syntax ```` block.
    pub fn add(&mut self, block: &str) -> Result<(), SyntaxError> {
        let mut lines = block.lines().map(str::trim).filter(|line| !line.is_empty());
        while let Some(line) = lines.next() {
            let name =
                line.strip_suffix("() {").ok_or_else(|| wrong(line, "no table begins so"))?;
            let body = parse_block(&mut lines)?;
            self.tables.insert(name.to_owned(), body);
        }
        Ok(())
    }

    pub(crate) fn table(&self, name: &str) -> Option<&[Statement]> {
        self.tables.get(name).map(Vec::as_slice)
    }

    /// All conditions, as `table: condition`, by table.
    pub fn conditions(&self) -> Vec<String> {
        fn walk(block: &[Statement], table: &str, conditions: &mut Vec<String>) {
            for statement in block {
                match statement {
                    Statement::If(condition, body) => {
                        conditions.push(format!("{table}: {condition}"));
                        walk(body, table, conditions);
                    }
                    Statement::While(_, body) | Statement::For(_, _, body) => {
                        walk(body, table, conditions);
                    }
                    Statement::Element { .. } | Statement::Assign(..) | Statement::Call(_) => {}
                }
            }
        }
        let mut conditions = Vec::new();
        self.tables.iter().for_each(|(name, body)| walk(body, name, &mut conditions));
        conditions
    }

    /// Names of all tables.
    pub fn table_names(&self) -> impl Iterator<Item = &str> {
        self.tables.keys().map(String::as_str)
    }

    /// Names of all syntax elements, each once, in alphabetical order.
    pub fn element_names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        let mut blocks: Vec<&[Statement]> = self.tables.values().map(Vec::as_slice).collect();
        while let Some(block) = blocks.pop() {
            for statement in block {
                match statement {
                    Statement::Element { name, .. } => names.push(name.as_str()),
                    Statement::If(_, body)
                    | Statement::While(_, body)
                    | Statement::For(_, _, body) => blocks.push(body),
                    Statement::Assign(..) | Statement::Call(_) => {}
                }
            }
        }
        names.sort_unstable();
        names.dedup();
        names
    }
}

fn wrong(line: &str, reason: impl Into<String>) -> SyntaxError {
    SyntaxError { line: line.to_owned(), reason: reason.into() }
}

/// The statements up to the closing brace.
fn parse_block<'a>(
    lines: &mut impl Iterator<Item = &'a str>,
) -> Result<Vec<Statement>, SyntaxError> {
    let mut block = Vec::new();
    while let Some(line) = lines.next() {
        if line == "}" {
            return Ok(block);
        }
        block.push(match line.strip_suffix('{') {
            Some(head) => parse_compound(head.trim(), lines)?,
            None => parse_simple(line)?,
        });
    }
    Err(wrong("", "a brace is not closed"))
}

fn parse_compound<'a>(
    head: &str,
    lines: &mut impl Iterator<Item = &'a str>,
) -> Result<Statement, SyntaxError> {
    let inside = |keyword| {
        let rest: &str = head.strip_prefix(keyword)?.trim().strip_prefix('(')?;
        rest.strip_suffix(')')
    };
    if let Some(condition) = inside("if") {
        Ok(Statement::If(parse_expression(condition)?, parse_block(lines)?))
    } else if let Some(condition) = inside("while") {
        Ok(Statement::While(parse_expression(condition)?, parse_block(lines)?))
    } else if let Some(range) = inside("for") {
        let (variable, bound) = parse_range(range).ok_or_else(|| wrong(head, "not a range"))?;
        Ok(Statement::For(variable.to_owned(), parse_expression(bound)?, parse_block(lines)?))
    } else {
        Err(wrong(head, "neither if, while nor for"))
    }
}

/// `i = 0; i < bound; i++`
fn parse_range(text: &str) -> Option<(&str, &str)> {
    let mut parts = text.split(';').map(str::trim);
    let variable = parts.next()?.strip_suffix("= 0")?.trim();
    let bound = parts.next()?.strip_prefix(variable)?.trim().strip_prefix('<')?;
    let step = parts.next()?.strip_prefix(variable)?;
    (step == "++" && parts.next().is_none()).then_some((variable, bound))
}

fn parse_simple(line: &str) -> Result<Statement, SyntaxError> {
    if let Some((name, value)) = line.split_once(" = ") {
        return Ok(Statement::Assign(name.to_owned(), parse_expression(value)?));
    }
    match line.split_once(char::is_whitespace) {
        None => {
            let call = line.strip_suffix("()").ok_or_else(|| wrong(line, "no descriptor"))?;
            Ok(Statement::Call(call.to_owned()))
        }
        Some((element, descriptor)) => parse_element(element, descriptor.trim()),
    }
}

fn parse_element(element: &str, descriptor: &str) -> Result<Statement, SyntaxError> {
    let (name, indices) = split_indices(element);
    let (kind, argument) = descriptor.split_once('(').unwrap_or((descriptor, ")"));
    let argument = argument.strip_suffix(')').ok_or_else(|| wrong(descriptor, "no )"))?;
    let descriptor = match kind {
        "u" => Descriptor::U,
        "uleb" => Descriptor::Uleb,
        "f64" => Descriptor::F64,
        "bytes" => Descriptor::Bytes,
        "rice" => Descriptor::Rice,
        "srice" => Descriptor::Srice,
        "huffman" => Descriptor::Huffman,
        _ => return Err(wrong(descriptor, "no such descriptor")),
    };
    let argument = if argument.is_empty() { "0" } else { argument };
    let indices = indices.map(str::to_owned).collect();
    let argument = parse_expression(argument)?;
    Ok(Statement::Element { name: name.to_owned(), indices, descriptor, argument })
}

/// `name[i][j]` as `name` and `i`, `j`.
pub(crate) fn split_indices(element: &str) -> (&str, impl Iterator<Item = &str>) {
    let mut parts = element.split('[');
    let name = parts.next().unwrap_or("");
    (name, parts.map(|part| part.trim_end_matches(']')))
}

/// Operators from the loosest to the tightest; those of one row bind alike, from left to right.
const OPERATORS: [&[&str]; 4] =
    [&["||"], &["&&"], &["==", "!=", ">=", "<=", ">", "<"], &["+", "-"]];

fn parse_expression(text: &str) -> Result<Expression, SyntaxError> {
    let tokens = tokenise(text).ok_or_else(|| wrong(text, "not an expression"))?;
    let mut rest = tokens.as_slice();
    let expression = parse_level(&mut rest, 0).ok_or_else(|| wrong(text, "not an expression"))?;
    if rest.is_empty() { Ok(expression) } else { Err(wrong(text, "more than an expression")) }
}

fn tokenise(text: &str) -> Option<Vec<&str>> {
    let mut tokens = Vec::new();
    let mut rest = text.trim();
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let length = if is_word(first) {
            rest.find(|c| !is_word(c)).unwrap_or(rest.len())
        } else {
            let symbols = OPERATORS.concat();
            let symbol =
                symbols.iter().chain(&["(", ")"]).find(|symbol| rest.starts_with(**symbol));
            symbol?.len()
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
    if first.starts_with(|c: char| c.is_ascii_digit()) {
        return first.parse().ok().map(Expression::Number);
    }
    if let Some(rest) = tokens.strip_prefix(&["(", ")"]) {
        *tokens = rest;
        return Some(Expression::Function((*first).to_owned()));
    }
    first.starts_with(|c: char| c.is_ascii_alphabetic()).then(|| Expression::Name((*first).into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_becomes_a_tree() {
        let mut syntax = Syntax::default();
        let block = "t() {\n  count  uleb\n  for (i = 0; i < count + 1; i++) {\n  a[i][j]  huffman(k)\n  }\n  s()\n}";
        syntax.add(block).expect("a table");
        let [Statement::Element { .. }, Statement::For(i, bound, body), Statement::Call(call)] =
            syntax.table("t").expect("there")
        else {
            panic!("{syntax:?}")
        };
        assert_eq!((i.as_str(), call.as_str()), ("i", "s"));
        assert!(matches!(bound, Expression::Binary("+", ..)));
        assert!(matches!(&body[0], Statement::Element { indices, .. } if indices == &["i", "j"]));
        assert_eq!(syntax.element_names(), ["a", "count"]);
    }

    #[test]
    fn what_is_no_table_is_refused() {
        for block in
            ["t() {", "t() {\n a u(8\n}", "t() {\n a foo(8)\n}", "t() {\n if (a ==) {\n}\n}"]
        {
            assert!(Syntax::default().add(block).is_err(), "{block}");
        }
    }
}
