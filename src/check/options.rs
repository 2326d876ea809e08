use alloc::vec;
use alloc::vec::Vec;
use core::fmt;

use crate::collision::BroadPhaseKind;
use crate::replay::Limits;
use crate::world::Backend;

/// A way of playing the same inputs that must lead to the same states.
///
/// Variants that act on a [`World`](crate::world::World) are skipped for a game without
/// [`Game::world_mut`](crate::lockstep::Game::world_mut).
///
/// ```
/// use lockstep2d::check::{CheckOptions, Variant};
/// // A short test for every build: the two variants that find most mistakes.
/// let quick = CheckOptions::default().only(&[Variant::Reloaded, Variant::RolledBack]);
/// assert_eq!(quick.variants.len(), 2);
/// // All variants that this machine supports, for a nightly test.
/// assert!(Variant::all().contains(&Variant::ByteSwapped));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Variant {
    /// The inputs are played again from [`CheckOptions::from`] on, in the same process. This detects random iteration
    /// orders, global state, addresses and clocks.
    Again,
    /// `state_hash`, `work`, `claims` and `save` are called twice after every tick. The calls must not change the
    /// state.
    HashPolled,
    /// `state_hash` is called only after the last tick. Its result must equal the hash of the reference run.
    HashUnpolled,
    /// Every [`CheckOptions::every`] ticks, the state is encoded, decoded and loaded into a new game, which continues.
    Reloaded,
    /// Every [`CheckOptions::every`] ticks, the game is rolled back by some ticks and plays them again with the actual
    /// inputs. Often it plays predicted inputs first, and is then rolled back once more.
    RolledBack,
    /// The caches of the world are cleared every [`CheckOptions::every`] ticks.
    ClearedScratch,
    /// The solver runs on another backend.
    Backend(Backend),
    /// The broad phase uses another algorithm.
    BroadPhase(BroadPhaseKind),
    /// The world has this number of threads. The threads share the work of a tick if the previous tick had at least 256
    /// awake bodies. The variant has no effect without the feature `parallel`, or if the system cannot create the
    /// threads.
    Threads(usize),
    /// Bytes of a save are replaced by bytes of another tick's save. If the hash does not change, later hashes must not
    /// change either.
    ByteSwapped,
    /// The game is recorded, and its replay is verified with its claims.
    Recorded,
}

impl Variant {
    /// All variants for this machine: [`Variant::Backend`] with each available backend except the best one,
    /// [`Variant::BroadPhase`] with each algorithm except the default one, [`Variant::Threads`] with 2 and with 4
    /// threads if the feature `parallel` is enabled, and all others.
    #[must_use]
    pub fn all() -> Vec<Variant> {
        let mut variants = vec![
            Variant::Again,
            Variant::HashPolled,
            Variant::HashUnpolled,
            Variant::Reloaded,
            Variant::RolledBack,
            Variant::ClearedScratch,
            Variant::BroadPhase(BroadPhaseKind::SweepAndPrune),
            Variant::BroadPhase(BroadPhaseKind::BruteForce),
            Variant::ByteSwapped,
            Variant::Recorded,
        ];
        variants
            .extend(Backend::available().filter(|backend| *backend != Backend::best()).map(Variant::Backend));
        if cfg!(feature = "parallel") {
            variants.extend([Variant::Threads(2), Variant::Threads(4)]);
        }
        variants
    }

    pub(super) const fn needs_world(self) -> bool {
        matches!(
            self,
            Variant::ClearedScratch | Variant::Backend(_) | Variant::BroadPhase(_) | Variant::Threads(_)
        )
    }
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Variant::Again => write!(f, "played again"),
            Variant::HashPolled => write!(f, "with hash, work, claims and save polled twice"),
            Variant::HashUnpolled => write!(f, "with the hash polled only at the end"),
            Variant::Reloaded => write!(f, "reloaded from bytes into a new game"),
            Variant::RolledBack => write!(f, "rolled back"),
            Variant::ClearedScratch => write!(f, "with cleared scratch"),
            Variant::Backend(backend) => write!(f, "with the backend {backend:?}"),
            Variant::BroadPhase(kind) => write!(f, "with the broad phase {kind:?}"),
            Variant::Threads(count) => write!(f, "on {count} threads"),
            Variant::ByteSwapped => write!(f, "with bytes of another tick swapped into its save"),
            Variant::Recorded => write!(f, "recorded and verified"),
        }
    }
}

/// Maximum length, in ticks, of a log in which each tick with rollbacks tests all combinations of depth and guess. Such
/// a log has too few ticks to test all of them in turn. Minimised logs are often this short.
const SHORT_TICKS: u64 = 24;

