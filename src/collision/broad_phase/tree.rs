//! Dynamic AABB tree. Every box is a leaf, and an inner node has the box around its two children.
//!
//! The cost of a tree is the sum of the perimeters of its inner boxes, because a random search visits a proportional
//! number of nodes (J. Goldsmith, J. Salmon, 1987). A new leaf descends greedily to the place of least added cost. On
//! the way back up, a child is exchanged with a child of its sibling if that reduces the perimeters, as in Box2D v3.
//! Nested boxes would make a chain of nodes, so the heights of siblings differ by at most [`IMBALANCE_MAX`], as in a
//! relaxed AVL tree (G. Adelson-Velsky, E. Landis, 1962): an insertion or removal changes heights by one, and one
//! exchange of nodes on each level restores the balance.
//!
//! A box that moves a little only enlarges its ancestors. Moving many boxes at once refits or rebuilds the tree
//! (`rebuild.rs`).

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::search::Search;
use crate::body::CollisionClass;
use crate::math::Aabb;
pub(super) use pairs::Meetings;
use rebuild::Rebuilt;

mod balance;
mod pairs;
mod rebuild;
#[cfg(test)]
mod tests;

const NONE: u32 = u32::MAX;

/// Largest difference of the heights of two siblings. A large value lets a long ground box stay near the root. With 4,
/// finding the pairs of 10 000 boxes on some long ground boxes takes several times as long.
const IMBALANCE_MAX: u8 = 16;

/// Stack size of a search: one waiting node per level, plus one. Enough for 2^31 boxes.
const STACK_LEN: usize = 192;

#[derive(Clone, Debug)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    root: u32,
    /// First vacant node. The `parent` of a vacant node is the next vacant one.
    vacant: u32,
    /// Leaf of each slot, or [`NONE`].
    leaves: Vec<u32>,
    len: u32,
    /// Number of leaves inserted or removed since the last rebuild. While it is 0, every node is in use and stored
    /// before its children.
    relinked: u32,
    /// Number of moves since the last refit or rebuild that left a leaf in place although its fourth ancestor did not
    /// contain the new box. See [`Tree::stays_near`].
    strays: u32,
    rebuilt: Rebuilt,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    aabb: Aabb,
    parent: u32,
    /// 0 for a leaf.
    height: u8,
    /// Collision class of a leaf. For an inner node, the class that all leaves below have, or
    /// [`CollisionClass::NONE`] if their classes differ.
    class: CollisionClass,
    /// Whether the current search wants the pairs of this leaf or, for an inner node, of a leaf below.
    pub(super) marked: bool,
    /// Children. For a leaf, its slot and [`NONE`].
    children: [u32; 2],
}

impl Default for Tree {
    fn default() -> Self {
        Tree {
            nodes: Vec::new(),
            root: NONE,
            vacant: NONE,
            leaves: Vec::new(),
            len: 0,
            relinked: 0,
            strays: 0,
            rebuilt: Rebuilt::default(),
        }
    }
}

impl Tree {
    pub(crate) fn len(&self) -> usize {
        self.len as usize
    }

    pub(crate) fn set(&mut self, slot: u32, fat: Aabb) {
        match self.leaf_of(slot) {
            Some(leaf) if self.at(leaf).aabb == fat => {}
            Some(leaf) if self.stays_near(leaf, fat) => self.enlarge(leaf, fat),
            // A few misplaced leaves stay in place, and their ancestors are enlarged: relinking them would lose the
            // storage order that makes a refit fast.
            Some(leaf) if self.strays < self.len / 8 => {
                self.strays += 1;
                self.enlarge(leaf, fat);
            }
            Some(leaf) => {
                self.unlink(leaf);
                self.at_mut(leaf).aabb = fat;
                self.link(leaf);
            }
            None => {
                let leaf = self.allocate(Node::leaf(slot, fat));
                self.leaves.resize(self.leaves.len().max(slot as usize + 1), NONE);
                self.leaves[slot as usize] = leaf;
                self.len += 1;
                self.link(leaf);
            }
        }
    }

    #[inline]
    pub(crate) fn has(&self, slot: u32) -> bool {
        self.leaf_of(slot).is_some()
    }

    pub(crate) fn collision_class(&self, slot: u32) -> Option<CollisionClass> {
        self.leaf_of(slot).map(|leaf| self.at(leaf).class)
    }

