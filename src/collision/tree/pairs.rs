//! Which boxes overlap each other.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::{NONE, Node, Tree};
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
        // Two different nodes in the stack overlap, and at least one of them has children.
        let child = |node: &Node, i: usize| (node.children[i], self.at(node.children[i]));
        while let Some((a, b)) = stack.pop() {
            let (node_a, node_b) = (self.at(a), self.at(b));
            match (node_a.is_leaf(), node_b.is_leaf()) {
                _ if a == b => {
                    if !node_a.is_leaf() {
                        let [a0, a1] = node_a.children;
                        stack.extend([(a0, a0), (a1, a1)]);
                        meet(child(node_a, 0), child(node_a, 1), &mut stack, &mut found);
                    }
                }
                (false, false) => {
                    let (a0, a1) = (child(node_a, 0), child(node_a, 1));
                    let (b0, b1) = (child(node_b, 0), child(node_b, 1));
                    meet(a0, b0, &mut stack, &mut found);
                    meet(a0, b1, &mut stack, &mut found);
                    meet(a1, b0, &mut stack, &mut found);
                    meet(a1, b1, &mut stack, &mut found);
                }
                (true, _) => {
                    meet((a, node_a), child(node_b, 0), &mut stack, &mut found);
                    meet((a, node_a), child(node_b, 1), &mut stack, &mut found);
                }
                (false, true) => {
                    meet(child(node_a, 0), (b, node_b), &mut stack, &mut found);
                    meet(child(node_a, 1), (b, node_b), &mut stack, &mut found);
                }
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

/// Two nodes that overlap are a pair, or have something to be looked at later. Inlined wherever it is called, whatever a
/// compiler thinks of it: all there is to finding pairs is this.
#[inline(always)]
fn meet(
    (a, node_a): (u32, &Node),
    (b, node_b): (u32, &Node),
    stack: &mut Vec<Pair>,
    found: &mut impl FnMut(Pair),
) {
    if node_a.aabb.overlaps(node_b.aabb) {
        if node_a.is_leaf() && node_b.is_leaf() {
            let (a, b) = (node_a.children[0], node_b.children[0]);
            found((a.min(b), a.max(b)));
        } else {
            stack.push((a, b));
        }
    }
}
