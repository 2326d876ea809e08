use alloc::vec::Vec;
use core::ops::ControlFlow;

use crate::body::{BodyId, Handle, IslandId};
use crate::collision::{Contact, Pair};
use crate::math::Fx;
use crate::world::cache::{NARROW_PHASE_WORK, Scratch};
use crate::world::state::State;

/// Number of visited boxes that together cost one work unit.
const VISITS_PER_WORK: u64 = 4;

/// Wakes an island. Its sleeping contacts become active at the next pair update.
pub(crate) fn wake_island(state: &mut State, scratch: &mut Scratch, island: IslandId) {
    let Some(island) = state.islands.remove(island) else { return };
    for slot in island.bodies {
        let body = state.bodies.at_mut(slot);
        body.island = None;
        body.rest_ticks.reset();
        scratch.pairs.changes.body_changed(body);
    }
    scratch.pairs.changes.sleeping_contacts_changed();
    scratch.awake.invalidate();
}

/// Wakes a body with its island, and restarts its count of ticks at rest. A resting kinematic body becomes active for
/// one tick, and thereby wakes all islands that touch it.
pub(crate) fn wake_body(state: &mut State, scratch: &mut Scratch, slot: u32) {
    scratch.pairs.changes.compact();
    let body = state.bodies.at_mut(slot);
    let was_settled = !body.is_dynamic() && body.rest_ticks.has_settled();
    body.rest_ticks.reset();
    match body.island {
        Some(island) => wake_island(state, scratch, island),
        None if was_settled => {
            scratch.pairs.changes.body_changed(body);
            scratch.pairs.changes.sleeping_contacts_changed();
        }
        None => {}
    }
}

/// Wakes a body if it is dynamic. For changes in the surroundings of a body that do not affect kinematic bodies.
fn wake_dynamic(state: &mut State, scratch: &mut Scratch, slot: u32) {
    if state.bodies.at(slot).is_dynamic() {
        wake_body(state, scratch, slot);
    }
}

/// Restarts the counts of ticks at rest of two bodies that no longer touch. A slow body that has lost its support would
/// otherwise fall asleep before it begins to fall.
pub(crate) fn contact_ended(state: &mut State, (a, b): Pair) {
    for shape in [a, b] {
        let slot = state.shapes.at(shape).body().slot();
        if state.bodies.at(slot).is_dynamic() {
            state.bodies.at_mut(slot).rest_ticks.reset();
        }
    }
}

/// Wakes a body and the bodies whose fat boxes overlap its own, and restarts their counts of ticks at rest. Called
/// before and after a change of fat boxes.
pub(crate) fn wake_overlapping(state: &mut State, scratch: &mut Scratch, slot: u32) {
    wake_body(state, scratch, slot);
    for index in 0..state.bodies.at(slot).shapes().len() {
        let shape = state.bodies.at(slot).shapes()[index];
        wake_overlapping_shape(state, scratch, shape.slot());
    }
}

pub(crate) fn wake_overlapping_shape(state: &mut State, scratch: &mut Scratch, shape: u32) {
    let (mut neighbours, mut visited) = (Vec::new(), 0u64);
    let is_dynamic = state.body_of(shape).is_dynamic();
    scratch.shapes.broad_phase().each_overlap_of(false, state.shapes.at(shape).fat, |other| {
        visited += 1;
        // Wakes a kinematic body only for a sensor pair with another body that is not dynamic: without an active body,
        // the pair would have no events.
        let is_sensed = || {
            let pair = (shape.min(other), shape.max(other));
            !is_dynamic
                && state.sensor_of(pair).is_some()
                && scratch.pairs.non_colliding.may_touch(state, pair)
        };
        if state.body_of(other).is_dynamic() || is_sensed() {
            neighbours.push(state.shapes.at(other).body().slot());
        }
        ControlFlow::Continue(())
    });
    scratch.meter.spend(visited / VISITS_PER_WORK);
    // The broad phase visits boxes in no defined order.
    neighbours.sort_unstable();
    neighbours.dedup();
    for body in neighbours {
        wake_body(state, scratch, body);
    }
}

