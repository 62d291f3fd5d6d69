//! A literal decoder: chapters 4 to 9 from the elements that the tables read.
//!
//! Shares no code with kn-deform and kn-codec, and has no eye on speed.

mod conquest;
mod deform;
mod geometry;
mod intra;
mod labels;
mod range;
mod spread;

use std::collections::HashMap;

use kn_mesh::GridMesh;
use sha2::{Digest, Sha256};

use crate::affine::count_affine_by_label;
use crate::spec::Spec;
use crate::value::{Failure, TraceLine, Value};
use deform::{Motion, Node, Settings, Slots, bind, blend, transform};

pub use intra::decode_mesh;

/// Regions of the 15 labels of a body (6.2).
const BODY_REGIONS: [i64; 15] = [0, 2, 2, 2, 3, 3, 3, 1, 4, 4, 4, 5, 5, 5, 6];

impl Spec {
    /// The frames of a stream as lines `index kind #V #F sha256` (9.7), by a literal reading of the
    /// specification.
    ///
    /// For streams that a decoder accepts: it checks few rules and may panic where one is broken.
    pub fn reconstruct(&self, stream: &[u8]) -> Result<Vec<String>, Failure> {
        let mut oracle = Oracle::default();
        for line in self.parse(stream, &count_affine_by_label)? {
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
        self.mesh = decode_mesh(payload).ok()?;
        let unit = 1 << self.fraction_bits();
        let in_units = |p: &[i32; 3]| p.map(|coordinate| i64::from(coordinate) * unit);
        self.reference = self.mesh.positions.iter().map(in_units).collect();
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
        let motions = self.motions();
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

    /// Chapter 7: the values of every node.
    fn motions(&self) -> Vec<Motion> {
        let step = |name: &str| {
            let s = self.number(name) as u32;
            i64::from(4 + s % 4) << (s / 4)
        };
        let translation_step = step("translation_step") / 4;
        let mut rotations = self.triples("rotation").into_iter();
        let mut scales = self.triples("scale").into_iter();
        let mut shears = self.triples("shear").into_iter();
        let flag = |name: &str, node: &Node| node.affine && self.number(name) == 1;
        let value = |q: i64, name: &str| (q * step(name)) as f64 / 65536.0;
        let of_node = |(node, translation): (&Node, [i64; 3])| {
            let rotates = !node.affine || flag("rotation_enabled", node);
            let next = |carries: bool, list: &mut std::vec::IntoIter<[i64; 3]>| {
                if carries { list.next().unwrap_or([0; 3]) } else { [0; 3] }
            };
            let angles = next(rotates, &mut rotations);
            let scale = next(flag("scale_enabled", node), &mut scales);
            let shear = next(flag("shear_enabled", node), &mut shears);
            Motion {
                translation: translation.map(|q| q * translation_step),
                angles: angles.map(|q| value(q, "rotation_step")),
                scale: scale.map(|q| 1.0 + value(q, "scale_step")),
                shear: shear.map(|q| value(q, "shear_step")),
            }
        };
        self.nodes.iter().zip(self.triples("translation")).map(of_node).collect()
    }

    /// 8.4 and 9.5: the frame on the grid as a line; `None` where its own digest is another.
    fn show(&mut self, kind: char) -> Option<()> {
        let fraction_bits = self.fraction_bits();
        let half = (1 << fraction_bits) >> 1;
        let on_grid = |x: &[i64; 3]| x.map(|x| (x + half) >> fraction_bits);
        let positions: Vec<[i64; 3]> = self.reference.iter().map(on_grid).collect();
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
