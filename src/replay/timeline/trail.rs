//! [`Trail`]: saves of ticks before the current one, for stepping backwards.

use alloc::collections::BTreeMap;

use super::super::raw_replay::ReplayPosition;

pub(super) struct Trail<'a, S> {
    saves: BTreeMap<u64, (ReplayPosition<'a>, S)>,
}

impl<S> Default for Trail<'_, S> {
    fn default() -> Self {
        Trail { saves: BTreeMap::new() }
    }
}

impl<'a, S> Trail<'a, S> {
    pub(super) fn latest(&self, tick: u64) -> Option<&(ReplayPosition<'a>, S)> {
        self.saves.range(..=tick).next_back().map(|(_, kept)| kept)
    }

    /// Inserts a save. If there are more than `length` saves, removes other saves. Saves of later ticks are removed
    /// first, starting with the latest, because further steps backwards do not need them. Then the earliest saves are
    /// removed.
    pub(super) fn keep(&mut self, position: ReplayPosition<'a>, save: S, length: u64) {
        let tick = position.tick;
        self.saves.insert(tick, (position, save));
        let is_full = |count: usize| u64::try_from(count).is_ok_and(|count| count > length);
        while is_full(self.saves.len()) {
            let last = self.saves.keys().next_back().copied().filter(|last| *last > tick);
            let dropped = last.or_else(|| self.saves.keys().next().copied());
            dropped.map(|dropped| self.saves.remove(&dropped));
        }
    }
}
