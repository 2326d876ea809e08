//! Joints that bear more than their threshold: the world reports them, and those that break are removed.

use alloc::vec::Vec;

use super::events::JointEvent;
use super::islands;
use super::scratch::Scratch;
use super::state::State;
use crate::body::{BodyId, Handle};
use crate::math::{Fx, Vec2};
use crate::solver::{Joint, Solver, Threshold, ThresholdAction, Tuning};

/// Looks at what the joints of the tick have borne in its last sub-step.
pub(super) fn report(state: &mut State, scratch: &mut Scratch, tuning: &Tuning) {
    let Scratch { roster, events, solver, .. } = scratch;
    // Joints break so rarely that this is no buffer of the scratch memory.
    let mut broken = Vec::new();
    for &slot in &roster.breakable {
        let joint = state.joints.at(slot);
        if let Some((force, torque)) = excess(state, solver, joint, tuning) {
            let broke = joint.def().threshold.action == ThresholdAction::Break;
            let id = state.joints.handle_at(slot);
            events.joints.push(JointEvent { joint: id, force, torque, broke });
            if broke {
                broken.push(id);
            }
        }
    }
    for &id in &broken {
        if let Some(joint) = state.joints.remove(id) {
            let (a, b) = joint.def().bodies();
            scratch.links.remove(id, (a, b));
            rejoined(state, scratch, [a, b]);
        }
    }
    scratch.roster.refresh(state);
}

/// The force and torque of a joint, if one of them is above the threshold.
fn excess(state: &State, solver: &mut Solver, joint: &Joint, tuning: &Tuning) -> Option<(Vec2<Fx>, Fx)> {
    let Threshold { force: most_force, torque: most_torque, action: _ } = joint.def().threshold;
    let (a, b) = joint.def().bodies();
    let (a, b) = (state.bodies.at(a.slot()), state.bodies.at(b.slot()));
    let (force, torque) = solver.reaction(joint, (a, b), tuning);
    let too_much = most_force.is_some_and(|most| force.length() > most)
        || most_torque.is_some_and(|most| torque.saturating_abs() > most);
    too_much.then_some((force, torque))
}

/// Wakes bodies whose joints have changed, and lets their contacts be looked at anew.
pub(super) fn rejoined(state: &mut State, scratch: &mut Scratch, bodies: [BodyId; 2]) {
    for id in bodies {
        islands::wake_body(state, scratch, id.slot());
        scratch.changes.body(state.bodies.at(id.slot()));
    }
    scratch.changes.rules = true;
    scratch.joined_stale = true;
    scratch.roster.invalidate();
}
