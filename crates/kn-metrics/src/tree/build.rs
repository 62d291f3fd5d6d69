//! Builds the tree from the top by the surface-area heuristic on binned centroids.

use glam::Vec3A;

use super::node::{Bounds, CHILDREN, Child, LANES, Leaf, Node};
use kn_mesh::vec3::Vec3;

const BINS: usize = 16;

/// From this level on every split halves its range, so that no input makes the tree deep.
const BALANCED_FROM: u32 = 8;

/// Levels of nodes: beyond [`BALANCED_FROM`] each level divides at most 2³¹ faces by eight.
pub(super) const MAX_LEVELS: usize = BALANCED_FROM as usize + 11;

struct Item {
    bounds: Bounds,
    face: u32,
}

impl Item {
    #[inline]
    fn twice_centre(&self) -> Vec3A {
        self.bounds.min + self.bounds.max
    }
}

/// A range of items that becomes the child `lane` of `parent`.
struct Task {
    start: usize,
    end: usize,
    node: usize,
    level: u32,
}

/// Nodes (the first is the root) and leaves over triangles in normalised coordinates.
pub(super) fn build(
    face_count: usize,
    corners: impl Fn(usize) -> [Vec3; 3],
) -> (Vec<Node>, Vec<Leaf>) {
    let mut items: Vec<Item> = (0..face_count)
        .map(|face| Item { bounds: Bounds::of(corners(face)), face: face as u32 })
        .collect();
    let mut nodes = vec![Node::new()];
    let mut leaves = Vec::with_capacity(face_count / 3 + 1);
    let mut tasks = vec![Task { start: 0, end: face_count, node: 0, level: 0 }];
    while let Some(task) = tasks.pop() {
        let cuts = children(&mut items[task.start..task.end], task.level >= BALANCED_FROM);
        for (lane, range) in cuts.into_iter().enumerate() {
            let (start, end) = (task.start + range.0, task.start + range.1);
            let items = &items[start..end];
            let child = match items.len() {
                0 => continue,
                1..=LANES => {
                    leaves.push(leaf(items, &corners));
                    Child::leaf(leaves.len() - 1)
                }
                _ => {
                    nodes.push(Node::new());
                    tasks.push(Task { start, end, node: nodes.len() - 1, level: task.level + 1 });
                    Child::node(nodes.len() - 1)
                }
            };
            nodes[task.node].set(lane, &bounds_of(items), child);
        }
    }
    (nodes, leaves)
}

fn leaf(items: &[Item], corners: impl Fn(usize) -> [Vec3; 3]) -> Leaf {
    let mut leaf = Leaf::new();
    for item in items {
        leaf.push(item.face, corners(item.face as usize));
    }
    leaf
}

fn bounds_of(items: &[Item]) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    items.iter().for_each(|item| bounds.union(&item.bounds));
    bounds
}

/// Cuts the items into up to eight ranges: always the largest next, while it exceeds a leaf.
fn children(items: &mut [Item], balanced: bool) -> [(usize, usize); CHILDREN] {
    let mut ranges = [(0, 0); CHILDREN];
    ranges[0].1 = items.len();
    for used in 1..CHILDREN {
        let Some(largest) = (0..used).max_by_key(|&i| ranges[i].1 - ranges[i].0) else { break };
        let (start, end) = ranges[largest];
        if end - start <= LANES {
            break;
        }
        let middle = start + split(&mut items[start..end], balanced);
        ranges[largest] = (start, middle);
        ranges[used] = (middle, end);
    }
    ranges
}

/// Reorders the items and returns where the second part starts; neither part is empty.
fn split(items: &mut [Item], balanced: bool) -> usize {
    let (axis, low, extent) = longest_axis(items);
    if !balanced && extent > 0.0 {
        let to_bin = BINS as f32 / extent;
        let bin =
            |item: &Item| (((item.twice_centre()[axis] - low) * to_bin) as usize).min(BINS - 1);
        if let Some(cut) = best_cut(items, bin) {
            return partition(items, |item| bin(item) < cut);
        }
    }
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| {
        a.twice_centre()[axis].total_cmp(&b.twice_centre()[axis]).then(a.face.cmp(&b.face))
    });
    half
}

/// The axis along which the centres spread most: (axis, lowest, spread), centres doubled.
fn longest_axis(items: &[Item]) -> (usize, f32, f32) {
    let (mut low, mut high) = (Vec3A::INFINITY, Vec3A::NEG_INFINITY);
    for item in items {
        low = low.min(item.twice_centre());
        high = high.max(item.twice_centre());
    }
    let spread = high - low;
    let axis = spread.max_position();
    (axis, low[axis], spread[axis])
}

/// The first bin of the second part, by the surface-area heuristic; whole leaves are counted, so
/// that they come out full. `None` if all items are in one bin.
fn best_cut(items: &[Item], bin: impl Fn(&Item) -> usize) -> Option<usize> {
    let mut bins = [(Bounds::EMPTY, 0usize); BINS];
    for item in items {
        let (bounds, count) = &mut bins[bin(item)];
        bounds.union(&item.bounds);
        *count += 1;
    }
    let cost = |bounds: &Bounds, count: usize| bounds.half_area() * count.div_ceil(LANES) as f32;
    let mut right_costs = [f32::INFINITY; BINS];
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    for cut in (1..BINS).rev() {
        bounds.union(&bins[cut].0);
        count += bins[cut].1;
        right_costs[cut] = if count > 0 { cost(&bounds, count) } else { f32::INFINITY };
    }
    let (mut bounds, mut count) = (Bounds::EMPTY, 0);
    let mut best = (f32::INFINITY, None);
    for cut in 1..BINS {
        bounds.union(&bins[cut - 1].0);
        count += bins[cut - 1].1;
        let total = cost(&bounds, count) + right_costs[cut];
        if count > 0 && total < best.0 {
            best = (total, Some(cut));
        }
    }
    best.1
}

/// Moves the items for which `first` holds to the front; returns their number.
fn partition(items: &mut [Item], first: impl Fn(&Item) -> bool) -> usize {
    let (mut start, mut end) = (0, items.len());
    while start < end {
        if first(&items[start]) {
            start += 1;
        } else {
            end -= 1;
            items.swap(start, end);
        }
    }
    start
}
