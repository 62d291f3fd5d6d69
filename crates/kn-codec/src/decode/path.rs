//! The path that spatial prediction follows over the key nodes: a spiral from the top of each
//! component downwards (`spec/07-motion.md`, 7.5). Integers only.

use crate::decode::node_graph::NodeGraph;
use kn_bitstream::params::{BodyPart, Region};
use kn_deform::Influence;
use std::cmp::Ordering;

/// A step of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Visit {
    pub(crate) node: u16,
    /// The node that it is predicted from, visited before; `None` for the first of the path.
    pub(crate) from: Option<u16>,
}

/// The data that determine the path.
pub(crate) struct Sites<'s> {
    /// `#N × 3`, on the I-frame, in grid steps.
    pub(crate) positions: &'s [[i32; 3]],
    /// `#N`, parts of a body; `None` where labels mean something else.
    pub(crate) body_labels: Option<&'s [u8]>,
    pub(crate) influence: &'s Influence,
    pub(crate) up_axis: usize,
}

/// Finds the path. It visits every node once.
pub(crate) fn trace_path(sites: &Sites<'_>) -> Vec<Visit> {
    let graph = NodeGraph::new(sites.positions.len(), sites.influence);
    let mut components: Vec<(BodyPart, Vec<u16>)> =
        graph.components().into_iter().map(|nodes| (sites.part_of(&nodes), nodes)).collect();
    // Stable: of equals the one with the lowest node stays first.
    components.sort_by_key(|(part, nodes)| (*part, std::cmp::Reverse(nodes.len())));
    let mut visited = vec![false; sites.positions.len()];
    let mut path = Vec::with_capacity(visited.len());
    for (part, component) in &components {
        let start = sites.start(*part, component, &path);
        visited[usize::from(start.node)] = true;
        path.push(start);
        let mut layer = vec![start.node];
        let mut last = start.node;
        while !layer.is_empty() {
            layer = next_layer(&graph, &layer, &mut visited);
            sites.wind(&mut layer, last);
            for &node in &layer {
                path.push(Visit { node, from: Some(last) });
                last = node;
            }
        }
    }
    path
}

/// The nodes around a layer that are not visited yet (`path.layers`). Marks them as visited.
fn next_layer(graph: &NodeGraph, layer: &[u16], visited: &mut [bool]) -> Vec<u16> {
    let around = layer.iter().flat_map(|&node| graph.neighbours(node));
    around.filter(|&node| !std::mem::replace(&mut visited[usize::from(node)], true)).collect()
}

impl Sites<'_> {
    /// The first part of a component in the order of the body (`path.part`).
    fn part_of(&self, component: &[u16]) -> BodyPart {
        let label = |labels: &[u8]| component.iter().map(|&n| labels[usize::from(n)]).min();
        let label = self.body_labels.and_then(label);
        label.and_then(BodyPart::from_label).unwrap_or(BodyPart::Other)
    }

    /// Finds the node where the spiral of a component begins, and the node that it is predicted
    /// from.
    fn start(&self, part: BodyPart, component: &[u16], path: &[Visit]) -> Visit {
        let references = self.references(part, path);
        if references.is_empty() {
            let height =
                |&&node: &&u16| (self.position(node)[self.up_axis], std::cmp::Reverse(node));
            let node = component.iter().max_by_key(height).copied().unwrap_or(0);
            return Visit { node, from: None };
        }
        let origin = self.centre(&references);
        let centre = self.centre(component);
        let along: [i64; 3] = std::array::from_fn(|axis| centre[axis] - origin[axis]);
        let distance = |&&node: &&u16| -> i64 {
            let position = self.position(node);
            (0..3).map(|axis| (position[axis] - origin[axis]) * along[axis]).sum()
        };
        // The first of equals is the lowest: the list rises.
        let node = component.iter().min_by_key(distance).copied().unwrap_or(0);
        let near = |&&other: &&u16| (self.squared(node, other), other);
        Visit { node, from: references.iter().min_by_key(near).copied() }
    }

    /// The nodes that a component's start is sought and predicted from (`path.references`).
    fn references(&self, part: BodyPart, path: &[Visit]) -> Vec<u16> {
        let wanted = match part.region() {
            Region::Head | Region::Other => None,
            Region::Torso | Region::LeftArm | Region::RightArm => Some(BodyPart::Head.label()),
            Region::LeftLeg | Region::RightLeg => Some(BodyPart::Torso.label()),
        };
        let labels = self.body_labels.unwrap_or_default();
        let of_part = (0_u16..).zip(labels).filter(|(_, label)| Some(**label) == wanted);
        let references: Vec<u16> = of_part.map(|(node, _)| node).collect();
        if references.is_empty() {
            path.iter().map(|visit| visit.node).collect()
        } else {
            references
        }
    }

    /// Puts a layer in the order of the spiral: clockwise seen from above, from the node that is
    /// nearest to `last` on (`path.ring`).
    fn wind(&self, ring: &mut [u16], last: u16) {
        let centre = self.centre(ring);
        ring.sort_unstable_by(|&a, &b| {
            clockwise(self.seen_from_above(a, centre), self.seen_from_above(b, centre))
                .then(a.cmp(&b))
        });
        let near = |&(_, &node): &(usize, &u16)| self.squared(node, last);
        let first = ring.iter().enumerate().min_by_key(near).map_or(0, |(place, _)| place);
        ring.rotate_left(first);
    }

    fn position(&self, node: u16) -> [i64; 3] {
        self.positions[usize::from(node)].map(i64::from)
    }

    fn squared(&self, one: u16, other: u16) -> i64 {
        let (a, b) = (self.position(one), self.position(other));
        (0..3).map(|axis| (a[axis] - b[axis]) * (a[axis] - b[axis])).sum()
    }

    /// Mean of the positions, rounded down.
    fn centre(&self, nodes: &[u16]) -> [i64; 3] {
        std::array::from_fn(|axis| {
            let sum: i64 = nodes.iter().map(|&node| self.position(node)[axis]).sum();
            sum.div_euclid(nodes.len().max(1) as i64)
        })
    }

    /// A node relative to `centre` in the plane that is seen from above: a turn from the first
    /// coordinate's axis to the second's is clockwise.
    fn seen_from_above(&self, node: u16, centre: [i64; 3]) -> [i64; 2] {
        let position = self.position(node);
        [2, 1].map(|offset| (self.up_axis + offset) % 3).map(|axis| position[axis] - centre[axis])
    }
}

