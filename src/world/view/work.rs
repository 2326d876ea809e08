//! The cost of a tick, to limit the computing time of untrusted input.

use crate::collision::Moved;
use crate::solver::SolverSettings;
use crate::world::World;
use crate::world::cache::{NARROW_PHASE_WORK, pair_work, search_work, visit_work};
use crate::world::state::State;

/// Work units of the tick itself, even if the world is empty. Such a tick takes some microseconds.
const TICK_WORK: u64 = 8;

/// Number of slots that are visited in one work unit.
const SCANNED_PER_WORK: usize = 16;

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AddedWork {
    pub(crate) bodies: u64,
    pub(crate) shapes: u64,
    pub(crate) joints: u64,
}

impl World {
    /// Returns an upper bound of the cost of the next tick in work units, as far as it is known before the tick.
    /// `bodies` and `shapes` are the largest numbers of bodies and shapes that may be added before the tick.
    /// [`Game::work`](crate::lockstep::Game::work) can be based on the result.
    ///
    /// The bound is the number of bodies, pairs and joints, times the solver's sub-steps and iterations, plus 4 for
    /// each pair, 1 for each shape, 1/16 for each slot of a body, shape, joint or island (including free slots), and 8
    /// for the tick. In the product, each pair beyond 32 per body counts as 65. The bound does not include the work of
    /// finding pairs and of solving new pairs and the pairs of woken bodies. A verifier counts this work during the
    /// tick, if [`Game::world_mut`](crate::lockstep::Game::world_mut) gives access to the world.
    ///
    /// ```
    /// # use lockstep2d::world::World;
    /// let world = World::default();
    /// assert_eq!(world.work(0, 0), 8);
    /// assert!(world.work(10, 20) > world.work(10, 10));
    /// ```
    #[must_use]
    pub fn work(&self, bodies: u64, shapes: u64) -> u64 {
        let SolverSettings { sub_steps, iterations, .. } = self.config().solver;
        let added = AddedWork { bodies, shapes, joints: 0 };
        self.work_in_rounds(added, u64::from(sub_steps) * u64::from(iterations))
    }

    /// `rounds` is the number of passes of the solver in a tick: sub-steps times iterations.
    pub(crate) fn work_in_rounds(&self, added: AddedWork, rounds: u64) -> u64 {
        let AddedWork { bodies, shapes, joints } = added;
        let count = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
        let shapes = count(self.shape_count()).saturating_add(shapes);
        let bodies = count(self.body_count()).saturating_add(bodies);
        let joints = count(self.joint_count()).saturating_add(joints);
        let pairs = count(self.pair_count());
        let constraints = joints.saturating_add(pair_work(pairs, bodies));
        let solved = bodies.saturating_add(constraints).saturating_mul(rounds);
        let narrow_phase = pairs.saturating_mul(NARROW_PHASE_WORK);
        [solved, shapes, narrow_phase, self.scan_work()].into_iter().fold(TICK_WORK, u64::saturating_add)
    }

    /// Work units of visiting all slots, including free ones: a slot remains when its body, shape, joint or island is
    /// removed.
    pub(crate) fn scan_work(&self) -> u64 {
        let State { bodies, shapes, joints, islands, .. } = &*self.state;
        let slots = [bodies.slot_count(), shapes.slot_count(), joints.slot_count(), islands.slot_count()];
        u64::try_from(slots.iter().sum::<usize>() / SCANNED_PER_WORK).unwrap_or(u64::MAX)
    }

    /// Exempts the work that the next tick needs in addition if the world was decoded: its caches are new, so the tick
    /// searches all pairs and visits all sleeping contacts. Exempts nothing if the caches are not new.
    pub(crate) fn exempt_fresh_caches(&mut self) {
        if !self.scratch.pairs.changes.all() {
            return;
        }
        let search = search_work(self.scratch.shapes.broad_phase().comparisons(Moved::All));
        self.scratch.meter.exempt(search.saturating_add(visit_work(&self.state.sleeping_contacts)));
    }

    /// Starts to count work whose amount is known only after it is done, such as sweeps of fast bodies, the search for
    /// pairs, new and woken pairs, joints in blocks, and shapes in reach of an explosion. Work beyond `max` units may
    /// be skipped, so the state may be wrong from then on.
    pub(crate) fn start_work_meter(&mut self, max: u64) {
        self.scratch.meter.start(max);
    }

    pub(crate) fn is_work_exhausted(&self) -> bool {
        self.scratch.meter.is_exhausted()
    }

    /// Stops counting and removes the limit. Returns the work units counted since the start.
    pub(crate) fn stop_work_meter(&mut self) -> u64 {
        core::mem::take(&mut self.scratch.meter).spent()
    }
}
