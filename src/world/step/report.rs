use crate::world::cache::Scratch;
use crate::world::events::MoveEvent;
use crate::world::state::State;
use crate::world::stats::StepStats;

/// Adds a move event for each body that has moved or has fallen asleep in the tick, in slot order.
pub(super) fn report_moves(state: &State, scratch: &mut Scratch) {
    let Scratch { awake, sweeps, results, .. } = scratch;
    for (&slot, &start) in awake.bodies().iter().zip(&sweeps.starts) {
        let body = state.bodies.at(slot);
        let fell_asleep = body.is_asleep();
        // Compares poses instead of velocities, because a body whose velocity is 0 may have moved: continuous collision
        // lets a fast kinematic body carry the bodies in its way.
        if fell_asleep || body.pose() != start {
            let (position, angle) = (body.position(), body.angle());
            let body = state.bodies.handle_at(slot);
            results.events.moved.push(MoveEvent { body, position, angle, fell_asleep });
        }
    }
}

pub(super) fn count(state: &mut State, scratch: &mut Scratch) {
    let Scratch { solver, results, contacts, awake, .. } = scratch;
    let (stats, output) = (&mut results.stats, contacts.output());
    let faults = solver.faults + u64::from(state.pairs_left_out);
    state.faults = state.faults.saturating_add(faults);
    let count = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    *stats = StepStats {
        bodies: count(awake.bodies().len()),
        joints: count(awake.joints().len()),
        pairs: count(state.contacts.len()),
        contacts: count(output.touching.len()),
        points: solver.warm_starts.points,
        points_kept: solver.warm_starts.kept,
        points_lost: solver.warm_starts.lost,
        axis_hits: output.sat.cached_axis_hits,
        axis_searches: output.sat.searches,
        impacts: stats.impacts,
        faults,
    };
}
