//! The interpreter of the syntax tables. It parses a stream from bits, and assembles a stream from
//! text.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};

use crate::environment::Environment;
use crate::expression::{Expression, Variable, apply, call};
use crate::ranges::{Part, Range};
use crate::syntax::{Descriptor, Element, Statement, Syntax};
use crate::tables::Table;
use crate::value::{Failure, TraceLine, Value};

/// A syntax element that the tables ask for.
pub(crate) struct Place<'p> {
    pub(crate) name: &'p str,
    pub(crate) indices: &'p [u32],
    pub(crate) descriptor: Descriptor,
    pub(crate) argument: i128,
}

/// The source of the elements: the bits of a stream or the lines of a text.
pub(crate) trait Elements {
    /// The next element.
    fn element(&mut self, place: &Place<'_>) -> Result<Value, Failure>;
    /// Whether anything is left.
    fn more_data(&mut self) -> bool;
    /// Offset of the next bit.
    fn position(&self) -> u64;
    /// Goes to the next byte boundary, which ends a unit's structure.
    fn end_structure(&mut self, unit: OpenUnit) -> Result<(), Failure>;
}

/// A unit whose structure is being walked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OpenUnit {
    /// First bit of its structure.
    pub(crate) start: u64,
    /// Value of `unit_size`.
    pub(crate) size: i128,
}

/// Finds the labels of the last key nodes from the elements so far, where something depends on
/// them: that takes a decoded I-frame.
pub type NodeLabels<'l> = dyn Fn(&[TraceLine]) -> Option<Vec<u8>> + 'l;

/// Walks tables and keeps the values that they refer to.
pub(crate) struct Interpreter<'i, E> {
    syntax: &'i Syntax,
    labels: &'i NodeLabels<'i>,
    pub(crate) elements: E,
    pub(crate) environment: Environment,
    /// The levels; without them ranges are not checked.
    levels: Option<&'i Table>,
    /// The table that is being walked.
    table: &'i str,
    pub(crate) trace: Vec<TraceLine>,
    /// Every condition met, and how it turned out.
    pub(crate) branches: BTreeSet<(String, bool)>,
}

/// Structures nest no deeper: the tables call one another without recursion.
const DEPTH_LIMIT: u32 = 8;

impl<'i, E: Elements> Interpreter<'i, E> {
    pub(crate) fn new(syntax: &'i Syntax, labels: &'i NodeLabels<'i>, elements: E) -> Self {
        Self {
            syntax,
            labels,
            elements,
            environment: Environment::default(),
            levels: None,
            table: "",
            trace: Vec::new(),
            branches: BTreeSet::new(),
        }
    }

    /// Refuses values that the text does not allow.
    pub(crate) fn strictly(mut self, levels: &'i Table) -> Self {
        self.levels = Some(levels);
        self
    }

    /// Walks a table by name.
    pub(crate) fn run(&mut self, table: &'i str) -> Result<(), Failure> {
        self.call(table, 0)
    }

    fn call(&mut self, table: &'i str, depth: u32) -> Result<(), Failure> {
        let body = self.syntax.table(table).filter(|_| depth < DEPTH_LIMIT);
        let body = body.ok_or_else(|| self.failure(format!("there is no table {table}()")))?;
        let caller = std::mem::replace(&mut self.table, table);
        self.block(body, &mut HashMap::new(), depth)?;
        self.table = caller;
        Ok(())
    }

