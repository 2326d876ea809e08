use crate::body::{Body, BodyKind, Handle};
use crate::math::{Shift, Speed, Vec2, narrow};
use crate::solver::SolverBody;
use crate::world::cache::Scratch;
use crate::world::islands::{put_sleepy_sets_to_sleep, unite_connected};
use crate::world::state::State;

pub(super) fn fall_asleep(state: &mut State, scratch: &mut Scratch) {
    if !state.config.sleeping {
        return;
    }
    let limit = state.config.ticks_to_sleep();
    if scratch.awake.may_have_kinematic() {
        keep_awake_on_moving_ground(state, scratch);
        keep_awake_on_moving_anchors(state, scratch);
    }
    let Scratch { awake, solver, .. } = scratch;
    let mut any_sleepy = false;
    for &slot in awake.bodies() {
        let body = state.bodies.at_mut(slot);
        if body.is_dynamic() {
            if is_slow(body, solver.body(slot), state.config.tick_rate) {
                body.rest_ticks.count(limit);
            } else {
                body.rest_ticks.reset();
            }
        }
        any_sleepy |= is_sleepy(body, limit);
    }
    if any_sleepy {
        unite_connected(state, scratch);
        let Scratch { awake, union, .. } = &mut *scratch;
        for &slot in awake.bodies() {
            if !is_sleepy(state.bodies.at(slot), limit) {
                union.keep_awake(slot);
            }
        }
        put_sleepy_sets_to_sleep(state, scratch);
    }
}

fn is_sleepy(body: &Body, limit: u32) -> bool {
    body.is_dynamic() && body.rest_ticks.has_reached(limit)
}

fn keep_awake_on_moving_ground(state: &mut State, scratch: &Scratch) {
    for pair in &scratch.contacts.output().touching {
        let (a, b) = pair.bodies;
        keep_awake_on(state, scratch, a, b);
        keep_awake_on(state, scratch, b, a);
    }
}

fn keep_awake_on_moving_anchors(state: &mut State, scratch: &Scratch) {
    for &joint in scratch.awake.joints() {
        let (a, b) = state.joints.at(joint).def().bodies();
        keep_awake_on(state, scratch, a.slot(), b.slot());
        keep_awake_on(state, scratch, b.slot(), a.slot());
    }
}

#[inline(always)]
fn keep_awake_on(state: &mut State, scratch: &Scratch, ground: u32, other: u32) {
    // Reads the velocity from the solver: in the state, it is already 0 if the ground has reached its target.
    let has_moved = || {
        let solved = scratch.solver.body(ground);
        solved.velocity != Vec2::ZERO || solved.spin != 0
    };
    if state.bodies.at(ground).kind() == BodyKind::Kinematic && has_moved() {
        state.bodies.at_mut(other).rest_ticks.reset();
    }
}

/// Whether a body was slow in this tick. Its displacement must be small too, because the solver can push overlapping
/// bodies apart without leaving a velocity.
fn is_slow(body: &Body, solved: &SolverBody, tick_rate: u32) -> bool {
    let square = |x: i32| i64::from(x) * i64::from(x);
    // `body.spin` is the speed at the radius of gyration; twice this is about the speed of the outline. Displacements
    // may have saturated at the limits of `i32`. The sum of two squares of such values exceeds `i64`, so it saturates.
    let fastest =
        |x: i32, y: i32, turn: i32| square(x).saturating_add(square(y)).max(square(turn).saturating_mul(4));
    let limit: Speed = narrow(body.settings.sleep_speed);
    let reach: Shift = narrow(body.settings.sleep_speed / i64::from(tick_rate));
    let (v, d) = (body.velocity, solved.shift);
    body.settings.may_sleep
        && fastest(v.x.to_bits(), v.y.to_bits(), body.spin.to_bits()) < square(limit.to_bits())
        && fastest(d.x.to_bits(), d.y.to_bits(), solved.turn.to_bits()) < square(reach.to_bits())
}
