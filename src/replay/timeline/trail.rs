//! [`Trail`]: saves of the ticks behind where someone steps backwards.

use alloc::collections::BTreeMap;

use super::super::rerun::Place;

/// Some saves by their ticks, the latest of which are forgotten first: who steps backwards has no use for them.
pub(super) struct Trail<'a, S> {
    saves: BTreeMap<u64, (Place<'a>, S)>,
}

impl<S> Default for Trail<'_, S> {
    fn default() -> Self {
        Trail { saves: BTreeMap::new() }
    }
}

impl<'a, S> Trail<'a, S> {
    /// The last one up to a tick.
    pub(super) fn latest(&self, tick: u64) -> Option<&(Place<'a>, S)> {
        self.saves.range(..=tick).next_back().map(|(_, kept)| kept)
    }

    /// Keeps a save, and of those in front of it so many that there are at most `length` in all.
    pub(super) fn keep(&mut self, place: Place<'a>, save: S, length: u64) {
        let tick = place.tick;
        self.saves.insert(tick, (place, save));
        let is_full = |count: usize| u64::try_from(count).is_ok_and(|count| count > length);
        while is_full(self.saves.len()) {
            // None in front: then the one furthest behind is of the least use.
            let last = self.saves.keys().next_back().copied().filter(|last| *last > tick);
            let dropped = last.or_else(|| self.saves.keys().next().copied());
            dropped.map(|dropped| self.saves.remove(&dropped));
        }
    }
}
