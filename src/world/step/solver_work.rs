//! Work of the solver whose amount is known only during the tick.

use crate::world::cache::{NARROW_PHASE_WORK, NEW_PAIR_WORK, Scratch, pair_work};
use crate::world::state::State;

/// Work units in each iteration of the solver for each joint that is solved in a block. The number allows for full
/// blocks: a matrix of 96 rows is factored for the bias pass and again for the relax pass, in several rounds if the
/// block has limits or motors.
const BLOCKED_JOINT_WORK: u64 = 96;

/// Number of active contacts, whether or not they touch.
pub(super) fn pairs(state: &State) -> u64 {
    count(state.contacts.len())
}

/// Counts the work of new and woken pairs, and of the joints that are solved in blocks. `pairs_before` is the number of
/// active contacts at the start of the tick. Returns whether the work budget covers the work.
pub(super) fn spend(state: &State, scratch: &mut Scratch, pairs_before: u64) -> bool {
    let (sub_steps, iterations) = (state.config.solver.sub_steps, state.config.solver.iterations);
    let (bodies, pairs) = (count(state.bodies.len()), pairs(state));
    let solved = pair_work(pairs, bodies).saturating_sub(pair_work(pairs_before, bodies));
    let rounds = u64::from(sub_steps) * u64::from(iterations);
    let solved = solved.saturating_mul(rounds);
    let found = pairs.saturating_sub(pairs_before).saturating_mul(NEW_PAIR_WORK + NARROW_PHASE_WORK);
    let blocked = count(scratch.solver.blocked_joint_count()).saturating_mul(BLOCKED_JOINT_WORK);
    let blocked = blocked.saturating_mul(rounds);
    scratch.meter.spend(solved.saturating_add(found).saturating_add(blocked))
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}