/// Order by the angle from the first axis towards the second, from 0 to a whole turn; the centre
/// comes first. Exact: coordinates are below 2^21, products below 2^42.
fn clockwise(a: [i64; 2], b: [i64; 2]) -> Ordering {
    let half = |[p, q]: [i64; 2]| match (p, q) {
        (0, 0) => 0,
        _ if q > 0 || (q == 0 && p > 0) => 1,
        _ => 2,
    };
    let cross = a[0] * b[1] - a[1] * b[0];
    half(a).cmp(&half(b)).then(0.cmp(&cross))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Vertices that are moved by two nodes each.
    fn edges(pairs: &[[u16; 2]]) -> Influence {
        let nodes = pairs.as_flattened().to_vec();
        Influence { nodes_per_vertex: 2, weights: vec![0.5; nodes.len()], nodes }
    }

    fn order(path: &[Visit]) -> Vec<u16> {
        path.iter().map(|visit| visit.node).collect()
    }

    #[test]
    fn a_layer_is_wound_clockwise_seen_from_above() {
        // Node 0 on top, a ring of four below it: at +x, +z, −x, −z where y is up.
        let ring = [[5, 0, 0], [0, 0, 5], [-5, 0, 0], [0, 0, -5]];
        let mut positions = vec![[4, 9, -3]];
        positions.extend(ring);
        let influence = edges(&[[0, 4], [0, 2], [0, 1], [3, 0]]);
        for up_axis in 0..3 {
            let mut turned = positions.clone();
            turned.iter_mut().for_each(|p| p.rotate_right((up_axis + 2) % 3));
            let sites =
                Sites { positions: &turned, body_labels: None, influence: &influence, up_axis };
            let path = trace_path(&sites);
            // The top is nearest to the node at +x.
            assert_eq!(order(&path), [0, 1, 2, 3, 4], "up {up_axis}");
            assert_eq!(path[0].from, None);
            assert!(path.windows(2).all(|pair| pair[1].from == Some(pair[0].node)));
        }
    }

    #[test]
    fn angles_are_compared_exactly() {
        let around = [[0, 0], [3, 0], [2_000_000, 1], [1, 1], [0, 4], [-1, 0], [0, -2], [9, -1]];
        for (i, &a) in around.iter().enumerate() {
            for (j, &b) in around.iter().enumerate() {
                assert_eq!(clockwise(a, b), i.cmp(&j), "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn components_follow_the_order_of_the_body() {
        // Head 3, arm 2, torso 0, thigh 4 with its foot 5, something held 1.
        let positions = [[0, 50, 0], [9, 9, 9], [20, 60, 0], [0, 90, 0], [0, 30, 0], [0, 0, 0]];
        let labels = [7, 14, 4, 0, 8, 10];
        let influence = edges(&[[0, 0], [5, 4]]);
        let sites = Sites {
            positions: &positions,
            body_labels: Some(&labels),
            influence: &influence,
            up_axis: 1,
        };
        let path = trace_path(&sites);
        assert_eq!(order(&path), [3, 2, 0, 4, 5, 1]);
        let from: Vec<_> = path.iter().map(|visit| visit.from).collect();
        assert_eq!(from, [None, Some(3), Some(3), Some(0), Some(4), Some(5)]);
        // Without a torso the thigh follows the nearest node so far.
        let labels = [6, 14, 4, 0, 8, 10];
        let path = trace_path(&Sites { body_labels: Some(&labels), ..sites });
        assert_eq!(order(&path), [3, 2, 0, 4, 5, 1]);
        assert_eq!(path[3].from, Some(0));
    }

    #[test]
    fn without_parts_the_largest_component_is_first() {
        let positions = [[0, 9, 0], [0, 1, 0], [0, 2, 0], [0, 40, 0]];
        let influence = edges(&[[1, 2]]);
        let sites =
            Sites { positions: &positions, body_labels: None, influence: &influence, up_axis: 1 };
        assert_eq!(order(&trace_path(&sites)), [2, 1, 0, 3]);
    }
}
