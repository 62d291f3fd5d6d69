//! The uses of the syntax tables: to parse a stream, to assemble one, to read an example.

use std::collections::BTreeSet;

use kn_mesh::GridMesh;

use crate::assemble::{TextElements, text_of};
use crate::bits::BitSource;
use crate::environment::Environment;
use crate::interpret::{Elements, Interpreter, NodeLabels};
use crate::labels::node_labels;
use crate::oracle::{Payload, decode_mesh};
use crate::parse::StreamElements;
use crate::spec::{Example, Spec};
use crate::syntax::{Syntax, SyntaxError};
use crate::value::{Failure, TraceLine};

impl Spec {
    /// Every syntax element of a stream, read by the tables of chapter 3.
    ///
    /// Safe on untrusted input; takes memory in proportion to the stream and time with no eye on
    /// speed.
    pub fn parse(&self, stream: &[u8], labels: &NodeLabels<'_>) -> Result<Vec<TraceLine>, Failure> {
        let elements = StreamElements::new(BitSource::of_file(stream), &self.codes);
        let mut interpreter = Interpreter::new(&self.syntax, labels, elements);
        interpreter.run("file")?;
        Ok(interpreter.trace)
    }

    /// As [`Self::parse`], and refuses values outside the ranges of the text. The elements before
    /// the failure, and the failure.
    pub fn parse_strictly(
        &self,
        stream: &[u8],
        labels: &NodeLabels<'_>,
    ) -> (Vec<TraceLine>, Result<(), Failure>) {
        let elements = StreamElements::new(BitSource::of_file(stream), &self.codes);
        let interpreter = Interpreter::new(&self.syntax, labels, elements);
        let mut interpreter = interpreter.strictly(&self.levels);
        let result = interpreter.run("file");
        (interpreter.trace, result)
    }

    /// The conditions of the syntax tables that a stream meets, as `table: condition`, and how they
    /// turn out, up to where it cannot be read.
    pub fn branches_of(&self, stream: &[u8]) -> BTreeSet<(String, bool)> {
        let elements = StreamElements::new(BitSource::of_file(stream), &self.codes);
        let mut interpreter = Interpreter::new(&self.syntax, &node_labels, elements);
        // What a broken stream meets before it breaks is met as well.
        let _ = interpreter.run("file");
        interpreter.branches
    }

    /// The stream that a text describes: the tables run backwards.
    pub fn assemble(&self, text: &str, labels: &NodeLabels<'_>) -> Result<Vec<u8>, Failure> {
        let elements = TextElements::new(text, &self.codes)?;
        let mut interpreter = Interpreter::new(&self.syntax, labels, elements);
        interpreter.run("file")?;
        interpreter.elements.finish()
    }

    /// The text of a stream, from which [`Self::assemble`] makes the stream again.
    pub fn disassemble(&self, stream: &[u8], labels: &NodeLabels<'_>) -> Result<String, Failure> {
        Ok(text_of(&self.parse(stream, labels)?))
    }

    /// The trace of an example, by the tables.
    pub fn parse_example(&self, example: &Example) -> Result<Vec<TraceLine>, Failure> {
        let (syntax, table) = self.example_table(example).map_err(no_table)?;
        let bits = BitSource::of_structure(&example.bytes);
        let elements = StreamElements::new(bits, &self.codes);
        let interpreter = Interpreter::new(&syntax, crate::no_labels(), elements);
        let mut interpreter = interpreter.strictly(&self.levels);
        know(&mut interpreter.environment, example);
        interpreter.run(table)?;
        interpreter.elements.finish()?;
        Ok(interpreter.trace)
    }

    /// The mesh of an I-frame's payload by the tables, with their ranges, and a literal reading of
    /// chapters 4 and 5; the level is the highest.
    pub fn decode_mesh(&self, payload: &[u8]) -> Result<GridMesh, Failure> {
        let elements = StreamElements::new(BitSource::of_structure(payload), &self.codes);
        let interpreter = Interpreter::new(&self.syntax, crate::no_labels(), elements);
        let mut interpreter = interpreter.strictly(&self.levels);
        interpreter.environment.set("intra_size", payload.len() as i128);
        interpreter.run("intra_payload")?;
        let end = interpreter.elements.position();
        interpreter.elements.finish()?;
        let element = |name: &str| interpreter.trace.iter().find(|line| line.name == name);
        let read = Payload::of(|name| Some(&element(name)?.value));
        let read = read.ok_or_else(|| Failure::new(end, "the table lacks an element"))?;
        decode_mesh(&read).map_err(|rule| Failure::of_rule(end, rule, "the mesh breaks it"))
    }

    /// The bytes of an example, assembled from its trace.
    pub fn assemble_example(
        &self,
        example: &Example,
        trace: &[TraceLine],
    ) -> Result<Vec<u8>, Failure> {
        let (syntax, table) = self.example_table(example).map_err(no_table)?;
        let mut text = String::new();
        for line in trace {
            text.push_str(&format!("{} = {}\n", line.name, line.value));
        }
        let elements = TextElements::new(&text, &self.codes)?;
        let mut interpreter = Interpreter::new(&syntax, crate::no_labels(), elements);
        know(&mut interpreter.environment, example);
        interpreter.run(table)?;
        interpreter.elements.finish()
    }

    /// The tables and the name of the one to read an example with; a lone descriptor gets a table
    /// of its own with the one element `value`.
    pub(crate) fn example_table<'e>(
        &self,
        example: &'e Example,
    ) -> Result<(Syntax, &'e str), SyntaxError> {
        match example.structure.strip_prefix("descriptor ") {
            None => Ok((self.syntax.clone(), &example.structure)),
            Some(descriptor) => {
                let mut syntax = Syntax::default();
                syntax.add(&format!("descriptor() {{\nvalue  {descriptor}\n}}"))?;
                Ok((syntax, "descriptor"))
            }
        }
    }
}

/// The values that are known before an example (1.4).
pub(crate) fn know(environment: &mut Environment, example: &Example) {
    environment.set("UnitBegin", -16);
    for (name, value) in &example.given {
        environment.set(name, i128::from(*value));
    }
}

fn no_table(error: SyntaxError) -> Failure {
    Failure::new(0, error.to_string())
}
