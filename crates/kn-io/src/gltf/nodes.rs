//! The tree of nodes: who hangs below whom, and where a pose puts them in the world.

use super::super::Fault;
use super::json::{self, Root};
use super::{bad, requirements};
use glam::{DMat4, DQuat, DVec3};

/// A node's place relative to its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    parent: Option<usize>,
    /// Instead of translation, rotation and scale; such a node cannot be animated.
    pub(super) matrix: Option<DMat4>,
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
    /// Whether the node and those below it are drawn.
    pub(super) visible: bool,
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
            for &child in &json.children {
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
        let number = root.scene.unwrap_or(0);
        let Some(scene) = root.scenes.get(number) else {
            return match root.scene {
                Some(_) => Err(bad(format!("scene {number} does not exist"))),
                None => Ok(self.parents_first.clone()),
            };
        };
        let roots = &scene.nodes;
        let mut listed = vec![false; self.nodes.len()];
        for &node in roots {
            // A node listed twice, or below a listed one, would be drawn twice.
            let is_root = self.nodes.get(node).is_some_and(|node| node.parent.is_none());
            if !is_root || std::mem::replace(&mut listed[node], true) {
                return Err(bad(format!("node {node} is not a root of scene {number}")));
            }
        }
        Ok(depth_first(root, roots))
    }

    /// Whether each node is drawn: it and all above it are visible.
    pub(super) fn drawn(&self) -> Vec<bool> {
        let mut drawn = vec![true; self.nodes.len()];
        for &node in &self.parents_first {
            let Node { visible, parent, .. } = self.nodes[node];
            drawn[node] = visible && parent.is_none_or(|parent| drawn[parent]);
        }
        drawn
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

/// The nodes below `roots`; ends on any graph in which no node has two parents.
fn depth_first(root: &Root, roots: &[usize]) -> Vec<usize> {
    let mut order = Vec::new();
    let mut stack: Vec<usize> = roots.iter().rev().copied().collect();
    while let Some(node) = stack.pop() {
        order.push(node);
        stack.extend(root.nodes[node].children.iter().rev());
    }
    order
}

/// A node as the file has it, without its parent.
fn at_rest(json: &json::Node) -> Node {
    Node {
        parent: None,
        matrix: json.matrix.map(|columns| DMat4::from_cols_array(&columns)),
        translation: DVec3::from_array(json.translation.unwrap_or([0.0; 3])),
        rotation: unit(json.rotation.map_or(DQuat::IDENTITY, DQuat::from_array)),
        scale: DVec3::from_array(json.scale.unwrap_or([1.0; 3])),
        visible: requirements::visible(&json.extensions),
    }
}

/// The rotation that a quaternion means, whatever its length.
pub(super) fn unit(quaternion: DQuat) -> DQuat {
    let length = quaternion.length();
    if length > 0.0 && length.is_finite() { quaternion / length } else { DQuat::IDENTITY }
}
