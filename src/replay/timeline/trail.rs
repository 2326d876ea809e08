//! [`Trail`]: saves of ticks before the current one, kept while stepping backwards.

use alloc::collections::BTreeMap;

use super::super::raw_replay::ReplayPosition;

/// Saves by tick. If there are too many, those of ticks after the newly saved one are removed first, because further
/// steps backwards do not need them.
pub(super) struct Trail<'a, S> {
    saves: BTreeMap<u64, (ReplayPosition<'a>, S)>,
}

impl<S> Default for Trail<'_, S> {
    fn default() -> Self {
        Trail { saves: BTreeMap::new() }
    }
}

impl<'a, S> Trail<'a, S> {
    /// The last save at or before a tick.
    pub(super) fn latest(&self, tick: u64) -> Option<&(ReplayPosition<'a>, S)> {
        self.saves.range(..=tick).next_back().map(|(_, kept)| kept)
    }

    /// Inserts a save and removes others until at most `length` are left: first those of later ticks, latest first,
    /// then the earliest.
    pub(super) fn keep(&mut self, position: ReplayPosition<'a>, save: S, length: u64) {
        let tick = position.tick;
        self.saves.insert(tick, (position, save));
        let is_full = |count: usize| u64::try_from(count).is_ok_and(|count| count > length);
        while is_full(self.saves.len()) {
            // If no save is later than this tick, the earliest one is the least useful.
            let last = self.saves.keys().next_back().copied().filter(|last| *last > tick);
            let dropped = last.or_else(|| self.saves.keys().next().copied());
            dropped.map(|dropped| self.saves.remove(&dropped));
        }
    }
}
