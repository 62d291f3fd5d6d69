//! A literal decoder: chapters 6 to 9 from the elements that the tables read.
//!
//! Shares no code with kn-deform and with kn-codec's reconstruction, and has no eye on speed. The
//! mesh of an I-frame is kn-codec's.

mod deform;
mod path;
mod smooth;

use std::collections::{BTreeSet, HashMap};

use kn_codec::intra::{IntraDecoder, IntraLimits, decode_intra};
use kn_mesh::GridMesh;
use sha2::{Digest, Sha256};

use crate::labels::node_labels;
use crate::spec::Spec;
use crate::value::{Failure, TraceLine, Value};
use deform::{Motion, Node, Settings, Slots, bind, blend, transform};
use path::{Nodes, path};
use smooth::smooth;

/// Regions of the 15 labels of a body (6.2).
const BODY_REGIONS: [i64; 15] = [0, 2, 2, 2, 3, 3, 3, 1, 4, 4, 4, 5, 5, 5, 6];

impl Spec {
    /// The frames of a stream as lines `index kind #V #F sha256` (9.7), by a literal reading of the
    /// specification.
    ///
    /// For streams that a decoder accepts: it checks few rules and may panic where one is broken.
    pub fn reconstruct(&self, stream: &[u8]) -> Result<Vec<String>, Failure> {
        let mut oracle = Oracle::default();
        for line in self.parse(stream, &node_labels)? {
            oracle.element(line)?;
        }
        Ok(oracle.frames)
    }
}

#[derive(Default)]
struct Oracle {
    /// Values of the unit that is being read, by element; arrays in order.
    unit: HashMap<String, Vec<Value>>,
    /// Of the sequence header and of the last key nodes.
    header: HashMap<String, Vec<Value>>,
    settings: Settings,
    mesh: GridMesh,
    nodes: Vec<Node>,
    /// Slots of every vertex.
    influence: Vec<Slots>,
    /// Every node with its predecessor (7.5).
    path: Vec<(usize, Option<usize>)>,
    /// Of the P-frame before in the group: translations of the nodes, and PreviousStep.
    previous: (Vec<[i64; 3]>, i64),
    /// #V × 3, in reference units.
    reference: Vec<[i64; 3]>,
    frames: Vec<String>,
}

