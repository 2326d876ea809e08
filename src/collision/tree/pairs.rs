//! Which boxes overlap each other.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::{NONE, Tree};
use crate::collision::broad_phase::Pair;
use crate::collision::search::Overlap;

impl Tree {
    /// Calls `found` with every pair of overlapping boxes once: the tree against itself.
    pub(crate) fn each_pair(&mut self, mut found: impl FnMut(Pair)) {
        let mut stack = core::mem::take(&mut self.stack);
        stack.clear();
        if self.root != NONE {
            stack.push((self.root, self.root));
        }
        let mut meet = |a: u32, b: u32, stack: &mut Vec<Pair>| {
            let (node_a, node_b) = (self.at(a), self.at(b));
            if node_a.aabb.overlaps(node_b.aabb) {
                if node_a.is_leaf() && node_b.is_leaf() {
                    let (a, b) = (node_a.children[0], node_b.children[0]);
                    found((a.min(b), a.max(b)));
                } else {
                    stack.push((a, b));
                }
            }
        };
        while let Some((a, b)) = stack.pop() {
            let (node_a, node_b) = (self.at(a), self.at(b));
            let ([a0, a1], [b0, b1]) = (node_a.children, node_b.children);
            match (node_a.is_leaf(), node_b.is_leaf()) {
                _ if a == b => {
                    if !node_a.is_leaf() {
                        stack.extend([(a0, a0), (a1, a1)]);
                        meet(a0, a1, &mut stack);
                    }
                }
                (false, false) => {
                    for (a, b) in [(a0, b0), (a0, b1), (a1, b0), (a1, b1)] {
                        meet(a, b, &mut stack);
                    }
                }
                (true, _) => [b0, b1].into_iter().for_each(|b| meet(a, b, &mut stack)),
                (false, true) => [a0, a1].into_iter().for_each(|a| meet(a, b, &mut stack)),
            }
        }
        self.stack = stack;
    }

    /// Calls `found` with every slot whose box overlaps that of a slot, itself included.
    pub(crate) fn each_overlap_of(&self, slot: u32, mut found: impl FnMut(u32)) {
        if let Some(leaf) = self.leaf_of(slot) {
            let area = self.at(leaf).aabb;
            let visit = |slot| {
                found(slot);
                ControlFlow::Continue(())
            };
            let _never_breaks = self.search(&mut Overlap { area, visit });
        }
    }
}