/// Wakes the sleeping bodies that touch the body in `slot`, which is not dynamic, and those that an area connects to it.
pub(crate) fn wake_touching(state: &mut State, scratch: &mut Scratch, slot: u32) {
    scratch.meter.spend_visit(&state.sleeping_contacts);
    let other_body = |contact: &Contact| {
        let (a, b) = contact.shapes;
        let (body_a, body_b) = (state.shapes.at(a).body().slot(), state.shapes.at(b).body().slot());
        let other = if body_a == slot { Some(body_b) } else { (body_b == slot).then_some(body_a) };
        let connects = || state.sensor_of(contact.shapes).is_none() || state.has_area(contact.shapes);
        other.filter(|_| contact.touching && connects())
    };
    let mut touching: Vec<u32> = state.sleeping_contacts.iter().filter_map(other_body).collect();
    add_touching(state, scratch, slot, &mut touching);
    for body in touching {
        wake_dynamic(state, scratch, body);
    }
}

/// Adds the sleeping bodies whose shapes touch the body in `slot`, in slot order. A body that was put to sleep before it
/// took part in a tick has no contacts yet.
fn add_touching(state: &State, scratch: &mut Scratch, slot: u32, touching: &mut Vec<u32>) {
    scratch.pairs.non_colliding.refresh(state);
    let Scratch { shapes, pairs, meter, .. } = scratch;
    let (mut found, mut visited) = (Vec::new(), 0u64);
    for shape in state.bodies.at(slot).shapes() {
        let shape = shape.slot();
        shapes.broad_phase().each_overlap_of(false, state.shapes.at(shape).fat, |other| {
            visited += 1;
            if state.body_of(other).is_asleep() {
                found.push((shape.min(other), shape.max(other), state.shapes.at(other).body().slot()));
            }
            ControlFlow::Continue(())
        });
    }
    meter.spend(visited / VISITS_PER_WORK);
    found.retain(|&(a, b, _)| {
        let pair = (a, b);
        let reach = if state.has_area(pair) { Fx::ZERO } else { state.config.touching_distance() };
        pairs.non_colliding.may_touch(state, pair)
            && state.supports(pair)
            && meter.spend(NARROW_PHASE_WORK)
            && shapes.poses().are_within(pair, reach)
    });
    // The broad phase visits boxes in no defined order.
    found.sort_unstable();
    touching.extend(found.into_iter().map(|(.., body)| body));
}

/// Wakes the bodies that joints connect to a body, and restarts their counts of ticks at rest.
pub(crate) fn wake_joined(state: &mut State, scratch: &mut Scratch, id: BodyId) {
    let joints = scratch.joint_links.of(state, id);
    scratch.meter.spend(u64::try_from(joints.len()).unwrap_or(u64::MAX));
    for joint in joints {
        let (a, b) = state.joints.at(joint.slot()).def().bodies();
        for body in [a, b] {
            wake_dynamic(state, scratch, body.slot());
        }
    }
}

/// Wakes two bodies after a change of their joint that does not affect whether they may collide.
pub(crate) fn joint_retuned(state: &mut State, scratch: &mut Scratch, bodies: [BodyId; 2]) {
    for id in bodies {
        wake_dynamic(state, scratch, id.slot());
    }
    scratch.awake.invalidate();
}

/// Wakes bodies after a change of their joints that may affect whether the bodies collide. `bodies` may list a body
/// repeatedly.
pub(crate) fn joints_changed(state: &mut State, scratch: &mut Scratch, mut bodies: Vec<BodyId>) {
    if bodies.is_empty() {
        return;
    }
    bodies.sort_unstable();
    bodies.dedup();
    for id in bodies {
        wake_dynamic(state, scratch, id.slot());
        scratch.pairs.changes.body_changed(state.bodies.at(id.slot()));
    }
    scratch.pairs.changes.rules_changed();
    scratch.pairs.non_colliding.invalidate();
    scratch.awake.invalidate();
}