impl Oracle {
    fn element(&mut self, line: TraceLine) -> Result<(), Failure> {
        let end_of_unit = line.name == "unit_crc";
        let bit = line.bit;
        self.unit.entry(line.name).or_default().push(line.value);
        if !end_of_unit {
            return Ok(());
        }
        let wrong = |reason: &str| Failure::new(bit, reason);
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
            2 => self.intra_frame().ok_or_else(|| wrong("the I-frame cannot be decoded"))?,
            3 => self.key_nodes().ok_or_else(|| wrong("a region has no node"))?,
            4 => self.motion_frame().ok_or_else(|| wrong("a position leaves the grid"))?,
            _ => {}
        }
        self.unit.clear();
        Ok(())
    }

    fn number(&self, name: &str) -> i128 {
        number(&self.unit, name)
    }

    /// Values of an array in threes.
    fn triples(&self, name: &str) -> Vec<[i64; 3]> {
        let values = self.unit.get(name).map_or(&[][..], Vec::as_slice);
        let triple = |three: &[Value]| [0, 1, 2].map(|axis| three[axis].number() as i64);
        values.chunks_exact(3).map(triple).collect()
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

    fn intra_frame(&mut self) -> Option<()> {
        let Some([Value::Bytes(payload)]) = self.unit.get("intra_payload").map(Vec::as_slice)
        else {
            return None;
        };
        let limits = IntraLimits { max_vertices: u32::MAX, max_faces: u32::MAX };
        decode_intra(payload, &limits, &mut IntraDecoder::default(), &mut self.mesh).ok()?;
        let unit = 1 << self.fraction_bits();
        let in_units = |p: &[i32; 3]| p.map(|coordinate| i64::from(coordinate) * unit);
        let decoded: Vec<[i64; 3]> = self.mesh.positions.iter().map(in_units).collect();
        let strength = self.number("smoothing_strength") as usize;
        self.reference = smooth(&decoded, &self.mesh.faces, strength, unit / 2);
        self.show('I')
    }

    fn key_nodes(&mut self) -> Option<()> {
        let points = self.node_points();
        let vertices: Vec<[i64; 3]> =
            self.mesh.positions.iter().map(|p| p.map(i64::from)).collect();
        let labels: Vec<u8> =
            points.iter().map(|&point| self.vertex_label(closest(point, &vertices))).collect();
        let unit = 1 << self.fraction_bits();
        let node = |(index, point): (usize, &[i64; 3])| Node {
            position: point.map(|coordinate| coordinate * unit),
            label: labels[index],
            region: self.region_of(labels[index]),
            affine: self.is_affine(index, labels[index]),
        };
        let nodes: Vec<Node> = points.iter().enumerate().map(node).collect();
        self.nodes = nodes;
        self.settings.sigma = self.number("weight_sigma");
        let sites: Vec<_> =
            points.iter().zip(&self.nodes).map(|(&point, node)| (point, node.region)).collect();
        let slots = |(index, &vertex): (usize, &[i64; 3])| {
            bind(vertex, self.region_of(self.vertex_label(index)), &sites, &self.settings)
        };
        self.influence = vertices.iter().enumerate().map(slots).collect::<Option<_>>()?;
        self.path = path(&Nodes {
            positions: &points,
            labels: &labels,
            influence: &self.influence,
            body: number(&self.header, "label_set") == 1,
            up_axis: number(&self.header, "up_axis") as usize,
        });
        Some(())
    }

    /// 6.5: positions of the nodes in grid steps.
    fn node_points(&self) -> Vec<[i64; 3]> {
        if self.number("node_coding") == 1 {
            let mut point = [0; 3];
            let step = |delta: [i64; 3]| {
                point = [0, 1, 2].map(|axis| point[axis] + delta[axis]);
                point
            };
            return self.triples("node_delta").into_iter().map(step).collect();
        }
        let mut vertex = -1;
        let mut points = Vec::new();
        for gap in &self.unit["node_vertex_gap"] {
            vertex += 1 + gap.number() as i64;
            points.push(self.mesh.positions[vertex as usize].map(i64::from));
        }
        points
    }

    fn is_affine(&self, node: usize, label: u8) -> bool {
        match self.number("affine_mode") {
            0 => false,
            1 => self.unit["affine_label"][usize::from(label)].number() == 1,
            2 => true,
            _ => self.unit["affine_node"][node].number() == 1,
        }
    }

    fn motion_frame(&mut self) -> Option<()> {
        self.previous = self.translations();
        let motions = self.motions(&self.previous.0);
        let transforms: Vec<_> =
            self.nodes.iter().zip(&motions).map(|(node, motion)| transform(node, motion)).collect();
        let fraction_bits = self.fraction_bits();
        let moved = |(&x, slots)| blend(x, slots, &transforms, fraction_bits);
        let reference: Option<Vec<_>> =
            self.reference.iter().zip(&self.influence).map(moved).collect();
        self.reference = reference?;
        for (node, motion) in self.nodes.iter_mut().zip(&motions) {
            for axis in 0..3 {
                node.position[axis] += motion.translation[axis];
                if node.position[axis].abs() >= 1 << (20 + fraction_bits) {
                    return None;
                }
            }
        }
        self.show('P')
    }

    /// P(s), four times T(s), of 7.2.
    fn step(&self, name: &str) -> i64 {
        let s = self.number(name) as u32;
        i64::from(4 + s % 4) << (s / 4)
    }

    /// 7.3 and 7.4: the translations of the nodes, and T(s).
    fn translations(&self) -> (Vec<[i64; 3]>, i64) {
        let step = self.step("translation_step") / 4;
        let values = self.triples("translation");
        let (before, previous_step) = &self.previous;
        let add = |a: [i64; 3], b: [i64; 3], step: i64| [0, 1, 2].map(|k| a[k] + b[k] * step);
        let mut translations = vec![[0; 3]; values.len()];
        match self.number("translation_mode") {
            0 => {
                for node in 0..values.len() {
                    translations[node] = add([0; 3], values[node], step);
                }
            }
            1 => {
                for &(node, predecessor) in &self.path {
                    let prediction = predecessor.map_or([0; 3], |before| translations[before]);
                    translations[node] = add(prediction, values[node], step);
                }
            }
            _ => {
                let changes = self.triples("translation_change");
                let parts: BTreeSet<u8> = self.nodes.iter().map(|node| node.label).collect();
                for (node, value) in values.into_iter().enumerate() {
                    let label = self.nodes[node].label;
                    let part = parts.iter().take_while(|&&part| part < label).count();
                    let prediction = add(before[node], changes[part], *previous_step);
                    translations[node] = add(prediction, value, step);
                }
            }
        }
        (translations, step)
    }

    /// Chapter 7: the values of every node.
    fn motions(&self, translations: &[[i64; 3]]) -> Vec<Motion> {
        let mut rotations = self.triples("rotation").into_iter();
        let mut scales = self.triples("scale").into_iter();
        let mut shears = self.triples("shear").into_iter();
        let flag = |name: &str, node: &Node| node.affine && self.number(name) == 1;
        let value = |q: i64, name: &str| (q * self.step(name)) as f64 / 65536.0;
        let of_node = |(node, &translation): (&Node, &[i64; 3])| {
            let rotates = !node.affine || flag("rotation_enabled", node);
            let next = |carries: bool, list: &mut std::vec::IntoIter<[i64; 3]>| {
                if carries { list.next().unwrap_or([0; 3]) } else { [0; 3] }
            };
            let angles = next(rotates, &mut rotations);
            let scale = next(flag("scale_enabled", node), &mut scales);
            let shear = next(flag("shear_enabled", node), &mut shears);
            Motion {
                translation,
                angles: angles.map(|q| value(q, "rotation_step")),
                scale: scale.map(|q| 1.0 + value(q, "scale_step")),
                shear: shear.map(|q| value(q, "shear_step")),
            }
        };
        self.nodes.iter().zip(translations).map(of_node).collect()
    }

    /// 9.5: the frame as a line; `None` where its own digest is another.
    fn show(&mut self, kind: char) -> Option<()> {
        let positions = &self.reference;
        let numbers = |list: &mut dyn Iterator<Item = i64>| -> Vec<u8> {
            list.flat_map(|number| (number as i32).to_le_bytes()).collect()
        };
        let vertices = numbers(&mut positions.iter().flatten().copied());
        let faces = numbers(&mut self.mesh.faces.iter().flatten().map(|&i| i64::from(i)));
        let counts = [positions.len() as i64, self.mesh.faces.len() as i64];
        let [vertex_count, face_count] = counts.map(|count| numbers(&mut [count].into_iter()));
        let agrees = |name: &str, bytes: &[u8]| match self.unit.get(name).map(|v| v[0].number()) {
            Some(digest) => sha256(bytes)[..16] == format!("{digest:016x}"),
            None => true,
        };
        let sound = agrees("positions_digest", &[vertex_count.clone(), vertices.clone()].concat())
            && agrees("faces_digest", &[face_count.clone(), faces.clone()].concat());
        let digest = sha256(&[vertex_count, face_count, vertices, faces].concat());
        let index = self.frames.len();
        self.frames.push(format!("{index} {kind} {} {} {digest}", counts[0], counts[1]));
        sound.then_some(())
    }
}

fn number(values: &HashMap<String, Vec<Value>>, name: &str) -> i128 {
    values.get(name).and_then(|values| values.first()).map_or(0, Value::number)
}

/// 6.5: the closest vertex, of equally close ones the lowest.
fn closest(point: [i64; 3], vertices: &[[i64; 3]]) -> usize {
    let squared =
        |vertex: &[i64; 3]| -> i64 { (0..3).map(|axis| (vertex[axis] - point[axis]).pow(2)).sum() };
    let by_distance = |&index: &usize| (squared(&vertices[index]), index);
    (0..vertices.len()).min_by_key(by_distance).unwrap_or(0)
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
