//! Walks the syntax tables: over bits they parse a stream, over a text they assemble one.

use std::collections::{BTreeSet, HashMap};

use crate::environment::Environment;
use crate::ranges;
use crate::syntax::{Descriptor, Expression, Statement, Syntax};
use crate::tables::Table;
use crate::value::{Failure, TraceLine, Value};

/// A syntax element that the tables ask for.
pub(crate) struct Place<'p> {
    pub(crate) name: &'p str,
    pub(crate) indices: &'p [u32],
    pub(crate) descriptor: Descriptor,
    pub(crate) argument: i128,
}

/// Where the elements come from: the bits of a stream or the lines of a text.
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

/// Finds the labels of the last key nodes from the elements so far, where something depends on them:
/// that takes a decoded I-frame.
pub type NodeLabels<'l> = dyn Fn(&[TraceLine]) -> Option<Vec<u8>> + 'l;

/// Walks tables and keeps the values that they refer to.
pub(crate) struct Interpreter<'i, E> {
    syntax: &'i Syntax,
    labels: &'i NodeLabels<'i>,
    pub(crate) elements: E,
    pub(crate) environment: Environment,
    /// Where they are there, ranges are checked.
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
                Statement::Element { name, indices, descriptor, argument } => {
                    let argument = self.evaluate(argument, counters)?;
                    let index = |i: &String| counters.get(i.as_str()).copied().unwrap_or(0);
                    let indices: Vec<u32> = indices.iter().map(index).collect();
                    let descriptor = *descriptor;
                    self.element(&Place { name, indices: &indices, descriptor, argument })?;
                }
                Statement::Assign(name, expression) => {
                    let value = self.evaluate(expression, counters)?;
                    self.environment.set(name, value);
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

    fn element(&mut self, place: &Place<'_>) -> Result<(), Failure> {
        let bit = self.elements.position();
        let value = self.elements.element(place)?;
        let trace = &self.trace;
        let labels = || (self.labels)(trace);
        self.environment.read(place.name, value.number(), &labels);
        if let Some(levels) = self.levels {
            ranges::check(&mut self.environment, levels, place, &value, bit)?;
        }
        let (name, indices) = (place.name.to_owned(), place.indices.to_vec());
        self.trace.push(TraceLine { bit, name, indices, value });
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
            Expression::Name(name) => {
                let counter = counters.get(name.as_str()).map(|&index| i128::from(index));
                let value = counter.or_else(|| self.environment.get(name));
                value.ok_or_else(|| self.failure(format!("{name} is not known here")))?
            }
            Expression::Function(name) => match name.as_str() {
                "more_data" => i128::from(self.elements.more_data()),
                "position" => i128::from(self.elements.position()),
                _ => return Err(self.failure(format!("there is no function {name}()"))),
            },
            Expression::Binary(operator, left, right) => {
                let left = self.evaluate(left, counters)?;
                let right = self.evaluate(right, counters)?;
                apply(operator, left, right)
            }
        })
    }

    fn failure(&self, reason: String) -> Failure {
        Failure::new(self.elements.position(), reason)
    }
}

fn apply(operator: &str, left: i128, right: i128) -> i128 {
    match operator {
        "||" => i128::from(left != 0 || right != 0),
        "&&" => i128::from(left != 0 && right != 0),
        "==" => i128::from(left == right),
        "!=" => i128::from(left != right),
        ">=" => i128::from(left >= right),
        "<=" => i128::from(left <= right),
        ">" => i128::from(left > right),
        "<" => i128::from(left < right),
        "+" => left + right,
        _ => left - right,
    }
}