/// The rollback depths of [`Variant::RolledBack`].
///
/// ```
/// use lockstep2d::check::{check, CheckOptions, Depths, Phases, Variant};
/// use lockstep2d::lockstep::{Sandbox, SandboxSetup};
/// // A thorough check of a short log: every rollback depth at every tick, and a comparison of every phase of a tick.
/// let options = CheckOptions { depths: Depths::Each, phases: Phases::Compared, ..CheckOptions::default() };
/// let options = options.only(&[Variant::RolledBack]);
/// let checked = check::<Sandbox>(&SandboxSetup::default(), &vec![vec![vec![]]; 4], &options)?;
/// assert!(checked.simulated > 40, "four ticks, many times");
/// # Ok::<(), lockstep2d::check::CheckError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Depths {
    /// Each tick that [`CheckOptions::every`] selects tests one combination of a depth and a [`Guess`](super::Guess),
    /// in turn. For depths of 1 to 8 ticks, this costs about eight simulated ticks per tick. In logs of at most 24
    /// ticks, [`check`](super::check) and [`check_replay`](super::check_replay) play all combinations, as with
    /// [`Depths::Each`].
    #[default]
    InTurn,
    /// Each tick that [`CheckOptions::every`] selects tests all combinations. For depths of 1 to 8 ticks, this costs
    /// 180 simulated ticks per tick.
    Each,
}

/// Whether a check compares the phases of the physics step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phases {
    /// Compares only the states between ticks.
    #[default]
    Ignored,
    /// Compares digests of the state, the manifolds and the solver velocities after the phases that compute them. A
    /// tick takes several times as long.
    Compared,
}

/// The extent and cost of a check.
///
/// ```
/// use lockstep2d::check::{CheckOptions, Variant};
/// use lockstep2d::collision::BroadPhaseKind;
/// // For a large world: every tenth tick, without the variant that compares all pairs of shapes.
/// let options = CheckOptions::default().every(10).without(Variant::BroadPhase(BroadPhaseKind::BruteForce));
/// assert_eq!(options.every, 10);
/// ```
#[derive(Clone, Debug)]
pub struct CheckOptions {
    /// The variants to play.
    pub variants: Vec<Variant>,
    /// Interval in ticks at which the state is reloaded, rolled back or loses its caches, at least 1.
    /// [`Variant::ByteSwapped`] keeps saves at this interval or every 16 ticks, whichever is longer.
    pub every: u64,
    /// Maximum rollback depth in ticks, up to 64.
    pub rollback_max: u32,
    /// The depths that are played at a tick.
    pub depths: Depths,
    /// Whether the phases of the physics step are compared.
    pub phases: Phases,
    /// The tick at which the variants begin, except [`Variant::Recorded`], which begins at tick 0.
    pub from: u64,
    /// The tick at which the check ends, if the log is longer.
    pub to: u64,
    /// Maximum number of runs of each shortened log, at least 1, to measure how often it fails. A log that fails
    /// randomly is shortened only while it fails as often as before.
    pub repeats: u32,
    /// Number of simulated ticks after which a failing log is not minimised further, not counting the runs that measure
    /// how often the log fails. With 0, the log is only cut after the tick at which the fault was detected.
    pub budget: u64,
    /// Limits of the reference run, and of the replays that are read and verified.
    pub limits: Limits,
}

impl Default for CheckOptions {
    /// All variants, with an interval of one tick and one rollback per tick: for logs of some hundred ticks.
    fn default() -> Self {
        CheckOptions {
            variants: Variant::all(),
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

impl CheckOptions {
    /// Restricts the options to some variants.
    #[must_use]
    pub fn only(self, variants: &[Variant]) -> Self {
        CheckOptions { variants: variants.to_vec(), ..self }
    }

    /// Removes a variant.
    #[must_use]
    pub fn without(mut self, variant: Variant) -> Self {
        self.variants.retain(|kept| *kept != variant);
        self
    }

    /// Sets [`CheckOptions::every`], the interval in ticks at which the state is reloaded, rolled back or loses its caches.
    /// A larger interval makes the check of a long log faster.
    #[must_use]
    pub fn every(self, ticks: u64) -> Self {
        CheckOptions { every: ticks.max(1), ..self }
    }

    /// The options for a log of this number of ticks.
    pub(super) fn for_ticks(&self, ticks: u64) -> Self {
        let depths = if ticks <= SHORT_TICKS { Depths::Each } else { self.depths };
        CheckOptions { depths, ..self.clone() }
    }

    pub(super) fn is_due(&self, tick: u64) -> bool {
        tick.is_multiple_of(self.every.max(1))
    }
}
