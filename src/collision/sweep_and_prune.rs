//! Incremental sweep and prune (D. Baraff, 1992): boxes are kept sorted by their lower end on one axis and swept
//! in that order; only those that overlap on this axis are compared on the other. Boxes move little in a tick,
//! so the order of the last one is nearly right and an insertion sort repairs it in nearly linear time.

use alloc::vec::Vec;

use super::broad_phase::{Pair, Proxy};
use crate::math::Fx;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Axis {
    #[default]
    X,
    Y,
}

/// The order found in the last tick: a cache.
#[derive(Clone, Debug, Default)]
pub(crate) struct SweepAndPrune {
    axis: Axis,
    /// Slots in the order of their boxes' lower ends.
    order: Vec<u32>,
    /// Index into the proxies for each slot, `u32::MAX` for none.
    index_of: Vec<u32>,
    /// The boxes in order, for the sweep.
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
    pub(crate) fn each_pair(&mut self, proxies: &[Proxy], found: impl FnMut(Pair)) {
        self.choose_axis(proxies);
        self.refresh_order(proxies);
        self.sort();
        self.sweep(found);
    }

    /// Sweeps along the axis on which the boxes are spread out more.
    fn choose_axis(&mut self, proxies: &[Proxy]) {
        let mean = |value: fn(&Proxy) -> Fx| {
            let sum: i128 = proxies.iter().map(|proxy| i128::from(value(proxy).to_bits())).sum();
            sum / (proxies.len().max(1) as i128)
        };
        let spread = |value: fn(&Proxy) -> Fx| {
            let mean = mean(value);
            let distance = |proxy: &Proxy| (i128::from(value(proxy).to_bits()) - mean).unsigned_abs();
            proxies.iter().map(distance).sum::<u128>()
        };
        let (x, y) = (spread(|proxy| proxy.fat.lower.x), spread(|proxy| proxy.fat.lower.y));
        let axis = if y > x { Axis::Y } else { Axis::X };
        if axis != self.axis {
            // The old order says nothing about the other axis, and an insertion sort from it would be quadratic.
            self.axis = axis;
            self.order.clear();
        }
    }

    /// Drops slots that are gone, appends new ones, and copies the boxes in the order of the last tick.
    fn refresh_order(&mut self, proxies: &[Proxy]) {
        self.index_of.clear();
        let slot_count = proxies.last().map_or(0, |last| last.slot as usize + 1);
        self.index_of.resize(slot_count, u32::MAX);
        for (proxy, index) in proxies.iter().zip(0u32..) {
            self.index_of[proxy.slot as usize] = index;
        }
        self.sorted.clear();
        for &slot in &self.order {
            if let Some(&index) = self.index_of.get(slot as usize) {
                if index != u32::MAX {
                    self.sorted.push(Interval::of(self.axis, &proxies[index as usize]));
                    self.index_of[slot as usize] = u32::MAX;
                }
            }
        }
        let kept = self.sorted.len();
        let fresh = proxies.iter().filter(|proxy| self.index_of[proxy.slot as usize] != u32::MAX);
        self.sorted.extend(fresh.map(|proxy| Interval::of(self.axis, proxy)));
        // Many newcomers at once would make the insertion sort quadratic.
        if self.sorted.len() - kept > 64 {
            self.sorted.sort_unstable_by_key(Interval::key);
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
    fn of(axis: Axis, proxy: &Proxy) -> Self {
        let (lower, upper) = (proxy.fat.lower, proxy.fat.upper);
        let slot = proxy.slot;
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
