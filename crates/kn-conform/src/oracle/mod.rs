//! A literal decoder: chapters 4 to 9 from the elements that the tables read.
//!
//! It shares no code with kn-deform and kn-codec, and is not made for speed.

mod conquest;
mod deform;
mod faces;
mod framing;
mod geometry;
mod intra;
mod labels;
mod motion;
mod path;
#[cfg(test)]
mod printed;
mod range;
mod smooth;
mod spread;
mod stages;

use kn_bitstream::rule::{self, Rule};
use std::collections::HashMap;

use kn_mesh::GridMesh;

use crate::labels::{closest, node_labels, node_points};
use crate::spec::Spec;
use crate::value::{Failure, TraceLine, Value};
use deform::{Node, Settings, Slots, bind, blend, transform};
use framing::Framing;
use path::{Nodes, path};
use smooth::smooth;

pub(crate) use intra::{Payload, decode_mesh};

/// Regions of the 15 labels of a body (6.2).
const BODY_REGIONS: [i64; 15] = [0, 2, 2, 2, 3, 3, 3, 1, 4, 4, 4, 5, 5, 5, 6];

/// The result of the literal decoder for a stream.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Literal {
    /// Lines `index kind #V #F sha256` (9.7).
    pub frames: Vec<String>,
    /// Lines `index kind nodes influence transforms predicted reconstructed` (9.6).
    pub stages: Vec<String>,
}

impl Spec {
    /// The frames of a stream by a literal reading of the specification, or the rule that it
    /// breaks.
    ///
    /// Takes memory and time with no eye on either: not for untrusted streams of unknown size.
    pub fn reconstruct(&self, stream: &[u8]) -> Result<Literal, Failure> {
        let (trace, result) = self.parse_strictly(stream, &node_labels);
        let mut oracle = Oracle::default();
        for line in trace {
            let bit = line.bit;
            let read = oracle.framing.element(&line).and_then(|()| oracle.element(line));
            read.map_err(|rule| Failure::of_rule(bit, rule, "the stream breaks it"))?;
        }
        // Behind the index nothing is a unit.
        let behind = |failure: Failure| match oracle.framing.finish() {
            Ok(()) => Failure::of_rule(failure.bit, rule::FILE_ORDER, failure.reason),
            Err(_) => failure,
        };
        result.map_err(behind)?;
        let end = 8 * stream.len() as u64;
        oracle.framing.finish().map_err(|rule| Failure::of_rule(end, rule, "the file ends"))?;
        Ok(oracle.decoded)
    }
}

#[derive(Default)]
struct Oracle {
    framing: Framing,
    /// Values of the unit that is being read, by element; arrays in order.
    unit: HashMap<String, Vec<Value>>,
    /// Of the sequence header.
    header: HashMap<String, Vec<Value>>,
    settings: Settings,
    mesh: GridMesh,
    nodes: Vec<Node>,
    /// Slots of every vertex.
    influence: Vec<Slots>,
    /// Every node with its predecessor (7.5).
    path: Vec<(usize, Option<usize>)>,
    /// Of the P-frame before in the GoF: translations of the nodes, and PreviousStep.
    previous: (Vec<[i64; 3]>, i64),
    /// #V × 3, in reference units.
    reference: Vec<[i64; 3]>,
    decoded: Literal,
}

impl Oracle {
    fn element(&mut self, line: TraceLine) -> Result<(), Rule> {
        let end_of_unit = line.name == "unit_crc";
        self.unit.entry(line.name).or_default().push(line.value);
        if !end_of_unit {
            return Ok(());
        }
        match self.number("unit_type") {
            1 => {
                self.header = std::mem::take(&mut self.unit);
                self.settings = Settings {
                    nodes_per_vertex: number(&self.header, "nodes_per_vertex") as usize,
                    weight_scheme: number(&self.header, "weight_scheme"),
                    fallback: number(&self.header, "influence_mode") == 1,
                    sigma: 0,
                };
            }
            2 => self.intra_frame()?,
            3 => self.key_nodes()?,
            4 => self.motion_frame()?,
            _ => {}
        }
        self.unit.clear();
        Ok(())
    }

    fn number(&self, name: &str) -> i128 {
        number(&self.unit, name)
    }

    fn numbers(&self, name: &str) -> Vec<i64> {
        let values = self.unit.get(name).map_or(&[][..], Vec::as_slice);
        values.iter().map(|value| value.number() as i64).collect()
    }

    /// Values of an array in threes.
    fn triples(&self, name: &str) -> Vec<[i64; 3]> {
        self.numbers(name).chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect()
    }

    fn fraction_bits(&self) -> u32 {
        number(&self.header, "fraction_bits") as u32
    }

    fn region_of(&self, label: u8) -> i64 {
        match number(&self.header, "label_set") {
            0 => 0,
            1 => BODY_REGIONS[usize::from(label)],
            _ => self.header["label_region"][usize::from(label)].number() as i64,
        }
    }