    pub(crate) fn set_collision_class(&mut self, slot: u32, class: CollisionClass) {
        if let Some(leaf) = self.leaf_of(slot).filter(|&leaf| self.at(leaf).class != class) {
            self.at_mut(leaf).class = class;
            let mut at = self.at(leaf).parent;
            while at != NONE {
                let before = self.at(at).class;
                self.refit(at);
                if self.at(at).class == before {
                    break;
                }
                at = self.at(at).parent;
            }
        }
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        if let Some(leaf) = self.leaf_of(slot) {
            self.unlink(leaf);
            self.free(leaf);
            self.leaves[slot as usize] = NONE;
            self.len -= 1;
        }
    }

    pub(crate) fn search(&self, search: &mut impl Search) -> ControlFlow<()> {
        let mut stack = [self.root; STACK_LEN];
        let mut waiting = usize::from(self.root != NONE);
        while waiting > 0 {
            waiting -= 1;
            let node = self.at(stack[waiting]);
            if !search.reaches(node.aabb) {
                continue;
            }
            let [a, b] = node.children;
            if node.is_leaf() {
                search.visit(a)?;
            } else {
                let a_first = search.prefers(self.at(a).aabb, self.at(b).aabb);
                (stack[waiting], stack[waiting + 1]) = if a_first { (b, a) } else { (a, b) };
                waiting += 2;
            }
        }
        ControlFlow::Continue(())
    }

    /// Boxes of inner nodes with their depths, parents first.
    pub(crate) fn inner_boxes(&self) -> Vec<(Aabb, u32)> {
        let mut boxes = Vec::new();
        let mut waiting = Vec::from_iter((self.root != NONE).then_some((self.root, 0)));
        while let Some((index, depth)) = waiting.pop() {
            let node = self.at(index);
            if !node.is_leaf() {
                boxes.push((node.aabb, depth));
                waiting.extend(node.children.iter().rev().map(|&child| (child, depth + 1)));
            }
        }
        boxes
    }

    /// Sets the box of a leaf, and enlarges its ancestors to contain the box. The next refit or rebuild shrinks the
    /// ancestors.
    fn enlarge(&mut self, leaf: u32, fat: Aabb) {
        self.at_mut(leaf).aabb = fat;
        let mut at = self.at(leaf).parent;
        while at != NONE && !self.at(at).aabb.contains(fat) {
            let node = self.at_mut(at);
            node.aabb = node.aabb.union(fat);
            at = node.parent;
        }
    }

    fn link(&mut self, leaf: u32) {
        self.relinked = self.relinked.saturating_add(1);
        if self.root == NONE {
            self.root = leaf;
            return;
        }
        let sibling = self.best_sibling(self.at(leaf).aabb);
        let grandparent = self.at(sibling).parent;
        let parent = self.allocate(Node { children: [sibling, leaf], ..*self.at(sibling) });
        self.replace_child(grandparent, sibling, parent);
        self.at_mut(sibling).parent = parent;
        self.at_mut(leaf).parent = parent;
        self.repair(parent);
    }

    /// Takes a leaf out of the tree: its sibling replaces their parent.
    fn unlink(&mut self, leaf: u32) {
        self.relinked = self.relinked.saturating_add(1);
        let parent = self.at(leaf).parent;
        if parent == NONE {
            self.root = NONE;
            return;
        }
        let Node { children: [a, b], parent: grandparent, .. } = *self.at(parent);
        let sibling = if a == leaf { b } else { a };
        self.replace_child(grandparent, parent, sibling);
        self.at_mut(sibling).parent = grandparent;
        self.at_mut(leaf).parent = NONE;
        self.free(parent);
        self.repair(grandparent);
    }

