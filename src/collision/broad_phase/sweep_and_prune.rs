//! Incremental sweep and prune (D. Baraff, 1992). Boxes are swept in the order of their lower ends on one axis. Boxes
//! move little in a tick, so an insertion sort of the last order takes nearly linear time.

use alloc::vec::Vec;

use super::box_list::BoxList;
use crate::collision::contact::Pair;
use crate::math::{Aabb, Fx};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Axis {
    #[default]
    X,
    Y,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct SweepAndPrune {
    axis: Axis,
    boxes: BoxList,
    /// Slots in the order of the last sweep, followed by slots added since then. The order is a cache.
    order: Vec<u32>,
    /// For each slot, whether it is in `order`. A removed slot stays there until the next sweep.
    ordered: Vec<bool>,
    /// Number of slots added since the last sweep.
    newcomers: usize,
    sorted: Vec<Interval>,
}

#[derive(Clone, Copy, Debug)]
struct Interval {
    lower: Fx,
    upper: Fx,
    across_lower: Fx,
    across_upper: Fx,
    slot: u32,
}

impl SweepAndPrune {
    pub(crate) fn boxes(&self) -> &BoxList {
        &self.boxes
    }

    pub(crate) fn set(&mut self, slot: u32, fat: Aabb) {
        self.boxes.set(slot, fat);
        let index = slot as usize;
        self.ordered.resize(self.ordered.len().max(index + 1), false);
        if !core::mem::replace(&mut self.ordered[index], true) {
            self.order.push(slot);
            self.newcomers += 1;
        }
    }

    pub(crate) fn remove(&mut self, slot: u32) {
        self.boxes.remove(slot);
    }

    pub(crate) fn each_pair(&mut self, found: impl FnMut(Pair)) {
        let axis = self.best_axis();
        let turned = core::mem::replace(&mut self.axis, axis) != axis;
        self.copy_boxes();
        // After a change of axis or many insertions, an insertion sort would take quadratic time.
        if turned || self.newcomers > 64 {
            self.sorted.sort_unstable_by_key(Interval::key);
        }
        self.newcomers = 0;
        self.sort();
        self.sweep(found);
    }

    fn best_axis(&self) -> Axis {
        let mean = |value: fn(Aabb) -> Fx| {
            let sum: i128 = self.boxes.iter().map(|(_, fat)| i128::from(value(fat).to_bits())).sum();
            sum / (self.boxes.len().max(1) as i128)
        };
        let spread = |value: fn(Aabb) -> Fx| {
            let mean = mean(value);
            let distance = |(_, fat): (u32, Aabb)| (i128::from(value(fat).to_bits()) - mean).unsigned_abs();
            self.boxes.iter().map(distance).sum::<u128>()
        };
        let (x, y) = (spread(|fat| fat.lower.x), spread(|fat| fat.lower.y));
        if y > x { Axis::Y } else { Axis::X }
    }

    fn copy_boxes(&mut self) {
        self.sorted.clear();
        for &slot in &self.order {
            match self.boxes.get(slot) {
                Some(fat) => self.sorted.push(Interval::of(self.axis, slot, fat)),
                None => self.ordered[slot as usize] = false,
            }
        }
    }

    fn sort(&mut self) {
        for i in 1..self.sorted.len() {
            let moving = self.sorted[i];
            let mut hole = i;
            while hole > 0 && self.sorted[hole - 1].key() > moving.key() {
                self.sorted[hole] = self.sorted[hole - 1];
                hole -= 1;
            }
            self.sorted[hole] = moving;
        }
        self.order.clear();
        self.order.extend(self.sorted.iter().map(|interval| interval.slot));
    }

    fn sweep(&self, mut found: impl FnMut(Pair)) {
        for (i, a) in self.sorted.iter().enumerate() {
            let rest = self.sorted[i + 1..].iter().take_while(|b| b.lower <= a.upper);
            for b in rest {
                if b.across_lower <= a.across_upper && a.across_lower <= b.across_upper {
                    found((a.slot.min(b.slot), a.slot.max(b.slot)));
                }
            }
        }
    }
}

impl Interval {
    fn of(axis: Axis, slot: u32, fat: Aabb) -> Self {
        let Aabb { lower, upper } = fat;
        match axis {
            Axis::X => Interval {
                lower: lower.x,
                upper: upper.x,
                across_lower: lower.y,
                across_upper: upper.y,
                slot,
            },
            Axis::Y => Interval {
                lower: lower.y,
                upper: upper.y,
                across_lower: lower.x,
                across_upper: upper.x,
                slot,
            },
        }
    }

    /// The slot breaks ties, so that the order is total.
    fn key(&self) -> (Fx, u32) {
        (self.lower, self.slot)
    }
}
