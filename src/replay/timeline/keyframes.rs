//! [`Keyframes`]: evenly spaced saved states within a memory budget.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::super::raw_replay::ReplayPosition;

#[derive(Clone, Debug)]
pub(super) struct Keyframe<'a> {
    pub(super) position: ReplayPosition<'a>,
    /// Canonical bytes of the game's save.
    pub(super) save: Vec<u8>,
}

impl Keyframe<'_> {
    /// Memory in bytes, including the position.
    pub(super) fn bytes(&self) -> usize {
        self.save.len() + size_of::<Self>()
    }
}

/// Keyframes by tick, at multiples of the interval. Some multiples may have no keyframe.
#[derive(Debug)]
pub(super) struct Keyframes<'a> {
    /// Keyframe of tick 0, which is never removed.
    first: Keyframe<'a>,
    later: BTreeMap<u64, Keyframe<'a>>,
    interval: u64,
    bytes: usize,
    bytes_max: usize,
}

impl<'a> Keyframes<'a> {
    pub(super) fn new(first: Keyframe<'a>, interval: u64, bytes_max: usize) -> Self {
        Keyframes { bytes: first.bytes(), first, later: BTreeMap::new(), interval, bytes_max }
    }

    pub(super) fn interval(&self) -> u64 {
        self.interval
    }

    pub(super) fn bytes_max(&self) -> usize {
        self.bytes_max
    }

    pub(super) fn first(&self) -> &Keyframe<'a> {
        &self.first
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Keyframe<'a>> {
        core::iter::once(&self.first).chain(self.later.values())
    }

    pub(super) fn latest(&self, tick: u64) -> &Keyframe<'a> {
        self.later.range(..=tick).next_back().map_or(&self.first, |(_, frame)| frame)
    }

    pub(super) fn is_due(&self, tick: u64) -> bool {
        tick > 0 && tick.is_multiple_of(self.interval) && !self.later.contains_key(&tick)
    }

    pub(super) fn insert(&mut self, frame: Keyframe<'a>) {
        if self.is_due(frame.position.tick) {
            self.bytes += frame.bytes();
            self.later.insert(frame.position.tick, frame);
            while self.bytes > self.bytes_max && !self.later.is_empty() {
                self.thin_out();
            }
        }
    }

    /// Doubles the interval, and removes the keyframes that are not at multiples of the new interval.
    fn thin_out(&mut self) {
        self.interval = self.interval.saturating_mul(2);
        let interval = self.interval;
        self.later.retain(|tick, _| tick % interval == 0);
        self.bytes = self.iter().map(Keyframe::bytes).sum();
    }
}
