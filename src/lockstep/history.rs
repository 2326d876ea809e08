#[cfg(test)]
mod tests;
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
