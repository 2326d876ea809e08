use alloc::vec::Vec;

use crate::hash::StateHash;
use crate::solver::{Solver, SolverBody};
use crate::world::World;
use crate::world::cache::{AwakeSet, NarrowPhaseOutput, Scratch};
use crate::world::snapshot::{PhaseDigest, PhaseLog, Snapshot};
use crate::world::state::State;
use crate::world::stats::Phase;

impl World {
    /// Starts to record a digest after every phase of every [`World::step`], and discards earlier digests. Does not
    /// change the simulation, but ticks take several times as long.
    pub fn log_phases(&mut self) {
        self.phases = Some(PhaseLog::default());
    }

    /// Stops the recording that [`World::log_phases`] has started, and discards its digests.
    pub fn stop_logging_phases(&mut self) {
        self.phases = None;
    }

    /// Returns the digests of every [`World::step`] since [`World::log_phases`], in order. Each tick has eight: one at
    /// its beginning, and one after each of the seven phases.
    ///
    /// ```
    /// # use lockstep2d::world::{Phase, World};
    /// let mut world = World::default();
    /// world.log_phases();
    /// world.step();
    /// let phases: Vec<_> = world.phase_digests().iter().map(|log| log.phase).collect();
    /// assert_eq!(phases.len(), 8);
    /// assert_eq!(phases[..2], [None, Some(Phase::BroadPhase)]);
    /// ```
    #[must_use]
    pub fn phase_digests(&self) -> &[PhaseDigest] {
        self.phases.as_ref().map_or(&[], |log| &log.digests)
    }

    /// Returns the state at the start of the last recorded [`World::step`], or `None` if none is recorded.
    #[must_use]
    pub fn step_start(&self) -> Option<&Snapshot> {
        self.phases.as_ref()?.start.as_ref()
    }

    pub(super) fn step_with_phase_log(&mut self) {
        let mut log = self.phases.take().unwrap_or_default();
        log.start = Some(self.save());
        let mut running = None;
        self.advance(|next, view| {
            log.digests.push(PhaseDigest { phase: running, digest: view.digest_after(running) });
            running = Some(next);
        });
        let view = PhaseView::of(self.state.get(), &self.scratch);
        log.digests.push(PhaseDigest { phase: running, digest: view.digest_after(running) });
        self.phases = Some(log);
    }
}

pub(super) struct PhaseView<'a> {
    pub(super) state: &'a State,
    pub(super) solver: &'a Solver,
    pub(super) awake: &'a AwakeSet,
    pub(super) output: &'a NarrowPhaseOutput,
}

impl<'a> PhaseView<'a> {
    pub(super) fn of(state: &'a State, scratch: &'a Scratch) -> Self {
        let Scratch { solver, awake, contacts, .. } = scratch;
        PhaseView { state, solver, awake, output: contacts.output() }
    }

    fn digest_after(&self, phase: Option<Phase>) -> StateHash {
        let intermediate = match phase {
            Some(Phase::NarrowPhase) => self.manifolds(),
            Some(Phase::Prepare | Phase::Solve) => self.motions(),
            None | Some(Phase::BroadPhase | Phase::Finalise | Phase::Sleep | Phase::Report) => StateHash(0),
        };
        StateHash::of_digests([StateHash::of(self.state), intermediate])
    }

    fn manifolds(&self) -> StateHash {
        let listed = self.output.manifolds.iter().map(|manifold| {
            let points = manifold.points().iter();
            let points = points.map(|point| (point.anchor, point.separation, point.feature.0));
            (manifold.normal, manifold.origin, points.collect::<Vec<_>>())
        });
        StateHash::of(&(&self.output.contacts, listed.collect::<Vec<_>>()))
    }

    fn motions(&self) -> StateHash {
        let listed = self.awake.bodies().iter().map(|&slot| {
            let SolverBody { velocity, spin, shift, turn, .. } = *self.solver.body(slot);
            (slot, velocity, spin, shift, turn)
        });
        StateHash::of(&listed.collect::<Vec<_>>())
    }
}
