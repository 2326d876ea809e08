use alloc::collections::VecDeque;

use super::Game;
use crate::hash::StateHash;

/// The state of a game after a number of ticks, as [`History`] stores it.
///
/// ```
/// use lockstep2d::lockstep::{Game, History, Past, Sandbox, SandboxSetup};
/// let mut game = Sandbox::new(&SandboxSetup::default())?;
/// let mut history = History::<Sandbox>::of_ticks(60);
/// for tick in 0..10 {
///     history.push(tick, game.save(), game.state_hash());
///     game.step(&[vec![]]);
/// }
/// // Another input arrives for tick 7.
/// let Past { tick, save, hash } = history.get(7).expect("a tick of the last second");
/// game.load(save);
/// assert_eq!((game.world().tick(), game.state_hash()), (*tick, *hash));
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Past<S> {
    /// Number of ticks played.
    pub tick: u64,
    /// Hash of the state.
    pub hash: StateHash,
    /// Copy of the state.
    pub save: S,
}

/// Number of ticks kept in addition to two seconds: room for mispredicted ticks, which a rollback removes.
const ROLLBACK_TICKS: u32 = 16;

/// Saves and state hashes of the last ticks, for rollback and to examine a divergence at its first tick. Saves of a
/// world share unchanged data.
///
/// ```
/// use lockstep2d::lockstep::{Game, History, Sandbox, SandboxSetup};
///
/// let mut game = Sandbox::new(&SandboxSetup::default())?;
/// let mut history = History::new(&game);
/// for tick in 0..500 {
///     history.push(tick, game.save(), game.state_hash());
///     game.step(&[vec![]]);
/// }
/// assert_eq!((history.oldest(), history.newest()), (Some(364), Some(499)));
/// # Ok::<(), lockstep2d::lockstep::SetupError>(())
/// ```
#[derive(Clone, Debug)]
pub struct History<G: Game> {
    ticks: VecDeque<Past<G::Save>>,
    length: u64,
}

impl<G: Game> History<G> {
    /// Creates a history of two seconds and 16 ticks. At least two seconds remain after a rollback of up to 16 ticks.
    #[must_use]
    pub fn new(game: &G) -> Self {
        Self::of_ticks(game.tick_rate().saturating_mul(2).saturating_add(ROLLBACK_TICKS))
    }

    /// Creates a history of the last `length` ticks, at least 1.
    #[must_use]
    pub fn of_ticks(length: u32) -> Self {
        History { ticks: VecDeque::new(), length: length.max(1).into() }
    }

    /// Maximum number of ticks kept.
    #[must_use]
    pub fn capacity(&self) -> u64 {
        self.length
    }

    /// Stores the game after `tick` ticks. Removes entries of this and later ticks, which a rollback has made invalid.
    pub fn push(&mut self, tick: u64, save: G::Save, hash: StateHash) {
        if let Some(before) = tick.checked_sub(1) {
            self.truncate(before);
        } else {
            self.ticks.clear();
        }
        while self.ticks.front().is_some_and(|past| tick - past.tick >= self.length) {
            self.ticks.pop_front();
        }
        self.ticks.push_back(Past { tick, hash, save });
    }

    /// The entry after `tick` ticks, if it is kept.
    #[must_use]
    pub fn get(&self, tick: u64) -> Option<&Past<G::Save>> {
        let index = self.ticks.partition_point(|past| past.tick < tick);
        self.ticks.get(index).filter(|past| past.tick == tick)
    }

    /// Removes the entries of ticks later than `tick`.
    pub fn truncate(&mut self, tick: u64) {
        self.ticks.truncate(self.ticks.partition_point(|past| past.tick <= tick));
    }

    /// The entries, ascending by tick.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Past<G::Save>> {
        self.ticks.iter()
    }

    /// Tick of the oldest entry; `None` if there are no entries.
    #[must_use]
    pub fn oldest(&self) -> Option<u64> {
        self.ticks.front().map(|past| past.tick)
    }

    /// Tick of the newest entry; `None` if there are no entries.
    #[must_use]
    pub fn newest(&self) -> Option<u64> {
        self.ticks.back().map(|past| past.tick)
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::super::{RulesId, SetupError};
    use super::*;

    struct Toy;

    impl Game for Toy {
        type Setup = ();
        type Input = ();
        type Save = u64;
        const RULES: RulesId = RulesId { name: "toy", version: 1 };

        fn new(&(): &()) -> Result<Self, SetupError> {
            Ok(Toy)
        }

        fn players(&self) -> u32 {
            1
        }

        fn tick_rate(&self) -> u32 {
            60
        }

        fn step(&mut self, _: &[()]) {}

        fn state_hash(&self) -> StateHash {
            StateHash(0)
        }

        fn save(&self) -> u64 {
            0
        }

        fn load(&mut self, _: &u64) {}

        fn work(&self, _: &[()]) -> u64 {
            0
        }
    }

    fn push(history: &mut History<Toy>, tick: u64, hash: u128) {
        history.push(tick, tick, StateHash(hash));
    }

    fn known(history: &History<Toy>) -> Vec<(u64, u128)> {
        for past in history.iter() {
            let found = history.get(past.tick).map(|found| (found.hash, found.save));
            assert_eq!(found, Some((past.hash, past.tick)));
        }
        history.iter().map(|past| (past.tick, past.hash.0)).collect()
    }

    #[test]
    fn it_has_two_seconds_and_a_rollback_and_never_nothing() {
        assert_eq!(History::new(&Toy).capacity(), 2 * 60 + 16);
        assert_eq!(History::<Toy>::of_ticks(0).capacity(), 1);
    }

    #[test]
    fn the_last_ticks_are_known_and_no_others() {
        let mut history = History::of_ticks(3);
        assert_eq!((history.oldest(), history.newest()), (None, None));
        (0..5).for_each(|tick| push(&mut history, tick, 100 + u128::from(tick)));
        assert_eq!(known(&history), [(2, 102), (3, 103), (4, 104)]);
        assert_eq!((history.oldest(), history.newest()), (Some(2), Some(4)));
        assert!(history.get(1).is_none() && history.get(5).is_none());
        history.truncate(3);
        assert_eq!(known(&history), [(2, 102), (3, 103)]);
    }

    #[test]
    fn a_rollback_replaces_what_never_happened() {
        let mut history = History::of_ticks(10);
        (0..6).for_each(|tick| push(&mut history, tick, 0));
        push(&mut history, 3, 1);
        assert_eq!(known(&history), [(0, 0), (1, 0), (2, 0), (3, 1)]);
        push(&mut history, 0, 2);
        assert_eq!(known(&history), [(0, 2)]);
        push(&mut history, 8, 3);
        assert_eq!(known(&history), [(0, 2), (8, 3)], "not every tick has to be saved");
        push(&mut history, 100, 4);
        assert_eq!(known(&history), [(100, 4)]);
    }
}
