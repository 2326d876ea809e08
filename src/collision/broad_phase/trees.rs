//! Two trees, one for fixed bodies and one for others. The tree of fixed bodies stays unchanged while other bodies
//! move, and no search looks for pairs of fixed bodies.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::search::Search;
use super::tree::{Meetings, Node, Tree};
use crate::body::CollisionClass;
use crate::collision::contact::Pair;
use crate::math::Aabb;

#[derive(Clone, Debug, Default)]
pub(super) struct Trees {
    moving: Tree,
    fixed: Tree,
    meetings: Meetings,
}

impl Trees {
    pub(super) fn moving_len(&self) -> usize {
        self.moving.len()
    }

    /// Numbers of moving and of fixed boxes.
    pub(super) fn lens(&self) -> (usize, usize) {
        (self.moving.len(), self.fixed.len())
    }

    pub(super) fn put(&mut self, slot: u32, fat: Aabb, fixed: bool) {
        let (own, other) = match fixed {
            true => (&mut self.fixed, &mut self.moving),
            false => (&mut self.moving, &mut self.fixed),
        };
        let class = other.collision_class(slot);
        other.remove(slot);
        own.set(slot, fat);
        if let Some(class) = class {
            own.set_collision_class(slot, class);
        }
    }

    pub(super) fn set(&mut self, slot: u32, fat: Aabb) {
        self.tree_of(slot).set(slot, fat);
    }

    pub(super) fn set_collision_class(&mut self, slot: u32, class: CollisionClass) {
        self.tree_of(slot).set_collision_class(slot, class);
    }

    fn tree_of(&mut self, slot: u32) -> &mut Tree {
        if self.fixed.has(slot) { &mut self.fixed } else { &mut self.moving }
    }

    pub(super) fn set_many(&mut self, boxes: &[(u32, Aabb)]) {
        let Trees { moving, fixed, .. } = self;
        let fixed_count = boxes.iter().filter(|(slot, _)| fixed.has(*slot)).count();
        if fixed_count == 0 {
            moving.set_many(boxes.iter().copied());
            return;
        }
        let (ours, others) = boxes.iter().copied().partition::<Vec<_>, _>(|&(slot, _)| fixed.has(slot));
        fixed.set_many(ours.into_iter());
        moving.set_many(others.into_iter());
    }

    pub(super) fn remove(&mut self, slot: u32) {
        self.moving.remove(slot);
        self.fixed.remove(slot);
    }

    /// Replaces all boxes. No slot may occur twice.
    pub(super) fn refill(&mut self, boxes: impl Iterator<Item = (u32, Aabb, bool)> + Clone) {
        let those = |wanted: bool| {
            let those = boxes.clone().filter(move |&(_, _, fixed)| fixed == wanted);
            those.map(|(slot, fat, _)| (slot, fat))
        };
        *self = Trees::default();
        self.moving.refill(those(false));
        self.fixed.refill(those(true));
    }

    /// Finds each overlapping pair once. Leaves out pairs of fixed bodies, and most pairs within one collision class.
    pub(super) fn each_pair(&mut self, found: impl FnMut(Pair)) {
        self.meet(|_| true, found);
    }

    /// Like [`Trees::each_pair`], but only for pairs with at least one of `slots`.
    pub(super) fn each_pair_of(&mut self, slots: &[u32], found: impl FnMut(Pair)) {
        self.mark(slots, true);
        self.meet(|node| node.marked, found);
        self.mark(slots, false);
    }

    fn mark(&mut self, slots: &[u32], marked: bool) {
        slots.iter().for_each(|&slot| self.tree_of(slot).mark(slot, marked));
    }

    #[inline(always)]
    fn meet(&mut self, wanted: impl Fn(&Node) -> bool, mut found: impl FnMut(Pair)) {
        let Trees { moving, fixed, meetings } = self;
        meetings.within(moving, &wanted, &mut found);
        meetings.between(moving, fixed, &wanted, &mut found);
    }

    pub(super) fn search(&self, search: &mut impl Search) -> ControlFlow<()> {
        self.moving.search(search)?;
        self.fixed.search(search)
    }

    pub(super) fn search_of(&self, fixed: bool, search: &mut impl Search) -> ControlFlow<()> {
        if fixed { self.fixed.search(search) } else { self.moving.search(search) }
    }

    pub(super) fn inner_boxes(&self) -> Vec<(Aabb, u32)> {
        [self.moving.inner_boxes(), self.fixed.inner_boxes()].concat()
    }
}
