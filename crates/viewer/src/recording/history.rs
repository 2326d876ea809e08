//! [`History`]: saves of a game, for seeking backwards.

use std::collections::BTreeMap;

/// Maximum number of saves. The number is limited, because adding a save may scan all of them.
const FRAMES_MAX: usize = 2048;
/// Number of ticks that [`History::least_useful`] adds to the distance of a save from the current tick: ten seconds at
/// 60 Hz. Because of this addition, saves within this distance are about equally dense.
const NEAR: u64 = 600;

/// Saves of a game at some ticks, within a memory budget.
///
/// When the budget is used up, the least useful saves are dropped. The gaps between saves may grow in proportion to
/// their distance from the current tick. So a step back is cheap, and the cost of a seek is proportional to its
/// distance.
pub(super) struct History<S> {
    frames: BTreeMap<u64, Frame<S>>,
    bytes: usize,
    bytes_max: usize,
}

struct Frame<S> {
    save: S,
    bytes: usize,
}

impl<S> History<S> {
    /// Creates a history with the save before the first tick, which is never dropped.
    pub(super) fn new(first: S, bytes_max: usize) -> Self {
        let frames = BTreeMap::from([(0, Frame { save: first, bytes: 0 })]);
        History { frames, bytes: 0, bytes_max }
    }

    /// The last save at or before a tick.
    pub(super) fn latest(&self, tick: u64) -> Option<(u64, &S)> {
        self.frames.range(..=tick).next_back().map(|(tick, frame)| (*tick, &frame.save))
    }

    pub(super) fn has(&self, tick: u64) -> bool {
        self.frames.contains_key(&tick)
    }

    /// Adds a save. `bytes` is the memory that it does not share with other saves. Then drops the saves that are least
    /// useful at tick `here`, until the remaining saves fit in the budget or only the first and the last are left.
    pub(super) fn keep(&mut self, tick: u64, save: S, bytes: usize, here: u64) {
        if self.has(tick) {
            return;
        }
        self.bytes += bytes;
        self.frames.insert(tick, Frame { save, bytes });
        while self.bytes > self.bytes_max || self.frames.len() > FRAMES_MAX {
            let Some(tick) = self.least_useful(here) else { break };
            self.remove(tick);
        }
    }

    pub(super) fn truncate(&mut self, tick: u64) {
        if let Some(next) = tick.checked_add(1) {
            let cut = self.frames.split_off(&next);
            self.bytes -= cut.values().map(|frame| frame.bytes).sum::<usize>();
        }
    }

    fn remove(&mut self, tick: u64) {
        if let Some(frame) = self.frames.remove(&tick) {
            self.bytes -= frame.bytes;
        }
    }

    /// Returns the tick of the save to drop, which is never the first or the last save. For each save, the gap that its
    /// removal would leave is divided by the sum of its distance from `here` and [`NEAR`]. The save with the smallest
    /// quotient is dropped.
    fn least_useful(&self, here: u64) -> Option<u64> {
        let (before, at, after) =
            (self.frames.keys(), self.frames.keys().skip(1), self.frames.keys().skip(2));
        let gaps = before.zip(at).zip(after).map(|((before, at), after)| (after - before, *at));
        let felt = |&(gap, at): &(u64, u64)| (u128::from(gap) << 32) / u128::from(here.abs_diff(at) + NEAR);
        gaps.min_by_key(felt).map(|(_, at)| at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(history: &History<u64>) -> Vec<u64> {
        history.frames.keys().copied().collect()
    }

    #[test]
    fn what_is_near_is_dense_and_what_is_far_is_not_forgotten() {
        let mut history = History::new(0, 100 * 10);
        for tick in (4..=40_000).step_by(4) {
            history.keep(tick, tick, 10, tick);
        }
        let kept = kept(&history);
        assert_eq!((kept.len(), kept[0], kept[100]), (101, 0, 40_000));
        for pair in kept.windows(2) {
            let (gap, age) = (pair[1] - pair[0], 40_000 - pair[0]);
            assert!(gap <= 40 + age / 8, "gap of {gap} ticks at an age of {age} ticks");
        }
    }

    #[test]
    fn who_goes_back_gets_dense_saves_there() {
        let mut history = History::new(0, 50 * 10);
        (4..=10_000).step_by(4).for_each(|tick| history.keep(tick, tick, 10, tick));
        (3000..=3200).step_by(4).for_each(|tick| history.keep(tick, tick, 10, 3200));
        let near = kept(&history).into_iter().filter(|tick| (3000..=3200).contains(tick)).count();
        assert!(near >= 4, "{near}");
        assert!(kept(&history).len() <= 51);
    }

    #[test]
    fn a_cut_removes_what_came_after() {
        let mut history = History::new(0, 1000);
        (1..=10).for_each(|tick| history.keep(tick * 10, tick, 7, tick));
        history.truncate(50);
        assert_eq!((kept(&history), history.bytes), (vec![0, 10, 20, 30, 40, 50], 35));
        assert_eq!(history.latest(49), Some((40, &4)));
        history.truncate(0);
        assert_eq!((kept(&history), history.bytes), (vec![0], 0));
    }

    #[test]
    fn the_first_and_the_last_stay_in_any_case() {
        let mut history = History::new(0, 1);
        (1..=10).for_each(|tick| history.keep(tick, tick, 100, tick));
        assert_eq!(kept(&history), [0, 10]);
    }
}
