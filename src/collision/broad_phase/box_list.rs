//! Linear list of boxes by slot, for sweep and prune and as the brute-force oracle.

use alloc::vec::Vec;
use core::ops::ControlFlow;

use super::search::Search;
use crate::collision::contact::Pair;
use crate::math::Aabb;

#[derive(Clone, Debug, Default)]
pub(crate) struct BoxList {
    boxes: Vec<Option<Aabb>>,
    len: usize,
}

impl BoxList {
    pub(crate) fn set(&mut self, slot: u32, fat: Aabb) {
        let slot = slot as usize;
        if slot >= self.boxes.len() {
            self.boxes.resize(slot + 1, None);
        }
        self.len += usize::from(self.boxes[slot].replace(fat).is_none());
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        if let Some(place) = self.boxes.get_mut(slot as usize) {
            self.len -= usize::from(place.take().is_some());
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn get(&self, slot: u32) -> Option<Aabb> {
        self.boxes.get(slot as usize).copied().flatten()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (u32, Aabb)> + Clone {
        (0..).zip(&self.boxes).filter_map(|(slot, aabb)| aabb.map(|aabb| (slot, aabb)))
    }

    pub(crate) fn each_pair(&self, mut found: impl FnMut(Pair)) {
        let mut rest = self.iter();
        while let Some((a, box_a)) = rest.next() {
            for (b, _) in rest.clone().filter(|&(_, box_b)| box_a.overlaps(box_b)) {
                found((a, b));
            }
        }
    }

    pub(crate) fn search(&self, search: &mut impl Search) -> ControlFlow<()> {
        for (slot, aabb) in self.iter() {
            if search.reaches(aabb) {
                search.visit(slot)?;
            }
        }
        ControlFlow::Continue(())
    }
}
