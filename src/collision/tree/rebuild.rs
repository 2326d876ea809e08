//! Building a tree from the top: the boxes are halved at the median of their centres, again and again, so that the
//! height is the logarithm of their number. Nodes are stored in the order of a search.

use alloc::vec::Vec;

use super::{NONE, Node, Tree};
use crate::math::{Aabb, Fx, Vec2};

/// A leaf that is not in the tree yet: where its centre is, and itself.
type Loose = (Vec2<Fx>, Node);

impl Tree {
    /// Replaces all boxes.
    pub(crate) fn refill(&mut self, boxes: impl IntoIterator<Item = (u32, Aabb)>) {
        self.nodes.clear();
        self.leaves.clear();
        self.vacant = NONE;
        // The slots are told apart first: of one that comes twice, the last box stays.
        for (slot, fat) in boxes {
            self.leaves.resize(self.leaves.len().max(slot as usize + 1), NONE);
            match self.leaf_of(slot) {
                Some(leaf) => self.at_mut(leaf).aabb = fat,
                None => self.leaves[slot as usize] = self.allocate(Node::leaf(slot, fat)),
            }
        }
        self.rebuild();
    }

    /// Inserts or moves many boxes. Those that are there already stay where they are in the tree, and the inner boxes are
    /// found anew: cheaper than moving each, for boxes that have not come far.
    pub(crate) fn set_many(&mut self, boxes: impl IntoIterator<Item = (u32, Aabb)>) {
        for (slot, fat) in boxes {
            match self.leaf_of(slot) {
                Some(leaf) => self.at_mut(leaf).aabb = fat,
                None => self.set(slot, fat),
            }
        }
        let mut inner = Vec::with_capacity(self.nodes.len() / 2);
        inner.extend((self.root != NONE && !self.at(self.root).is_leaf()).then_some(self.root));
        let mut next = 0;
        while let Some(&node) = inner.get(next) {
            let children = self.at(node).children;
            inner.extend(children.into_iter().filter(|&child| !self.at(child).is_leaf()));
            next += 1;
        }
        // Children are behind their parents.
        inner.into_iter().rev().for_each(|node| self.refit(node));
    }

    /// Builds the tree anew around the leaves that there are.
    pub(super) fn rebuild(&mut self) {
        let leaves = self.leaves.iter().filter(|&&leaf| leaf != NONE).map(|&leaf| *self.at(leaf));
        let mut loose: Vec<Loose> = leaves.map(|leaf| (leaf.aabb.centre(), leaf)).collect();
        self.nodes.clear();
        self.nodes.reserve(2 * loose.len());
        (self.root, self.vacant) = (NONE, NONE);
        self.len = u32::try_from(loose.len()).expect("fewer than 2^31 shapes");
        self.build(&mut loose);
        // Children have been stored behind their parents.
        for index in (0..u32::try_from(self.nodes.len()).expect("fewer than 2^32 nodes")).rev() {
            if !self.at(index).is_leaf() {
                self.refit(index);
            }
        }
    }

    /// Stores the nodes, inner ones without boxes and heights.
    fn build(&mut self, loose: &mut [Loose]) {
        // Parts that wait for their parent's first half to be done.
        let mut waiting: Vec<(&mut [Loose], u32)> = Vec::new();
        waiting.push((loose, NONE));
        while let Some((part, parent)) = waiting.pop() {
            let node = match part {
                [] => continue,
                [(_, leaf)] => Node { parent, ..*leaf },
                _ => Node { aabb: Aabb::default(), parent, height: 1, children: [NONE, NONE] },
            };
            let index = self.allocate(node);
            self.replace_child(parent, NONE, index);
            if let [_, _, ..] = part {
                let (first, second) = halved(part);
                waiting.extend([(second, index), (first, index)]);
            } else {
                self.leaves[node.children[0] as usize] = index;
            }
        }
    }
}

/// Two halves on either side of the median along the axis on which the centres are farther apart. Slots break ties.
fn halved(part: &mut [Loose]) -> (&mut [Loose], &mut [Loose]) {
    let around = Aabb::from_points(part.iter().map(|&(centre, _)| centre)).unwrap_or_default();
    let width = around.upper.x.to_bits().abs_diff(around.lower.x.to_bits());
    let height = around.upper.y.to_bits().abs_diff(around.lower.y.to_bits());
    let middle = part.len() / 2;
    if width >= height {
        part.select_nth_unstable_by_key(middle, |(centre, leaf)| (centre.x, leaf.children[0]));
    } else {
        part.select_nth_unstable_by_key(middle, |(centre, leaf)| (centre.y, leaf.children[0]));
    }
    part.split_at_mut(middle)
}
