//! 9.5 and 9.6: what a frame shows, and the digests of the stages on the way to it.

use kn_bitstream::rule::{self, Rule};
use sha2::{Digest, Sha256};

use super::Oracle;
use super::deform::{Node, Transform};

/// Integers as 32 bits in two's complement, little-endian.
fn integers(list: impl IntoIterator<Item = i64>) -> Vec<u8> {
    list.into_iter().flat_map(|number| (number as i32).to_le_bytes()).collect()
}

fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The first sixteen digits.
fn short(bytes: &[u8]) -> String {
    sha256(bytes)[..16].to_owned()
}

impl Oracle {
    /// Takes the frame down; its own digests must agree. `predicted` are the positions before
    /// smoothing. A P-frame comes with its nodes as they stood before it, and their transforms.
    pub(super) fn show(
        &mut self,
        kind: char,
        predicted: &[[i64; 3]],
        moved: Option<(&[Node], &[Transform])>,
    ) -> Result<(), Rule> {
        let vertices = integers(self.reference.iter().flatten().copied());
        let faces = integers(self.mesh.faces.iter().flatten().map(|&i| i64::from(i)));
        let counts = [self.reference.len() as i64, self.mesh.faces.len() as i64];
        let [vertex_count, face_count] = counts.map(|count| integers([count]));
        let agrees = |name: &str, bytes: &[u8]| match self.unit.get(name).map(|v| v[0].number()) {
            Some(digest) => short(bytes) == format!("{digest:016x}"),
            None => true,
        };
        if !agrees("positions_digest", &[vertex_count.clone(), vertices.clone()].concat()) {
            return Err(rule::FRAME_DIGEST_POSITIONS);
        }
        if !agrees("faces_digest", &[face_count.clone(), faces.clone()].concat()) {
            return Err(rule::INTRA_DIGEST_FACES);
        }
        let digest = sha256(&[vertex_count, face_count, vertices, faces].concat());
        let index = self.decoded.frames.len();
        let predicted = short(&integers(predicted.iter().flatten().copied()));
        let before = match moved {
            Some((nodes, transforms)) => self.stages(nodes, transforms).join(" "),
            None => "- - -".into(),
        };
        let stages = format!("{index} {kind} {before} {predicted} {}", &digest[..16]);
        self.decoded.stages.push(stages);
        let line = format!("{index} {kind} {} {} {digest}", counts[0], counts[1]);
        self.decoded.frames.push(line);
        Ok(())
    }

    /// Digests of nodes, influence and transforms: r[conformance.stages].
    fn stages(&self, nodes: &[Node], transforms: &[Transform]) -> [String; 3] {
        let of_node = |node: &Node| {
            let [x, y, z] = node.position;
            [x, y, z, i64::from(node.label), i64::from(node.affine)]
        };
        let nodes = integers(nodes.iter().flat_map(of_node));
        let mut influence = Vec::new();
        for &(node, weight) in self.influence.iter().flatten() {
            influence.extend(integers([node as i64]));
            influence.extend(weight.to_le_bytes());
        }
        let values = transforms.iter().flat_map(|(a, b)| a.iter().flatten().chain(b));
        let transforms: Vec<u8> = values.flat_map(|value| value.to_le_bytes()).collect();
        [nodes, influence, transforms].map(|bytes| short(&bytes))
    }
}
