//! Digests after each phase of a tick: they show not only the tick in which two runs diverge, but also the phase.

use alloc::vec::Vec;

use super::rollback::Snapshot;
use crate::hash::StateHash;
use crate::world::stats::Phase;

/// Digest after a phase of a tick. Two runs that were equal before a tick diverge in the first phase whose digests
/// differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseDigest {
    /// The phase, or `None` for the beginning of the tick.
    pub phase: Option<Phase>,
    /// Digest of the state and of the data that later phases read: the manifolds, and the velocities and displacements
    /// in the solver.
    pub digest: StateHash,
}

/// Recorded digests of a world since [`World::log_phases`](crate::world::World::note_phases).
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseLog {
    pub(crate) digests: Vec<PhaseDigest>,
    /// The state at the start of the last tick.
    pub(crate) start: Option<Snapshot>,
}
