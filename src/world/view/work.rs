//! The cost of a tick, for limits on what an untrusted input may make a machine compute.

use crate::solver::SolverSettings;
use crate::world::World;

/// Pairs per body that are assumed to be solved in SIMD batches of eight. A heap that is not forced together has up to
/// six pairs per body.
const PAIRS_PER_BODY: u64 = 32;

/// Cost of a pair beyond [`PAIRS_PER_BODY`], in ordinary pairs: measured on a thousand squares at the same position.
const CROWDED_WORK: u64 = 64;

impl World {
    /// Returns an upper bound of the cost of the next tick in work units, if at most `bodies` bodies with `shapes` shapes
    /// altogether are added before it: a start for [`Game::work`](crate::lockstep::Game::work). It counts bodies, shapes,
    /// pairs and joints, times the solver's sub-steps and iterations. Shapes may be added on top of each other: it
    /// assumes as many new pairs as the world allows, for which every shape is compared with every other.
    ///
    /// ```
    /// # use lockstep2d::world::World;
    /// let world = World::default();
    /// assert_eq!(world.work(0, 0), 0);
    /// assert!(world.work(10, 20) > world.work(10, 10));
    /// ```
    #[must_use]
    pub fn work(&self, bodies: u64, shapes: u64) -> u64 {
        let SolverSettings { sub_steps, iterations, .. } = self.config().solver;
        self.work_in_rounds(bodies, shapes, u64::from(sub_steps) * u64::from(iterations))
    }

    /// [`World::work`] with a number of passes of the solver in a tick: sub-steps times iterations.
    pub(crate) fn work_in_rounds(&self, bodies: u64, shapes: u64, rounds: u64) -> u64 {
        let count = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
        let shapes = count(self.shape_count()).saturating_add(shapes);
        let bodies = count(self.body_count()).saturating_add(bodies);
        let constraints = count(self.pair_count()).saturating_add(count(self.joint_count()));
        // In a heap of overlapping bodies, many contacts find no free place in a SIMD batch.
        let crowded = count(self.pair_count()).saturating_sub(bodies.saturating_mul(PAIRS_PER_BODY));
        let constraints = constraints.saturating_add(crowded.saturating_mul(CROWDED_WORK));
        let solved = bodies.saturating_add(shapes).saturating_add(constraints).saturating_mul(rounds);
        let compared = shapes.saturating_mul(shapes);
        let possible_pairs = (compared / 2).min(self.config().pair_limit.into());
        solved.saturating_add(possible_pairs).saturating_add(compared / 64)
    }
}
