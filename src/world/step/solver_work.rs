//! Work of the solver that is known only within the tick: pairs that begin in it, and joints that are solved in blocks.

use crate::world::cache::{Scratch, pair_work};
use crate::world::state::State;

/// Work units of a joint in a block in each sub-step: a full block of 96 rows factors its matrix for both passes, in
/// several rounds if it has limits or motors.
const BLOCKED_JOINT_WORK: u64 = 96;

/// Number of pairs of shapes.
pub(super) fn pairs(state: &State) -> u64 {
    count(state.contacts.len() + state.sleeping_contacts.len())
}

/// Counts the work, with the number of pairs before the tick. Returns whether the budget covers it.
pub(super) fn spend(state: &State, scratch: &mut Scratch, pairs_before: u64) -> bool {
    let (sub_steps, iterations) = (state.config.solver.sub_steps, state.config.solver.iterations);
    let bodies = count(state.bodies.len());
    let begun = pair_work(pairs(state), bodies).saturating_sub(pair_work(pairs_before, bodies));
    let begun = begun.saturating_mul(u64::from(sub_steps) * u64::from(iterations));
    let blocked = count(scratch.solver.blocked_joint_count()).saturating_mul(BLOCKED_JOINT_WORK);
    scratch.meter.spend(begun.saturating_add(blocked.saturating_mul(sub_steps.into())))
}

fn count(n: usize) -> u64 {
    u64::try_from(n).unwrap_or(u64::MAX)
}