    fn vertex_label(&self, vertex: usize) -> u8 {
        self.mesh.labels.get(vertex).copied().unwrap_or(0)
    }

    /// 6.4
    fn intra_frame(&mut self) -> Result<(), Rule> {
        let payload = Payload::of(|name| self.unit.get(name)?.first());
        self.mesh = decode_mesh(&payload.ok_or(rule::UNIT_SIZE_EXACT)?)?;
        let label_set = number(&self.header, "label_set");
        if (self.number("labels_present") != 0) != (label_set != 0) {
            return Err(rule::INTRA_LABELS_PRESENT);
        }
        let label_count = if label_set == 1 { 15 } else { number(&self.header, "label_count") };
        if self.mesh.labels.iter().any(|&label| i128::from(label) >= label_count) {
            return Err(rule::INTRA_LABELS_RANGE);
        }
        let unit = 1 << self.fraction_bits();
        let in_units = |p: &[i32; 3]| p.map(|coordinate| i64::from(coordinate) * unit);
        let decoded: Vec<[i64; 3]> = self.mesh.positions.iter().map(in_units).collect();
        let strength = self.number("smoothing_strength") as usize;
        self.reference = smooth(&decoded, &self.mesh.faces, strength, unit / 2);
        self.show('I', &decoded, None)
    }

    /// 6.5, 7.5 and 8.2
    fn key_nodes(&mut self) -> Result<(), Rule> {
        let vertices: Vec<[i64; 3]> =
            self.mesh.positions.iter().map(|p| p.map(i64::from)).collect();
        if vertices.is_empty() {
            return Err(rule::INTRA_VERTICES_NODES);
        }
        let (gaps, deltas) = (self.numbers("node_vertex_gap"), self.numbers("node_delta"));
        let points = node_points(&gaps, &deltas, &vertices).ok_or(rule::NODES_VERTEX_RANGE)?;
        let nearest = |&point: &[i64; 3]| self.vertex_label(closest(point, &vertices).unwrap_or(0));
        let labels: Vec<u8> = points.iter().map(nearest).collect();
        let unit = 1 << self.fraction_bits();
        let node = |(index, point): (usize, &[i64; 3])| Node {
            position: point.map(|coordinate| coordinate * unit),
            label: labels[index],
            region: self.region_of(labels[index]),
            affine: self.is_affine(index, labels[index]),
        };
        self.nodes = points.iter().enumerate().map(node).collect();
        self.settings.sigma = self.number("weight_sigma");
        let sites: Vec<_> =
            points.iter().zip(&self.nodes).map(|(&point, node)| (point, node.region)).collect();
        let slots = |(index, &vertex): (usize, &[i64; 3])| {
            bind(vertex, self.region_of(self.vertex_label(index)), &sites, &self.settings)
        };
        let influence: Option<_> = vertices.iter().enumerate().map(slots).collect();
        self.influence = influence.ok_or(rule::DEFORM_INFLUENCE_STRICT)?;
        self.path = path(&Nodes {
            positions: &points,
            labels: &labels,
            influence: &self.influence,
            body: number(&self.header, "label_set") == 1,
            up_axis: number(&self.header, "up_axis") as usize,
        });
        Ok(())
    }

    fn is_affine(&self, node: usize, label: u8) -> bool {
        match self.number("affine_mode") {
            0 => false,
            1 => self.unit["affine_label"][usize::from(label)].number() == 1,
            2 => true,
            _ => self.unit["affine_node"][node].number() == 1,
        }
    }

    /// Chapter 7, 8.3 and 8.4
    fn motion_frame(&mut self) -> Result<(), Rule> {
        self.previous = self.translations()?;
        let motions = self.motions(&self.previous.0);
        let transforms: Vec<_> =
            self.nodes.iter().zip(&motions).map(|(node, motion)| transform(node, motion)).collect();
        let fraction_bits = self.fraction_bits();
        let moved = |(&x, slots)| blend(x, slots, &transforms, fraction_bits);
        let reference: Option<Vec<_>> =
            self.reference.iter().zip(&self.influence).map(moved).collect();
        self.reference = reference.ok_or(rule::DEFORM_POSITION_RANGE)?;
        let before = self.nodes.clone();
        for (node, motion) in self.nodes.iter_mut().zip(&motions) {
            for axis in 0..3 {
                node.position[axis] += motion.translation[axis];
                if node.position[axis].abs() >= 1 << (20 + fraction_bits) {
                    return Err(rule::DEFORM_NODES_MOVE);
                }
            }
        }
        let predicted = self.reference.clone();
        self.show('P', &predicted, Some((&before, &transforms)))
    }
}

fn number(values: &HashMap<String, Vec<Value>>, name: &str) -> i128 {
    values.get(name).and_then(|values| values.first()).map_or(0, Value::number)
}
