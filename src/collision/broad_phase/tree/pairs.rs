//! Pairs of overlapping boxes in a tree, or in two trees.

use alloc::vec::Vec;

use super::{NONE, Node, Tree};
use crate::body::CollisionClass;
use crate::collision::contact::Pair;

/// Number of buffered pairs at which the buffer is reported and emptied.
const FOUND_MAX: usize = 256;

/// List with a branch-free push: whether two boxes overlap is hard to predict, and a mispredicted branch costs more
/// than an unnecessary store. A push always writes the pair, but counts only a wanted pair.
#[derive(Clone, Debug, Default)]
struct PairList {
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

#[derive(Clone, Debug, Default)]
pub(in crate::collision::broad_phase) struct Meetings {
    /// Pairs of nodes still to visit: overlapping pairs with at least one inner node, and inner nodes paired with
    /// themselves.
    waiting: PairList,
    found: PairList,
}

impl Meetings {
    /// Finds each pair of overlapping boxes of a tree once, except pairs within a subtree of one collision class. Skips
    /// a pair of nodes if neither of them is `wanted`.
    pub(in crate::collision::broad_phase) fn within(
        &mut self,
        tree: &Tree,
        wanted: impl Fn(&Node) -> bool,
        mut found: impl FnMut(Pair),
    ) {
        let itself = |node: u32| {
            let meets = node != NONE && wanted(tree.at(node)) && !tree.at(node).is_leaf();
            ((node, node), meets)
        };
        self.waiting.push_wanted([itself(tree.root)]);
        while let Some((a, b)) = self.waiting.pop() {
            if a != b {
                self.visit((tree, a), (tree, b), &wanted);
            } else if tree.at(a).class == CollisionClass::NONE {
                let [a0, a1] = tree.children_of(a);
                self.waiting.push_wanted([itself(a0.0), itself(a1.0)]);
                self.meet([[a0, a1]], &wanted);
            }
            self.tell_if_full(&mut found);
        }
        self.found.tell(&mut found);
    }

    /// Like [`Meetings::within`], but for pairs of a box of `tree` and a box of `other`.
    pub(in crate::collision::broad_phase) fn between(
        &mut self,
        tree: &Tree,
        other: &Tree,
        wanted: impl Fn(&Node) -> bool,
        mut found: impl FnMut(Pair),
    ) {
        if tree.root == NONE || other.root == NONE {
            return;
        }
        self.meet([[(tree.root, tree.at(tree.root)), (other.root, other.at(other.root))]], &wanted);
        while let Some((a, b)) = self.waiting.pop() {
            self.visit((tree, a), (other, b), &wanted);
            self.tell_if_full(&mut found);
        }
        self.found.tell(&mut found);
    }

    /// Tests the children of two overlapping nodes against each other.
    #[inline(always)]
    fn visit(
        &mut self,
        (tree_a, a): (&Tree, u32),
        (tree_b, b): (&Tree, u32),
        wanted: &impl Fn(&Node) -> bool,
    ) {
        let (node_a, node_b) = (tree_a.at(a), tree_b.at(b));
        if node_a.class.common(node_b.class) != CollisionClass::NONE {
            return;
        }
        if node_a.is_leaf() {
            let (leaf, [b0, b1]) = ((a, node_a), tree_b.children_of(b));
            self.meet([[leaf, b0], [leaf, b1]], wanted);
        } else if node_b.is_leaf() {
            let ([a0, a1], leaf) = (tree_a.children_of(a), (b, node_b));
            self.meet([[a0, leaf], [a1, leaf]], wanted);
        } else {
            let ([a0, a1], [b0, b1]) = (tree_a.children_of(a), tree_b.children_of(b));
            self.meet([[a0, b0], [a0, b1], [a1, b0], [a1, b1]], wanted);
        }
    }

    #[inline(always)]
    fn meet<const N: usize>(&mut self, pairs: [[(u32, &Node); 2]; N], wanted: &impl Fn(&Node) -> bool) {
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

    #[inline(always)]
    fn tell_if_full(&mut self, found: &mut impl FnMut(Pair)) {
        if self.found.len >= FOUND_MAX {
            self.found.tell(found);
        }
    }
}

impl Tree {
    /// Sets or clears the mark of a slot's leaf and its ancestors.
    pub(in crate::collision::broad_phase) fn mark(&mut self, slot: u32, marked: bool) {
        let mut at = self.leaf_of(slot).unwrap_or(NONE);
        while at != NONE && self.at(at).marked != marked {
            self.at_mut(at).marked = marked;
            at = self.at(at).parent;
        }
    }

    #[inline(always)]
    fn children_of(&self, node: u32) -> [(u32, &Node); 2] {
        self.at(node).children.map(|child| (child, self.at(child)))
    }
}
