//! Walks a tree, nearest boxes first, in bounded work.

use super::build::MAX_LEVELS;
use super::node::{CHILDREN, Child, Node, Query};
use crate::lanes::lanes;

/// Nodes and leaves that can wait at once: of each node on the way all children but one.
const STACK: usize = MAX_LEVELS * (CHILDREN - 1) + CHILDREN;

/// Nodes and leaves that a search visits before it becomes less exact. A query near a surface
/// visits 20 to 40 of them (`docs/notes/metrics.md`), so that only searches among hundreds of
/// equally near boxes come here: from the centre of a sphere, or from far away onto a plane.
const VISITS: u32 = 256;

/// A search for what is near a query.
pub(crate) trait Search {
    /// Nothing whose lower bound (a squared distance, in the tree's units) is at least this is
    /// wanted.
    fn limit(&self) -> f32;

    /// Looks at what a leaf holds.
    fn visit(&mut self, leaf: usize);

    /// Told when the search has taken long: `limit` must follow.
    fn hurry(&mut self);
}

/// How exact a search still is. It starts exact; where hundreds of boxes are equally near it then
/// leaves out what is nearer by a small part only, and ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Patience {
    /// What is nearer than this part of the least distance so far is looked for.
    part: f64,
}

impl Patience {
    pub(crate) const FULL: Self = Self { part: 1.0 };

    /// What part of a distance is still looked for; 0 where the search has to end.
    #[inline]
    pub(crate) fn part(self) -> f64 {
        self.part
    }

    /// 1, then 63 / 64, 7 / 8, and 0.
    pub(crate) fn less(self) -> Self {
        let lost = if self.part == 1.0 { 1.0 / 64.0 } else { 8.0 * (1.0 - self.part) };
        Self { part: if lost < 1.0 { 1.0 - lost } else { 0.0 } }
    }
}

/// Nodes and leaves with their lower bounds, the next one on top.
struct Waiting {
    stack: [(f32, Child); STACK],
    count: usize,
}

impl Waiting {
    fn new(root: Child) -> Self {
        Self { stack: [(0.0, root); STACK], count: 1 }
    }

    #[inline]
    fn pop(&mut self) -> Option<(f32, Child)> {
        self.count = self.count.checked_sub(1)?;
        Some(self.stack[self.count])
    }

    /// Keeps what is above `bottom` sorted, the nearest on top.
    #[inline]
    fn push_above(&mut self, bottom: usize, entry: (f32, Child)) {
        let mut place = self.count;
        while place > bottom && self.stack[place - 1].0 < entry.0 {
            self.stack[place] = self.stack[place - 1];
            place -= 1;
        }
        self.stack[place] = entry;
        self.count += 1;
    }
}

/// Shows the search all leaves that can hold what it wants, those of near boxes first. There must
/// be a root.
#[inline]
pub(crate) fn descend(nodes: &[Node], query: &Query, search: &mut impl Search) {
    let mut waiting = Waiting::new(Child::node(0));
    let mut visits = 0;
    while let Some((bound, child)) = waiting.pop() {
        if bound >= search.limit() {
            continue;
        }
        visits += 1;
        if visits % VISITS == 0 {
            search.hurry();
        }
        match child.get() {
            Ok(leaf) => search.visit(leaf),
            Err(node) => {
                let node = &nodes[node];
                let (bounds, hits) = node.children_within(query, search.limit());
                let bottom = waiting.count;
                for lane in lanes(hits) {
                    waiting.push_above(bottom, (bounds[lane], node.children[lane]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bounds, Item, Lanes, build};
    use super::*;

    /// A search that never finds anything nearer.
    struct Fruitless {
        patience: Patience,
        leaves: u32,
        hurries: u32,
    }

    impl Search for Fruitless {
        fn limit(&self) -> f32 {
            self.patience.part() as f32
        }

        fn visit(&mut self, _: usize) {
            self.leaves += 1;
        }

        fn hurry(&mut self) {
            self.hurries += 1;
            self.patience = self.patience.less();
        }
    }

    #[test]
    fn work_is_bounded_where_all_boxes_are_equally_near() {
        for count in [10, 100_000] {
            let mut bounds = Bounds::EMPTY;
            bounds.include([-1.0; 3]);
            bounds.include([1.0; 3]);
            let mut items: Vec<Item> = (0..count).map(|index| Item { bounds, index }).collect();
            let nodes = build(&mut items, 4, |_, _| ());
            let mut search = Fruitless { patience: Patience::FULL, leaves: 0, hurries: 0 };
            descend(&nodes, &[Lanes::ZERO; 3], &mut search);
            let all = count.div_ceil(4);
            assert!(search.leaves <= 3 * VISITS && search.hurries <= 3);
            assert!(count > 10 || (search.leaves >= all && search.hurries == 0));
        }
    }

    #[test]
    fn patience_ends() {
        let parts = [1.0, 63.0 / 64.0, 7.0 / 8.0, 0.0];
        let mut patience = Patience::FULL;
        for part in parts {
            assert_eq!(patience.part(), part);
            patience = patience.less();
        }
        assert_eq!(patience.part(), 0.0);
    }
}
