//! [`Options`]: what is checked, and how much it may cost.

use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use crate::collision::BroadPhaseKind;
use crate::replay::Limits;
use crate::world::Backend;

/// A way to play the same inputs that must come to the same.
///
/// Those that do something to a [`World`](crate::world::World) are left out for a game that has none to show
/// ([`Game::world_mut`](crate::lockstep::Game::world_mut)).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Way {
    /// Once more from the start, in the same process: random iteration orders, global state, addresses and clocks show.
    Again,
    /// Hash, work, claims and save are asked for twice after every tick: asking must change nothing.
    Asked,
    /// The hash is asked for after the last tick only: not asking must change nothing either.
    Unasked,
    /// After every tick the save is encoded, decoded, and loaded into a new game, which plays on.
    Reloaded,
    /// After every tick the game goes back by some ticks and plays them again, also after wrong guesses.
    RolledBack,
    /// All caches of the world are dropped after every tick.
    ClearedScratch,
    /// The solver computes in another way.
    Backend(Backend),
    /// Pairs are found in another way.
    BroadPhase(BroadPhaseKind),
    /// Another number of threads shares a tick; left out without the feature `parallel`.
    Threads(usize),
    /// Bytes of a save are exchanged for those of another tick: if the hash does not see that, it must not matter.
    Exchanged,
    /// The game is recorded and its replay verified, claims included.
    Recorded,
}

impl Way {
    /// All ways that this machine has.
    #[must_use]
    pub fn all() -> Vec<Way> {
        let mut ways = vec![
            Way::Again,
            Way::Asked,
            Way::Unasked,
            Way::Reloaded,
            Way::RolledBack,
            Way::ClearedScratch,
            Way::BroadPhase(BroadPhaseKind::SweepAndPrune),
            Way::BroadPhase(BroadPhaseKind::BruteForce),
            Way::Exchanged,
            Way::Recorded,
        ];
        ways.extend(Backend::available().filter(|backend| *backend != Backend::best()).map(Way::Backend));
        if cfg!(feature = "parallel") {
            ways.extend([Way::Threads(2), Way::Threads(4)]);
        }
        ways
    }

    /// Whether it does something to the world of a game.
    pub(super) const fn needs_world(self) -> bool {
        matches!(self, Way::ClearedScratch | Way::Backend(_) | Way::BroadPhase(_) | Way::Threads(_))
    }
}

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Way::Again => write!(f, "played again"),
            Way::Asked => write!(f, "asked for hash, work, claims and save"),
            Way::Unasked => write!(f, "not asked for its hash"),
            Way::Reloaded => write!(f, "through bytes into a new game"),
            Way::RolledBack => write!(f, "rolled back"),
            Way::ClearedScratch => write!(f, "with cleared scratch"),
            Way::Backend(backend) => write!(f, "with the backend {backend:?}"),
            Way::BroadPhase(kind) => write!(f, "with the broad phase {kind:?}"),
            Way::Threads(count) => write!(f, "on {count} threads"),
            Way::Exchanged => write!(f, "with bytes of another tick in its save"),
            Way::Recorded => write!(f, "recorded and verified"),
        }
    }
}

/// By how many ticks [`Way::RolledBack`] goes back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depths {
    /// By one number of ticks with one guess, the next at the next tick: all of them within 24 ticks, for some eight
    /// steps a tick.
    #[default]
    InTurn,
    /// By each number of ticks with each guess, every time: 180 steps a tick.
    Each,
}

/// Whether the phases of the physics step are compared as well.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phases {
    /// Only the states between ticks.
    #[default]
    Ignored,
    /// After each phase the world and what its later phases work with; a tick takes several times as long.
    Compared,
}

/// What is checked, and how much it may cost.
#[derive(Clone, Debug)]
pub struct Options {
    /// The ways to play.
    pub ways: Vec<Way>,
    /// Every how many ticks the state goes through bytes, is rolled back, or loses its caches; at least 1.
    pub every: u64,
    /// By how many ticks it is rolled back at most, up to 64.
    pub rollback_max: u32,
    /// Which of these numbers of ticks in one go.
    pub depths: Depths,
    /// Whether the phases of the physics step are compared as well.
    pub phases: Phases,
    /// The tick from which on it is checked; before it, the game is only played.
    pub from: u64,
    /// The tick up to which a log is played, if it is that long.
    pub to: u64,
    /// How often a shorter log is played to see how often it fails, at least 1. A log that fails by chance, because of a
    /// `HashMap`, is made shorter only as long as it fails as often as before.
    pub repeats: u32,
    /// Ticks that may be simulated to make a failing log shorter. With 0 it ends with the tick that fails,
    /// and is not played again.
    pub budget: u64,
    /// What a replay may cost: one that is checked, and one that is recorded.
    pub limits: Limits,
}

impl Default for Options {
    /// Everything at every tick: for logs of some hundred ticks.
    fn default() -> Self {
        Options {
            ways: Way::all(),
            every: 1,
            rollback_max: 8,
            depths: Depths::default(),
            phases: Phases::default(),
            from: 0,
            to: u64::MAX,
            repeats: 4,
            budget: 200_000,
            limits: Limits::default(),
        }
    }
}

impl Options {
    /// The same with only some ways.
    #[must_use]
    pub fn only(self, ways: &[Way]) -> Self {
        Options { ways: ways.to_vec(), ..self }
    }

    /// The same without a way.
    #[must_use]
    pub fn without(mut self, way: Way) -> Self {
        self.ways.retain(|kept| *kept != way);
        self
    }

    /// The same for a longer log: what costs most is done every so many ticks.
    #[must_use]
    pub fn every(self, ticks: u64) -> Self {
        Options { every: ticks.max(1), ..self }
    }

    pub(super) fn is_due(&self, tick: u64) -> bool {
        tick.is_multiple_of(self.every.max(1))
    }
}
