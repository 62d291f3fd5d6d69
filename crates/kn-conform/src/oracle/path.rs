//! The path of 7.5 as it is written.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::deform::Slots;

/// The data that determine the path.
pub(crate) struct Nodes<'n> {
    /// On the I-frame, in grid steps.
    pub(crate) positions: &'n [[i64; 3]],
    pub(crate) labels: &'n [u8],
    /// Slots of every vertex.
    pub(crate) influence: &'n [Slots],
    /// Whether `label_set` is 1.
    pub(crate) body: bool,
    pub(crate) up_axis: usize,
}

/// Every node with its predecessor, in the order of the path.
pub(crate) fn path(nodes: &Nodes<'_>) -> Vec<(usize, Option<usize>)> {
    let neighbours = nodes.neighbours();
    let mut components = components(&neighbours);
    components.sort_by_key(|component| {
        let size = component.len() as i64;
        (nodes.part(component), -size, component.first().copied())
    });
    let mut path: Vec<(usize, Option<usize>)> = Vec::new();
    for component in &components {
        let (start, predecessor) = nodes.start(component, &path);
        path.push((start, predecessor));
        let mut layer = vec![start];
        while !layer.is_empty() {
            let is_next = |node: &&usize| {
                let visited = path.iter().any(|(visited, _)| visited == *node);
                !visited && layer.iter().any(|before| neighbours[*before].contains(*node))
            };
            let next: Vec<usize> = component.iter().filter(is_next).copied().collect();
            layer = nodes.ring(next, path[path.len() - 1].0);
            for &node in &layer {
                path.push((node, Some(path[path.len() - 1].0)));
            }
        }
    }
    path
}

/// Sets of nodes that neighbours connect.
fn components(neighbours: &[BTreeSet<usize>]) -> Vec<BTreeSet<usize>> {
    let mut components: Vec<BTreeSet<usize>> = Vec::new();
    for node in 0..neighbours.len() {
        if components.iter().any(|component| component.contains(&node)) {
            continue;
        }
        let mut component = BTreeSet::from([node]);
        loop {
            let reached: BTreeSet<usize> =
                component.iter().flat_map(|&node| neighbours[node].iter().copied()).collect();
            if reached.is_subset(&component) {
                break;
            }
            component.extend(reached);
        }
        components.push(component);
    }
    components
}

impl Nodes<'_> {
    fn neighbours(&self) -> Vec<BTreeSet<usize>> {
        let mut neighbours = vec![BTreeSet::new(); self.positions.len()];
        for slots in self.influence {
            for (one, _) in slots {
                for (other, _) in slots.iter().filter(|(other, _)| other != one) {
                    neighbours[*one].insert(*other);
                }
            }
        }
        neighbours
    }

    fn part(&self, component: &BTreeSet<usize>) -> u8 {
        if !self.body {
            return 14;
        }
        component.iter().map(|&node| self.labels[node]).min().unwrap_or(14)
    }

    fn mean(&self, nodes: &[usize]) -> [i64; 3] {
        let count = nodes.len() as i64;
        [0, 1, 2].map(|axis| {
            nodes.iter().map(|&node| self.positions[node][axis]).sum::<i64>().div_euclid(count)
        })
    }

    fn squared(&self, one: usize, other: usize) -> i64 {
        (0..3).map(|axis| (self.positions[one][axis] - self.positions[other][axis]).pow(2)).sum()
    }

    fn start(
        &self,
        component: &BTreeSet<usize>,
        path: &[(usize, Option<usize>)],
    ) -> (usize, Option<usize>) {
        let with_label = |label: u8| -> Vec<usize> {
            (0..self.labels.len()).filter(|&node| self.labels[node] == label).collect()
        };
        let mut references = match self.part(component) {
            1..=7 => with_label(0),
            8..=13 => with_label(7),
            _ => Vec::new(),
        };
        if references.is_empty() {
            references = path.iter().map(|(node, _)| *node).collect();
        }
        let all: Vec<usize> = component.iter().copied().collect();
        if references.is_empty() {
            let by_height = |node: &usize| (-self.positions[*node][self.up_axis], *node);
            return (all.into_iter().min_by_key(by_height).unwrap_or(0), None);
        }
        let c = self.mean(&references);
        let mean = self.mean(&all);
        let d = [0, 1, 2].map(|axis| mean[axis] - c[axis]);
        let product = |node: usize| -> i64 {
            (0..3).map(|axis| (self.positions[node][axis] - c[axis]) * d[axis]).sum()
        };
        let start = all.into_iter().min_by_key(|&node| (product(node), node)).unwrap_or(0);
        let near = |reference: &usize| (self.squared(start, *reference), *reference);
        (start, references.into_iter().min_by_key(near))
    }

    fn ring(&self, mut layer: Vec<usize>, last: usize) -> Vec<usize> {
        if layer.is_empty() {
            return layer;
        }
        let mean = self.mean(&layer);
        let [right, front] = [(self.up_axis + 2) % 3, (self.up_axis + 1) % 3];
        let seen = |node: usize| {
            let position = self.positions[node];
            (position[right] - mean[right], position[front] - mean[front])
        };
        layer.sort_by(|&a, &b| by_angle(seen(a), seen(b)).then(a.cmp(&b)));
        let begin = (0..layer.len()).min_by_key(|&place| (self.squared(layer[place], last), place));
        let begin = begin.unwrap_or(0);
        [&layer[begin..], &layer[..begin]].concat()
    }
}

fn by_angle(a: (i64, i64), b: (i64, i64)) -> Ordering {
    let first_half = |(r, f): (i64, i64)| f > 0 || (f == 0 && r > 0);
    match (a == (0, 0), b == (0, 0)) {
        (true, true) => return Ordering::Equal,
        (true, false) => return Ordering::Less,
        (false, true) => return Ordering::Greater,
        (false, false) => {}
    }
    match (first_half(a), first_half(b)) {
        (true, false) => Ordering::Less,
        (false, true) => Ordering::Greater,
        _ => 0.cmp(&(a.0 * b.1 - a.1 * b.0)),
    }
}
