//! The syntax tables of chapter 3 as a tree.

use std::collections::BTreeMap;

use kn_bitstream::Rule;

use crate::expression::{Expression, Variable};
use crate::ranges::Range;

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
    /// `name[i][j]  descriptor(argument)  range  r[rule]`
    Element(Element),
    /// `Name = expression  range  r[rule]`
    Assign(Variable, Expression, Vec<Range>),
    /// `if (condition) { … }`
    If(Expression, Vec<Statement>),
    /// `while (condition) { … }`
    While(Expression, Vec<Statement>),
    /// `for (variable = 0; variable < bound; variable++) { … }`
    For(String, Expression, Vec<Statement>),
    /// `name()`
    Call(String),
}

/// A syntax element of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Element {
    pub(crate) name: String,
    /// Names of the counters that index it.
    pub(crate) indices: Vec<String>,
    pub(crate) descriptor: Descriptor,
    pub(crate) argument: Expression,
    pub(crate) ranges: Vec<Range>,
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
                    Statement::Element(_) | Statement::Assign(..) | Statement::Call(_) => {}
                }
            }
        }
        let mut conditions = Vec::new();
        self.tables.iter().for_each(|(name, body)| walk(body, name, &mut conditions));
        conditions
    }

    /// Every range: the element behind which it is checked, and its rule.
    pub fn ranges(&self) -> Vec<(&str, Rule)> {
        fn walk<'s>(block: &'s [Statement], last: &mut &'s str, found: &mut Vec<(&'s str, Rule)>) {
            for statement in block {
                match statement {
                    Statement::Element(Element { name, ranges, .. }) => {
                        *last = name;
                        found.extend(ranges.iter().map(|range| (*last, range.rule)));
                    }
                    Statement::Assign(_, _, ranges) => {
                        found.extend(ranges.iter().map(|range| (*last, range.rule)));
                    }
                    Statement::If(_, body)
                    | Statement::While(_, body)
                    | Statement::For(_, _, body) => walk(body, last, found),
                    Statement::Call(_) => {}
                }
            }
        }
        let mut found = Vec::new();
        self.tables.values().for_each(|body| walk(body, &mut "", &mut found));
        found
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
                    Statement::Element(element) => names.push(element.name.as_str()),
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

pub(crate) fn wrong(line: &str, reason: impl Into<String>) -> SyntaxError {
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
            None if line.contains(RULE) => {
                parse_ranged(line, &mut block)?;
                continue;
            }
            None => parse_simple(line)?,
        });
    }
    Err(wrong("", "a brace is not closed"))
}

/// The text before the rule of a range.
const RULE: &str = "  r[";

/// A line that ends with a range and its rule; one without anything else ranges over the statement
/// before it.
fn parse_ranged(line: &str, block: &mut Vec<Statement>) -> Result<(), SyntaxError> {
    let (rest, id) = line.rsplit_once(RULE).unwrap_or((line, ""));
    let rest = rest.trim_end();
    let (statement, range) = rest.rsplit_once("  ").unwrap_or(("", rest));
    if !statement.is_empty() {
        block.push(parse_simple(statement.trim_end())?);
    }
    let range = Range::parse(range, id.trim_end_matches(']')).map_err(|why| wrong(line, why))?;
    match block.last_mut() {
        Some(Statement::Element(Element { ranges, .. }) | Statement::Assign(_, _, ranges)) => {
            ranges.push(range);
            Ok(())
        }
        _ => Err(wrong(line, "a range of nothing")),
    }
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
        Ok(Statement::If(expression(condition)?, parse_block(lines)?))
    } else if let Some(condition) = inside("while") {
        Ok(Statement::While(expression(condition)?, parse_block(lines)?))
    } else if let Some(range) = inside("for") {
        let (variable, bound) = parse_range(range).ok_or_else(|| wrong(head, "not a range"))?;
        Ok(Statement::For(variable.to_owned(), expression(bound)?, parse_block(lines)?))
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
        return Ok(Statement::Assign(Variable::parse(name), expression(value)?, Vec::new()));
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
    let argument = expression(argument)?;
    let (name, ranges) = (name.to_owned(), Vec::new());
    Ok(Statement::Element(Element { name, indices, descriptor, argument, ranges }))
}

fn expression(text: &str) -> Result<Expression, SyntaxError> {
    Expression::parse(text).ok_or_else(|| wrong(text, "not an expression"))
}

/// `name[i][j]` as `name` and `i`, `j`.
pub(crate) fn split_indices(element: &str) -> (&str, impl Iterator<Item = &str>) {
    let mut parts = element.split('[');
    let name = parts.next().unwrap_or("");
    (name, parts.map(|part| part.trim_end_matches(']')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_becomes_a_tree() {
        let mut syntax = Syntax::default();
        let block = "t() {\n  count  uleb\n  for (i = 0; i < count + 1; i++) {\n  a[i][j]  huffman(k)\n  }\n  s()\n}";
        syntax.add(block).expect("a table");
        let [Statement::Element(_), Statement::For(i, bound, body), Statement::Call(call)] =
            syntax.table("t").expect("there")
        else {
            panic!("{syntax:?}")
        };
        assert_eq!((i.as_str(), call.as_str()), ("i", "s"));
        assert!(matches!(bound, Expression::Binary("+", ..)));
        assert!(matches!(&body[0], Statement::Element(e) if e.indices == ["i", "j"]));
        assert_eq!(syntax.element_names(), ["a", "count"]);
    }

    #[test]
    fn ranges_stand_behind_what_they_are_of() {
        let mut syntax = Syntax::default();
        let block = "t() {\n a[i]  u(4)  0 … 2   r[header.axis.range]\n \
                     1 …  r[nodes.count.range]\n B = a[i] + 1  5  r[name.whole]\n}";
        syntax.add(block).expect("a table");
        let [Statement::Element(a), Statement::Assign(_, _, of_b)] =
            syntax.table("t").expect("there")
        else {
            panic!("{syntax:?}")
        };
        assert_eq!((a.ranges.len(), of_b.len()), (2, 1));
        for block in ["t() {\n 0 … 2  r[header.axis.range]\n}", "t() {\n a  u(4)  7  r[no.rule]\n}"]
        {
            assert!(Syntax::default().add(block).is_err(), "{block}");
        }
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