    fn block(
        &mut self,
        block: &'i [Statement],
        counters: &mut HashMap<&'i str, u32>,
        depth: u32,
    ) -> Result<(), Failure> {
        for statement in block {
            match statement {
                Statement::Element(element) => self.element(element, counters)?,
                Statement::Assign(variable, expression, ranges) => {
                    let value = self.evaluate(expression, counters)?;
                    self.environment.set(&key(variable, counters), value);
                    let bit = self.elements.position();
                    let value = Value::Integer(i64::try_from(value).unwrap_or(i64::MAX));
                    self.check(ranges, &variable.name, &value, bit, counters)?;
                }
                Statement::If(condition, body) => {
                    let holds = self.evaluate(condition, counters)? != 0;
                    self.branches.insert((format!("{}: {condition}", self.table), holds));
                    if holds {
                        self.block(body, counters, depth)?;
                    }
                }
                Statement::While(condition, body) => {
                    while self.evaluate(condition, counters)? != 0 {
                        self.block(body, counters, depth)?;
                    }
                }
                Statement::For(variable, bound, body) => {
                    let bound = self.evaluate(bound, counters)?;
                    for index in 0..u32::try_from(bound).unwrap_or(0) {
                        counters.insert(variable, index);
                        self.block(body, counters, depth)?;
                    }
                }
                Statement::Call(name) if name == "byte_align" => self.end_structure()?,
                Statement::Call(name) => self.call(name, depth + 1)?,
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        element: &'i Element,
        counters: &HashMap<&str, u32>,
    ) -> Result<(), Failure> {
        let argument = self.evaluate(&element.argument, counters)?;
        let index = |i: &String| counters.get(i.as_str()).copied().unwrap_or(0);
        let indices: Vec<u32> = element.indices.iter().map(index).collect();
        let (name, descriptor) = (element.name.as_str(), element.descriptor);
        let bit = self.elements.position();
        let value =
            self.elements.element(&Place { name, indices: &indices, descriptor, argument })?;
        let trace = &self.trace;
        let labels = || (self.labels)(trace);
        self.environment.read(name, value.number(), &labels);
        self.check(&element.ranges, name, &value, bit, counters)?;
        self.trace.push(TraceLine { bit, name: name.to_owned(), indices, value });
        Ok(())
    }

    /// Refuses a value outside its ranges, where they are checked at all.
    fn check(
        &mut self,
        ranges: &[Range],
        name: &str,
        value: &Value,
        bit: u64,
        counters: &HashMap<&str, u32>,
    ) -> Result<(), Failure> {
        if self.levels.is_none() {
            return Ok(());
        }
        for range in ranges {
            let mut allowed = false;
            for part in &range.parts {
                allowed |= match part {
                    Part::Word(word) => word.allows(value),
                    Part::Between(low, high) => {
                        let low = self.evaluate(low, counters)?;
                        let high = high.as_ref().map(|high| self.evaluate(high, counters));
                        let high = high.transpose()?.unwrap_or(i128::MAX);
                        (low..=high).contains(&value.number())
                    }
                };
            }
            if !allowed {
                let reason = format!("{name} cannot be {value}");
                return Err(Failure::of_rule(bit, range.rule, reason));
            }
        }
        Ok(())
    }

    /// `byte_align()`, which ends the structure of a unit.
    fn end_structure(&mut self) -> Result<(), Failure> {
        let known = |name| self.environment.get(name).unwrap_or(0);
        let unit = OpenUnit { start: known("UnitStart") as u64, size: known("unit_size") };
        self.elements.end_structure(unit)
    }

    fn evaluate(
        &mut self,
        expression: &Expression,
        counters: &HashMap<&str, u32>,
    ) -> Result<i128, Failure> {
        Ok(match expression {
            Expression::Number(value) => *value,
            Expression::Name(variable) => {
                let counter = counters.get(variable.name.as_str()).map(|&i| i128::from(i));
                let value = counter.or_else(|| self.environment.get(&key(variable, counters)));
                let value = value.or_else(|| self.limit(&variable.name));
                value.ok_or_else(|| self.failure(format!("{variable} is not known here")))?
            }
            Expression::Function(name, arguments) => {
                let arguments = arguments.iter().map(|argument| self.evaluate(argument, counters));
                let arguments = arguments.collect::<Result<Vec<_>, _>>()?;
                match name.as_str() {
                    "more_data" => i128::from(self.elements.more_data()),
                    "position" => i128::from(self.elements.position()),
                    _ => call(name, &arguments)
                        .ok_or_else(|| self.failure(format!("{name}() has no value here")))?,
                }
            }
            Expression::Binary(operator, left, right) => {
                let left = self.evaluate(left, counters)?;
                let right = self.evaluate(right, counters)?;
                let value = apply(operator, left, right);
                value.ok_or_else(|| self.failure(format!("{expression} has no value")))?
            }
        })
    }

    /// A limit of the stream's level, or the number of the highest level.
    fn limit(&self, name: &str) -> Option<i128> {
        let levels = self.levels?;
        match name {
            "HighestLevel" => Some(levels.rows.len() as i128 - 1),
            _ => level_limit(levels, self.environment.get("level"), name),
        }
    }

    fn failure(&self, reason: String) -> Failure {
        Failure::new(self.elements.position(), reason)
    }
}

/// The key under which a variable is kept.
fn key<'v>(variable: &'v Variable, counters: &HashMap<&str, u32>) -> Cow<'v, str> {
    if !variable.is_kept_by_index() {
        return Cow::Borrowed(&variable.name);
    }
    let index = |i: &String| counters.get(i.as_str()).copied().unwrap_or(0);
    let indices = variable.indices.iter().map(|i| format!("[{}]", index(i)));
    Cow::Owned(variable.name.clone() + &indices.collect::<String>())
}

/// A limit of a level, `None` for what is none; the highest level's where the level is not known.
fn level_limit(levels: &Table, level: Option<i128>, column: &str) -> Option<i128> {
    let at = levels.columns.iter().position(|name| name == column)?;
    let row = level.and_then(|level| levels.rows.get(usize::try_from(level).ok()?));
    row.or(levels.rows.last()).map(|row| i128::from(row[at]))
}
