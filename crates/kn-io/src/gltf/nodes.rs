//! The tree of nodes: who hangs below whom, and where a pose puts them in the world.

use super::super::Fault;
use super::bad;
use glam::{DMat4, DQuat, DVec3};
use gltf::json::Root;

/// A node's place relative to its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    parent: Option<usize>,
    /// Instead of translation, rotation and scale; such a node cannot be animated.
    pub(super) matrix: Option<DMat4>,
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
}

impl Node {
    fn local(&self) -> DMat4 {
        self.matrix.unwrap_or_else(|| {
            DMat4::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
        })
    }
}

/// All nodes of a file, in file order.
#[derive(Clone, Debug)]
pub(super) struct Nodes {
    pub(super) nodes: Vec<Node>,
    /// All node numbers, parents before children, children in file order.
    parents_first: Vec<usize>,
}

impl Nodes {
    /// Builds the tree; a node below two others, or below itself, is an error.
    pub(super) fn load(root: &Root) -> Result<Self, Fault> {
        let mut nodes: Vec<Node> = root.nodes.iter().map(at_rest).collect();
        for (parent, json) in root.nodes.iter().enumerate() {
            for child in children(json) {
                let Some(node) = nodes.get_mut(child) else {
                    return Err(bad(format!("node {child} does not exist")));
                };
                if node.parent.replace(parent).is_some() {
                    return Err(bad(format!("node {child} has two parents")));
                }
            }
        }
        let roots: Vec<usize> = (0..nodes.len()).filter(|&n| nodes[n].parent.is_none()).collect();
        let parents_first = depth_first(root, &roots);
        if parents_first.len() == nodes.len() {
            Ok(Self { nodes, parents_first })
        } else {
            Err(bad("the nodes are not a tree"))
        }
    }

    /// The nodes of the default scene in depth-first order; all nodes where there is no scene.
    pub(super) fn of_default_scene(&self, root: &Root) -> Result<Vec<usize>, Fault> {
        let number = root.scene.map_or(0, |scene| scene.value());
        let Some(scene) = root.scenes.get(number) else {
            return match root.scene {
                Some(_) => Err(bad(format!("scene {number} does not exist"))),
                None => Ok(self.parents_first.clone()),
            };
        };
        let roots: Vec<usize> = scene.nodes.iter().map(|node| node.value()).collect();
        let mut listed = vec![false; self.nodes.len()];
        for &node in &roots {
            // A node listed twice, or below a listed one, would be drawn twice.
            let is_root = self.nodes.get(node).is_some_and(|node| node.parent.is_none());
            if !is_root || std::mem::replace(&mut listed[node], true) {
                return Err(bad(format!("node {node} is not a root of scene {number}")));
            }
        }
        Ok(depth_first(root, &roots))
    }

    /// The matrix from every node to the world.
    pub(super) fn to_world(&self) -> Vec<DMat4> {
        let mut world = vec![DMat4::IDENTITY; self.nodes.len()];
        for &node in &self.parents_first {
            let local = self.nodes[node].local();
            world[node] = match self.nodes[node].parent {
                Some(parent) => world[parent] * local,
                None => local,
            };
        }
        world
    }
}

fn children(json: &gltf::json::Node) -> impl DoubleEndedIterator<Item = usize> {
    json.children.iter().flatten().map(|child| child.value())
}

/// The nodes below `roots`; ends on any graph in which no node has two parents.
fn depth_first(root: &Root, roots: &[usize]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut stack: Vec<usize> = roots.iter().rev().copied().collect();
    while let Some(node) = stack.pop() {
        order.push(node);
        stack.extend(children(&root.nodes[node]).rev());
    }
    order
}

/// A node as the file has it, without its parent.
fn at_rest(json: &gltf::json::Node) -> Node {
    let rotation = json.rotation.unwrap_or_default().0.map(f64::from);
    Node {
        parent: None,
        matrix: json.matrix.map(|columns| DMat4::from_cols_array(&columns.map(f64::from))),
        translation: DVec3::from_array(json.translation.unwrap_or([0.0; 3]).map(f64::from)),
        rotation: unit(DQuat::from_array(rotation)),
        scale: DVec3::from_array(json.scale.unwrap_or([1.0; 3]).map(f64::from)),
    }
}

/// The rotation that a quaternion means, whatever its length.
pub(super) fn unit(quaternion: DQuat) -> DQuat {
    let length = quaternion.length();
    if length > 0.0 && length.is_finite() { quaternion / length } else { DQuat::IDENTITY }
}
