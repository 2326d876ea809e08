//! Refit and rebuild of whole trees. A refit recomputes the boxes from the leaves up. If the tree is then too costly,
//! or many leaves have been inserted or removed, it is rebuilt from the top, by splits at the median of the centres.
//! The height is then the logarithm of the number of boxes. Nodes are stored in depth-first order.

use alloc::vec::Vec;

use super::{NONE, Node, Tree, perimeter};
use crate::math::Aabb;

#[derive(Clone, Debug, Default)]
pub(super) struct Rebuilt {
    cost: u64,
    /// The nodes as they were before the last rebuild. A rebuild swaps this list with that of the tree, reads the old
    /// nodes here, and writes the new nodes to the tree.
    nodes: Vec<Node>,
    loose: Vec<Loose>,
    waiting: Vec<Part>,
    /// Indices of nodes, parents before their children.
    below: Vec<u32>,
}

/// A leaf with its centre on a grid of up to 2^32 cells per side.
#[derive(Clone, Copy, Debug)]
struct Loose {
    x: u32,
    y: u32,
    leaf: u32,
}

/// A range of the loose leaves that becomes the next child of a node.
#[derive(Clone, Copy, Debug)]
struct Part {
    start: usize,
    end: usize,
    parent: u32,
}

impl Tree {
    pub(crate) fn refill(&mut self, boxes: impl IntoIterator<Item = (u32, Aabb)>) {
        self.nodes.clear();
        self.leaves.clear();
        self.vacant = NONE;
        // If a slot repeats, its last box counts.
        for (slot, fat) in boxes {
            self.leaves.resize(self.leaves.len().max(slot as usize + 1), NONE);
            match self.leaf_of(slot) {
                Some(leaf) => self.at_mut(leaf).aabb = fat,
                None => self.leaves[slot as usize] = self.allocate(Node::leaf(slot, fat)),
            }
        }
        self.rebuild();
    }

    pub(crate) fn set_many(&mut self, boxes: impl ExactSizeIterator<Item = (u32, Aabb)>) {
        if boxes.len() + (self.strays as usize) < self.len() / 16 {
            boxes.for_each(|(slot, fat)| self.set(slot, fat));
            return;
        }
        for (slot, fat) in boxes {
            match self.leaf_of(slot) {
                Some(leaf) => self.at_mut(leaf).aabb = fat,
                None => self.set(slot, fat),
            }
        }
        // Rebuilds after many insertions and removals, or if the cost has grown by more than a quarter.
        if self.relinked > self.len / 4 || self.refit_all() / 5 > self.rebuilt.cost / 4 {
            self.rebuild();
        }
        self.strays = 0;
    }

    /// Refits all nodes. Returns the cost of the tree.
    fn refit_all(&mut self) -> u64 {
        if self.relinked == 0 {
            let count = u32::try_from(self.nodes.len()).expect("fewer than 2^32 nodes");
            return self.refit_each((0..count).rev());
        }
        let mut below = core::mem::take(&mut self.rebuilt.below);
        below.clear();
        below.extend((self.root != NONE).then_some(self.root));
        let mut next = 0;
        while let Some(&index) = below.get(next) {
            let node = self.at(index);
            if !node.is_leaf() {
                below.extend(node.children);
            }
            next += 1;
        }
        let cost = self.refit_each(below.iter().rev().copied());
        self.rebuilt.below = below;
        cost
    }

    /// Refits nodes, which must be listed with children before their parents. Returns the cost of the inner nodes.
    fn refit_each(&mut self, nodes: impl Iterator<Item = u32>) -> u64 {
        let mut cost = 0_u64;
        for index in nodes {
            if !self.at(index).is_leaf() {
                self.refit(index);
                cost = cost.saturating_add(perimeter(self.at(index).aabb) >> 16);
            }
        }
        cost
    }

    pub(super) fn rebuild(&mut self) {
        let mut rebuilt = core::mem::take(&mut self.rebuilt);
        core::mem::swap(&mut self.nodes, &mut rebuilt.nodes);
        rebuilt.collect(&self.leaves);
        self.nodes.clear();
        self.nodes.reserve(2 * rebuilt.loose.len());
        (self.root, self.vacant) = (NONE, NONE);
        self.len = u32::try_from(rebuilt.loose.len()).expect("fewer than 2^31 shapes");
        self.build(&mut rebuilt);
        // Children are stored after their parents, so that `refit_all` can visit the nodes in reverse order of storage.
        (self.relinked, self.strays) = (0, 0);
        rebuilt.cost = self.refit_all();
        self.rebuilt = rebuilt;
    }

    /// Builds the nodes from the loose leaves. Boxes and heights of inner nodes are placeholders until the next refit.
    fn build(&mut self, Rebuilt { nodes, loose, waiting, .. }: &mut Rebuilt) {
        waiting.clear();
        waiting.push(Part { start: 0, end: loose.len(), parent: NONE });
        // Takes the last part first, so that the nodes are stored depth first.
        while let Some(Part { start, end, parent }) = waiting.pop() {
            let node = match loose[start..end] {
                [] => continue,
                [Loose { leaf, .. }] => Node { parent, ..nodes[leaf as usize] },
                _ => Node { parent, height: 1, ..Node::leaf(NONE, Aabb::default()) },
            };
            let index = self.allocate(node);
            self.replace_child(parent, NONE, index);
            if end - start > 1 {
                let middle = start + halve(&mut loose[start..end]);
                waiting.push(Part { start: middle, end, parent: index });
                waiting.push(Part { start, end: middle, parent: index });
            } else {
                self.leaves[node.children[0] as usize] = index;
            }
        }
    }
}

impl Rebuilt {
    fn collect(&mut self, leaves: &[u32]) {
        let Rebuilt { nodes, loose, .. } = self;
        let present = || leaves.iter().filter(|&&leaf| leaf != NONE);
        let centres = present().map(|&leaf| nodes[leaf as usize].aabb.centre());
        let around = Aabb::from_points(centres).unwrap_or_default();
        let (origin, corner) = (around.lower, around.upper);
        let widest = corner
            .x
            .to_bits()
            .abs_diff(origin.x.to_bits())
            .max(corner.y.to_bits().abs_diff(origin.y.to_bits()));
        let shift = u64::BITS.saturating_sub(widest.leading_zeros()).saturating_sub(u32::BITS);
        let cell =
            |at: i64, origin: i64| u32::try_from(at.abs_diff(origin) >> shift).expect("within the grid");
        loose.clear();
        loose.extend(present().map(|&leaf| {
            let centre = nodes[leaf as usize].aabb.centre();
            let x = cell(centre.x.to_bits(), origin.x.to_bits());
            Loose { x, y: cell(centre.y.to_bits(), origin.y.to_bits()), leaf }
        }));
    }
}

/// Splits at the median along the axis of larger spread. Returns the start of the second half.
fn halve(part: &mut [Loose]) -> usize {
    let middle = part.len() / 2;
    let least_most = (u32::MAX, u32::MIN);
    let grow = |(least, most): (u32, u32), x: u32| (least.min(x), most.max(x));
    let (x, y) = part.iter().fold((least_most, least_most), |(x, y), at| (grow(x, at.x), grow(y, at.y)));
    if x.1 - x.0 >= y.1 - y.0 {
        part.select_nth_unstable_by_key(middle, |at| at.x);
    } else {
        part.select_nth_unstable_by_key(middle, |at| at.y);
    }
    middle
}
