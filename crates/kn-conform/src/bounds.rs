//! Test inputs for readers: values at the bounds of every range of the syntax tables and beyond
//! them, as bytes.

use crate::assemble::write_element;
use crate::bits::BitSink;
use crate::huffman::Codes;
use crate::interpret::{Elements, Interpreter, OpenUnit, Place};
use crate::second::know;
use crate::spec::{Example, Expected, Spec};
use crate::syntax::Descriptor;
use crate::value::{Failure, Value};
use kn_bitstream::Rule;

/// The beginning of a structure up to one element, whose value is at a bound or beyond it.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The structure, with what is known before it; its bytes end with zeros behind the element.
    pub example: Example,
    /// `element = value`.
    pub what: String,
    /// The first bit behind the element.
    pub end: u64,
    /// The rule that the value breaks, `None` for one that the table allows.
    pub rule: Option<Rule>,
}

/// Zero bytes behind the element: more than one element of any kind takes.
const ZEROS: usize = 16;

impl Spec {
    /// For every element of a sound example the values around which the tables change their
    /// verdict, or all values of a short one. A verdict is that of the ranges of the element and of
    /// what is derived from it before the next one is read.
    pub fn probes(&self, example: &Example) -> Vec<Probe> {
        let Expected::Trace(lines) = &example.expected else { return Vec::new() };
        if example.structure.starts_with("descriptor ") {
            return Vec::new();
        }
        let value = |line: &String| Value::parse(line.split_once(" = ")?.1);
        let values: Vec<Value> = lines.iter().filter_map(value).collect();
        let trials = (0..values.len()).map(|at| Trial { spec: self, example, values: &values, at });
        trials.flat_map(|trial| trial.probes()).collect()
    }
}

/// One element of an example in the place of which other values are tried.
struct Trial<'t> {
    spec: &'t Spec,
    example: &'t Example,
    values: &'t [Value],
    at: usize,
}

impl Trial<'_> {
    fn probes(&self) -> Vec<Probe> {
        let Some((descriptor, argument)) = self.run(&self.values[self.at]).element else {
            return Vec::new();
        };
        let n = u32::try_from(argument).unwrap_or(0);
        let (low, high) = match descriptor {
            Descriptor::F64 => return self.all(&floats()),
            Descriptor::Bytes => return self.all(&names(n as usize)),
            Descriptor::U if n <= 8 => {
                return self.all(&(0..1 << n).map(Value::Integer).collect::<Vec<_>>());
            }
            Descriptor::U => (0, (1 << n.min(62)) - 1),
            Descriptor::Uleb => (0, u32::MAX.into()),
            // As far as the longest unary part goes, or nearly so.
            Descriptor::Rice => (0, 32 << n.min(26)),
            Descriptor::Srice => (-(16 << n.min(26)), 16 << n.min(26)),
            Descriptor::Huffman => (1 - (1 << 20), (1 << 20) - 1),
        };
        let sound = self.values[self.at].number() as i64;
        let bounds = [low, high].map(|far| self.bound(sound, far));
        bounds.into_iter().flatten().flat_map(|value| self.all(&[Value::Integer(value)])).collect()
    }

    /// The last value from `sound` towards `far` that the tables allow, the one behind it, and
    /// `far`; nothing where they allow `far`.
    fn bound(&self, sound: i64, far: i64) -> Vec<i64> {
        let allows = |value: i64| self.run(&Value::Integer(value)).rule.is_none();
        if allows(far) {
            return Vec::new();
        }
        let (mut inside, mut outside) = (sound, far);
        while inside.abs_diff(outside) > 1 {
            let middle = inside + (outside - inside) / 2;
            *(if allows(middle) { &mut inside } else { &mut outside }) = middle;
        }
        vec![inside, outside, far]
    }

    fn all(&self, values: &[Value]) -> Vec<Probe> {
        values.iter().map(|value| self.probe(value)).collect()
    }

    fn probe(&self, value: &Value) -> Probe {
        let run = self.run(value);
        let mut bytes = run.bytes;
        if self.at + 1 < self.values.len() {
            bytes.resize(bytes.len() + ZEROS, 0);
        }
        Probe {
            example: Example { bytes, ..self.example.clone() },
            what: format!("{} = {value}", run.name),
            end: run.end,
            rule: run.rule,
        }
    }

    /// The verdict of the tables on the example with another value of the element.
    fn run(&self, value: &Value) -> Run {
        let mut values = self.values[..self.at].to_vec();
        values.push(value.clone());
        let elements = ProbeElements {
            values,
            next: 0,
            codes: &self.spec.codes,
            sink: BitSink::default(),
            run: Run::default(),
        };
        let interpreter = Interpreter::new(&self.spec.syntax, crate::no_labels(), elements);
        let mut interpreter = interpreter.strictly(&self.spec.levels);
        know(&mut interpreter.environment, self.example);
        let result = interpreter.run(&self.example.structure);
        let elements = interpreter.elements;
        let rule = result.err().and_then(|failure| failure.rule);
        Run { rule, bytes: elements.sink.as_bytes().to_vec(), ..elements.run }
    }
}

#[derive(Default)]
struct Run {
    /// The element whose value is tried.
    name: String,
    element: Option<(Descriptor, i128)>,
    end: u64,
    rule: Option<Rule>,
    bytes: Vec<u8>,
}

/// Gives the values one after another and stops behind the last.
struct ProbeElements<'c> {
    values: Vec<Value>,
    next: usize,
    codes: &'c Codes,
    sink: BitSink,
    run: Run,
}

impl Elements for ProbeElements<'_> {
    fn element(&mut self, place: &Place<'_>) -> Result<Value, Failure> {
        let at = self.sink.position();
        let value = self.values.get(self.next).cloned();
        let value = value.ok_or_else(|| Failure::new(at, "behind the element"))?;
        self.next += 1;
        if self.next == self.values.len() {
            self.run.name = place.name.to_owned();
            self.run.element = Some((place.descriptor, place.argument));
        }
        write_element(&mut self.sink, self.codes, place, &value)?;
        self.run.end = self.sink.position();
        Ok(value)
    }

    fn more_data(&mut self) -> bool {
        self.next < self.values.len()
    }

    fn position(&self) -> u64 {
        self.sink.position()
    }

    fn end_structure(&mut self, _unit: OpenUnit) -> Result<(), Failure> {
        self.sink.align();
        Ok(())
    }
}

fn floats() -> Vec<Value> {
    let values = [0.0, -0.0, f64::from_bits(1), -f64::from_bits(1), 1.0, -1.0, f64::MAX, f64::MIN];
    let values = values.into_iter().chain([f64::INFINITY, f64::NEG_INFINITY, f64::NAN]);
    values.map(Value::Float).collect()
}

/// Strings of so many bytes that are a name and that are none.
fn names(length: usize) -> Vec<Value> {
    let characters = [b'a', b'.', b'/', b'\\', b':', b' ', 0, 0x1f, 0x7f, 0x80, 0xff];
    characters.into_iter().map(|byte| Value::Bytes(vec![byte; length])).collect()
}
