//! [`History`]: the states of the last ticks.

use alloc::collections::VecDeque;

use super::Game;
use crate::hash::StateHash;

/// The state after some tick.
#[derive(Clone, Debug)]
pub struct Moment<S> {
    /// The state.
    pub save: S,
    /// Its hash.
    pub hash: StateHash,
}

/// The states of the last ticks, by tick.
pub struct History<G: Game> {
    first: u64,
    moments: VecDeque<Moment<G::Save>>,
    capacity: usize,
}

impl<G: Game> History<G> {
    /// Room for two seconds.
    #[must_use]
    pub fn new(tick_rate: u32) -> Self {
        History { first: 0, moments: VecDeque::new(), capacity: 2 * tick_rate as usize + 1 }
    }

    /// Keeps at least this many states.
    pub fn reserve(&mut self, ticks: u64) {
        self.capacity = self.capacity.max(usize::try_from(ticks).unwrap_or(usize::MAX));
    }

    /// Puts the state after `tick` ticks, in place of this one and all later ones.
    pub fn push(&mut self, tick: u64, save: G::Save, hash: StateHash) {
        self.truncate(tick);
        if self.moments.is_empty() || self.first + self.moments.len() as u64 != tick {
            self.moments.clear();
            self.first = tick;
        }
        if self.moments.len() == self.capacity {
            self.moments.pop_front();
            self.first += 1;
        }
        self.moments.push_back(Moment { save, hash });
    }

    /// The state after `tick` ticks.
    #[must_use]
    pub fn get(&self, tick: u64) -> Option<&Moment<G::Save>> {
        self.moments.get(usize::try_from(tick.checked_sub(self.first)?).ok()?)
    }

    /// Forgets all states from `tick` on.
    pub fn truncate(&mut self, tick: u64) {
        let keep = usize::try_from(tick.saturating_sub(self.first)).unwrap_or(usize::MAX);
        self.moments.truncate(keep);
    }
}
