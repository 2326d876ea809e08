//! Pairs of overlapping boxes in a tree.

use alloc::vec::Vec;

use super::{NONE, Node, Tree};
use crate::body::CollisionClass;
use crate::collision::contact::Pair;

/// Number of found pairs that are buffered before they are reported.
const FOUND_MAX: usize = 256;

/// Branch-free list of pairs. Whether two boxes overlap is nearly random, and a mispredicted branch costs more than an
/// unnecessary store: a pair is always written, and counted only if it is wanted.
#[derive(Clone, Debug, Default)]
pub(super) struct PairList {
    pairs: Vec<Pair>,
    len: usize,
}

impl PairList {
    #[inline(always)]
    fn push_wanted<const N: usize>(&mut self, pairs: [(Pair, bool); N]) {
        let end = self.len + N;
        if self.pairs.len() < end {
            self.pairs.resize(end.next_power_of_two(), (NONE, NONE));
        }
        let room = &mut self.pairs[self.len..end];
        let mut count = 0;
        for (pair, wanted) in pairs {
            room[count] = pair;
            count += usize::from(wanted);
        }
        self.len += count;
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<Pair> {
        self.len = self.len.checked_sub(1)?;
        Some(self.pairs[self.len])
    }

    fn tell(&mut self, found: &mut impl FnMut(Pair)) {
        self.pairs[..self.len].iter().for_each(|&pair| found(pair));
        self.len = 0;
    }
}

/// Stack of node pairs to visit, and buffer of slot pairs found.
#[derive(Clone, Debug, Default)]
pub(super) struct Meetings {
    /// Pairs of overlapping nodes of which at least one is an inner node, and inner nodes paired with themselves.
    waiting: PairList,
    found: PairList,
}

impl Meetings {
    /// Visits pairs of nodes that overlap and of which at least one is wanted: reports a pair of leaves, and pushes any
    /// other pair.
    #[inline(always)]
    fn meet<const N: usize>(&mut self, pairs: [[(u32, &Node); 2]; N], wanted: impl Fn(&Node) -> bool) {
        let (mut found, mut waiting) = ([((NONE, NONE), false); N], [((NONE, NONE), false); N]);
        for i in 0..N {
            let [(a, node_a), (b, node_b)] = pairs[i];
            let overlap = node_a.aabb.overlaps(node_b.aabb) & (wanted(node_a) | wanted(node_b));
            let are_leaves = node_a.is_leaf() & node_b.is_leaf();
            let (slot_a, slot_b) = (node_a.children[0], node_b.children[0]);
            found[i] = ((slot_a.min(slot_b), slot_a.max(slot_b)), overlap & are_leaves);
            waiting[i] = ((a, b), overlap & !are_leaves);
        }
        self.found.push_wanted(found);
        self.waiting.push_wanted(waiting);
    }
}

impl Tree {
    /// Calls `found` with every pair of overlapping boxes once, except for most pairs within one collision class.
    pub(crate) fn each_pair(&mut self, found: impl FnMut(Pair)) {
        self.meet_itself(|_| true, found);
    }

    /// Like [`Tree::each_pair`], for pairs with at least one of some slots.
    pub(crate) fn each_pair_of(&mut self, slots: &[u32], found: impl FnMut(Pair)) {
        slots.iter().for_each(|&slot| self.mark(slot, true));
        self.meet_itself(|node| node.marked, found);
        slots.iter().for_each(|&slot| self.mark(slot, false));
    }

    /// Sets or clears the mark of a leaf and its ancestors.
    fn mark(&mut self, slot: u32, marked: bool) {
        let mut at = self.leaf_of(slot).unwrap_or(NONE);
        while at != NONE && self.at(at).marked != marked {
            self.at_mut(at).marked = marked;
            at = self.at(at).parent;
        }
    }

    /// Traverses the tree against itself, skipping pairs of nodes of which neither is wanted.
    #[inline(always)]
    fn meet_itself(&mut self, wanted: impl Fn(&Node) -> bool, mut found: impl FnMut(Pair)) {
        let mut meetings = core::mem::take(&mut self.meetings);
        let itself = |node: u32| {
            let meets = node != NONE && wanted(self.at(node)) && !self.at(node).is_leaf();
            ((node, node), meets)
        };
        let child = |node: &Node, i: usize| (node.children[i], self.at(node.children[i]));
        meetings.waiting.push_wanted([itself(self.root)]);
        while let Some((a, b)) = meetings.waiting.pop() {
            let (node_a, node_b) = (self.at(a), self.at(b));
            if node_a.class.common(node_b.class) != CollisionClass::NONE {
                continue;
            }
            if a == b {
                let [a0, a1] = [child(node_a, 0), child(node_a, 1)];
                meetings.waiting.push_wanted([itself(a0.0), itself(a1.0)]);
                meetings.meet([[a0, a1]], &wanted);
            } else if node_a.is_leaf() {
                let leaf = (a, node_a);
                meetings.meet([[leaf, child(node_b, 0)], [leaf, child(node_b, 1)]], &wanted);
            } else if node_b.is_leaf() {
                let leaf = (b, node_b);
                meetings.meet([[child(node_a, 0), leaf], [child(node_a, 1), leaf]], &wanted);
            } else {
                let [a0, a1] = [child(node_a, 0), child(node_a, 1)];
                let [b0, b1] = [child(node_b, 0), child(node_b, 1)];
                meetings.meet([[a0, b0], [a0, b1], [a1, b0], [a1, b1]], &wanted);
            }
            if meetings.found.len >= FOUND_MAX {
                meetings.found.tell(&mut found);
            }
        }
        meetings.found.tell(&mut found);
        self.meetings = meetings;
    }
}
