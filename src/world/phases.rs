//! What each phase of a tick leaves behind: to find not only the tick in which two runs part, but the part of it.

use alloc::vec::Vec;

use super::World;
use super::islands::Roster;
use super::manifolds::Found;
use super::rollback::Snapshot;
use super::scratch::Scratch;
use super::state::State;
use super::stats::Phase;
use crate::hash::StateHash;
use crate::solver::{Solver, SolverBody};

/// What a phase of a tick has left behind. Two runs that were equal before a tick part in the first phase whose digests
/// differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseDigest {
    /// Which phase; `None` is what the first one has found.
    pub phase: Option<Phase>,
    /// The digest of the state and of what later phases work with: manifolds, and velocities and displacements in the
    /// solver.
    pub digest: StateHash,
}

/// What a world has noted.
#[derive(Clone, Debug, Default)]
pub(super) struct Noted {
    digests: Vec<PhaseDigest>,
    start: Option<Snapshot>,
}

impl World {
    /// From now on every tick notes what its phases leave behind, and takes several times as long. What has been noted
    /// before is forgotten. No result depends on it.
    pub fn note_phases(&mut self) {
        self.phases = Some(Noted::default());
    }

    /// Ends what [`World::note_phases`] has begun.
    pub fn ignore_phases(&mut self) {
        self.phases = None;
    }

    /// What the phases of every tick since [`World::note_phases`] have found and left behind, in order: eight digests a
    /// tick.
    ///
    /// ```
    /// # use lockstep2d::world::{Phase, World};
    /// let mut world = World::default();
    /// world.note_phases();
    /// world.step();
    /// let phases: Vec<_> = world.phase_digests().iter().map(|noted| noted.phase).collect();
    /// assert_eq!(phases.len(), 8);
    /// assert_eq!(phases[..2], [None, Some(Phase::BroadPhase)]);
    /// ```
    #[must_use]
    pub fn phase_digests(&self) -> &[PhaseDigest] {
        self.phases.as_ref().map_or(&[], |noted| &noted.digests)
    }

    /// The state with which the last tick since [`World::note_phases`] began: what the last one has left behind, and
    /// whatever was changed since.
    #[must_use]
    pub fn step_start(&self) -> Option<&Snapshot> {
        self.phases.as_ref()?.start.as_ref()
    }

    pub(super) fn step_noting_phases(&mut self) {
        let mut noted = self.phases.take().unwrap_or_default();
        noted.start = Some(self.save());
        let mut running = None;
        self.advance(|next, sight| {
            noted.digests.push(PhaseDigest { phase: running, digest: sight.after(running) });
            running = Some(next);
        });
        let sight = Sight::of(self.state.get(), &self.scratch);
        noted.digests.push(PhaseDigest { phase: running, digest: sight.after(running) });
        self.phases = Some(noted);
    }
}

/// What a phase begins with.
pub(super) struct Sight<'a> {
    pub(super) state: &'a State,
    pub(super) solver: &'a Solver,
    pub(super) roster: &'a Roster,
    pub(super) found: &'a Found,
}

impl<'a> Sight<'a> {
    pub(super) fn of(state: &'a State, scratch: &'a Scratch) -> Self {
        let Scratch { solver, roster, found, .. } = scratch;
        Sight { state, solver, roster, found }
    }

    /// Of what a phase has left behind, all that is not from an earlier tick.
    fn after(&self, phase: Option<Phase>) -> StateHash {
        let working = match phase {
            Some(Phase::NarrowPhase) => self.manifolds(),
            Some(Phase::Prepare | Phase::Solve) => self.motions(),
            None | Some(Phase::BroadPhase | Phase::Finalise | Phase::Sleep | Phase::Report) => StateHash(0),
        };
        StateHash::of_digests([StateHash::of(self.state), working])
    }

    fn manifolds(&self) -> StateHash {
        let listed = self.found.manifolds.iter().map(|manifold| {
            let points = manifold.points().iter();
            let points = points.map(|point| (point.anchor, point.separation, point.feature.0));
            (manifold.normal, manifold.origin, points.collect::<Vec<_>>())
        });
        StateHash::of(&(&self.found.contacts, listed.collect::<Vec<_>>()))
    }

    fn motions(&self) -> StateHash {
        let listed = self.roster.bodies.iter().map(|&slot| {
            let SolverBody { velocity, spin, shift, turn, .. } = *self.solver.body(slot);
            (slot, velocity, spin, shift, turn)
        });
        StateHash::of(&listed.collect::<Vec<_>>())
    }
}
