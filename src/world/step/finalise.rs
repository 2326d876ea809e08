//! Copies the solver's velocities and poses to the state.

use super::continuous;
use crate::body::{BodyKind, Pose, WORLD_EXTENT_MAX};
use crate::math::{Angle, Fx, Vec2};
use crate::solver::{SolverBody, turn_of};
use crate::world::cache::Scratch;
use crate::world::movement::move_body;
use crate::world::state::State;

/// Moves the awake bodies to the poses that the solver has computed, and fast bodies as far as nothing stops them.
pub(super) fn finalise_poses(state: &mut State, scratch: &mut Scratch) {
    scratch.results.stats.impacts = 0;
    scratch.sweeps.starts.clear();
    scratch.sweeps.relative.clear();
    scratch.sweeps.bullets.clear();
    scratch.sweeps.left_boxes.clear();
    for index in 0..scratch.awake.bodies().len() {
        let slot = scratch.awake.bodies()[index];
        let body = state.bodies.at(slot);
        scratch.sweeps.starts.push(Pose { centre: body.centre, angle: body.angle });
        let end = finalise_body(state, scratch, slot);
        match continuous::swept_body(state, scratch, slot, end.pose, end.turn) {
            None => move_body(state, scratch, slot, end.pose),
            Some(fast) if continuous::is_bullet(state.bodies.at(slot)) => scratch.sweeps.bullets.push(fast),
            Some(fast) if continuous::sees_kinematic(state.bodies.at(slot)) => {
                scratch.sweeps.relative.push(fast)
            }
            // Only fixed bodies stop this body, so that it need not wait for all other bodies.
            Some(fast) => continuous::sweep(state, scratch, &fast),
        }
    }
    for index in 0..scratch.sweeps.relative.len() {
        let body = scratch.sweeps.relative[index];
        continuous::sweep(state, scratch, &body);
    }
    // Bullets are swept in slot order once all other bodies have been moved.
    for index in 0..scratch.sweeps.bullets.len() {
        let bullet = scratch.sweeps.bullets[index];
        continuous::sweep(state, scratch, &bullet);
    }
}

/// The end of a body's motion in the tick, as computed by the solver.
struct FinalPose {
    pose: Pose,
    /// Rotation in units of 2^-32 turns, with whole turns, which the angle of the pose does not contain.
    turn: i64,
}

/// Copies the velocity of a body from the solver, clears its forces, and returns the pose to which it has to be moved.
fn finalise_body(state: &mut State, scratch: &mut Scratch, slot: u32) -> FinalPose {
    let SolverBody { velocity, spin, shift, turn, .. } = *scratch.solver.body(slot);
    let body = state.bodies.at_mut(slot);
    body.velocity = velocity;
    body.spin = spin;
    body.hold_locked_axes();
    body.force = Vec2::ZERO;
    body.torque = Fx::ZERO;
    if body.kind() == BodyKind::Kinematic && !body.is_moving() && !body.rest_ticks.has_settled() {
        body.rest_ticks.settle();
        scratch.pairs.changes.body_changed(body);
    }
    let turn = turn_of(turn, body.mass.inverse_gyration);
    if let Some(target) = body.target.take() {
        body.stop();
        return FinalPose { pose: *target, turn };
    }
    let centre = body.centre + shift.widen();
    let edge = Vec2::new(WORLD_EXTENT_MAX, WORLD_EXTENT_MAX);
    let inside = centre.max(-edge).min(edge);
    scratch.solver.faults += u64::from(inside != centre);
    let angle = body.angle + Angle::from_turns(Fx::from_bits(turn));
    FinalPose { pose: Pose { centre: inside, angle }, turn }
}