    /// The sibling with which a new leaf adds the least perimeter to the new parent and the ancestors. The search
    /// descends to the child with the smaller lower bound of this cost. The search ends when the bound exceeds the best
    /// cost, provided that the best node is low enough to have a leaf as its sibling.
    fn best_sibling(&self, fat: Aabb) -> u32 {
        let own = perimeter(fat);
        let mut at = self.root;
        let mut grown = 0_u64;
        let mut around = perimeter(self.at(at).aabb.union(fat));
        let (mut best, mut best_cost) = (at, around);
        while !self.at(at).is_leaf() {
            grown = grown.saturating_add(around - perimeter(self.at(at).aabb));
            let options = self.at(at).children.map(|child| {
                let node = self.at(child);
                let around = perimeter(node.aabb.union(fat));
                let cost = grown.saturating_add(around);
                // A sibling below this child adds at least the perimeter of the leaf and the growth of the child.
                let bound = cost.saturating_sub(perimeter(node.aabb).saturating_sub(own));
                (if node.is_leaf() { cost } else { bound }, node.height, child, around)
            });
            // Ties go to the lower child, so that coincident boxes do not form a chain.
            let (bound, _, child, child_around) = options[0].min(options[1]);
            if bound > best_cost && self.at(best).height <= IMBALANCE_MAX {
                break;
            }
            (at, around) = (child, child_around);
            let cost = grown.saturating_add(around);
            if cost <= best_cost || self.at(best).height > IMBALANCE_MAX {
                (best, best_cost) = (at, cost);
            }
        }
        best
    }

    /// Whether a leaf may stay in place with a new box: its fourth ancestor contains the box.
    fn stays_near(&self, leaf: u32, fat: Aabb) -> bool {
        let parent_of = |&at: &u32| Some(self.at(at).parent).filter(|&parent| parent != NONE);
        // With a lower ancestor, most moved boxes would be reinserted. With a higher ancestor, the tree would degrade.
        let neighbourhood = core::iter::successors(Some(leaf), parent_of).nth(4);
        neighbourhood.is_some_and(|at| self.at(at).aabb.contains(fat))
    }

    /// Updates the node `at` and its ancestors, up to the first one that does not change.
    fn repair(&mut self, mut at: u32) {
        while at != NONE {
            let Node { aabb, height, class, parent, .. } = *self.at(at);
            self.refit(at);
            self.balance(at);
            self.tighten(at, height);
            let node = self.at(at);
            if (node.aabb, node.height, node.class) == (aabb, height, class) {
                break;
            }
            at = parent;
        }
    }

    fn refit(&mut self, at: u32) {
        let [a, b] = self.at(at).children.map(|child| *self.at(child));
        let node = self.at_mut(at);
        node.aabb = a.aabb.union(b.aabb);
        node.height = 1 + a.height.max(b.height);
        node.class = a.class.common(b.class);
    }

    /// Replaces a child of a node, or the root. The caller sets the parent of the new child.
    fn replace_child(&mut self, parent: u32, old: u32, new: u32) {
        if parent == NONE {
            self.root = new;
        } else {
            let [first, second] = &mut self.at_mut(parent).children;
            *(if *first == old { first } else { second }) = new;
        }
    }

    fn leaf_of(&self, slot: u32) -> Option<u32> {
        self.leaves.get(slot as usize).copied().filter(|&leaf| leaf != NONE)
    }

    fn at(&self, index: u32) -> &Node {
        &self.nodes[index as usize]
    }

    fn at_mut(&mut self, index: u32) -> &mut Node {
        &mut self.nodes[index as usize]
    }

    fn allocate(&mut self, node: Node) -> u32 {
        let index = self.vacant;
        if index == NONE {
            self.nodes.push(node);
            return u32::try_from(self.nodes.len() - 1).expect("fewer than 2^31 shapes");
        }
        self.vacant = self.at(index).parent;
        *self.at_mut(index) = node;
        index
    }

    fn free(&mut self, index: u32) {
        self.at_mut(index).parent = self.vacant;
        self.vacant = index;
    }
}

impl Node {
    fn leaf(slot: u32, aabb: Aabb) -> Self {
        Node {
            aabb,
            parent: NONE,
            height: 0,
            class: CollisionClass::NONE,
            marked: false,
            children: [slot, NONE],
        }
    }

    fn is_leaf(&self) -> bool {
        self.height == 0
    }
}

/// Half the perimeter, in units of 2^-30 m. The sum for two boxes of the largest size fits 64 bits.
fn perimeter(aabb: Aabb) -> u64 {
    let Aabb { lower, upper } = aabb;
    (upper.x.to_bits().abs_diff(lower.x.to_bits()) >> 2)
        + (upper.y.to_bits().abs_diff(lower.y.to_bits()) >> 2)
}
