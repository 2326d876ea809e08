//! stub
use crate::math::Aabb;
use alloc::vec::Vec;
use core::ops::ControlFlow;
/// A pair of shape slots, the smaller one first.
pub(crate) type Pair = (u32, u32);
/// kinds
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BroadPhaseKind {
    /// tree
    #[default]
    Tree,
    /// sap
    SweepAndPrune,
    /// brute
    BruteForce,
}
#[derive(Clone, Copy, Debug)]
pub(crate) enum Moved<'a> {
    All,
    Slots(&'a [u32]),
}
#[derive(Clone, Debug)]
pub(crate) struct BroadPhase {
    kind: BroadPhaseKind,
    boxes: Vec<Option<Aabb>>,
}
impl BroadPhase {
    pub(crate) fn new(kind: BroadPhaseKind) -> Self {
        BroadPhase { kind, boxes: Vec::new() }
    }
    pub(crate) fn kind(&self) -> BroadPhaseKind {
        self.kind
    }
    pub(crate) fn set(&mut self, slot: u32, fat: Aabb) {
        if self.boxes.len() <= slot as usize {
            self.boxes.resize(slot as usize + 1, None);
        }
        self.boxes[slot as usize] = Some(fat);
    }
    pub(crate) fn remove(&mut self, slot: u32) {
        if let Some(b) = self.boxes.get_mut(slot as usize) {
            *b = None;
        }
    }
    pub(crate) fn each_overlap(&self, area: Aabb, mut visit: impl FnMut(u32) -> ControlFlow<()>) {
        for (b, i) in self.boxes.iter().zip(0u32..) {
            if let Some(b) = b {
                if b.overlaps(area) && visit(i).is_break() {
                    return;
                }
            }
        }
    }
    pub(crate) fn pairs(
        &mut self,
        moved: Moved<'_>,
        accept: impl Fn(Pair) -> bool,
        limit: usize,
        pairs: &mut Vec<Pair>,
    ) -> bool {
        pairs.clear();
        let mut m = alloc::vec![matches!(moved, Moved::All); self.boxes.len()];
        if let Moved::Slots(slots) = moved {
            for &s in slots {
                if let Some(x) = m.get_mut(s as usize) {
                    *x = true;
                }
            }
        }
        for i in 0..self.boxes.len() {
            for j in i + 1..self.boxes.len() {
                if !(m[i] || m[j]) {
                    continue;
                }
                if let (Some(a), Some(b)) = (self.boxes[i], self.boxes[j]) {
                    let p = (i as u32, j as u32);
                    if a.overlaps(b) && accept(p) {
                        pairs.push(p);
                    }
                }
            }
        }
        let over = pairs.len() > limit;
        pairs.truncate(limit);
        over
    }
}
